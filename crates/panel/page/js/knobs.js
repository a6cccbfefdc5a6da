/** The controls of the patch: parameters, pots, switches, initial conditions and other settings. */

import { dial } from './dial.js';
import { button, el } from './dom.js';
import { highlight, on, send } from './state.js';

/** With more controls than this there is a field that filters them. */
const FILTERED = 12;
const GROUPS = ['Parameters', 'Pots', 'Switches', 'Initial conditions and other settings'];

/** The values of the patch as it was opened, by the keys of the controls. */
const opened = new Map();
/** The keys of settings whose formula may be replaced. */
const unlocked = new Set();
/** @type {Map<string, Card>} */
const cards = new Map();
let openedFile = '';

/**
 * @typedef {{key: string, group: number, place: object, title: string, about: string, unit: string, view: any}} Control
 * @typedef {{node: HTMLElement, control: Control, update: (view: any, patch: any) => void}} Card
 */

const keyOf = (place) => `${place.parameter ?? place.element}\n${place.setting ?? ''}`;
const isNumber = (text) => text !== null && Number.isFinite(Number(text));
const isFormula = ({ form, text }) => form === 'number' && text !== null && !isNumber(text);

/** The value as a command has it. */
function content({ form, text, value, words }) {
  if (form === 'flag') return value === 1;
  if (form === 'choice') return words[value];
  if (form === undefined || isNumber(text)) return value ?? Number(text);
  return text;
}

function isShown(kind, { form, name, text }) {
  if (form === 'points') return false;
  return text !== null || ['setting', 'initial'].includes(name) || (kind === 'key-switch' && form === 'flag');
}

/** The control of a setting. @returns {Control} */
function ofSetting(element, view, patch) {
  const place = { element: element.name, setting: view.name };
  const isPot = view.name === 'setting';
  const output = patch.outputs.find(({ name }) => name === element.outputs[0]);
  return {
    key: keyOf(place), place, view,
    group: isPot ? 1 : view.form === 'number' ? 3 : 2,
    title: isPot || view.form === 'flag' ? element.name : `${element.name} ${view.name}`,
    about: element.note || view.description,
    unit: { 'unit of the scale': output?.unit ?? '', 'whole number': '' }[view.unit] ?? view.unit,
  };
}

/** All controls. Pots that had a formula when the patch was opened follow the others. @returns {Control[]} */
function controlsOf(patch) {
  const parameters = patch.parameters.map((view) => {
    const place = { parameter: view.name };
    return { key: keyOf(place), place, view, group: 0, title: view.name, about: view.description, unit: view.unit };
  });
  const settings = patch.elements.flatMap((element) => element.settings.filter((view) => isShown(element.kind, view))
    .map((view) => ofSetting(element, view, patch)));
  return [...parameters, ...settings];
}

/** Keeps the values of a patch without a history; of one with a history, those of new controls. */
function keepOpened(patch, controls) {
  const file = `${patch.file}\n${patch.title}`;
  if (patch.undo === null || file !== openedFile) opened.clear();
  openedFile = file;
  for (const { key, view } of controls) if (!opened.has(key)) opened.set(key, content(view));
}

/** Marks these controls and moves the page to the first one. */
function show(keys) {
  const nodes = keys.map((key) => cards.get(key)?.node).filter(Boolean);
  for (const { node } of cards.values()) node.classList.toggle('is-marked', nodes.includes(node));
  nodes[0]?.scrollIntoView({ block: 'nearest', behavior: 'smooth' });
}

/** The lines below a dial whose value a formula gives. */
function formulaLines({ key, place, title }, { text, parameters }, unlock) {
  const follow = () => {
    highlight(place);
    show(parameters.map((parameter) => keyOf({ parameter })));
  };
  return [
    button(text, follow, { class: 'knob-law', title: parameters.length ? `Show ${parameters.join(', ')}` : 'Show the element' }),
    unlocked.has(key) ? el('p', {}, 'Turning replaces the formula.')
      : button('Unlock', unlock, { class: 'knob-unlock', 'aria-label': `Unlock ${title}. Turning it then replaces the formula`, title: 'Turning then replaces the formula' }),
  ];
}

/** A dial for a number, with the formula behind it or the pots that it turns. */
function dialOf(control, set, reset) {
  const { key, place, title, about, unit, view } = control;
  const isPot = control.group === 1;
  const lines = el('div', { class: 'knob-lines' });
  let present = view;
  const knob = dial({
    label: about ? `${title}, ${about}` : title, unit, range: view.range, whole: view.unit === 'whole number', turned: set, reset,
    perTurn: isPot ? 0.1 : 0, digits: isPot ? 4 : 0,
    blocked: () => knob.note(`A formula sets it. ${present.parameters.length ? `Turn ${present.parameters.join(' or ')}, or unlock` : 'Unlock'} it.`),
  });
  let drawn = '';
  const update = (one, patch) => {
    present = one;
    knob.show(one.value ?? (one.text === null ? 0 : NaN));
    const turns = place.parameter ? patch.elements.filter(({ settings }) => settings.some(({ parameters }) => parameters.includes(title))) : [];
    const isLocked = isFormula(one) && !unlocked.has(key);
    const line = isFormula(one) ? `${one.text} ${isLocked}` : turns.map(({ name }) => name).join(', ');
    if (line === drawn) return;
    drawn = line;
    if (!isFormula(one)) unlocked.delete(key);
    knob.lock(isLocked);
    const unlock = () => {
      unlocked.add(key);
      knob.note('');
      update(one, patch);
      knob.knob.focus();
    };
    lines.replaceChildren(...isFormula(one) ? formulaLines(control, one, unlock) : turns.length ? [el('p', {}, `turns ${line}`)] : []);
  };
  return { parts: [knob.node, lines], update };
}

