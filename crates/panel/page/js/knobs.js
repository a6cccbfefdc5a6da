/** The controls of the patch: parameters, pots, switches, initial conditions and other settings. */

import { dial } from './dial.js';
import { byId, changeDetector, filter, hasFocus, named, template, write } from './dom.js';
import { highlight, on, outputOf, refusalOf, send, state } from './state.js';

/** With more controls than this there is a field that filters them. */
const FILTERED = 12;
/** The groups of controls in the order of index.html. */
const [PARAMETERS, POTS, SWITCHES, OTHERS, BY_PARAMETERS] = [0, 1, 2, 3, 4];

/** The values of the patch as it was opened, by the keys of the controls. */
const opened = new Map();
/** The keys of settings whose formula may be replaced. */
const unlocked = new Set();
/** The cards of the controls, by their keys. */
const cards = new Map();
let openedFile = '';
let controls = [];

const keyOf = ({ parameter, element, setting }) => JSON.stringify([parameter, element, setting]);
const isPlain = (text) => text === null || !Number.isNaN(Number(text));
const isFormula = ({ form, text }) => form === 'number' && !isPlain(text);

/** The value as a command has it. */
function content(view) {
  const { form, text, value, words } = view;
  if (form === 'flag') return value === 1;
  if (form === 'choice') return words[value];
  return isFormula(view) ? text : value ?? Number(text);
}

function isShown({ kind }, { form, name, text }) {
  return form !== 'points' && (text !== null || name === 'setting' || name === 'initial' || (kind === 'key-switch' && form === 'flag'));
}

/** The control of a setting. */
function ofSetting(element, view) {
  const place = { element: element.name, setting: view.name };
  const isPot = view.name === 'setting';
  return {
    key: keyOf(place), place, view,
    title: isPot || view.form === 'flag' ? element.name : `${element.name} ${view.name}`,
    about: element.note || (isPot ? '' : view.description),
    unit: { 'unit of the scale': outputOf(element.outputs[0])?.unit, 'whole number': '' }[view.unit] ?? view.unit,
  };
}

/** Finds all controls, and the values that they had when the patch was opened: those of a patch without a history. */
function take(patch) {
  const parameters = patch.parameters.map((view) => {
    const place = { parameter: view.name };
    return { key: keyOf(place), place, view, title: view.name, about: view.description, unit: view.unit };
  });
  controls = [...parameters, ...patch.elements.flatMap((element) => element.settings.filter((view) => isShown(element, view))
    .map((view) => ofSetting(element, view)))];
  const file = `${patch.file}\n${patch.title}`;
  if (patch.undo === null || file !== openedFile) opened.clear();
  if (file !== openedFile) unlocked.clear();
  openedFile = file;
  for (const control of controls) {
    const { key, place, view } = control;
    if (!opened.has(key)) opened.set(key, content(view));
    // A control stays in its group when its formula is replaced: it must not move while it is being turned.
    const other = typeof opened.get(key) === 'string' ? BY_PARAMETERS : place.setting === 'setting' ? POTS : OTHERS;
    control.group = place.parameter ? PARAMETERS : view.form === 'number' ? other : SWITCHES;
  }
}
// Before any other listener, because a pot at the null meter also has a value to which it is reset.
on('patch', take);

/** Marks these cards, and moves the page to the first one unless the user is there. */
function show(found, mark) {
  for (const { node } of cards.values()) node.classList.remove('is-marked', 'is-lit');
  for (const { node } of found) node.classList.add(mark);
  const first = found[0]?.node;
  if (!first || hasFocus(first)) return;
  first.closest('details').open = true;
  first.scrollIntoView({ block: 'nearest' });
}

