/** The patch panel: the faceplate of the machine with its cords, and what can be read there. */

import { mountTools } from './board-tools.js';
import { cordKey, drawCords } from './cords.js';
import { el, quantity, svg } from './dom.js';
import { arrange, draw, faceplate } from './faceplate.js';
import { toast } from './messages.js';
import { mountPatching } from './patching.js';
import { on, send, state } from './state.js';

/** Milliseconds between two changes of the voltages. */
const PERIOD = 100;
/** Milliseconds for which a place or a message is marked. */
const MARKED = 4000;

const stored = (key) => `patchcord.board.${key}`;

/** @param {HTMLElement} root */
export function mountBoard(root) {
  const find = (query) => root.querySelector(query);
  const canvas = find('.board-canvas');
  const [, face, cordLayer, over] = canvas.children;
  const [stage, tip, alert, status] = ['.board-stage', '.board-tip', '.board-alert', '.board-status'].map(find);
  let plate = null;
  let faceShape = '';
  let cordShape = '';
  let drawn = { stops: new Map(), outs: [], lamps: [], show() {} };
  let cords = { stops: new Map(), plugs: [], colours: new Map(), nodes: [] };
  let layout = { width: 1000, height: 600 };
  let notes = new Map();
  let index = new Map();
  let [x, y, scale, width, height] = [0, 0, 0, 0, 0];
  let isFitted = true;
  let isShown = false;
  let tipped = null;
  let current = null;
  let last = 0;

  const stop = (key) => drawn.stops.get(key) ?? cords.stops.get(key);
  const say = (text) => { status.textContent = text; };
  const keep = (key, value) => (value === undefined ? localStorage.getItem(stored(key)) : localStorage.setItem(stored(key), value));

  // The part of the panel that is shown.
  function show() {
    const within = (at, size, whole) => (size > whole + 40 ? (whole - size) / 2 : Math.min(Math.max(at, -20), whole + 20 - size));
    x = within(x, width / scale, layout.width);
    y = within(y, height / scale, layout.height + 30);
    canvas.setAttribute('viewBox', `${x} ${y} ${width / scale} ${height / scale}`);
    showTip(tipped);
  }
  const whole = () => Math.min(width / (layout.width + 12), height / (layout.height + 12));
  function zoom(factor, px = width / 2, py = height / 2) {
    const next = factor ? Math.min(Math.max(scale * factor, whole() * 0.9), 4) : whole();
    [x, y] = [x + px / scale - px / next, y + py / scale - py / next];
    scale = next;
    isFitted = !factor;
    show();
  }
  /** The whole panel; on a narrow page its top left corner, where the jacks are large enough for fingers. */
  function fit() {
    [x, y, scale] = [-20, -20, Math.max(whole(), 0.55)];
    show();
  }
  function pan(dx, dy) {
    [x, y, isFitted] = [x - dx / scale, y - dy / scale, false];
    show();
  }
  const pixels = (point) => [(point.x - x) * scale, (point.y - y) * scale];
  function reveal(point) {
    const by = pixels(point).map((at, axis) => { const size = [width, height][axis]; return at < 40 || at > size - 40 ? size / 2 - at : 0; });
    if (by.some(Boolean)) pan(...by);
  }

  // What a place is, as text.
  const volts = (output) => { const value = state.frame?.volts[index.get(output)]; return value === undefined || Number.isNaN(value) ? '' : value.toFixed(1).replace('-', '−'); };
  const nameOf = ({ type, element, jack, output, name }) => name ?? { in: `${element}.${jack}`, out: output }[type] ?? element?.name ?? '';
  function live({ output }) {
    const value = volts(output);
    const { signal, unit, per_volt: perVolt } = state.patch.outputs[index.get(output)] ?? {};
    return output && value && `${value} V${signal ? `, ${signal} = ${quantity(value.replace('−', '-') * perVolt, unit, 3)}` : ''}`;
  }
  function describe(one) {
    const { type, element, view, section, output } = one;
    const goals = type === 'out' && [...cords.stops.values()].filter(({ cord }) => cord?.from === output).map(({ cord }) => `${cord.element}.${cord.jack}`);
    const what = {
      in: () => `input${view.cords.length ? ` from ${view.cords.join(', ')}` : ', no cord'}. ${view.description}`, cord: () => '',
      out: () => `output${goals.length ? ` to ${goals.join(', ')}` : ', no cord'}`, loose: () => '',
      module: () => [element.kind, element.note].filter(Boolean).join('. '), free: () => `Free: ${section.title}. Enter adds an element`,
    }[type]();
    return [nameOf(one), what, live(one), ...notes.get(one.key) ?? []].filter(Boolean).join(type === 'cord' ? ': ' : ', ');
  }
  const label = (one) => one.node.setAttribute('aria-label', describe(one));

  function showTip(one, canRemove = tip.lastChild.hidden === false) {
    tipped = one;
    tip.hidden = !one;
    if (!one) return;
    tip.firstChild.textContent = describe(one);
    tip.lastChild.hidden = !canRemove || !['cord', 'module', 'loose'].includes(one.type) || canvas.dataset.lock === 'true';
    at(tip, one);
  }
  function at(box, point) {
    const [left, top] = pixels(point);
    box.style.left = `${Math.max(Math.min(left + 14, width - box.offsetWidth - 6), 6)}px`;
    box.style.top = `${Math.max(Math.min(top + 16, height - box.offsetHeight - 6), 6)}px`;
  }
  function activate(one) {
    cordLayer.querySelector('.is-active')?.classList.remove('is-active');
    cordLayer.classList.toggle('has-active', one?.type === 'cord');
    if (one?.type === 'cord') one.node.classList.add('is-active');
  }
  /** What the pointer is on; without it, what has the focus. */
  function hover(one) {
    const seen = one ?? (canvas.contains(document.activeElement) ? current : null);
    if (seen === tipped) return;
    activate(seen);
    showTip(seen, !one);
  }
  /** The panel has two stops of the Tab key: one of the jacks and modules, and one of the cords. */
  function settle(one) {
    const layer = one.type === 'cord' ? cordLayer : face;
    layer.querySelector('[tabindex="0"]')?.setAttribute('tabindex', -1);
    one.node.tabIndex = 0;
    current = one;
  }
  function focus(key) {
    const one = stop(key);
    if (!one) return;
    settle(one);
    label(one);
    one.node.focus({ preventScroll: true });
    reveal(one);
    activate(one);
    showTip(one, true);
  }
  function bubble(message, point) {
    alert.hidden = false;
    alert.textContent = message;
    at(alert, point);
    clearTimeout(bubble.timer);
    bubble.timer = setTimeout(() => { alert.hidden = true; }, MARKED + 40 * message.length);
  }
  function ring(one, kind) {
    const [left, top, w, h] = one.box ?? [one.x - 15, one.y - 15, 30, 30];
    const node = svg('rect', { class: kind, x: left - 3, y: top - 3, width: w + 6, height: h + 6, rx: one.box ? 7 : 18 });
    over.append(node);
    return node;
  }
  const placed = ({ element, jack, from }) => stop(cordKey({ element, jack, from })) ?? stop(`in:${element}.${jack}`) ?? stop(`module:${element}`) ?? stop(`out:${element}`);

  const board = {
    root, find, canvas, over, send, say, keep, stop, focus, reveal, pan, zoom, hover, bubble, ring, nameOf, render,
    get stops() { return [...drawn.stops.values(), ...cords.stops.values()]; },
    get plugs() { return cords.plugs; }, get colours() { return cords.colours; }, get current() { return current; }, get scale() { return scale; },
    units: ({ clientX, clientY }) => { const box = canvas.getBoundingClientRect(); return { x: x + (clientX - box.x) / scale, y: y + (clientY - box.y) / scale }; },
    remove(one) {
      const { type, cord, id, element } = one;
      send({ cord: { command: 'unplug', ...cord }, loose: { command: 'remove-loose', id }, module: { command: 'remove-element', name: element?.name } }[type]);
      say(`Removed ${nameOf(one)}. Undo brings it back.`);
    },
  };

  /** Marks the findings at their jacks and modules, each severity with a shape of its own. */
  function mark() {
    for (const node of face.querySelectorAll('.finding-mark')) node.remove();
    notes = new Map();
    for (const { severity, message, hint, place } of state.findings) {
      const one = place?.element && placed({ ...place, from: null });
      if (!one) continue;
      const isError = severity === 'error';
      const before = notes.get(one.key);
      notes.set(one.key, [...before ?? [], `${isError ? 'Error' : 'Warning'}: ${message} ${hint}`]);
      if (before) continue;
      one.node.append(svg('g', { class: `finding-mark ${isError ? 'error' : 'warning'}`, transform: `translate(${one.box ? [one.box[2] - 13, 30] : [11, 9]})` },
        svg('path', { d: isError ? 'M0-9 9 7H-9Z' : 'M0 8 8-6H-8Z' }), isError && svg('text', { y: 5 }, '!')));
    }
    board.stops.forEach(label);
  }

  async function render() {
    const { patch } = state;
    if (!patch || !root.offsetParent) return;
    const name = keep(`plate.${patch.machine}`) ?? (board.plates?.[patch.machine] ? patch.machine : 'plain');
    if (plate?.name !== name) plate = { name, ...await faceplate(name) };
    if (patch !== state.patch) return;
    const had = canvas.contains(document.activeElement) ? current : null;
    const face1 = JSON.stringify([name, patch.parts, patch.elements.map(({ jacks, settings, note, ...rest }) => [rest, jacks.map((jack) => [jack.name, jack.label])])]);
    if (face1 !== faceShape) {
      const isOther = faceShape.split(',')[0] !== face1.split(',')[0] || isFitted;
      faceShape = face1;
      cordShape = '';
      layout = arrange(plate, patch, state.hello?.kinds ?? []);
      drawn = draw(layout);
      face.replaceChildren(drawn.node);
      stage.style.aspectRatio = `${layout.width + 12} / ${layout.height + 12}`;
      if (isOther) fit();
    }
    index = new Map(patch.outputs.map((output, position) => [output.name, position]));
    for (const element of patch.elements) {
      for (const view of element.jacks) Object.assign(stop(`in:${element.name}.${view.name}`) ?? {}, { view });
      Object.assign(stop(`module:${element.name}`) ?? {}, { element });
    }
    const cord1 = JSON.stringify([patch.loose, patch.elements.map(({ jacks }) => jacks.map((jack) => jack.cords))]);
    if (cord1 !== cordShape) {
      cordShape = cord1;
      board.release?.();
      cords = drawCords(patch, drawn.stops);
      cordLayer.replaceChildren(...cords.nodes);
      activate(null);
    }
    for (const { node, type, view } of drawn.stops.values()) if (type === 'in') node.classList.toggle('is-full', view.most !== null && view.cords.length >= view.most);
    drawn.show(patch);
    mark();
    tipped = null;
    const seen = stop(current?.key) ?? (had?.cord && stop(`in:${had.cord.element}.${had.cord.jack}`)) ?? drawn.stops.values().next().value;
    if (cords.nodes.length) settle(stop(cords.nodes[0].dataset.key));
    settle(seen);
    if (had) focus(current.key);
    else showTip(null);
    board.patched?.(name);
  }

  on('patch', render);
  on('findings', () => { if (root.offsetParent) mark(); });
  on('frame', ({ lamps, firstLamp }) => {
    if (!isShown) return;
    for (const lamp of drawn.lamps) {
      const position = index.get(lamp.output);
      const look = !lamps[position] ? 'off' : firstLamp === position ? 'first' : 'lit';
      if (look !== lamp.look) lamp.node.dataset.lamp = lamp.look = look;
    }
    if (performance.now() - last < PERIOD) return;
    last = performance.now();
    for (const out of drawn.outs) {
      const text = volts(out.name);
      if (text !== out.text) out.node.textContent = out.text = text;
    }
    if (tipped?.output) tip.firstChild.textContent = describe(tipped);
  });
  on('refused', ({ message, place }) => {
    if (!root.offsetParent || !place?.element) return;
    const one = placed(place);
    if (one) bubble(message, one);
    else toast(message);
  });
  on('highlight', (place) => {
    const one = root.offsetParent && place?.element && placed(place);
    if (!one) return;
    stage.scrollIntoView({ block: 'nearest', behavior: 'smooth' });
    reveal(one);
    const node = ring(one, 'seek');
    setTimeout(() => node.remove(), MARKED);
  });
  new ResizeObserver(() => {
    [width, height] = [stage.clientWidth, stage.clientHeight];
    if (!width) return;
    if (isFitted || !scale) fit();
    else show();
    render();
  }).observe(stage);
  new IntersectionObserver(([{ isIntersecting }]) => { isShown = isIntersecting; }).observe(stage);
  canvas.addEventListener('focusin', ({ target }) => { const one = stop(target.dataset.key); if (one && one !== current) focus(one.key); else if (one !== tipped) hover(null); });
  root.addEventListener('focusout', ({ relatedTarget }) => { if (!stage.contains(relatedTarget)) { activate(null); showTip(null); } });
  tip.lastChild.addEventListener('click', () => { const one = tipped; showTip(null); canvas.focus(); board.remove(one); });
  mountPatching(board);
  mountTools(board);
}
