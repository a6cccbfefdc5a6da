/** The cords of the patch panel: their colours, their curves and their plugs. */

import { svg } from './dom.js';

const COLOURS = 8;
/** The references have the same colours in every patch. */
const FIXED = { '+100': 1, '-100': 0, ground: 7 };
/** Outputs that are nearer than this have different colours if that is possible. */
const NEAR = 190;
/** Distance of the plugs in one jack. */
const STACKED = 6;

/** A number from 0 to 1 that depends only on the text. */
function hash(text) {
  let sum = 2166136261;
  for (const letter of text) sum = Math.imul(sum ^ letter.codePointAt(0), 16777619);
  return ((sum ^ (sum >>> 15)) >>> 0) / 2 ** 32;
}

/** The key of a cord. */
export const cordKey = ({ element, jack, from }) => `cord:${from}>${element}.${jack}`;

/** All cords of a patch. */
export function cordsOf({ elements }) {
  return elements.flatMap(({ name, jacks }) => jacks.flatMap((jack) => jack.cords.map((from) => ({ element: name, jack: jack.name, from }))));
}

/** The colour of each output: by its name, but not that of an output nearby or of a cord into the same element. */
function colours(cords, stops) {
  const found = new Map();
  for (const from of new Set(cords.map((cord) => cord.from))) {
    const goals = new Set(cords.filter((cord) => cord.from === from).map(({ element }) => element));
    const place = stops.get(`out:${from}`);
    const taken = new Set(cords.filter((cord) => goals.has(cord.element)).map((cord) => found.get(cord.from)));
    for (const [other, colour] of found) {
      const there = stops.get(`out:${other}`);
      if (place && there && Math.hypot(place.x - there.x, place.y - there.y) < NEAR) taken.add(colour);
    }
    const first = FIXED[from] ?? Math.floor(hash(from) * COLOURS);
    const free = [...Array(COLOURS).keys()].map((step) => (first + 3 * step) % COLOURS).find((colour) => !taken.has(colour));
    found.set(from, from in FIXED ? first : free ?? first);
  }
  return found;
}

/** A hanging cord from one point to another. Its sag and its bow depend on its name, so that cords do not cover each other. */
export function curve(a, b, name = '') {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const length = Math.hypot(dx, dy);
  const sag = Math.min(22 + length * 0.26, 150) * (0.75 + hash(name) / 2);
  const bow = (hash(`${name}~`) - 0.5) * 0.5 * Math.abs(dy);
  const at = (share) => `${(a.x + dx * share + bow).toFixed(1)} ${(a.y + dy * share + sag).toFixed(1)}`;
  return `M${a.x} ${a.y}C${at(0.2)} ${at(0.8)} ${b.x} ${b.y}`;
}

function plug({ x, y }) {
  return svg('g', { class: 'plug', transform: `translate(${x} ${y})` },
    svg('circle', { class: 'plug-shade', cx: 1.5, cy: 3, r: 9 }), svg('circle', { class: 'plug-body', r: 8.5 }),
    svg('circle', { r: 8.5, fill: 'url(#board-shine)' }), svg('circle', { class: 'plug-core', r: 3.2 }));
}

/** A picture of a cord between two points. */
export function drawCord(a, b, { name = '', colour = 0, ...attributes }) {
  const d = curve(a, b, name);
  return svg('g', { class: `cord cord-${colour + 1}`, ...attributes }, ['shade', 'body', 'shine', 'hit'].map((part) =>
    svg('path', { class: `cord-${part}`, d, transform: part === 'shade' ? 'translate(2 6)' : null })), plug(a), plug(b));
}

/**
 * Draws all cords, longest first.
 * @returns {{nodes: Element[], stops: Map<string, any>, plugs: any[], colours: Map<string, number>}} stops are cords and
 *   loose plugs by their keys
 */
export function drawCords(patch, jacks) {
  const cords = cordsOf(patch);
  const found = colours(cords, jacks);
  const heights = new Map();
  const stops = new Map();
  const plugs = [];
  /** A plug on top of those that are already in the jack. */
  const stack = (key) => {
    const jack = jacks.get(key);
    if (!jack) return null;
    const height = heights.get(key) ?? 0;
    heights.set(key, height + 1);
    return { x: jack.x + height * STACKED, y: jack.y - height * STACKED, jack };
  };
  for (const cord of cords) {
    const [from, to] = [stack(`out:${cord.from}`), stack(`in:${cord.element}.${cord.jack}`)];
    if (!from || !to) continue;
    const key = cordKey(cord);
    const name = `${cord.from} → ${cord.element}.${cord.jack}`;
    const node = drawCord(from, to, { name, colour: found.get(cord.from), role: 'button', tabindex: -1, 'data-key': key, 'aria-label': `Cord ${name.replace('→', 'to')}` });
    stops.set(key, { key, node, type: 'cord', cord, name, output: cord.from, x: (from.x + to.x) / 2, y: Math.max(from.y, to.y), length: Math.hypot(from.x - to.x, from.y - to.y) });
    plugs.push({ ...from, type: 'plug', cord, moves: 'out', of: node }, { ...to, type: 'plug', cord, moves: 'in', of: node });
  }
  for (const { id, end, at } of patch.loose) {
    const fixed = stack(end.output ? `out:${end.output}` : `in:${end.element}.${end.jack}`);
    if (!fixed) continue;
    const tip = { x: at[0], y: at[1] };
    const key = `loose:${id}`;
    const name = `Loose cord at ${end.output ?? `${end.element}.${end.jack}`}`;
    const node = drawCord(fixed, tip, { name: key, colour: found.get(end.output) ?? Math.floor(hash(fixed.jack.key) * COLOURS), role: 'button', tabindex: -1, 'data-key': key, 'aria-label': name });
    const data = { key, node, type: 'loose', id, fixed: fixed.jack, output: end.output, name, length: 0, ...tip };
    stops.set(key, data);
    plugs.push(data);
  }
  const nodes = [...stops.values()].sort((one, other) => other.length - one.length).map(({ node }) => node);
  return { nodes, stops, plugs, colours: found };
}
