/** The controls around the screen of a scope. Each has the path of what it sets: "trigger.level". */

import { el, quantity, within, write } from './dom.js';
import { fillOutputs } from './probes.js';

const [LEAST_VOLTS, MOST_VOLTS] = [0.01, 50];
/** The steps of a decade: at 25 volts per division, the machine unit is at the edge of the screen. */
const [TIMES, VOLTS] = [[1, 2, 5], [1, 2, 2.5, 5]];

/** The next round value above (1) or below (-1) a value. */
function stepOf(value, direction, round) {
  const decade = 10 ** Math.floor(Math.log10(value) + 1e-9);
  const steps = direction > 0 ? [...round, 10] : [...round, round.at(-1) / 10].sort((a, b) => b - a);
  return Number((steps.find((step) => direction * (step * decade - value) > 1e-6 * value) * decade).toPrecision(3));
}

function series(first, last, round) {
  const values = [];
  for (let value = first; value <= last * (1 + 1e-9); value = stepOf(value, 1, round)) values.push(value);
  return values;
}

const BASES = series(1e-6, 1000, TIMES);

/** The time base one step larger or smaller. */
export const stepBase = (seconds, direction) => within(BASES[0], stepOf(seconds, direction, TIMES), BASES.at(-1));

/** Volts per division one step larger or smaller, at a round number of volts, or of units if it is one now. */
export function stepVolts(volts, direction, output, isNew = false) {
  const perVolt = output?.signal ? Math.abs(output.per_volt) : 1;
  const isRound = Math.abs(stepOf(stepOf(volts * perVolt, 1, VOLTS), -1, VOLTS) / (volts * perVolt) - 1) < 1e-4;
  const scale = isNew || isRound ? perVolt : 1;
  return within(LEAST_VOLTS, stepOf(volts * scale, direction, VOLTS) / scale, MOST_VOLTS);
}

/** Divisions from the middle of the screen up to 0 V. */
const positionOf = ({ centre, volts_per_division: volts, inverted }) => (inverted ? centre : -centre) / volts || 0;

export function setPosition(channel, position) {
  channel.centre = (channel.inverted ? position : -position) * channel.volts_per_division || 0;
}

/** Changes the scale. 0 V stays at its place. */
export function setVolts(channel, volts) {
  const position = positionOf(channel);
  channel.volts_per_division = volts;
  setPosition(channel, position);
}

const option = (value, text) => el('option', { value }, text);

/** Selects a value in a list, and adds it if the list does not have it. */
function select(list, value, text) {
  list.querySelector('[data-own]')?.remove();
  list.value = String(value);
  if (list.selectedIndex < 0) list.prepend(el('option', { value, 'data-own': true, selected: true }, text));
}

/** Fills a list of volts per division: round volts, and round units if the voltage stands for a quantity. */
function fillVolts(list, output) {
  const group = (unit, perVolt) => el('optgroup', { label: `${unit} per division` },
    series(stepOf(LEAST_VOLTS * perVolt * 0.999, 1, VOLTS), MOST_VOLTS * perVolt, VOLTS)
      .map((value) => option(value / perVolt, `${quantity(value, unit, 3)}/div`)));
  list.replaceChildren(...(output?.signal ? [group(output.unit, Math.abs(output.per_volt))] : []), group('V', 1));
}

/** The object that has a control's value, and its key there. */
function placeOf(controls, control) {
  const path = control.dataset.set.split('.');
  const key = path.pop();
  return [path.reduce((part, name) => part[name], controls), key];
}

/**
 * Connects the controls of a scope. `act` has what the buttons do.
 * @returns a function that shows controls; with a patch, it makes the lists of probes again
 */
export function mountControls({ controls: root, base, trigger, summary, erase }, model, change, act) {
  const lists = [...root.querySelectorAll('[data-set]')];
  const scales = ['', ''];
  base.append(option(0, 'one sweep'), ...BASES.map((value) => option(value, `${quantity(value, 's', 3)}/div`)));
  const set = (control, where) => {
    const [owner, key] = placeOf(where, control);
    const isNumber = ['range', 'number'].includes(control.type) || typeof owner[key] === 'number';
    const value = control.type === 'checkbox' ? control.checked : isNumber ? Number(control.value)
      : typeof owner[key] === 'boolean' ? control.value === 'true' : control.value || null;
    if (key === 'position') setPosition(owner, value);
    else if (key === 'volts_per_division') setVolts(owner, value);
    else owner[key] = value;
  };
  for (const kind of ['input', 'change']) {
    root.addEventListener(kind, ({ target }) => {
      if ((target.type === 'range') !== (kind === 'input')) return;
      if (target.dataset.set) change((controls) => set(target, controls));
      else act[target.dataset.act]?.(target.checked);
    });
  }
  root.addEventListener('click', ({ target }) => {
    const button = target.closest('button');
    if (!button) return;
    act[button.dataset.act](Number(button.parentElement.dataset.channel));
    const menu = button.closest('details');
    if (menu) menu.open = false;
  });
  return (controls, patch) => {
    const { display, trigger: { mode, level, rising } } = controls;
    const isTime = display === 'time';
    for (const control of lists) {
      const [owner, key] = placeOf(controls, control);
      const channel = controls.channels.indexOf(owner);
      if (key === 'output' && patch) fillOutputs(control, patch, 'no probe');
      const scale = JSON.stringify(model.outputs[channel]);
      if (key === 'volts_per_division' && scale !== scales[channel]) {
        fillVolts(control, model.outputs[channel]);
        scales[channel] = scale;
      }
      const value = key === 'position' ? positionOf(owner) : owner[key];
      if (control.type === 'checkbox') control.checked = value;
      else if (control.localName === 'select') select(control, value ?? '', typeof value === 'number' ? quantity(value, channel < 0 ? 's' : 'V', 3) : value);
      else control.value = Number(value.toPrecision(6));
      if (key === 'position') control.setAttribute('aria-valuetext', quantity(value, 'divisions', 2));
      if (owner === controls.trigger && key !== 'mode') control.parentElement.hidden = mode === 'run';
    }
    root.querySelectorAll('b').forEach((name, channel) => write(name, isTime ? String(channel + 1) : 'XY'[channel]));
    base.hidden = trigger.hidden = !isTime;
    write(summary, mode === 'run' ? 'Trigger: run' : `${mode === 'level' ? 'Trigger' : 'Single'}: ${quantity(level, 'V', 3)} ${rising ? '↗' : '↘'}`);
    write(erase, isTime && mode === 'single-shot' ? 'Erase and arm' : 'Erase');
  };
}
