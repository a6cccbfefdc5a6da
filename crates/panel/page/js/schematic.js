/** The schematic: symbols and wires with live voltages, probes and findings. */

import { byId, fill, fixed, hasFocus, hasModifier, joined, named, partsOf, rateLimiter, shape, svg, write } from './dom.js';
import { lookOf } from './lamps.js';
import { placeName } from './messages.js';
import { choose, outputName, probes, reading } from './probes.js';
import { emit, highlight, on, outputOf, state, voltsOf } from './state.js';
import { ahead, ARROWS, nodeAt, Zoom } from './zoom.js';

/** Milliseconds between changes of the voltages; digits that change faster cannot be read. */
const SHOWN = 67;
/** Steps of thickness and colour of a wire from zero to full scale. */
const LEVELS = 4;
/** The least scale at which texts can be read. */
const READABLE = 0.62;
/** Space below the drawing for the buttons. */
const TOOLS = 40;
/** Milliseconds for which a place is ringed. */
const RINGED = 4000;

/** A primitive as `Schematic::to_live_json` has it. */
function primitive([form, ink, ...rest]) {
  const line = { class: `ink-${ink}`, 'stroke-width': rest[0] };
  const filled = { class: `fill-${ink}` };
  const circle = (look, cx, cy, r) => svg('circle', { ...look, cx, cy, r });
  return {
    line: (_, points) => svg('polyline', { ...line, points }),
    area: (points) => svg('polygon', { ...filled, points }),
    ring: (_, ...place) => circle(line, ...place),
    disc: (...place) => circle(filled, ...place),
    text: (size, anchor, x, y, text, setting) =>
      svg('text', { ...filled, x, y, 'font-size': size, 'text-anchor': anchor, 'data-setting': setting }, text),
  }[form](...rest);
}

/** A box around an area, with so much space. */
const around = ([left, top, right, bottom], by, look) =>
  svg('rect', { class: look, x: left - by, y: top - by, width: right - left + 2 * by, height: bottom - top + 2 * by, rx: by });

function symbolNode({ name, area: [left, top, right, bottom], primitives, outputs: [output] }) {
  return svg('g', { class: 'symbol', 'data-element': name, 'data-output': output?.name },
    around([left, top, output ? output.from[0] - 2 : right, bottom], 5, 'hit'), primitives.map(primitive));
}

/** The lines of an output: the piece at the symbol, then those of its net. */
function netNode(output, { lines = [], dots = [], arrows = [] } = {}) {
  const d = [[output.from, output.at], ...lines].map(([[x, y], [u, v]]) => `M${x} ${y}L${u} ${v}`).join('');
  return svg('g', { class: 'net', 'data-output': output.name },
    ['hit', 'wire'].map((look) => svg('path', { class: look, d })),
    dots.map(([cx, cy]) => svg('circle', { cx, cy, r: 3 })),
    arrows.map(([x, y]) => svg('path', { d: `M${x - 4} ${y}l8-3.5v7z` })));
}

function outputNode({ name, from: [left, y], at: [right] }) {
  return svg('g', {
    class: 'output', role: 'button', tabindex: -1, 'data-output': name, 'aria-haspopup': 'dialog', 'aria-label': outputName(name),
  }, around([left + 2, y - 10, right, y + 12], 4, 'hit'), svg('text', { class: 'volts', x: left + 4, y: y + 11.5 }));
}

/** Volts with two decimals and a sign, as `patchcord draw --values` writes them. */
const voltsText = (volts) => (volts < 0.005 ? '' : '+') + fixed(volts, 2);

const root = byId('schematic');
const { picture, nets, symbols, outputs, marks, info, message } = partsOf(root);
const zoom = new Zoom(root, [picture], 0, READABLE);

/** The drawing, and what belongs to each output: `{output, element, net, nodes, x, y, text, level, lamp}`. */
let drawing = null;
let cells = new Map();
let [lit, focused] = [null, null];

// Values.

