/** The patch panel: the faceplate of the machine with its cords, and what can be read there. */

import { mountTools } from './board-tools.js';
import { drawCords, keysOf } from './cords.js';
import { byId, fill, fixed, float, hasFocus, joined, partsOf, quantity, rateLimiter, shape, stored, svg } from './dom.js';
import { draw, faceplate } from './faceplate.js';
import { lookOf } from './lamps.js';
import { toast } from './messages.js';
import { mountPatching } from './patching.js';
import { on, outputOf, refusalOf, send, state, voltsOf } from './state.js';
import { Zoom } from './zoom.js';

/** Milliseconds between two changes of the voltages. */
const PERIOD = 100;
/** Milliseconds for which a place or a message is marked. */
const MARKED = 4000;
/** The least scale at which a page opens: fingers need it. */
const READABLE = 0.55;
/** The commands that remove what is at a place, by its type. */
const REMOVE = {
  cord: ({ cord }) => send('unplug', cord), loose: ({ id }) => send('remove-loose', { id }), module: ({ name }) => send('remove-element', { name }),
};

const root = byId('board');
const parts = partsOf(root);
const { stage, canvas, face, cordLayer, live, tip, tipText, tipButton, alert, status } = parts;
let plate = {};
let drawn = { stops: new Map(), outs: [], lamps: [] };
let cords = { stops: new Map() };
let notes = new Map();
let [isShown, tipped, marked, current, timer] = [false, null, null, null, 0];
let isDue = rateLimiter(PERIOD);
const zoom = new Zoom(root, [canvas, live], 20, READABLE, () => showTip(tipped));

const stop = (key) => drawn.stops.get(key) ?? cords.stops.get(key);
const say = (text) => { status.textContent = text; };
const isVisible = () => root.offsetParent !== null;

// What a place is, as text.
function volts(output) {
  const value = voltsOf(output) ?? NaN;
  return Number.isNaN(value) ? '' : fixed(value, 1);
}
function describe({ type, name, element, view, section, output, key }) {
  const value = volts(output);
  const { signal, unit, per_volt: perVolt } = outputOf(output) ?? {};
  const list = (names, word) => (names.length ? `${word} ${names.join(', ')}` : 'no cord');
  const goals = () => board.plugs.filter(({ moves, cord }) => moves === 'in' && cord.from === output)
    .map(({ cord }) => `${cord.element}.${cord.jack}`);
  const what = {
    in: () => ['input', list(view.cords, 'from'), view.description], out: () => ['output', list(goals(), 'to')],
    module: () => [element.kind, element.note], free: () => [`Free: ${section.title}. Enter adds an element`],
  }[type]?.() ?? [];
  if (value) what.push(`${value} V`, signal && `${signal} = ${quantity(voltsOf(output) * perVolt, unit, 3)}`);
  return joined([name, ...what, ...notes.get(key) ?? []]);
}
const label = (one) => { one.node.ariaLabel = describe(one); };

// What is shown at a place.
function put(box, point) {
  const [x, y] = zoom.pixels(point);
  float(box, x + 15, y + 15, zoom.width, zoom.height);
}
function showTip(one, canRemove = !tipButton.hidden) {
  tipped = one;
  tip.hidden = !one;
  if (!one) return;
  tipText.textContent = describe(one);
  tipButton.hidden = !canRemove || !(one.type in REMOVE);
  put(tip, one);
}
/** Shows what the pointer is on; without it, what has the focus. */
function hover(one, seen = one ?? (hasFocus(canvas) ? current : null)) {
  // A jack marks its cords, but not because it has the focus after a click.
  const marks = (one ?? seen?.node.matches(':focus-visible')) && seen;
  if (seen === tipped && marks === marked) return;
  marked = marks;
  const active = [seen, ...board.plugs.filter(({ jack, fixed }) => (jack ?? fixed) === marks)].map((each) => each?.node);
  for (const node of cordLayer.children) node.classList.toggle('is-active', active.includes(node));
  showTip(seen, !one);
}
/** The panel has two stops of the Tab key: one of the jacks and modules, and one of the cords. */
function settle(one) {
  const layer = one.type === 'cord' ? cordLayer : face;
  for (const node of layer.querySelectorAll('[tabindex="0"]')) node.tabIndex = -1;
  one.node.tabIndex = 0;
  current = one;
}
function focus(key) {
  const one = stop(key);
  if (!one) return;
  settle(one);
  label(one);
  one.node.focus({ preventScroll: true });
  zoom.reveal(one);
  hover(null);
}
function bubble(message, point) {
  alert.textContent = message;
  put(alert, point);
  clearTimeout(timer);
  timer = setTimeout(() => { alert.textContent = ''; }, MARKED + 40 * message.length);
}
function placed({ element, jack, from }) {
  const keys = keysOf({ element, jack, from });
  return stop(keys.cord) ?? stop(keys.in) ?? stop(`module:${element}`) ?? stop(`out:${element}`);
}
/** Marks the findings at their jacks and modules. Each severity has a shape of its own. */
function mark() {
  for (const node of face.querySelectorAll('.mark')) node.remove();
  notes = new Map();
  for (const { severity, message, hint, place } of state.findings) {
    const one = place?.element && placed({ ...place, from: null });
    if (!one) continue;
    const before = notes.get(one.key) ?? [];
    notes.set(one.key, [...before, `${severity === 'error' ? 'Error' : 'Warning'}: ${message}. ${hint}`]);
    if (before.length) continue;
    one.node.append(shape(`mark-${severity}`, { transform: `translate(${one.box ? [one.box[2] - 13, 30] : [11, 9]})` }));
  }
  board.stops.forEach(label);
}

