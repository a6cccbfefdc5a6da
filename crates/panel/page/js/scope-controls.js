/**
 * The controls around the screen of a scope, and the marks on it: cursors and the trigger level. A control has the path of what
 * it sets: "trigger.level".
 */

import { decadeOf, el, fill, quantity, within, write } from './dom.js';
import { fillOutputs } from './probes.js';
import { ARROWS } from './zoom.js';

const [LEAST_VOLTS, MOST_VOLTS] = [0.01, 50];
/** The steps of a decade: at 25 volts per division, the machine unit is at the edge of the screen. */
const STEPS = [1, 2, 2.5, 5];

/** The round values of a range. */
export function series(first, last) {
  const values = [];
  for (let decade = decadeOf(first); decade < last * 1.001; decade *= 10) {
    values.push(...STEPS.map((step) => Number((step * decade).toPrecision(12))));
  }
  return values.filter((value) => value >= first * (1 - 1e-9) && value <= last * (1 + 1e-9));
}

/** Divisions from the middle of the screen up to 0 V. */
const positionOf = ({ centre, volts_per_division: volts, inverted }) => (inverted ? centre : -centre) / volts || 0;

export function setPosition(channel, position) {
  channel.centre = (channel.inverted ? position : -position) * channel.volts_per_division || 0;
}

/** Changes the scale. 0 V stays at its place. */
function setVolts(channel, volts) {
  const position = positionOf(channel);
  channel.volts_per_division = volts;
  setPosition(channel, position);
}

/** Fills a list of volts per division: round units if the voltage stands for a quantity, and round volts. */
function fillVolts(list, output) {
  const group = (unit, perVolt) => el('optgroup', { label: `${unit} per division` },
    series(LEAST_VOLTS * perVolt, MOST_VOLTS * perVolt)
      .map((value) => el('option', { value: value / perVolt }, `${quantity(value, unit, 3)}/div`)));
  list.replaceChildren(...output?.signal ? [group(output.unit, Math.abs(output.per_volt))] : [], group('V', 1));
}

/** Selects a value in a list, and adds it if the list does not have it. */
function select(list, value, text) {
  list.querySelector('[data-own]')?.remove();
  list.value = value;
  if (list.selectedIndex < 0) list.prepend(el('option', { value, 'data-own': true, selected: true }, text));
}

/** The round value of a list that is next to a value, above it (1) or below it (-1). */
function nextOf(list, value, direction) {
  const options = list.querySelectorAll(':not(optgroup ~ optgroup) > option:not([data-own])');
  const values = Array.from(options, (option) => Number(option.value)).filter(Boolean);
  const isNext = (each) => direction * (each - value) > 1e-6 * value;
  return direction > 0 ? values.find(isNext) ?? values.at(-1) : values.findLast(isNext) ?? values[0];
}

/** The object that has a control's value, and its key there. */
function placeOf(controls, { dataset }) {
  const path = dataset.set.split('.');
  const key = path.pop();
  return [path.reduce((part, name) => part[name], controls), key];
}

/** The value of a control, in the type of the value before. A position has none before, and is a number. */
function valueOf({ type, checked, value }, before) {
  if (type === 'checkbox') return checked;
  if (typeof before === 'boolean') return value === 'true';
  return typeof before === 'string' || before === null ? value || null : Number(value);
}

/**
 * Connects the controls of a scope. `act` has what the buttons do.
 * @returns {{update: Function, step: Function}} `update` shows controls; with a patch, it makes the lists of probes again.
 *   `step` sets the scale of a channel, or the time base, to the round value that is next to a value.
 */
export function mountControls({ node, controls: root, base, summary }, model, change, act) {
  const inputs = [...root.querySelectorAll('[data-set]')];
  const scales = inputs.filter(({ dataset }) => dataset.set.endsWith('volts_per_division'));
  const set = (control, controls) => {
    const [owner, key] = placeOf(controls, control);
    const value = valueOf(control, owner[key]);
    if (key === 'position') setPosition(owner, value);
    else if (key === 'volts_per_division') setVolts(owner, value);
    else owner[key] = value;
  };
  root.oninput = root.onchange = ({ type, target }) => {
    // A slider acts while it is moved, the others when their values are complete.
    if ((target.type === 'range') !== (type === 'input')) return;
    if (target.dataset.set) change((controls) => set(target, controls));
    else act[target.dataset.act]?.();
  };
  root.onclick = ({ target }) => {
    const button = target.closest('button');
    if (!button) return;
    act[button.dataset.act](button.value);
    button.closest('details')?.removeAttribute('open');
  };
  const step = (controls, channel, value, direction) => {
    const owner = controls.channels[channel];
    if (owner) setVolts(owner, nextOf(scales[channel], value ?? owner.volts_per_division, direction));
    else controls.seconds_per_division = nextOf(base, value, direction);
  };
  const update = (controls, patch) => {
    const { display, trigger: { mode, level, rising } } = controls;
    for (const control of inputs) {
      const [owner, key] = placeOf(controls, control);
      const channel = controls.channels.indexOf(owner);
      const value = key === 'position' ? positionOf(owner) : owner[key];
      if (key === 'output' && patch) fillOutputs(control, patch, 'no probe');
      const scale = JSON.stringify(model.outputs[channel] ?? null);
      if (scales[channel] === control && control.dataset.scale !== scale) {
        fillVolts(control, model.outputs[channel]);
        control.dataset.scale = scale;
      }
      if (control.type === 'checkbox') control.checked = value;
      else if (control.localName === 'select') {
        select(control, value ?? '', typeof value === 'number' ? quantity(value, channel < 0 ? 's' : 'V', 3) : value);
      } else control.value = Number(value.toPrecision(6));
      if (key === 'position') control.ariaValueText = quantity(value, 'divisions', 2);
    }
    node.dataset.display = display;
    const names = { run: 'Trigger: run', level: 'Trigger: ', 'single-shot': 'Single: ' };
    write(summary, names[mode] + (mode === 'run' ? '' : `${quantity(level, 'V', 3)} ${rising ? '↗' : '↘'}`));
  };
  return { step, update };
}

/**
 * Lets a mark be moved. `move` gets shares of the graticule, from its lower left corner.
 * @param {() => [number, number]} where its present place
 */
export function mountMark(mark, screen, move, where) {
  const to = (...shares) => move(...shares.map((share) => within(0, share, 1)));
  fill(mark, {
    onpointerdown(event) {
      event.preventDefault();
      mark.setPointerCapture(event.pointerId);
      mark.focus();
    },
    onpointermove({ pointerId, clientX, clientY }) {
      if (!mark.hasPointerCapture(pointerId)) return;
      const { x, y, across, up } = screen.view;
      const { left, top } = screen.box.getBoundingClientRect();
      to((clientX - left - x) / across, 1 - (clientY - top - y) / up);
    },
    onkeydown(event) {
      const step = event.shiftKey ? 0.05 : 0.002;
      const way = ARROWS[event.key];
      if (!way) return;
      event.preventDefault();
      const [x, y] = where();
      to(x + way[0] * step, y - way[1] * step);
    },
  });
}

/** Puts a mark to its place. `text` is its value for a screen reader. */
export function placeMark(mark, { x, y, across, up }, [right, top], share, text) {
  mark.style.left = `${x + right * across}px`;
  mark.style.top = `${y + (1 - top) * up}px`;
  mark.ariaValueNow = (100 * share).toFixed(1);
  mark.ariaValueText = text;
}
