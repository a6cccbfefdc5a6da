/** The overload lamps of the amplifiers, and a list of what lit them. */

import { button, el, quantity } from './dom.js';
import { highlight, on } from './state.js';

/** From this number of lamps on they are small. */
const MANY = 24;

/** Shows a lamp for every amplifier that has one. @param {HTMLElement} root */
export function mountLamps(root) {
  let lamps = [];
  let drawn = '';
  let listed = '';
  const grid = el('div', { class: 'lamp-grid' });
  const list = el('ol', { class: 'lamp-list' });
  const status = el('p', { class: 'lamp-status', role: 'status' });
  root.replaceChildren(grid, status, list);
  const seek = (element) => () => highlight({ element });

  on('patch', ({ elements, outputs }) => {
    const own = elements.filter(({ lamp }) => lamp)
      .map((element) => ({ name: element.name, index: outputs.findIndex(({ name }) => name === element.outputs[0]) }));
    if (JSON.stringify(own) === drawn) return;
    drawn = JSON.stringify(own);
    lamps = own.map((lamp) => ({ ...lamp, node: button(lamp.name, seek(lamp.name), { class: 'lamp' }), look: '' }));
    grid.classList.toggle('is-small', lamps.length >= MANY);
    grid.replaceChildren(...lamps.map(({ node }) => node));
  });
  on('frame', (frame) => {
    for (const lamp of lamps) {
      const look = !frame.lamps[lamp.index] ? 'off' : frame.firstLamp === lamp.index ? 'first' : 'lit';
      if (look === lamp.look) continue;
      lamp.look = look;
      lamp.node.dataset.lamp = look;
      lamp.node.setAttribute('aria-label', `${lamp.name}, overload lamp ${look === 'first' ? 'lit first' : look}`);
    }
  });
  on('machine', ({ overloads }) => {
    const text = JSON.stringify(overloads);
    if (text === listed) return;
    listed = text;
    const words = overloads.map(({ element, time, caused_by: cause }) => `${element} at ${quantity(time, 's')}${cause ? `, caused by ${cause}` : ''}`);
    status.textContent = words.length ? `Overload. First: ${words[0]}.` : '';
    list.replaceChildren(...words.map((word, index) => el('li', {}, button(word, seek(overloads[index].element)))));
  });
}