const board = {
  root, parts, say, stop, focus, zoom, hover, bubble, render,
  stops: [], plugs: [],
  isLocked: () => canvas.dataset.lock === 'true',
  reach: (distance) => distance / Math.min(zoom.scale, 1.4),
  back: () => focus(current?.key),
  async remove(one) {
    if (!refusalOf(await REMOVE[one.type](one))) say(`Removed ${one.name}. Undo brings it back.`);
  },
};

async function render() {
  const { patch } = state;
  if (!patch || !isVisible() || !board.plates) return;
  const name = [stored(`board.plate.${patch.machine}`), patch.machine].find((each) => each in board.plates) ?? 'plain';
  if (plate.name !== name) plate = { name, ...await faceplate(name) };
  if (patch !== state.patch) return;
  const [before, had] = [current, hasFocus(canvas)];
  board.release();
  drawn = draw(plate, patch, state.hello?.kinds ?? []);
  cords = drawCords(patch, drawn.stops);
  [board.stops, board.plugs, board.colours] = [[...drawn.stops.values(), ...cords.stops.values()], cords.plugs, cords.colours];
  face.replaceChildren(drawn.node);
  cordLayer.replaceChildren(...cords.nodes);
  live.replaceChildren(svg('g', { class: `faceplate ${plate.class}` }, drawn.live));
  stage.style.aspectRatio = `${drawn.width + 40} / ${drawn.height + 40}`;
  if (cords.nodes.length) cords.nodes[0].tabIndex = 0;
  tipped = null;
  // The next frame writes the voltages.
  isDue = rateLimiter(PERIOD);
  zoom.size = drawn;
  zoom.resize();
  mark();
  const one = stop(before?.key) ?? (before?.cord && stop(keysOf(before.cord).in)) ?? drawn.stops.values().next().value;
  if (had) focus(one.key);
  else settle(one);
  hover(null, had ? one : null);
  board.patched(name);
}

on('patch', render);
on('findings', () => { if (isVisible()) mark(); });
on('frame', (frame) => {
  if (!isShown) return;
  for (const lamp of drawn.lamps) {
    const look = lookOf(frame, lamp.output);
    if (look !== lamp.look) lamp.node.dataset.lamp = lamp.look = look;
  }
  if (!isDue()) return;
  for (const out of drawn.outs) {
    const text = volts(out.name);
    if (text !== out.text) out.node.textContent = out.text = text;
  }
  if (tipped?.output) tipText.textContent = describe(tipped);
});
on('refused', ({ message, place }) => {
  if (!isVisible() || !place?.element) return;
  const one = placed(place);
  if (one) bubble(message, one);
  else toast(message);
});
on('highlight', (place) => {
  const one = isVisible() && place?.element && placed(place);
  if (!one) return;
  stage.scrollIntoView({ block: 'nearest' });
  zoom.reveal(one);
  one.node.classList.add('is-sought');
  setTimeout(() => one.node.classList.remove('is-sought'), MARKED);
});
new ResizeObserver(render).observe(stage);
new IntersectionObserver(([{ isIntersecting }]) => { isShown = isIntersecting; }).observe(stage);
fill(canvas, {
  onfocusin({ target }) {
    if (target.dataset.key !== current?.key) focus(target.dataset.key);
    else hover(null);
  },
});
fill(root, { onfocusout: ({ relatedTarget }) => { if (!stage.contains(relatedTarget)) hover(null, null); } });
tipButton.onclick = () => {
  const one = tipped;
  one.node.focus();
  board.remove(one);
};
mountPatching(board);
mountTools(board);
