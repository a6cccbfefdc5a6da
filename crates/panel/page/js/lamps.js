/** The overload lamps of the amplifiers, and a list of what lit them. */

import { button, byId, el, quantity } from './dom.js';
import { highlight, on } from './state.js';

/** From this number of lamps on they are small. */
const MANY = 24;

/** How the lamp of an output looks: "off", "lit", or "first" if it lit first. */
export const lookOf = ({ lamps, firstLamp }, index) => (!lamps[index] ? 'off' : firstLamp === index ? 'first' : 'lit');

/** Shows a lamp for every amplifier that has one. */
export function mountLamps() {
  let lamps = [];
  let [drawn, listed] = ['', ''];
  const [grid, status, list] = byId('lamps').children;
  const seek = (name, element, attributes) => button(name, () => highlight({ element }), attributes);

  on('patch', ({ elements, outputs }) => {
    const own = elements.filter(({ lamp }) => lamp)
      .map((element) => ({ name: element.name, index: outputs.findIndex(({ name }) => name === element.outputs[0]) }));
    if (JSON.stringify(own) === drawn) return;
    drawn = JSON.stringify(own);
    lamps = own.map((lamp) => ({ ...lamp, node: seek(lamp.name, lamp.name, { class: 'lamp' }) }));
    grid.classList.toggle('is-small', lamps.length >= MANY);
    grid.replaceChildren(...lamps.map(({ node }) => node));
  });
  on('frame', (frame) => {
    for (const { name, index, node } of lamps) {
      const look = lookOf(frame, index);
      if (look === node.dataset.lamp) continue;
      node.dataset.lamp = look;
      node.ariaLabel = `${name}, overload lamp ${look === 'first' ? 'lit first' : look}`;
    }
  });
  on('machine', ({ overloads }) => {
    const text = JSON.stringify(overloads);
    if (text === listed) return;
    listed = text;
    list.replaceChildren(...overloads.map(({ element, time, caused_by: cause }) =>
      el('li', null, seek(`${element} at ${quantity(time, 's')}${cause ? `, caused by ${cause}` : ''}`, element))));
    status.textContent = overloads.length ? `Overload. First: ${list.firstChild.textContent}.` : '';
  });
}
