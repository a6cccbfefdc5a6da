/** The controls of the patch: parameters, pots, switches, initial conditions and other settings. */

import { dial } from './dial.js';
import { button, el } from './dom.js';
import { highlight, on, send } from './state.js';

/** With more controls than this there is a field that filters them. */
const FILTERED = 12;
const GROUPS = ['Parameters', 'Pots', 'Switches', 'Initial conditions and other settings', 'Set by parameters'];

/** The values of the patch as it was opened, by the keys of the controls. */
const opened = new Map();
/** The keys of settings whose formula may be replaced. */
const unlocked = new Set();
/** The cards of the controls, by their keys. */
const cards = new Map();
let openedFile = '';
let controls = [];

const keyOf = ({ parameter, element, setting }) => JSON.stringify([parameter, element, setting]);
const isFormula = ({ form, text }) => form === 'number' && text !== null && Number.isNaN(Number(text));

/** The value as a command has it. */
function content({ form, text, value, words }) {
  if (form === 'flag') return value === 1;
  if (form === 'choice') return words[value];
  return form && (text === null || Number.isNaN(Number(text))) ? text : value ?? Number(text);
}

function isShown({ kind }, { form, name, text }) {
  return form !== 'points' && (text !== null || name === 'setting' || name === 'initial' || (kind === 'key-switch' && form === 'flag'));
}

/** The control of a setting. */
function ofSetting(element, view, patch) {
  const place = { element: element.name, setting: view.name };
  const isPot = view.name === 'setting';
  const output = patch.outputs.find(({ name }) => name === element.outputs[0]);
  return {
    key: keyOf(place), place, view,
    title: isPot || view.form === 'flag' ? element.name : `${element.name} ${view.name}`,
    about: element.note || (isPot ? '' : view.description),
    unit: { 'unit of the scale': output?.unit, 'whole number': '' }[view.unit] ?? view.unit,
  };
}

/** Finds all controls, and the values that they had when the patch was opened: those of a patch without a history. */
function take(patch) {
  const parameters = patch.parameters.map((view) => {
    const place = { parameter: view.name };
    return { key: keyOf(place), place, view, title: view.name, about: view.description, unit: view.unit };
  });
  const settings = patch.elements.flatMap((element) => element.settings.filter((view) => isShown(element, view))
    .map((view) => ofSetting(element, view, patch)));
  controls = [...parameters, ...settings];
  const file = `${patch.file}\n${patch.title}`;
  if (patch.undo === null || file !== openedFile) opened.clear();
  if (file !== openedFile) unlocked.clear();
  openedFile = file;
  for (const control of controls) {
    const { key, place, view } = control;
    if (!opened.has(key)) opened.set(key, content(view));
    // A control stays in its group when its formula is replaced: it must not move while it is being turned.
    const other = typeof opened.get(key) === 'string' ? 4 : place.setting === 'setting' ? 1 : 3;
    control.group = place.parameter ? 0 : view.form === 'number' ? other : 2;
  }
}
// Before any other listener, because a pot at the null meter also has a value to which it is reset.
on('patch', take);

/** Marks these controls and moves the page to the first one. */
function show(keys) {
  for (const [key, { node }] of cards) node.classList.toggle('is-marked', keys.includes(key));
  cards.get(keys[0])?.node.scrollIntoView({ block: 'center', behavior: 'smooth' });
}

/** A dial for a number, with the formula behind it or the elements that it turns. */
function dialOf({ key, place, title, about, unit, view }, set, reset) {
  const isPot = place.setting === 'setting';
  const lines = el('div', { class: 'knob-lines' });
  let present = view;
  let drawn = '';
  const knob = dial({
    label: about ? `${title}, ${about}` : title, unit, range: view.range, whole: view.unit === 'whole number', turned: set, reset,
    perTurn: isPot ? 0.1 : 0, digits: isPot ? 4 : 0,
    blocked: () => knob.note(`A formula sets it. ${present.parameters.length ? `Turn ${present.parameters.join(' or ')}, or unlock` : 'Unlock'} it.`),
  });
  const update = (one, patch) => {
    present = one;
    knob.show(one.value ?? (one.text === null ? 0 : NaN));
    if (!isFormula(one)) unlocked.delete(key);
    const isLocked = isFormula(one) && !unlocked.has(key);
    const turns = patch.elements.filter(({ settings }) => settings.some(({ parameters }) => parameters.includes(place.parameter)));
    const text = isFormula(one) ? one.text : turns.map(({ name }) => name).join(', ');
    if (drawn === text + isLocked) return;
    drawn = text + isLocked;
    knob.lock(isLocked);
    const follow = () => {
      highlight(place);
      show(one.parameters.map((parameter) => keyOf({ parameter })));
    };
    const unlock = () => {
      unlocked.add(key);
      knob.note('');
      update(one, patch);
      knob.knob.focus();
    };
    const formula = () => [button(text, follow, { class: 'knob-law', title: 'Show the parameters behind it' }),
      isLocked ? button('Unlock', unlock, { 'aria-label': `Unlock ${title}. Turning it then replaces the formula`, title: 'Turning then replaces the formula' })
        : el('p', {}, 'Turning replaces the formula.')];
    lines.replaceChildren(...(isFormula(one) ? formula() : [text && `turns ${text}`]));
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
    const list = el('select', { 'aria-label': title, onchange: () => change(list.value) }, view.words.map((word) => el('option', {}, word)));
    return { parts: [list, message], update: ({ value }) => { list.selectedIndex = value; } };
  }
  const word = el('span', {});
  let isOn = false;
  const toggle = button(word, () => change(!isOn), { class: 'toggle', role: 'switch', 'aria-label': `${title} ${view.name}` });
  return {
    parts: [toggle, message],
    update({ name, value }) {
      isOn = value === 1;
      toggle.setAttribute('aria-checked', isOn);
      word.textContent = isOn ? name : { closed: 'open' }[name] ?? `not ${name}`;
    },
  };
}

