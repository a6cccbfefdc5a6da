/** The faceplate of a machine: where its modules and jacks are, and their picture. */

import { quantity, svg } from './dom.js';

const PITCH = 28;
const ROW = 40;
const PAD = 9;
const GAP = 14;
const MARGIN = 24;
const TITLE = 24;
const HEAD = 44;
/** Sections are made wider by at most this factor, so that a row fills the panel. */
const STRETCH = 1.3;

/** Reads a file of the folder of faceplates. */
export async function faceplate(name) {
  return (await fetch(`faceplates/${name}.json`)).json();
}

/** The modules of each section, in order. An unlimited machine has at least one free module in a section that is always shown. */
function fill(plate, { elements, outputs, parts }, kinds) {
  const partsOf = (kind) => kinds.find(({ name }) => name === kind)?.parts ?? [];
  const sections = plate.sections.map((row) => ({ ...row, slots: [] }));
  const homeOf = ({ kind, family }) => sections.find((row) => row.kinds?.includes(kind) || row.family === family)
    ?? sections.find(({ part }) => partsOf(kind).includes(part)) ?? sections.at(-1);
  for (const { name } of outputs) {
    if (name in plate.references) sections.find(({ references }) => references).slots.push({ output: name });
  }
  for (const element of elements) {
    const home = homeOf(element);
    home.slots.push({ element });
    for (const [key, names] of element.parts) {
      const row = sections.find(({ part }) => part === key);
      for (const name of names.length ? names : ['']) {
        if (row && row !== home) row.slots.push({ helps: element.name, part: name });
      }
    }
  }
  for (const { part, columns, min, slots, references } of sections) {
    const { used = 0, available = null } = parts.find(({ key }) => key === part) ?? {};
    while (slots.length < used) slots.push({ helps: 'another element' });
    const grown = min && !references ? Math.max(min, Math.ceil((slots.length + 1) / columns) * columns) : 0;
    while (slots.length < (available ?? grown)) slots.push({});
  }
  return sections.filter(({ slots }) => slots.length);
}

/** Gives the jacks of an element their places: those of the module by name, and others where there is room. */
function connect(slot, { jacks: own = {}, out }) {
  const { element, output } = slot;
  if (output) return { jacks: [], outs: [{ name: output, x: out[0], y: out[1] }] };
  if (!element) return { jacks: Object.values(own).map(([x, y]) => ({ x, y })), outs: [{ x: out[0], y: out[1] }] };
  const list = [...element.jacks];
  if (list.some(({ name }) => /^x\d/.test(name))) {
    for (const name of Object.keys(own)) {
      if (/^x\d/.test(name) && !list.some((jack) => jack.name === name)) list.push({ name, label: name.slice(1), description: '', most: null, cords: [] });
    }
  }
  const jacks = list.map((jack) => ({ jack, element: element.name, x: own[jack.name]?.[0], y: own[jack.name]?.[1] }));
  let row = 0;
  let x = 20;
  for (const place of jacks) {
    while (place.x === undefined) {
      const y = out[1] + row * ROW;
      if (!jacks.some((other) => other.y === y && Math.abs(other.x - x) < 20)) Object.assign(place, { x, y });
      x += PITCH;
      if (x > out[0] - PITCH) [x, row] = [20, row + 1];
    }
  }
  jacks.sort((one, other) => one.y - other.y || one.x - other.x);
  return { jacks, outs: element.outputs.map((name, index) => ({ name, element: element.name, x: out[0], y: out[1] + index * ROW })) };
}

/** Where everything is: sections from left to right and top to bottom, as wide as the panel. */
export function arrange(plate, patch, kinds) {
  const rows = [];
  let width = 0;
  for (const section of fill(plate, patch, kinds)) {
    const module = plate.modules[section.module];
    const columns = Math.min(section.columns, section.slots.length);
    const wide = columns * module.size[0];
    if (!rows.length || width + wide + 2 * PAD > plate.width - 2 * MARGIN) {
      rows.push([]);
      width = 0;
    }
    width += wide + 2 * PAD + GAP;
    rows.at(-1).push({ ...section, columns, wide, template: module });
  }
  const sections = [];
  let y = HEAD;
  for (const row of rows) {
    const free = plate.width - 2 * MARGIN - (row.length - 1) * GAP - row.length * 2 * PAD;
    const stretch = Math.min(free / row.reduce((sum, { wide }) => sum + wide, 0), STRETCH);
    let x = MARGIN;
    for (const section of row) {
      const w = section.wide * stretch + 2 * PAD;
      sections.push({ ...section, x, y, w, ...place(section, x + PAD, y + TITLE, (section.wide * stretch) / section.columns) });
      x += w + GAP;
    }
    const height = Math.max(...sections.slice(-row.length).map(({ h }) => h));
    for (const section of sections.slice(-row.length)) section.h = height;
    y += height + GAP;
  }
  return { plate, sections, width: plate.width, height: y + 22 };
}