/** Puts a dial on a card, with the formula behind it or the elements that it turns. Returns how it is updated. */
function dialOn({ control, lines, law, unlock, turns }, { key, place, title, about, unit, view }, set, reset) {
  let present = view;
  const knob = dial({
    label: about ? `${title}, ${about}` : title, unit, range: view.range, turned: set, reset,
    isWhole: view.unit === 'whole number', hasTurns: place.setting === 'setting',
    blocked: () => `A formula sets it. ${present.parameters.length ? `Turn ${present.parameters.join(' or ')}, or unlock` : 'Unlock'} it.`,
  });
  control.replaceWith(knob.node);
  law.onclick = () => {
    highlight(place);
    show(present.parameters.map((parameter) => cards.get(keyOf({ parameter }))).filter(Boolean), 'is-marked');
  };
  const update = (one, patch) => {
    present = one;
    knob.show(one.value ?? (one.text === null ? 0 : NaN));
    const is = isFormula(one);
    if (!is) unlocked.delete(key);
    const isLocked = is && !unlocked.has(key);
    const turned = patch.elements.filter(({ settings }) => settings.some(({ parameters }) => parameters.includes(place.parameter)));
    write(law, one.text ?? '');
    write(turns, turned.length ? `turns ${turned.map(({ name }) => name).join(', ')}` : '');
    lines.dataset.formula = is ? isLocked ? 'locked' : 'unlocked' : 'none';
    knob.lock(isLocked);
  };
  unlock.ariaLabel = `Unlock ${title}`;
  unlock.onclick = () => {
    unlocked.add(key);
    knob.note('');
    update(present, state.patch);
    knob.knob.focus();
  };
  return update;
}

/** Puts a toggle switch or a list of words on a card. Returns how it is updated. */
function switchOn({ control }, { title, view }, set) {
  const { node, list, toggle, word, message } = template('switch');
  control.replaceWith(node);
  const change = async (value) => { message.textContent = refusalOf(await set(value)) ?? ''; };
  list.ariaLabel = title;
  list.append(...(view.words ?? []).map((each) => new Option(each)));
  list.onchange = () => change(list.value);
  toggle.ariaLabel = `${title} ${view.name}`;
  toggle.onclick = () => change(toggle.ariaChecked !== 'true');
  (view.form === 'choice' ? toggle : list).remove();
  return ({ name, value }) => {
    list.selectedIndex = value;
    toggle.ariaChecked = value === 1;
    word.textContent = value === 1 ? name : { closed: 'open' }[name] ?? `not ${name}`;
  };
}

/** A card with the title of a control, the control, and a button that resets it. */
function cardOf(control) {
  const { key, place, title, about, view } = control;
  const set = (value) => (place.parameter ? send('parameter', { name: title, value }) : send('setting', { ...place, value }));
  const reset = () => set(opened.get(key));
  const parts = template('knob', { title, about });
  const { node, back } = parts;
  node.ariaLabel = title;
  parts.about.title = about;
  back.ariaLabel = `Reset ${title}`;
  back.onclick = reset;
  const update = (view.form ?? 'number') === 'number' ? dialOn(parts, control, set, reset) : switchOn(parts, control, set);
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
  const setting = named(element?.settings, 'setting');
  if (!setting) return null;
  const { node, update } = cardOf(ofSetting(element, setting));
  const refresh = (present) => {
    const view = named(named(present.elements, element.name)?.settings, 'setting');
    if (view) update(view, present);
  };
  refresh(patch);
  return { node, refresh };
}

const [search, root] = [byId('knob-filter'), byId('knob-groups')];
const hasOtherControls = changeDetector();

/** Makes the cards of all controls. */
function build() {
  cards.clear();
  for (const control of controls) cards.set(control.key, cardOf(control));
  [...root.children].forEach((group, at) => {
    const own = controls.filter((control) => control.group === at).map(({ key }) => cards.get(key).node);
    group.querySelector('small').textContent = own.length;
    group.lastChild.replaceChildren(...own);
    group.open = at !== BY_PARAMETERS;
  });
  search.value = '';
  search.hidden = controls.length <= FILTERED;
  search.oninput();
}

search.oninput = () => {
  filter(root.querySelectorAll('.knob'), search.value);
  for (const group of root.children) group.open ||= search.value;
};
on('patch', (patch) => {
  // Cards are kept while their controls are the same: a dial that is being turned must stay.
  if (hasOtherControls(controls.map(({ view: { range, words }, ...rest }) => [rest, range, words]))) build();
  for (const { key, view } of controls) cards.get(key).update(view, patch);
});
on('highlight', (to) => show([...cards.values()].filter(({ place: { parameter, element, setting } }) =>
  (parameter ? to.parameter === parameter : to.element === element && (to.setting ?? setting) === setting)), 'is-lit'));