/** A toggle switch, or a list of words. */
function switchOf({ title, view }, set) {
  const message = el('p', { class: 'dial-message', role: 'status' });
  const change = async (value) => {
    message.textContent = (await set(value)).find(({ event }) => event === 'refused')?.message ?? '';
  };
  if (view.form === 'choice') {
    const list = el('select', { 'aria-label': title, onchange: () => change(list.value) }, view.words.map((word) => el('option', { value: word }, word)));
    return { parts: [list, message], update: (one) => { list.value = one.words[one.value]; } };
  }
  const state = el('span', {});
  const toggle = button(state, () => change(toggle.getAttribute('aria-checked') !== 'true'), { class: 'toggle', role: 'switch', 'aria-label': `${title} ${view.name}` });
  return {
    parts: [toggle, message],
    update(one) {
      toggle.setAttribute('aria-checked', String(one.value === 1));
      state.textContent = one.value === 1 ? one.name : `not ${one.name}`;
    },
  };
}

/** @param {Control} control @returns {Card} */
function cardOf(control) {
  const { key, place, title, about, view } = control;
  const set = (value) => send(place.parameter ? { command: 'parameter', name: place.parameter, value } : { command: 'setting', ...place, value });
  const reset = () => set(opened.get(key));
  const { parts, update } = view.form === 'flag' || view.form === 'choice' ? switchOf(control, set) : dialOf(control, set, reset);
  const back = button('↺', reset, { class: 'knob-reset', 'aria-label': `Reset ${title}`, title: 'Reset to the value of the opened patch' });
  const node = el('div', { class: 'knob', role: 'group', 'aria-label': title },
    el('div', { class: 'knob-title' }, el('b', {}, title), back), el('p', { class: 'knob-about', title: about }, about), parts);
  return {
    node, control,
    update(one, patch) {
      update(one, patch);
      back.hidden = Object.is(content(one), opened.get(key));
    },
  };
}

/** A second control for the pot with this output; null if there is no such pot. @returns {Card|null} */
export function potCard(output, patch) {
  const element = patch.elements.find(({ outputs }) => outputs.includes(output));
  const view = element?.settings.find(({ name }) => name === 'setting');
  return view ? cardOf(ofSetting(element, view, patch)) : null;
}

/** Draws all groups again. */
function build(root, controls) {
  cards.clear();
  for (const control of controls) cards.set(control.key, cardOf(control));
  const groups = GROUPS.map((heading, group) => {
    const own = controls.filter((control) => control.group === group);
    own.sort((one, other) => isFormula(one.view) - isFormula(other.view));
    return own.length > 0 && el('details', { class: 'knob-group', open: true }, el('summary', {}, heading, el('small', {}, own.length)),
      el('div', { class: `knob-grid${group === 2 ? ' is-switches' : ''}` }, own.map(({ key }) => cards.get(key).node)));
  });
  const filter = el('input', {
    type: 'search', class: 'knob-filter', placeholder: 'Filter', 'aria-label': 'Filter the controls',
    oninput() {
      const words = filter.value.toLowerCase().split(/\s+/);
      for (const { node } of cards.values()) node.hidden = !words.every((word) => node.textContent.toLowerCase().includes(word));
      for (const group of root.querySelectorAll('.knob-group')) group.hidden = !group.querySelector('.knob:not([hidden])');
    },
  });
  root.replaceChildren(...[controls.length > FILTERED && filter, ...groups].filter(Boolean));
  if (!controls.length) root.append(el('p', { class: 'knob-none' }, 'This patch has nothing to turn. Add a pot or a parameter.'));
}

/** Shows the controls of the patch. @param {HTMLElement} root */
export function mountKnobs(root) {
  let drawn = '';
  root.classList.add('knobs');
  on('patch', (patch) => {
    const controls = controlsOf(patch);
    keepOpened(patch, controls);
    // Cards are kept while their controls are the same: a dial that is being turned must stay.
    const form = JSON.stringify(controls.map(({ view, ...rest }) => [rest, view.range, view.words]));
    if (form !== drawn) build(root, controls);
    drawn = form;
    for (const { key, view } of controls) cards.get(key).update(view, patch);
  });
  on('highlight', (place) => {
    for (const { node, control } of cards.values()) {
      const { element, setting, parameter } = control.place;
      node.classList.toggle('is-lit', parameter ? place?.parameter === parameter
        : place?.element === element && (place.setting ?? setting) === setting);
    }
  });
}