/** The modules of a section. */
function place({ slots, columns, template }, left, top, w) {
  const modules = [];
  let y = top;
  for (let first = 0; first < slots.length; first += columns) {
    const row = slots.slice(first, first + columns).map((slot) => ({ ...slot, ...connect(slot, template) }));
    const h = Math.max(template.size[1], ...row.flatMap(({ jacks, outs }) => [...jacks, ...outs].map((jack) => jack.y + 36)));
    const shift = (w - template.size[0]) / 2;
    row.forEach((slot, index) => {
      for (const jack of [...slot.jacks, ...slot.outs]) jack.x += shift;
      modules.push({ ...slot, x: left + index * w, y, w: w - 4, h: h - 4, knob: template.knob && [template.knob[0] + shift, template.knob[1]] });
    });
    y += h;
  }
  return { modules, h: y - top + TITLE + PAD - 4 };
}

const setting = ({ settings }, name) => settings.find((one) => one.name === name && (one.value !== null || one.text !== null));

/** What a module shows of its settings, in a few letters. */
function caption(element) {
  const pot = setting(element, 'setting');
  if (pot) return pot.value === null ? pot.text : pot.value.toFixed(4);
  const [initial, upper, lower] = ['initial', 'limit.upper', 'limit.lower'].map((name) => setting(element, name)?.value);
  const flag = element.settings.find(({ form }) => form === 'flag');
  const choice = element.settings.find(({ form, value }) => form === 'choice' && value !== null);
  return [initial !== undefined && `IC ${quantity(initial, 'V')}`, upper !== undefined && `≤ ${quantity(upper, 'V')}`, lower !== undefined && `≥ ${quantity(lower, 'V')}`,
    choice?.words[choice.value], element.kind === 'key-switch' && (flag?.value ? 'closed' : 'open')].filter(Boolean).join(' ');
}

/** Compresses a text that is too long. */
function squeeze(line, room, size = 6.1) {
  if (line.textContent.length * size > room) for (const [name, value] of [['textLength', room], ['lengthAdjust', 'spacingAndGlyphs']]) line.setAttribute(name, value);
  else line.removeAttribute('textLength');
  return line;
}

/** Something that can have the focus. */
const stop = (attributes, ...children) => svg('g', { role: 'button', tabindex: -1, ...attributes }, children);

function drawJack({ x, y, jack, name }, key, label) {
  return stop({ class: `jack ${jack ? 'in' : 'out'}`, 'data-key': key, transform: `translate(${x} ${y})` },
    svg('circle', { class: 'collar', r: 10.5 }), svg('circle', { class: 'metal', r: 7.5, fill: 'url(#board-metal)' }), svg('circle', { class: 'hole', r: 4 }),
    label && squeeze(svg('text', { y: -15, class: 'jack-label' }, label), 27), name && svg('text', { class: 'volts', y: 25 }));
}

/**
 * Draws a faceplate.
 * @returns {{node: Element, stops: Map<string, any>, outs: any[], lamps: any[], show: (patch: any) => void}} stops are jacks,
 *   modules and free places by their keys; `show` writes the settings
 */
