/** The overload lamps: one for every amplifier that has one, and a list of what lit them. */

import { button, byId, changeDetector, el, place, quantity } from './dom.js';
import { highlight, on, state } from './state.js';

/** How the lamp of an output looks: "off", "lit", or "first" if it lit first. */
export function lookOf({ lamps, firstLamp }, output) {
  const number = state.numbers.get(output);
  return !lamps[number] ? 'off' : firstLamp === number ? 'first' : 'lit';
}

let lamps = [];
const [hasOtherLamps, hasOtherOverloads] = [changeDetector(), changeDetector()];
const [grid, status, list] = byId('lamps').children;
const seek = (name, element, attributes) => button(name, () => highlight({ element }), attributes);

on('patch', ({ elements }) => {
  const own = elements.filter(({ lamp }) => lamp).map(({ name, outputs: [output] }) => ({ name, output }));
  if (!hasOtherLamps(own)) return;
  lamps = place(grid, own.map((lamp) => ({ ...lamp, node: seek(lamp.name, lamp.name, { class: 'lamp' }) })));
});
on('frame', (frame) => {
  for (const { name, output, node } of lamps) {
    const look = lookOf(frame, output);
    if (look === node.dataset.lamp) continue;
    node.dataset.lamp = look;
    node.ariaLabel = `${name}, overload lamp ${look === 'first' ? 'lit first' : look}`;
  }
});
on('machine', ({ overloads }) => {
  if (!hasOtherOverloads(overloads)) return;
  list.replaceChildren(...overloads.map(({ element, time, caused_by: cause }) =>
    el('li', null, seek(`${element} at ${quantity(time, 's')}${cause ? `, caused by ${cause}` : ''}`, element))));
  status.textContent = overloads.length ? `Overload. First: ${list.firstChild.textContent}.` : '';
});
