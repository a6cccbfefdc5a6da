/** The faceplate of a machine: where its modules and jacks are, and their picture. */

import { joined, keyed, named, quantity, shape, svg } from './dom.js';
import { read } from './resources.js';

/** The least distance of jacks. */
export const PITCH = 28;
const [ROW, PAD, GAP, MARGIN, HEAD] = [46, 9, 14, 24, 44];
/** Sections become wider by at most this factor, so that a row fills the panel. */
const STRETCH = 1.3;

const isGain = ({ name }) => /^x\d/.test(name);

/** Reads a file of the folder of faceplates. */
export const faceplate = async (name) => (await read(`faceplates/${name}.json`)).json();

/** The sections with their modules. An unlimited machine has a free module in each section that is always shown. */
function fill(plate, { elements, outputs, parts }, kinds) {
  const sections = plate.sections.map((row) => ({ ...row, modules: [] }));
  for (const { name: output } of outputs) if (output in plate.references) sections.find((row) => row.references).modules.push({ output });
  for (const element of elements) {
    const needs = named(kinds, element.kind)?.parts ?? [];
    const home = sections.find((row) => row.kinds?.includes(element.kind) || row.family === element.family)
      ?? sections.find(({ part }) => needs.includes(part)) ?? sections.at(-1);
    home.modules.push({ element });
    for (const [key, names] of element.parts) {
      const row = sections.find(({ part }) => part === key);
      if (row && row !== home) row.modules.push(...(names.length ? names : ['']).map((part) => ({ helps: element.name, part })));
    }
  }
  for (const { part, columns, min, modules } of sections) {
    const { used = 0, available = null } = parts.find(({ key }) => key === part) ?? {};
    while (modules.length < used) modules.push({ helps: 'another element' });
    const count = available ?? (min && Math.max(min, Math.ceil((modules.length + 1) / columns) * columns));
    while (modules.length < count) modules.push({});
  }
  return sections.filter(({ modules }) => modules.length);
}

/** Places the jacks of a module: by name where the faceplate has a place, the others where there is room. */
function connect(module, { jacks: own = {}, out: [left, top] }) {
  const { element, output } = module;
  module.outs = (element?.outputs ?? [output]).map((name, row) =>
    ({ type: 'out', output: name, element: element?.name, x: left, y: top + row * ROW }));
  const holes = Object.keys(own).map((name) => ({ name, label: name.slice(1), description: '', most: null, cords: [] }));
  const views = element ? [...element.jacks] : output ? [] : holes;
  // Every gain of a summing input at the faceplate can be used.
  if (element && views.some(isGain)) views.push(...holes.filter((hole) => isGain(hole) && !named(views, hole.name)));
  module.jacks = views.map((view) =>
    ({ type: 'in', element: element?.name, jack: view.name, view, x: own[view.name]?.[0], y: own[view.name]?.[1] }));
  let [x, y] = [20, top];
  for (const jack of module.jacks) {
    while (jack.x === undefined) {
      if (!module.jacks.some((other) => other.y === y && Math.abs(other.x - x) < PITCH)) [jack.x, jack.y] = [x, y];
      x += PITCH;
      if (x > left - PITCH) [x, y] = [20, y + ROW];
    }
  }
  module.jacks.sort((one, other) => one.y - other.y || one.x - other.x);
}

/** Places the modules of a section. */
function place(section, stretch) {
  const { x, y, columns, modules, template: { size, knob } } = section;
  const w = size[0] * stretch;
  const shift = (w - size[0]) / 2;
  let top = y + 24;
  for (let first = 0; first < modules.length; first += columns) {
    const row = modules.slice(first, first + columns);
    const h = Math.max(size[1], ...row.flatMap(({ jacks, outs }) => [...jacks, ...outs].map((jack) => jack.y + 36)));
    row.forEach((module, index) => {
      const at = [x + PAD + index * w, top];
      Object.assign(module, { at, w: w - 4, h: h - 4, knob: knob && [knob[0] + shift, knob[1]] });
      for (const jack of [...module.jacks, ...module.outs]) [jack.x, jack.y] = [at[0] + jack.x + shift, top + jack.y];
    });
    top += h;
  }
  Object.assign(section, { w: columns * w + 2 * PAD, h: top - y + PAD - 4 });
}

/** Where everything is: sections from left to right and top to bottom, as wide as the panel. */
function arrange(plate, patch, kinds) {
  const rows = [];
  const room = plate.width - 2 * MARGIN;
  let width = room;
  for (const section of fill(plate, patch, kinds)) {
    const template = plate.modules[section.module];
    const columns = Math.min(section.columns, section.modules.length);
    const wide = columns * template.size[0];
    section.modules.forEach((module) => connect(module, template));
    if (width + wide + 2 * PAD > room) {
      rows.push([]);
      width = 0;
    }
    width += wide + 2 * PAD + GAP;
    rows.at(-1).push({ ...section, columns, template, wide });
  }
  let y = HEAD;
  for (const row of rows) {
    const stretch = Math.min((room - row.length * (2 * PAD + GAP) + GAP) / row.reduce((sum, { wide }) => sum + wide, 0), STRETCH);
    let x = MARGIN;
    for (const section of row) {
      place(Object.assign(section, { x, y }), stretch);
      x += section.w + GAP;
    }
    const h = Math.max(...row.map((section) => section.h));
    for (const section of row) section.h = h;
    y += h + GAP;
  }
  return { sections: rows.flat(), height: y + 22 };
}