export function draw({ plate, sections, width, height }) {
  const stops = new Map();
  const outs = [];
  const lamps = [];
  const captions = [];
  const add = (key, node, data) => stops.set(key, { key, node, ...data });
  const drawModule = (module, section, index) => {
    const { element, output, helps, part, x, y, w, h, jacks, outs: own, knob } = module;
    const isUsed = Boolean(element || output);
    const key = isUsed ? `module:${element?.name ?? output}` : helps ? null : `empty:${section.title}:${index}`;
    const title = element?.name ?? (output ? plate.references[output] : part || '');
    const about = element ? `${element.name}, ${element.kind}` : `Free: ${section.title}. Add an element`;
    const kind = element && section.add !== element.kind ? element.kind.replaceAll('-', ' ') : helps && `of ${helps}`;
    const plateNode = (element || !isUsed && key ? stop : svg.bind(null, 'g'))(
      { class: 'plate', ...key && !output && { 'data-key': key, 'aria-label': about } },
      svg('rect', { width: w, height: h, rx: 4 }), squeeze(svg('text', { x: 9, y: 18, class: 'name' }, title), w - (element?.lamp ? 32 : 14), 8));
    const node = svg('g', { class: `module${isUsed ? '' : helps ? ' is-helper' : ' is-free'}`, transform: `translate(${x} ${y})` }, plateNode);
    if (key && !output) add(key, plateNode, { type: isUsed ? 'module' : 'free', element, section, x: x + 24, y: y + 14, box: [x, y, w, h] });
    const line = svg('text', { class: 'caption', x: knob ? knob[0] : 9, y: knob ? knob[1] + 28 : 33 });
    if (knob) {
      const pointer = svg('path', { d: 'M0-3V-12' });
      node.append(svg('g', { class: 'pot', 'data-knob': element?.name, transform: `translate(${knob})` },
        svg('circle', { r: 16, class: 'skirt' }), svg('circle', { r: 12.5, fill: 'url(#board-cap)' }), pointer));
      line.classList.add('is-middle');
      if (element) captions.push({ element: element.name, line, pointer });
    } else if (element) {
      captions.push({ element: element.name, line, kind, room: w - 14 });
    } else if (kind) line.textContent = kind;
    node.append(line);
    if (element?.lamp) {
      const lamp = svg('circle', { class: 'bulb', cx: w - 14, cy: 13, r: 5 });
      lamps.push({ output: element.outputs[0], node: lamp, look: '' });
      node.append(lamp);
    }
    for (const place of jacks) {
      const { jack } = place;
      const input = drawJack(place, jack && `in:${place.element}.${jack.name}`, jack && jack.label !== 'in' ? jack.label : '');
      node.append(input);
      if (jack) add(`in:${place.element}.${jack.name}`, input, { type: 'in', element: place.element, jack: jack.name, view: jack, x: x + place.x, y: y + place.y });
      else inert(input);
    }
    for (const place of own) {
      const port = place.name?.startsWith(`${place.element}.`) ? place.name.slice(place.element.length + 1) : '';
      const out = drawJack(place, place.name && `out:${place.name}`, own.length > 1 ? port : '');
      node.append(out);
      if (!place.name) inert(out);
      else {
        add(`out:${place.name}`, out, { type: 'out', element: place.element, output: place.name, x: x + place.x, y: y + place.y });
        outs.push({ name: place.name, node: out.querySelector('.volts'), text: '' });
      }
    }
    return node;
  };
  const inert = (node) => ['role', 'tabindex', 'data-key'].forEach((name) => node.removeAttribute(name));
  const screws = [[12, 12], [width - 12, 12], [12, height - 12], [width - 12, height - 12]].map(([x, y], index) =>
    svg('g', { class: 'screw', transform: `translate(${x} ${y}) rotate(${index * 53 + 20})` }, svg('circle', { r: 6, fill: 'url(#board-metal)' }), svg('path', { d: 'M-5 0H5' })));
  const node = svg('g', { class: `faceplate ${plate.class}` },
    svg('rect', { class: 'panel', width, height, rx: 12 }), svg('rect', { width, height, rx: 12, fill: 'url(#board-sheen)', 'pointer-events': 'none' }), screws,
    svg('text', { class: 'make', x: MARGIN + 6, y: 29 }, plate.title), svg('text', { class: 'small-print', x: width - MARGIN - 6, y: height - 12 }, plate.note),
    sections.map((section) => svg('g', { class: `section ${section.class}` },
      svg('rect', { class: 'frame', x: section.x, y: section.y, width: section.w, height: section.h, rx: 7 }),
      svg('rect', { class: 'stripe', x: section.x + 9, y: section.y + 8, width: 10, height: 10, rx: 2 }),
      svg('text', { class: 'section-title', x: section.x + 25, y: section.y + 17 }, section.title),
      section.modules.map((module, index) => drawModule(module, section, index)))));
  const show = (patch) => {
    for (const { element: name, line, pointer, kind, room } of captions) {
      const element = patch.elements.find((one) => one.name === name);
      const value = setting(element, 'setting')?.value;
      const content = pointer ? caption(element) : [kind, caption(element)].filter(Boolean).join(' · ');
      if (line.textContent !== content) line.textContent = content;
      squeeze(line, room);
      pointer?.setAttribute('transform', `rotate(${-150 + 300 * (value ?? 0)})`);
    }
  };
  return { node, stops, outs, lamps, show };
}
