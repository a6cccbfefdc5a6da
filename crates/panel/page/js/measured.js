/**
 * Measured data: the columns of a file and their roles, and a second session that compares them with the patch. The view
 * sends one request at a time. While one is on its way, later ones wait, each kind only once: a request is made when it is
 * sent, so that the latest values win.
 */

import { byId, changeDetector, parse, place, quantity, template, write } from './dom.js';
import { download } from './files.js';
import { connectComparison } from './link.js';
import { showCurves, view } from './measured-plot.js';
import { actions, list, showFound, showProgress } from './measured-search.js';
import { ask, on, refusalOf, send, sendAll, state } from './state.js';

/** The view. Its data attribute `busy` names the request that takes long. */
const root = byId('measured');

/** @type {import('./link.js').Link | null} */
let link = null;
/** The requests that wait. */
const waiting = new Set();
let [isBusy, isCancelled] = [false, false];
/** The file that is sent, with the experiment of an example; the file and the name of the patch that the controls are for. */
let [given, shown, patchName] = [];
/** The text of the last experiment that the session accepted. */
let accepted = '';
/** The controls of columns and parameters. */
let [columns, knobs] = [[], []];
/** Whether the session has accepted the experiment. Until then it is not asked for curves. */
let isCompared = false;
/** The values of all parameters. */
let values = {};
/** Detectors of changes on the panel, by the names of requests. */
const seen = {};

/** The experiment of an example, as long as its patch is on the panel. */
const shipped = () => (given.patch === state.patch.file && given.experiment) || {};

/** The experiment as the controls have it. What they do not have is that of the example. */
function experiment() {
  const interval = parse(view.interval.value);
  const made = {
    ...shipped(),
    time: interval ? { interval, unit: 's' } : undefined, outputs: {}, drives: {},
    fit: knobs.filter(({ fit }) => fit.checked).map(({ key }) => key),
  };
  for (const { key, role, unit, offset } of columns) {
    const [kind, name] = role.value.split(' ');
    const use = { ...shipped()[kind]?.[name], column: key, unit: unit.value || undefined, ...(kind === 'outputs' && { offset: offset.checked }) };
    if (name) made[kind][name] = use;
    else if (kind) made.time = use;
  }
  return made;
}

async function patch() {
  const { name, text } = await ask('text') ?? {};
  return { name, text };
}

/** The fields of requests that have some. */
const FIELDS = {
  begin: async () => ({ patch: await patch(), data: { name: given.name, text: given.text } }), patch, compare: () => ({ experiment: experiment() }), simulate: () => ({ parameters: values }),
};

/** Shows the values of parameters. */
function refresh() {
  for (const { key, unit, slider, reading } of knobs) {
    if (!slider.matches(':active')) slider.value = values[key];
    write(reading, quantity(values[key], unit));
  }
}

/** The controls of a column. `before` is the experiment that they show at first. */
function columnOf({ name: key, unit, least, most }, { signals, drives }, before) {
  const range = `${quantity(least, '', 3)} … ${quantity(most, unit ?? '', 3)}`;
  const column = { key, ...template('column', { name: key, range }) };
  const { node, role, unit: field, offset } = column;
  const add = (use, value, text) => {
    role.append(new Option(text, value));
    if (key !== (use?.column ?? use)) return;
    role.value = value;
    field.value = use.unit ?? '';
    offset.checked = use.offset;
  };
  const addAll = (kind, word, list) => list.forEach((each) => add(before[kind]?.[each.name], `${kind} ${each.name}`, `${word}${each.name} (${each.unit})`));
  node.ariaLabel = key;
  field.placeholder = unit ?? '';
  add(before.time, 'time', 'time');
  addAll('outputs', '', signals);
  addAll('drives', 'drive ', drives);
  return column;
}

function knobOf({ name: key, unit, low: min, high: max }, { fit }) {
  const knob = { key, unit, ...template('fit-parameter', { name: key }) };
  knob.fit.checked = fit?.includes(key);
  Object.assign(knob.slider, {
    min, max, ariaLabel: key, oninput: () => send('parameter', { name: key, value: Number(knob.slider.value) }),
  });
  return knob;
}

