/** The controls of a scope: selects, switches and buttons around the screen. */

import { el, svg } from './dom.js';
import { nameOf, si } from './scope-grid.js';

const PERSISTENCE = [0, 0.2, 0.5, 1, 2, 5, 10, 20, 60];
const [LEAST_VOLTS, MOST_VOLTS] = [0.01, 50];

/** The next value of the series 1-2-5 above (1) or below (-1) a value. */
export function stepOf(value, direction) {
  const decade = 10 ** Math.floor(Math.log10(value) + 1e-9);
  const steps = direction > 0 ? [2, 5, 10, 20] : [5, 2, 1, 0.5];
  const next = steps.find((step) => direction * (step * decade - value) > 1e-6 * value);
  return Number((next * decade).toPrecision(3));
}

function series(first, last) {
  const values = [];
  for (let value = first; value <= last * (1 + 1e-9); value = stepOf(value, 1)) values.push(value);
  return values;
}

export const TIME_BASES = series(1e-6, 1000);

/** Volts per division one step larger or smaller, at a round number of volts or of units. */
export function stepVolts(volts, direction, perVolt) {
  return Math.min(MOST_VOLTS, Math.max(LEAST_VOLTS, stepOf(volts * perVolt, direction) / perVolt));
}

const option = (value, text) => el('option', { value }, text);
const push = (text, onclick, name = null) => el('button', { type: 'button', onclick, 'aria-label': name, title: name }, text);

/** A control with its label, and what stands next to it. */
function field(text, control, ...more) {
  return el('div', { class: 'scope-field' }, el('label', {}, el('span', {}, text), control), ...more);
}

/** A select of [value, text] pairs. */
function choose(words, act) {
  const list = el('select', { onchange: () => act(list.value) }, words.map(([value, text]) => option(value, text)));
  return list;
}

function check(text, act) {
  const input = el('input', { type: 'checkbox', onchange: () => act(input.checked) });
  return [input, el('label', { class: 'scope-check' }, input, text)];
}

const steps = (text, step) => el('span', { class: 'scope-steps' },
  push('−', () => step(-1), `${text}: less`), push('+', () => step(1), `${text}: more`));

/** Selects a value in a list, and adds it if the list does not have it. */
function select(list, value, text) {
  list.querySelector('[data-own]')?.remove();
  list.value = String(value);
  if (list.selectedIndex >= 0) return;
  const own = option(value, text);
  own.dataset.own = '';
  list.prepend(own);
  own.selected = true;
}

/** Fills a list of probes: signals with their unit, then elements, drives and references. */
function fillProbes(list, { elements, outputs }) {
  const groups = ['Signals', 'Elements', 'Drives', 'References'].map((label) => el('optgroup', { label }));
  for (const output of outputs) {
    const element = elements.find((each) => each.name === output.name || each.outputs.includes(output.name));
    const family = element?.family === 'drive' ? 2 : output.signal ? 0 : element ? 1 : 3;
    const unit = output.signal && output.unit !== '1' ? ` (${output.unit})` : '';
    groups[family].append(option(output.name, nameOf(output) + unit));
  }
  list.replaceChildren(option('', 'no probe'), ...groups.filter((group) => group.childElementCount > 0));
}

/** Fills a list of volts per division: round volts, and round units if the voltage stands for a quantity. */
function fillVolts(list, output) {
  const group = (unit, perVolt) => el('optgroup', { label: `${unit} per division` },
    series(stepOf(LEAST_VOLTS * perVolt * 0.999, 1), MOST_VOLTS * perVolt)
      .map((value) => option(value / perVolt, `${si(value, unit)}/div`)));
  list.replaceChildren(...(output?.signal ? [group(output.unit, Math.abs(output.per_volt))] : []), group('V', 1));
}

