/** The controls of a scope: selects, switches and buttons around the screen. */

import { el } from './dom.js';
import { nameOf, si } from './scope-screen.js';

/** Names of the families of outputs, in the order of the list of probes. */
const FAMILIES = ['Signals', 'Elements', 'Drives', 'References'];
const PERSISTENCE = [0, 0.2, 0.5, 1, 2, 5, 10, 20, 60];

/** The values 1, 2, 5, 10, ... from the first to the last. */
function series(first, last) {
  const values = [];
  for (let value = first; value <= last * (1 + 1e-9); value = stepOf(value, 1)) values.push(value);
  return values;
}

/** The next value of the series 1-2-5 above (1) or below (-1) a value. */
export function stepOf(value, direction) {
  const decade = 10 ** Math.floor(Math.log10(value) + 1e-9);
  const steps = direction > 0 ? [1, 2, 5, 10] : [5, 2, 1, 0.5];
  const next = steps.find((step) => direction * (step * decade - value) > 1e-6 * value) ?? steps[3];
  return Number((next * decade).toPrecision(3));
}

export const TIME_BASES = series(1e-6, 1000);
const VOLTS = series(0.01, 50);

/** Volts per division one step larger or smaller. They are a round number of volts, or of units. */
export function stepVolts(volts, direction, perVolt) {
  const next = stepOf(volts * perVolt, direction) / perVolt;
  return Math.min(VOLTS.at(-1), Math.max(VOLTS[0], next));
}

/** A select with its label and buttons for one step down and up. */
function stepper(text, act, step) {
  const select = el('select', { onchange: () => act(select.value) });
  const move = (sign, direction) => el('button', {
    type: 'button', class: 'scope-step', 'aria-label': `${text}: ${direction < 0 ? 'less' : 'more'}`,
    onclick: () => step(direction),
  }, sign);
  const field = el('div', { class: 'scope-field' }, el('label', {}, el('span', {}, text), select),
    el('span', { class: 'scope-steps' }, move('−', -1), move('+', 1)));
  return { field, select };
}

function choose(text, words, act) {
  const select = el('select', { onchange: () => act(select.value) },
    Object.entries(words).map(([value, word]) => el('option', { value }, word)));
  return { field: el('label', { class: 'scope-field' }, el('span', {}, text), select), select };
}

function check(text, act) {
  const input = el('input', { type: 'checkbox', onchange: () => act(input.checked) });
  return { field: el('label', { class: 'scope-check' }, input, el('span', {}, text)), input };
}

function push(text, act, name) {
  return el('button', { type: 'button', onclick: act, 'aria-label': name ?? null }, text);
}

/** Selects a value in a list, and adds it if the list does not have it. */
function select(list, value, text) {
  const wanted = String(value);
  list.querySelector('[data-own]')?.remove();
  if (![...list.options].some((option) => option.value === wanted)) {
    list.prepend(el('option', { value: wanted, 'data-own': true }, text));
  }
  list.value = wanted;
}

function familyOf(output, patch) {
  const element = patch.elements.find(({ name, outputs }) => name === output.name || outputs.includes(output.name));
  if (element?.family === 'drive') return 2;
  if (output.signal) return 0;
  return element ? 1 : 3;
}

/** Fills a list of probes: signals with their unit, then elements, drives and references. */
function fillProbes(list, patch) {
  const groups = FAMILIES.map((label) => el('optgroup', { label }));
  for (const output of patch.outputs) {
    const unit = output.signal && output.unit !== '1' ? ` (${output.unit})` : '';
    groups[familyOf(output, patch)].append(el('option', { value: output.name }, nameOf(output) + unit));
  }
  list.replaceChildren(el('option', { value: '' }, 'no probe'), ...groups.filter((group) => group.childElementCount > 0));
}

/** Fills a list of volts per division: round volts, and round units if the voltage stands for a quantity. */
function fillVolts(list, output) {
  const group = (unit, perVolt) => el('optgroup', { label: unit === 'V' ? 'Volts per division' : `${unit} per division` },
    series(stepOf(VOLTS[0] * perVolt * 0.999, 1), VOLTS.at(-1) * perVolt)
      .map((value) => el('option', { value: value / perVolt }, `${si(value, unit)}/div`)));
  const perVolt = Math.abs(output?.per_volt ?? 1);
  list.replaceChildren(group('V', 1), ...(output?.signal && perVolt !== 1 ? [group(output.unit, perVolt)] : []));
}

