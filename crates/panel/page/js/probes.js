/** Probes: where they are, and the menu that places them. */

import { button, byId, el, float, quantity } from './dom.js';
import { isProbing, outputOf, probed, send, state } from './state.js';

/**
 * All probes of scopes and meters, with their outputs and a function that connects them.
 * @returns {{name: string, mark: string, look: string, output: string | null, connect: (output: string | null) => void}[]}
 */
export function probes() {
  const channels = state.scopes.flatMap((controls, scope) => controls.channels.map(({ output }, index) => ({
    name: `Scope ${scope + 1}, channel ${index + 1}`, mark: `${scope + 1}.${index + 1}`, look: String(index + 1), output,
    connect(to) {
      const copy = structuredClone(controls);
      copy.channels[index].output = to;
      send('scope', { scope, controls: copy });
    },
  })));
  const { meter = null, null_meter: nullMeter } = state.machine ?? {};
  return [...channels,
    { name: 'Voltmeter', mark: 'V', look: 'meter', output: meter, connect: (output) => send('meter', { output }) },
    {
      name: 'Null meter', mark: 'N', look: 'meter', output: nullMeter?.output ?? null,
      connect: (output) => send('null-meter', { ...nullMeter, output }),
    }];
}

/** Name of an output with the quantity that it stands for: "v_o at A1". */
export const nameOf = ({ name, signal }) => (signal && signal !== name ? `${signal} at ${name}` : name);

/** The same for the name of an output. */
export const outputName = (name) => nameOf(outputOf(name) ?? { name });

/** Volts, and what they stand for: "20 V/div = 4 m/div". `per` is "/div" or empty. */
export function reading(volts, { signal, unit, per_volt: perVolt }, per = '', digits = 4) {
  const value = per ? Math.abs(volts * perVolt) : volts * perVolt;
  return `${quantity(volts, 'V', digits)}${per}${signal && Number.isFinite(volts) ? ` = ${quantity(value, unit, digits)}${per}` : ''}`;
}

/** Fills a list of outputs: signals with their unit, then elements, drives and references. */
export function fillOutputs(list, { elements, outputs }, none) {
  const groups = ['Signals', 'Elements', 'Drives', 'References'].map((label) => el('optgroup', { label }));
  for (const output of outputs) {
    const element = elements.find((each) => each.outputs.includes(output.name));
    const family = element?.family === 'drive' ? 2 : output.signal ? 0 : element ? 1 : 3;
    const unit = output.signal && output.unit !== '1' ? ` (${output.unit})` : '';
    groups[family].append(el('option', { value: output.name }, nameOf(output) + unit));
  }
  list.replaceChildren(el('option', { value: '' }, none), ...groups.filter((group) => group.childElementCount > 0));
}

/** The user has chosen an output: it gets the probe that waits, or a menu opens at the place. @param {Element} at */
export function choose(output, at, { clientX = 0, clientY = 0 } = {}) {
  if (isProbing()) return probed(output);
  const menu = byId('probe-menu');
  const items = probes().map(({ name, look, output: now, connect }) => button(name, () => {
    connect(now === output ? null : output);
    menu.close();
  }, { 'aria-pressed': String(now === output), 'data-look': look }));
  menu.replaceChildren(el('h2', { id: 'probe-title' }, outputName(output)), ...items);

  menu.onkeydown = ({ key }) => {
    const by = { ArrowDown: 1, ArrowUp: -1 }[key];
    if (by) items.at((items.indexOf(document.activeElement) + by) % items.length).focus();
  };
  menu.showModal();
  const box = at.getBoundingClientRect();
  float(menu, clientX || box.left, (clientY || box.bottom) + 6);
}