const isDue = rateLimiter(SHOWN);
const valueText = (name) => {
  const volts = voltsOf(name);
  return volts === undefined ? '' : reading(volts, outputOf(name));
};
const showInfo = () => {
  const cell = cells.get(lit);
  const to = cell?.net?.to.map((end) => end.join(' ')).join(', ');
  write(info, cell ? joined([outputName(lit), valueText(lit), to && `to ${to}`], '  ·  ') : '');
};
const full = () => Number(state.patch?.outputs.find(({ name }) => /^\+\d+$/u.test(name))?.name ?? 100);
/** Writes what has changed. */
const paint = (cell, { text, level, lamp }) => {
  if (text !== cell.text) cell.nodes.volts.textContent = cell.text = text;
  if (level !== cell.level) cell.nodes.net.dataset.level = cell.level = level;
  if (lamp !== cell.lamp) cell.nodes.symbol.dataset.lamp = cell.lamp = lamp;
};
on('frame', (frame) => {
  if (!picture.clientWidth || !isDue()) return;
  const scale = full();
  for (const [name, cell] of cells) {
    const value = voltsOf(name);
    if (value === undefined) continue;
    const steps = Math.min(LEVELS, Math.ceil(Math.abs(value) / scale * LEVELS - 0.04));
    paint(cell, { text: voltsText(value), level: steps * Math.sign(value) || 0, lamp: lookOf(frame, name) });
  }
  showInfo();
});

// Nets under the pointer or the focus.

const light = (name) => {
  lit = name;
  const cell = cells.get(name);
  const ends = new Set([cell?.element, ...cell?.net?.to.map(([element]) => element) ?? []]);
  for (const node of picture.querySelectorAll('.net, .output, .symbol')) {
    const { element, output } = node.dataset;
    node.classList.toggle('lit', Boolean(cell) && (element ? ends.has(element) : output === name));
  }
  showInfo();
};
const point = (output) => emit('pointed', { output });
on('pointed', ({ output }) => light(output ?? null));

// Actions.

const under = ({ target }) => target.closest?.('[data-output]')?.dataset.output ?? null;
const rove = (name) => {
  for (const [each, { nodes }] of cells) nodes.output.tabIndex = each === name ? 0 : -1;
  focused = name;
};
const openKnob = (element, setting = named(state.patch?.elements, element)?.settings[0]?.name) => {
  if (setting) highlight({ element, setting });
};
const go = (name) => cells.get(name)?.nodes.output.focus({ preventScroll: true });

zoom.listen();
fill(picture, {
  onpointerleave: () => point(null),
  onpointerover: (event) => point(under(event) ?? (hasFocus(picture) ? focused : null)),
  onfocusout: () => point(null),
  onfocusin(event) {
    const name = under(event);
    const cell = cells.get(name);
    if (!cell) return;
    rove(name);
    const said = state.findings.filter(({ place: at }) => at?.element === cell.element).map((finding) => finding.message);
    cell.nodes.output.ariaLabel = joined([outputName(name), valueText(name), ...said]);
    zoom.reveal(cell);
    point(name);
  },
  onclick(event) {
    const node = event.target.closest('.net, .output') ?? nodeAt(event, outputs.children);
    if (node && zoom.isStill) choose(node.dataset.output, node, event);
  },
  ondblclick({ target }) {
    const symbol = target.closest('.symbol');
    if (symbol) openKnob(symbol.dataset.element, target.dataset.setting);
  },
});
fill(root, {
  onkeydown(event) {
    const { key, target } = event;
    if (hasModifier(event) || target.closest('button')) return;
    const node = target.closest('.output');
    const names = [...cells.keys()];
    const pick = () => choose(focused, node);
    const move = () => go(node ? ahead(cells.get(focused), cells.values(), ARROWS[key]).output.name : focused);
    const act = {
      Home: () => go(names[0]), End: () => go(names.at(-1)),
      ...node && { Enter: pick, ' ': pick, e: () => openKnob(cells.get(focused).element), Escape: () => point(null) },
    }[key] ?? (ARROWS[key] && move);
    if (!act || !cells.has(focused)) return;
    // A probe that waits is called off by the page.
    if (key !== 'Escape') event.preventDefault();
    act();
  },
});

