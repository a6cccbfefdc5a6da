/** The cords of the patch panel: their colours, their curves and their plugs. */

import { svg } from './dom.js';

const COLOURS = [...Array(8).keys()];
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

/** The keys of a cord and of its jacks. */
export const keysOf = ({ element, jack, from }) => ({ cord: `cord:${from}>${element}.${jack}`, out: `out:${from}`, in: `in:${element}.${jack}` });

/** The colour of each output, by its name. Outputs nearby and cords into one element differ, and all colours are used. */
function colours(cords, jacks) {
  const found = new Map();
  const count = (colour) => [...found.values()].filter((one) => one === colour).length;
  for (const from of new Set(cords.map((cord) => cord.from))) {
    const place = jacks.get(`out:${from}`);
    const goals = new Set(cords.filter((cord) => cord.from === from).map(({ element }) => element));
    const taken = new Set(cords.filter(({ element }) => goals.has(element)).map((cord) => found.get(cord.from)));
    for (const [other, colour] of found) {
      const there = jacks.get(`out:${other}`);
      if (place && there && Math.hypot(place.x - there.x, place.y - there.y) < NEAR) taken.add(colour);
    }
    const first = Math.floor(hash(from) * 8);
    const order = COLOURS.map((step) => (first + 3 * step) % 8);
    const cost = (colour) => count(colour) + (taken.has(colour) ? 1000 : 0);
    found.set(from, FIXED[from] ?? order.reduce((best, colour) => (cost(colour) < cost(best) ? colour : best)));
  }
  return found;
}

/** A hanging cord. Its sag and its bow depend on its name, so that cords do not cover each other. */
export function curve(a, b, name = '') {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const sag = Math.min(22 + Math.hypot(dx, dy) * 0.26, 150) * (0.75 + hash(name) / 2);
  const bow = (hash(`${name}~`) - 0.5) * Math.min(Math.abs(dy) / 2, 120);
  const at = (share) => `${Math.round(a.x + dx * share + bow)} ${Math.round(a.y + dy * share + sag)}`;
  return `M${a.x} ${a.y}C${at(0.2)} ${at(0.8)} ${b.x} ${b.y}`;
}

const plug = ({ x, y }) => svg('g', { class: 'plug', transform: `translate(${x} ${y})` }, svg('circle', { class: 'plug-shade', cx: 1.5, cy: 3, r: 9 }),
  svg('circle', { class: 'plug-body', r: 8.5 }), svg('circle', { r: 8.5, fill: 'url(#board-shine)' }), svg('circle', { class: 'plug-core', r: 3.2 }));

/** A picture of a cord between two points. */
export function drawCord(a, b, { name, colour = 4, ...attributes }) {
  const path = (part) => svg('path', { class: `cord-${part}`, d: curve(a, b, name), transform: part === 'shade' && 'translate(2 6)' });
  return svg('g', { class: `cord cord-${colour + 1}`, ...attributes }, ['shade', 'body', 'shine', 'hit'].map(path), plug(a), plug(b));
}

/**
 * Draws all cords, the longest ones at the back.
 * @returns {{nodes: Element[], stops: Map<string, any>, plugs: any[], colours: Map<string, number>}} `stops` are cords and
 *   loose plugs by their keys
 */
export function drawCords({ elements, loose }, jacks) {
  const cords = elements.flatMap(({ name, jacks: own }) => own.flatMap(({ name: jack, cords: from }) => from.map((output) => ({ element: name, jack, from: output }))));
  const found = colours(cords, jacks);
  const heights = new Map();
  const stops = new Map();
  const plugs = [];
  /** A plug on top of those that are already in the jack. */
  function stack(key) {
    const jack = jacks.get(key);
    const height = heights.get(key) ?? 0;
    heights.set(key, height + 1);
    return jack && { x: jack.x + height * STACKED, y: jack.y - height * STACKED, jack };
  }
  function add(key, name, a, b, data) {
    const node = drawCord(a, b, { name, colour: found.get(data.output), role: 'button', tabindex: -1, 'data-key': key });
    const stop = { key, node, name, ...data, length: Math.hypot(a.x - b.x, a.y - b.y) };
    stops.set(key, stop);
    return stop;
  }
  for (const cord of cords) {
    const keys = keysOf(cord);
    const [a, b] = [stack(keys.out), stack(keys.in)];
    if (!a || !b) continue;
    const middle = { x: (a.x + b.x) / 2, y: Math.max(a.y, b.y) };
    const { node } = add(keys.cord, `${cord.from} → ${cord.element}.${cord.jack}`, a, b, { type: 'cord', cord, output: cord.from, ...middle });
    plugs.push({ ...a, type: 'plug', cord, moves: 'out', node }, { ...b, type: 'plug', cord, moves: 'in', node });
  }
  for (const { id, end, at: [x, y] } of loose) {
    const a = stack(end.output ? `out:${end.output}` : keysOf({ ...end }).in);
    if (a) plugs.push(add(`loose:${id}`, `Loose cord at ${end.output ?? `${end.element}.${end.jack}`}`, a, { x, y }, { type: 'loose', id, fixed: a.jack, output: end.output, x, y }));
  }
  const nodes = [...stops.values()].sort((one, other) => other.length - one.length).map(({ node }) => node);
  return { nodes, stops, plugs, colours: found };
}
