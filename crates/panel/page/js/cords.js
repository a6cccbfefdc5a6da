/** The cords of the patch panel: their colours, their curves and their plugs. */

import { keyed, shape } from './dom.js';

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

/** The keys of a cord and of its jacks. */
export const keysOf = ({ element, jack, from }) => ({
  cord: `cord:${from}>${element}.${jack}`, out: `out:${from}`, in: `in:${element}.${jack}`
});

/** The colour of each output, by its name. Outputs nearby and cords into one element differ, and all colours are used. */
function colours(cords, jacks) {
  const found = new Map();
  const used = Array(COLOURS).fill(0);
  for (const from of new Set(cords.map((cord) => cord.from))) {
    const place = jacks.get(`out:${from}`);
    const goals = new Set(cords.filter((cord) => cord.from === from).map(({ element }) => element));
    const cost = [...used];
    for (const cord of cords) if (goals.has(cord.element) && found.has(cord.from)) cost[found.get(cord.from)] += 100;
    for (const [other, colour] of found) {
      const there = jacks.get(`out:${other}`);
      if (place && there && Math.hypot(place.x - there.x, place.y - there.y) < NEAR) cost[colour] += 100;
    }
    let colour = FIXED[from] ?? Math.floor(hash(from) * COLOURS);
    if (!(from in FIXED)) cost.forEach((_, step) => {
      const other = (colour + 3 * step) % COLOURS;
      if (cost[other] < cost[colour]) colour = other;
    });
    found.set(from, colour);
    used[colour] += 1;
  }
  return found;
}

/** The path of a hanging cord. Its sag and its bow depend on its name, so that cords do not cover each other. */
function curve(a, b, name = '') {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const sag = Math.min(22 + Math.hypot(dx, dy) * 0.26, 150) * (0.75 + hash(name) / 2);
  const bow = (hash(`${name}~`) - 0.5) * Math.min(Math.abs(dy) / 2, 120);
  const at = (share) => `${Math.round(a.x + dx * share + bow)} ${Math.round(a.y + dy * share + sag)}`;
  return `M${a.x} ${a.y}C${at(0.2)} ${at(0.8)} ${b.x} ${b.y}`;
}

/** The class of a cord with a colour. A loose cord from an input has none of its own. */
export const cordClass = (colour = 4) => `cord cord-${colour + 1}`;

/** Puts the curves and the plugs of a cord between two points. */
export function lay(node, a, b, name) {
  for (const path of node.querySelectorAll('path')) path.setAttribute('d', curve(a, b, name));
  [a, b].forEach(({ x, y }, end) => node.children[4 + end].setAttribute('transform', `translate(${x} ${y})`));
}

/**
 * Draws all cords, the longest ones at the back. `stops` are cords and loose plugs by their keys.
 * @returns {{nodes: Element[], stops: Map<string, any>, plugs: any[], colours: Map<string, number>}}
 */
export function drawCords({ elements, loose }, jacks) {
  const cords = elements.flatMap(({ name, jacks: own }) => own.flatMap(({ name: jack, cords: outputs }) =>
    outputs.map((from) => ({ element: name, jack, from }))));
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
    const node = shape('cord', { class: cordClass(found.get(data.output)), ...keyed(key) });
    lay(node, a, b, name);
    const one = { key, node, name, ...data, length: Math.hypot(a.x - b.x, a.y - b.y) };
    stops.set(key, one);
    return one;
  }
  for (const cord of cords) {
    const { from, element, jack } = cord;
    const keys = keysOf(cord);
    const [a, b] = [stack(keys.out), stack(keys.in)];
    if (!a || !b) continue;
    const data = { type: 'cord', cord, output: from, x: (a.x + b.x) / 2, y: Math.max(a.y, b.y) };
    const { node } = add(keys.cord, `${from} → ${element}.${jack}`, a, b, data);
    for (const [end, moves] of [[a, 'out'], [b, 'in']]) plugs.push({ ...end, type: 'plug', cord, moves, node });
  }
  for (const { id, end, at: [x, y] } of loose) {
    const a = stack(end.output ? `out:${end.output}` : keysOf(end).in);
    if (!a) continue;
    const data = { type: 'loose', id, fixed: a.jack, output: end.output, x, y };
    plugs.push(add(`loose:${id}`, `Loose cord at ${end.output ?? `${end.element}.${end.jack}`}`, a, data, data));
  }
  return {
    nodes: [...stops.values()].sort((one, other) => other.length - one.length).map(({ node }) => node),
    stops, plugs, colours: found
  };
}