// Probes, findings, and places to which something points.

let [ring, timer] = [null, 0];
/** The area of an element, or its jack. */
const spot = ({ element, jack }) => {
  const symbol = named(drawing?.symbols, element);
  const at = symbol?.inputs.find((each) => each.jack === jack)?.at;
  return symbol && { at, area: at ? [...at, ...at] : symbol.area };
};
const showMarks = () => {
  const counts = new Map();
  /** How many marks are already at a place. */
  const count = (key) => counts.set(key, (counts.get(key) ?? -1) + 1).get(key);
  const tips = probes().filter(({ output }) => cells.has(output)).map(({ output, mark, look, name }) => {
    // The outputs of an instance are close to each other, so that the tips are at the ends of their wires.
    const { port, at, from } = cells.get(output).output;
    const [x, y] = port ? [at[0], at[1] + 21] : from;
    const right = 24 * count(output);
    const tip = shape('tip', {
      'data-look': look, 'data-bare': port || right > 0,
      'aria-label': `${name} at ${outputName(output)}`, transform: `translate(${x + right} ${y})`,
    }, svg('title', null, name));
    tip.querySelector('text').textContent = mark;
    return tip;
  });
  const flags = state.findings.map(({ severity, message: text, place: where }) => {
    const { at, area } = spot(where ?? {}) ?? {};
    if (!area) return null;
    const [x, y] = at ?? [area[0] + 4, area[1] + 4];
    const label = `${severity} at ${placeName(where)}: ${text}`;
    const transform = `translate(${x - 7 - 15 * count(`${x} ${y}`)} ${y - 7})`;
    return shape(`mark-${severity}`, { role: 'img', 'aria-label': label, transform }, svg('title', null, text));
  });
  marks.replaceChildren(...[...tips, ...flags, ring].filter(Boolean));
};
on('scopes machine findings', showMarks);
on('highlight', (where) => {
  const { at, area } = spot(where) ?? {};
  if (!area) return;
  const [left, top, right, bottom] = area;
  ring = around(area, at ? 13 : 8, 'ring');
  showMarks();
  zoom.reveal({ x: (left + right) / 2, y: (top + bottom) / 2 });
  if (!root.hidden && !where.setting) root.scrollIntoView({ block: 'nearest' });
  clearTimeout(timer);
  timer = setTimeout(() => { ring = null; showMarks(); }, RINGED);
});

const draw = () => {
  const had = hasFocus(picture);
  symbols.replaceChildren();
  const made = drawing.symbols.flatMap((each) => {
    const symbol = symbols.appendChild(symbolNode(each));
    return each.outputs.map((output) => {
      const net = drawing.nets.find(({ from }) => from === output.name);
      const own = outputNode(output);
      const [x, y] = output.at;
      return { output, net, x, y, element: each.name, nodes: { symbol, net: netNode(output, net), output: own, volts: own.lastChild } };
    });
  });
  // In the order of reading: rows, and from left to right in each.
  const row = ({ y }) => Math.round(y / 90);
  made.sort((a, b) => row(a) - row(b) || a.x - b.x);
  // The last voltages stay until the next frame.
  for (const cell of made) paint(cell, cells.get(cell.output.name) ?? {});
  cells = new Map(made.map((cell) => [cell.output.name, cell]));
  nets.replaceChildren(...made.map(({ nodes }) => nodes.net));
  outputs.replaceChildren(...made.map(({ nodes }) => nodes.output));
  rove(cells.has(focused) ? focused : made[0]?.output.name);
  if (had) go(focused);
  else light(lit);
  showMarks();
};
on('schematic', ({ drawing: next, message: text }) => {
  message.textContent = text;
  if (!next) return;
  const isOther = !drawing || Math.abs(drawing.width - next.width) + Math.abs(drawing.height - next.height) > 200;
  drawing = next;
  zoom.size = { width: drawing.width, height: drawing.height + TOOLS };
  if (isOther) zoom.fit(READABLE);
  draw();
});