/** One channel's controls. */
function channelControls(channel, model, act) {
  const mine = (edit) => act.change((controls) => edit(controls.channels[channel]));
  const probe = el('select', { onchange: () => mine((each) => { each.output = probe.value || null; }) });
  const place = push('Place probe', () => act.place(channel), `Place the probe of channel ${channel + 1} by a click on an output`);
  const volts = stepper('Per division', (value) => act.setVolts(channel, Number(value)), (direction) => act.stepVolts(channel, direction));
  const position = el('input', {
    type: 'range', min: -6, max: 6, step: 0.1, oninput: () => act.setPosition(channel, Number(position.value)),
  });
  const shown = el('output', {});
  const inverted = check('Invert', (value) => mine((each) => { each.inverted = value; }));
  const legend = el('legend', {});
  const group = el('fieldset', { class: `scope-channel-${channel + 1}`, onfocusin: () => act.activate(channel), onpointerdown: () => act.activate(channel) },
    legend,
    el('label', { class: 'scope-field' }, el('span', {}, 'Probe'), probe), place, volts.field,
    el('label', { class: 'scope-field' }, el('span', {}, 'Position ', shown), position), inverted.field);
  return {
    group,
    refill(patch) {
      fillProbes(probe, patch);
      this.name = undefined;
    },
    update(controls) {
      const each = controls.channels[channel];
      const output = model.outputs[channel];
      legend.textContent = controls.display === 'plane' ? ['X', 'Y'][channel] : `Channel ${channel + 1}`;
      const name = output ? `${output.name} ${output.unit} ${output.per_volt}` : '';
      if (name !== this.name) fillVolts(volts.select, output);
      this.name = name;
      select(probe, each.output ?? '', each.output);
      select(volts.select, each.volts_per_division, `${si(each.volts_per_division, 'V')}/div`);
      position.value = String(act.positionOf(each));
      shown.textContent = si(act.positionOf(each), 'div', 2);
      inverted.input.checked = each.inverted;
    },
  };
}

function triggerControls(model, act) {
  const mine = (edit) => act.change((controls) => edit(controls.trigger));
  const mode = choose('Trigger', { run: 'each run', level: 'level', 'single-shot': 'single shot' }, (value) => mine((each) => { each.mode = value; }));
  const source = choose('Source', { 0: 'channel 1', 1: 'channel 2' }, (value) => mine((each) => { each.channel = Number(value); }));
  const slope = choose('Slope', { true: 'rising', false: 'falling' }, (value) => mine((each) => { each.rising = value === 'true'; }));
  const level = el('input', {
    type: 'number', step: 'any', onchange: () => Number.isFinite(level.valueAsNumber) && mine((each) => { each.level = level.valueAsNumber; }),
  });
  const levelField = el('label', { class: 'scope-field' }, el('span', {}, 'Level in V'), level);
  const group = el('fieldset', {}, el('legend', {}, 'Trigger'), mode.field, source.field, levelField, slope.field);
  return {
    group,
    update({ trigger, display }) {
      group.hidden = display === 'plane';
      mode.select.value = trigger.mode;
      source.select.value = String(trigger.channel);
      slope.select.value = String(trigger.rising);
      if (document.activeElement !== level) level.value = String(Number(trigger.level.toPrecision(6)));
      for (const field of [source.field, levelField, slope.field]) field.hidden = trigger.mode === 'run';
    },
  };
}

/** Makes all controls. `act` has what they do. */
export function makeControls(model, act) {
  const display = choose('Display', { time: 'Y-t', plane: 'X-Y' }, (value) => act.change((controls) => { controls.display = value; }));
  const base = stepper('Time base', (value) => act.setBase(Number(value)), act.stepBase);
  base.select.append(el('option', { value: 0 }, 'sweep'), ...TIME_BASES.map((value) => el('option', { value }, `${si(value, 's')}/div`)));
  const store = check('Store', (value) => act.change((controls) => { controls.store = value; }));
  const fade = choose('Persistence', Object.fromEntries(PERSISTENCE.map((value) => [value, value ? si(value, 's') : 'stays'])),
    (value) => act.change((controls) => { controls.persistence = Number(value); }));
  const cursors = check('Cursors', act.setCursors);
  const erase = push('Erase', act.erase);
  const menu = el('details', { class: 'scope-menu' }, el('summary', {}, 'Export'), el('div', {},
    Object.entries({ svg: 'SVG drawing', white: 'PNG, white page', dark: 'PNG, dark page', csv: 'CSV table' })
      .map(([kind, text]) => push(text, () => { menu.open = false; act.save(kind); }))));
  menu.addEventListener('keydown', (event) => { if (event.key === 'Escape') menu.open = false; });
  menu.addEventListener('focusout', (event) => { if (!menu.contains(event.relatedTarget)) menu.open = false; });
  const channels = [0, 1].map((channel) => channelControls(channel, model, act));
  const trigger = triggerControls(model, act);
  const element = el('div', { class: 'scope-controls' },
    el('fieldset', {}, el('legend', {}, 'Screen'), display.field, base.field, push('Auto-set', act.autoSet), cursors.field),
    channels.map(({ group }) => group), trigger.group,
    el('fieldset', {}, el('legend', {}, 'Storage'), store.field, fade.field, erase, menu));
  return {
    element,
    refill: (patch) => channels.forEach((channel) => channel.refill(patch)),
    update(controls) {
      display.select.value = controls.display;
      base.field.hidden = controls.display === 'plane';
      select(base.select, controls.seconds_per_division, `${si(controls.seconds_per_division, 's')}/div`);
      store.input.checked = controls.store;
      select(fade.select, controls.persistence, si(controls.persistence, 's'));
      erase.textContent = controls.trigger.mode === 'single-shot' && controls.display === 'time' ? 'Erase and arm' : 'Erase';
      for (const channel of channels) channel.update(controls);
      trigger.update(controls);
    },
  };
}