/** What each event changes. */
const TAKE = {
  columns(event) {
    const { file, rows } = event;
    const suggestion = { ...event.experiment, ...shipped() };
    // If only the patch has changed, what the user has selected stays.
    const before = shown === given && patchName === state.patch.file ? experiment() : suggestion;
    const known = knobs.map(({ key }) => key);
    [shown, patchName] = [given, state.patch.file];
    view.file.textContent = `${file}, ${rows} rows`;
    columns = place(view.columns, event.columns.map((each) => columnOf(each, event, before)));
    knobs = place(view.knobs, event.parameters.map((each) => knobOf(each, known.includes(each.name) ? before : suggestion)));
    view.interval.value = before.time?.interval ?? '';
    list(view.warnings, event.notes);
    refresh();
    waiting.add('compare');
  },
  comparison(event) {
    accepted = event.experiment;
    list(view.warnings, event.warnings);
    isCompared = true;
    // A knob may have been turned meanwhile.
    waiting.add('simulate');
  },
  curves: showCurves,
  fitted: ({ parameters }) => sendAll(Object.entries(parameters).map(([name, value]) => ({ command: 'parameter', name, value }))),
  progress: showProgress,
  found: showFound,
};

/** Takes an answer, or a part of one. */
function take(text) {
  const { events } = JSON.parse(text);
  for (const each of events) TAKE[each.event]?.(each);
  return refusalOf(events) ?? '';
}

/** Sends a request. Returns the answer. */
async function exchange(command) {
  const fields = await FIELDS[command]?.();
  return (await link.request(JSON.stringify({ id: 1, commands: [{ command, ...fields }] }))).text;
}

/** Connects. A new session learns silently what the last one knew. */
async function connect(name) {
  const own = link = await connectComparison();
  own.onpartial = take;
  own.lost.then(() => { if (link === own) link = null; });
  if (name === 'begin') return;
  await exchange('begin');
  await exchange('compare');
}

/** Fit and search take long. Meanwhile the columns cannot be changed, and the button of the search cancels. */
function setBusy(name) {
  root.dataset.busy = name;
  view.setup.disabled = name;
  view.ready.disabled = name || !isCompared;
  view.search.disabled = !name && !isCompared;
}

/** Sends what waits, unless the view is hidden. */
async function pump() {
  if (isBusy || !given || root.hidden) return;
  isBusy = true;
  for (const name of waiting) {
    waiting.delete(name);
    if (name === 'simulate' && !isCompared) continue;
    if (['fit', 'search'].includes(name)) setBusy(name);
    else if (name !== 'simulate') isCompared = false;
    isCancelled = false;
    try {
      if (!link) await connect(name);
      const refusal = take(await exchange(name));
      write(view.alert, refusal);
      if (refusal && name === 'begin') given = shown;
    } catch ({ message }) {
      if (!isCancelled) view.alert.textContent = message;
    }
    setBusy('');
  }
  isBusy = false;
}

function run(name) {
  waiting.add(name);
  pump();
}

/** Starts a fit or a search, or ends it. The next session begins with the same data. */
function start(name) {
  if (root.dataset.busy) {
    isCancelled = true;
    link?.close();
    link = null;
    return;
  }
  showFound(null);
  run(name);
}

/** Whether something on the panel differs from the last time, apart from values that parameters give. */
const differs = ([name, ...what]) => (seen[name] ??= changeDetector())(
  JSON.stringify(what, (key, each) => (['value', 'per_volt'].includes(key) ? null : each)));

/** Sends what follows from a change of the patch. The first request that is necessary includes the others. */
function follow({ file, signals, elements, time_scale: scale } = state.patch) {
  if (!given) return;
  const drives = elements.filter(({ family }) => family === 'drive').map(({ name }) => name);
  const [first] = [['begin', file, Object.keys(values), signals, drives], ['patch', scale, elements], ['simulate', Object.entries(values)]].filter(differs);
  if (first) run(first[0]);
  refresh();
}

const open = () => byId('file').click();
const buttons = {
  ...actions, open, other: open, fit: () => start('fit'), search: () => start('search'),
  save: () => download(`${given.name.replace(/\.\w+$/, '')}.experiment.json`, accepted, 'application/json'),
};
for (const [name, act] of Object.entries(buttons)) view[name].onclick = act;
view.setup.onchange = ({ target }) => {
  if (target.type === 'range') return;
  // Each role has one column.
  for (const { role } of columns) if (role !== target && role.value === target.value) role.value = '';
  run('compare');
};
on('data', (file) => {
  given = file;
  showFound(null);
  byId('tab-measured').click();
  root.closest('.views').scrollIntoView();
  waiting.add('begin');
  follow();
  pump();
});
on('patch', (patch) => {
  values = Object.fromEntries(patch.parameters.map(({ name, value }) => [name, value]));
  follow(patch);
});
on('parameter', ({ name, value }) => {
  values[name] = value;
  follow();
});
// It has been shown, perhaps with requests that wait.
new ResizeObserver(pump).observe(root);