/** A card with the title of a control, the control, and a button that resets it. */
function cardOf(control) {
  const { key, place, title, about, view } = control;
  const set = (value) => send(place.parameter ? { command: 'parameter', name: title, value } : { command: 'setting', ...place, value });
  const reset = () => set(opened.get(key));
  const { parts, update } = (view.form ?? 'number') === 'number' ? dialOf(control, set, reset) : switchOf(control, set);
  const back = button('↺', reset, { class: 'knob-reset', 'aria-label': `Reset ${title}`, title: 'Reset to the value of the opened patch' });
  const node = el('div', { class: 'knob', role: 'group', 'aria-label': title },
    el('div', { class: 'knob-title' }, el('b', {}, title), back), el('p', { class: 'knob-about', title: about }, about), parts);
  return {
    node, place,
    update(one, patch) {
      update(one, patch);
      back.hidden = content(one) === opened.get(key);
    },
  };
}

/** A second control for the pot with this output, if there is such a pot. */
export function potCard(output, patch) {
  const element = patch.elements.find(({ outputs }) => outputs.includes(output));
  const settingOf = (one) => one?.settings.find(({ name }) => name === 'setting');
  if (!settingOf(element)) return null;
  const { node, update } = cardOf(ofSetting(element, settingOf(element), patch));
  const refresh = (present) => {
    const view = settingOf(present.elements.find(({ name }) => name === element.name));
    if (view) update(view, present);
  };
  refresh(patch);
  return { node, refresh };
}

/** Draws all groups. */
function build(root) {
  cards.clear();
  for (const control of controls) cards.set(control.key, cardOf(control));
  const groups = GROUPS.map((heading, group) => {
    const own = controls.filter((control) => control.group === group).map(({ key }) => cards.get(key).node);
    return own.length > 0 && el('details', { class: 'knob-group', open: group < 4 },
      el('summary', {}, heading, el('small', {}, own.length)), el('div', { class: 'knob-grid' }, own));
  });
  const filter = el('input', {
    type: 'search', class: 'knob-filter', placeholder: 'Filter', 'aria-label': 'Filter the controls',
    oninput() {
      const words = filter.value.toLowerCase().split(/\s+/);
      for (const { node } of cards.values()) node.hidden = !words.every((word) => node.textContent.toLowerCase().includes(word));
      for (const group of root.querySelectorAll('details')) {
        group.hidden = !group.querySelector('.knob:not([hidden])');
        group.open ||= filter.value !== '';
      }
    },
  });
  const empty = el('p', {}, 'This patch has nothing to turn. Add a pot or a parameter.');
  root.replaceChildren(...[controls.length > FILTERED && filter, ...groups, !controls.length && empty].filter(Boolean));
}

/** Shows the controls of the patch. @param {HTMLElement} root */
export function mountKnobs(root) {
  let drawn = '';
  root.classList.add('knobs');
  on('patch', (patch) => {
    // Cards are kept while their controls are the same: a dial that is being turned must stay.
    const form = JSON.stringify(controls.map(({ view: { range, words }, ...rest }) => [rest, range, words]));
    if (form !== drawn) build(root);
    drawn = form;
    for (const { key, view } of controls) cards.get(key).update(view, patch);
  });
  on('highlight', (to) => {
    for (const { node, place: { parameter, element, setting } } of cards.values()) {
      node.classList.remove('is-marked');
      node.classList.toggle('is-lit', parameter ? to?.parameter === parameter : to?.element === element && (to.setting ?? setting) === setting);
    }
  });
}