/** What a module shows of its settings, in a few letters. */
function caption({ kind, settings }, name) {
  const set = Object.fromEntries(settings.filter(({ value, text }) => value !== null || text !== null).map((one) => [one.name, one]));
  if (set.setting) return set.setting.value?.toFixed(4) ?? set.setting.text;
  const rows = [['initial', 'IC'], ['limit.upper', '≤'], ['limit.lower', '≥']].filter(([key]) => set[key])
    .map(([key, sign]) => `${sign} ${quantity(set[key].value, 'V')}`);
  const words = settings.filter(({ form, value }) => form === 'choice' && value !== null).map((one) => one.words[one.value]);
  return joined([name, ...rows, ...words, kind === 'key-switch' && (set.closed?.value ? 'closed' : 'open')], ' · ');
}

const move = ([x, y]) => ({ transform: `translate(${x} ${y})` });
/** A text, compressed if it is too long for its room. */
function text(kind, x, y, content = '', room = Infinity, size = 6.1) {
  return svg('text', {
    class: kind, x, y, ...content.length * size > room && { textLength: room, lengthAdjust: 'spacingAndGlyphs' }
  }, content);
}

/**
 * Draws a faceplate. `stops` are jacks, modules and free places by their keys; `live` is what changes in a run.
 * @returns {{node: Element, live: Element[], stops: Map<string, any>, outs: any[], lamps: any[], width: number, height: number}}
 */
export function draw(plate, patch, kinds) {
  const { width } = plate;
  const { sections, height } = arrange(plate, patch, kinds);
  const stops = new Map();
  const [outs, lamps] = [[], []];
  function drawJack({ x, y, ...data }, name, label) {
    const key = name && `${data.type}:${name}`;
    const { most, cords } = data.view ?? {};
    const isFull = most !== null && most <= cords?.length;
    const node = shape('jack', { class: `jack ${data.type}${isFull ? ' is-full' : ''}`, ...move([x, y]), ...keyed(key) });
    if (label) node.append(text('jack-label', 0, -15, label, 27));
    if (key) stops.set(key, { key, node, name, x, y, ...data });
    if (key && data.type === 'out') outs.push({ name, node: text('volts', x, y + 25) });
    return node;
  }
  function drawModule({ element, output, helps, part, at, w, h, jacks, outs: own, knob }, section, index) {
    const type = element ? 'module' : output || helps ? null : 'free';
    const key = type && `${type}:${element?.name ?? section.title + index}`;
    const face = svg('g', { class: 'plate', ...keyed(key) }, svg('rect', { width: w, height: h, rx: 4 }),
      text('name', 9, 18, element?.name ?? plate.references[output] ?? part, w - (element?.lamp ? 32 : 14), 8));
    if (key) stops.set(key, { key, node: face, type, name: element?.name, element, section, x: at[0] + 24, y: at[1] + 14, box: [...at, w, h] });
    if (element?.lamp) lamps.push({
      output: element.outputs[0], node: svg('circle', { class: 'bulb', r: 5, ...move([at[0] + w - 14, at[1] + 13]) })
    });
    const line = element ? caption(element, section.add !== element.kind && element.kind.replaceAll('-', ' ')) : helps && `of ${helps}`;
    const pot = knob && shape('pot', { 'data-knob': element?.name, ...move(knob) });
    const setting = named(element?.settings, 'setting')?.value ?? 0;
    pot?.lastElementChild.setAttribute('transform', `rotate(${300 * setting - 150})`);
    return svg('g', { class: `module${element || output ? '' : helps ? ' is-helper' : ' is-free'}` },
      svg('g', move(at), face,
        knob ? text('caption is-middle', knob[0], knob[1] + 28, line || '') : text('caption', 9, 33, line || '', w - 14),
        pot),
      jacks.map((jack) => drawJack(jack, element && `${element.name}.${jack.jack}`,
        jack.view.label !== 'in' && element && jack.view.label)),
      own.map((out) => drawJack(out, out.output, own.length > 1 && out.output.slice(element.name.length + 1))));
  }
  const drawFrame = ({ x, y, w, h, title, class: kind }) =>
    shape('section', { class: `section ${kind}`, x, y, width: w, height: h }, text('section-title', 25, 17, title));
  const panel = shape('panel', { width, height });
  panel.querySelector('.make').textContent = plate.title;
  panel.querySelector('.small-print').textContent = plate.note;
  const node = svg('g', { class: `faceplate ${plate.class}` }, panel,
    sections.flatMap((section) => [drawFrame(section), ...section.modules.map((module, index) => drawModule(module, section, index))]));
  return { node, live: [...outs, ...lamps].map((one) => one.node), stops, outs, lamps, width, height };
}