function channelControls(channel, model, act) {
  const name = `Channel ${channel + 1}`;
  const mine = (edit) => act.change((controls) => edit(controls.channels[channel]));
  const probe = choose([], (value) => mine((each) => { each.output = value || null; }));
  const volts = choose([], (value) => act.setVolts(channel, Number(value)));
  const position = el('input', { type: 'range', min: -6, max: 6, step: 0.1, oninput: () => act.setPosition(channel, Number(position.value)) });
  const [inverted, invert] = check('Invert', (value) => mine((each) => { each.inverted = value; }));
  const legend = el('legend', {});
  const activate = () => act.activate(channel);
  const group = el('fieldset', { class: `scope-channel-${channel + 1}`, onfocusin: activate }, legend,
    field('Probe', probe, push(svg('svg', { viewBox: '0 0 20 20', 'aria-hidden': 'true' }, svg('path', { d: 'M10 1v6m0 6v6M1 10h6m6 0h6M10 4.5a5.5 5.5 0 1 0 .01 0' })), () => act.place(channel), `${name}: place the probe by a click on an output`)),
    field('Per division', volts, steps(`${name}, per division`, (direction) => act.stepVolts(channel, direction))),
    field('Position', position, invert));
  let filled;
  return {
    group,
    update({ display, channels }, patch) {
      const each = channels[channel];
      const output = model.outputs[channel];
      if (patch) fillProbes(probe, patch);
      const scale = JSON.stringify(output);
      if (scale !== filled) fillVolts(volts, output);
      filled = scale;
      legend.textContent = display === 'plane' ? `${'XY'[channel]}: ${name.toLowerCase()}` : name;
      select(probe, each.output ?? '', each.output);
      select(volts, each.volts_per_division, `${si(each.volts_per_division, 'V')}/div`);
      position.value = String(act.positionOf(each));
      position.setAttribute('aria-valuetext', si(act.positionOf(each), 'divisions', 2));
      inverted.checked = each.inverted;
    },
  };
}

/** Makes all controls. `act` has what they do. */
export function makeControls(model, act) {
  const set = (name, convert = (value) => value) => (value) => act.change((controls) => { controls[name] = convert(value); });
  const onTrigger = (name, convert) => (value) => act.change(({ trigger }) => { trigger[name] = convert(value); });
  const display = choose([['time', 'Y-t'], ['plane', 'X-Y']], set('display'));
  const base = choose([[0, 'sweep'], ...TIME_BASES.map((value) => [value, `${si(value, 's')}/div`])], (value) => act.setBase(Number(value)));
  const baseField = field('Time base', base, steps('Time base', act.stepBase));
  const [, cursors] = check('Cursors', act.setCursors);
  const mode = choose([['run', 'each run'], ['level', 'level'], ['single-shot', 'single shot']], onTrigger('mode', String));
  const source = choose([[0, 'channel 1'], [1, 'channel 2']], onTrigger('channel', Number));
  const slope = choose([[true, 'rising'], [false, 'falling']], onTrigger('rising', (value) => value === 'true'));
  const level = el('input', { type: 'number', step: 'any', onchange: () => Number.isFinite(level.valueAsNumber) && onTrigger('level', Number)(level.value) });
  const details = [field('Source', source), field('Slope', slope), field('Level in V', level)];
  const trigger = el('fieldset', {}, el('legend', {}, 'Trigger'), field('A trace begins with', mode), details);
  const [store, storeField] = check('Store', set('store'));
  const fade = choose(PERSISTENCE.map((value) => [value, value ? si(value, 's') : 'stays']), set('persistence', Number));
  const erase = push('Erase', act.erase);
  const menu = el('details', { class: 'scope-menu' }, el('summary', {}, 'Export'), el('div', {},
    [['svg', 'SVG drawing'], ['white', 'PNG, white page'], ['dark', 'PNG, dark page'], ['csv', 'CSV table']]
      .map(([kind, text]) => push(text, () => { menu.open = false; act.save(kind); }))));
  menu.addEventListener('keydown', (event) => { if (event.key === 'Escape') menu.open = false; });
  menu.addEventListener('focusout', (event) => { if (!menu.contains(event.relatedTarget)) menu.open = false; });
  const channels = [0, 1].map((channel) => channelControls(channel, model, act));
  return {
    element: el('div', { class: 'scope-controls' }, channels.map(({ group }) => group),
      el('fieldset', {}, el('legend', {}, 'Screen'), field('Display', display), baseField, cursors, push('Auto-set', act.autoSet)),
      trigger, el('fieldset', {}, el('legend', {}, 'Storage'), field('Persistence', fade), storeField, erase, menu)),
    /** Shows the controls. With a patch, the lists of probes are made again. */
    update(controls, patch) {
      const isTime = controls.display === 'time';
      for (const channel of channels) channel.update(controls, patch);
      display.value = controls.display;
      baseField.hidden = trigger.hidden = !isTime;
      select(base, controls.seconds_per_division, `${si(controls.seconds_per_division, 's')}/div`);
      mode.value = controls.trigger.mode;
      source.value = String(controls.trigger.channel);
      slope.value = String(controls.trigger.rising);
      level.value = String(Number(controls.trigger.level.toPrecision(6)));
      for (const each of details) each.hidden = controls.trigger.mode === 'run';
      store.checked = controls.store;
      select(fade, controls.persistence, si(controls.persistence, 's'));
      erase.textContent = isTime && controls.trigger.mode === 'single-shot' ? 'Erase and arm' : 'Erase';
    },
  };
}
