/** The controls of the machine: modes, time, speed, run, history. */

import { button, el, format, label, parse, quantity } from './dom.js';
import { bind } from './keys.js';
import { on, send, state } from './state.js';

/** Modes in the order of the buttons: name, text, key, and what the machine does. */
const MODES = [
  ['operate', 'Operate', 'o', 'The integrators integrate.'],
  ['hold', 'Hold', 'h', 'The integrators keep their outputs. Move the slider to see an earlier time.'],
  ['initial-condition', 'Initial condition', 'i', 'The integrators are at their initial conditions. Operate starts them.'],
  ['repetitive', 'Repetitive', 'r', 'The run is repeated. Turn a knob and watch the trace.'],
  ['single', 'Single sweep', 's', 'The run is made once. Then the machine holds.'],
  ['pot-set', 'Pot set', 'p', 'The references are disconnected, except at the pot that is being set.'],
  ['problem-check', 'Problem check', 'c', 'Every output at the start is compared with the equations.'],
];

/** Speeds: factor, text, name for screen readers. */
const SPEEDS = [[0.5, '½×', 'Half speed'], [1, '1×', 'Real time'], [2, '2×', 'Double speed'], [null, 'Max', 'Maximum speed']];

/** Below this share of the wanted speed the page reports that the machine is slow. */
const SLOW = 0.95;

const byId = (id) => document.getElementById(id);

/** Writes only what has changed, because this runs for every frame. */
function put(element, property, value) {
  if (element[property] !== value) element[property] = value;
}

function mountModes() {
  const buttons = MODES.map(([mode, text, key]) => {
    const select = () => send({ command: 'mode', mode });
    bind(key, text, select);
    return el('button', { type: 'button', class: `mode mode-${mode}`, 'aria-pressed': 'false', 'aria-keyshortcuts': key, onclick: select },
      el('span', { class: 'mode-lamp' }), el('span', { class: 'mode-name' }, text),
      el('kbd', { 'aria-hidden': 'true' }, key.toUpperCase()));
  });
  byId('modes').append(...buttons);
  const show = (mode) => {
    buttons.forEach((each, index) => {
      const isOn = String(MODES[index][0] === mode);
      if (each.getAttribute('aria-pressed') !== isOn) each.setAttribute('aria-pressed', isOn);
    });
    byId('mode-text').dataset.stopped = String(Boolean(state.machine?.stopped));
    put(byId('mode-text'), 'textContent', state.machine?.stopped ?? MODES.find(([name]) => name === mode)?.[3] ?? '');
    // A first look at the panel: the button that makes a trace stands out until the machine has run.
    if (['operate', 'repetitive', 'single'].includes(mode)) delete document.documentElement.dataset.first;
  };
  on('machine', (machine) => show(machine.mode));
  on('frame', (frame) => show(frame.mode));
}

function mountSpeed() {
  const choose = (factor) => send({ command: 'speed', factor });
  const buttons = SPEEDS.map(([factor, text, name]) =>
    button(text, () => choose(factor), { 'aria-pressed': 'false', 'aria-label': name, title: name }));
  byId('speed').append(...buttons);
  const step = (by) => {
    const at = SPEEDS.findIndex(([factor]) => factor === state.machine?.speed);
    choose(SPEEDS[Math.min(Math.max((at < 0 ? 1 : at) + by, 0), SPEEDS.length - 1)][0]);
  };
  bind(',', 'Slower', () => step(-1));
  bind('.', 'Faster', () => step(1));
  on('machine', ({ speed, rate }) => {
    buttons.forEach((each, index) => each.setAttribute('aria-pressed', String(rate === null && SPEEDS[index][0] === speed)));
  });
}

function mountPause() {
  const pause = byId('pause');
  const toggle = () => send({ command: 'pause', paused: !state.machine?.paused });
  pause.addEventListener('click', toggle);
  bind('Space', 'Pause or continue', toggle);
  on('machine', ({ paused }) => {
    pause.setAttribute('aria-pressed', String(paused));
    pause.querySelector('use').setAttribute('href', paused ? '#icon-play' : '#icon-pause');
    pause.querySelector('span').textContent = paused ? 'Continue' : 'Pause';
  });
}

/** Seconds with as many decimals as the length of the run needs, so that the digits stay in their places. */
function clock(time) {
  const length = state.machine?.sweep || 1;
  const decimals = Math.min(Math.max(3 - Math.floor(Math.log10(length)), 1), 6);
  return time.toFixed(decimals);
}

/** Why the time stands or runs slowly, in few words. */
function pace(frame) {
  if (frame.stopped) return 'stopped';
  if (frame.paused) return 'paused';
  if (!frame.moves) return 'at rest';
  if (frame.factor < SLOW) return `${quantity(1 / frame.factor, '', 2)} times too slow for this computer`;
  return state.machine?.speed === null && state.machine?.rate === null ? 'as fast as possible' : 'running';
}

/** The time, the slider over the run, and the sentence about speed. */
function mountTime() {
  const scrub = byId('scrub');
  let factor = 1;
  let isMoved = false;
  scrub.addEventListener('input', () => {
    isMoved = true;
    byId('scrub-time').textContent = quantity(Number(scrub.value), 's');
  });
  // The machine forgets the run after the time to which it moves back, so that it moves when the slider is let go.
  scrub.addEventListener('change', async () => {
    await send({ command: 'scrub', time: Number(scrub.value) });
    isMoved = false;
  });
  // There is no `change` if the slider is back at its place.
  for (const end of ['pointerup', 'pointercancel', 'blur']) scrub.addEventListener(end, () => setTimeout(() => { isMoved = false; }, 100));
  on('machine', ({ oldest }) => put(scrub, 'min', String(oldest)));
  on('frame', (frame) => {
    if (frame.moves) factor += 0.1 * (Math.min(frame.factor, 1) - factor);
    put(byId('time'), 'textContent', clock(frame.time));
    put(byId('pace'), 'textContent', pace({ ...frame, factor }));
    if (isMoved) return;
    put(scrub, 'max', String(Math.max(frame.time, Number(scrub.min))));
    put(scrub, 'disabled', frame.time <= Number(scrub.min));
    put(scrub, 'value', String(frame.time));
    put(byId('scrub-time'), 'textContent', quantity(frame.time, 's'));
  });
}

/** The lamp of the whole machine: it names the amplifier whose lamp lit first. */
function mountOverload() {
  const lamp = byId('overload');
  const text = byId('overload-text');
  const show = (name) => {
    lamp.dataset.lit = String(name !== null);
    put(text, 'textContent', name === null ? 'No overload' : `Overload: ${name}`);
  };
  on('frame', ({ firstLamp }) => show(state.patch?.outputs[firstLamp ?? -1]?.name ?? null));
  on('machine', ({ overloads }) => show(overloads[0]?.element ?? null));
}

/**
 * A number that the patch or the machine gives by default: an empty field goes back to it.
 * @param {(value: number | null) => any} commit
 */
function numberField(text, placeholder, commit) {
  const input = el('input', { type: 'text', inputmode: 'decimal', autocomplete: 'off', placeholder });
  const show = (value) => { if (document.activeElement !== input) input.value = value === null ? '' : format(value, 6); };
  input.addEventListener('change', async () => {
    await commit(parse(input.value));
    input.setAttribute('aria-invalid', String(input.value.trim() !== '' && parse(input.value) === null));
  });
  input.addEventListener('keydown', ({ key }) => { if (key === 'Enter' || key === 'Escape') input.blur(); });
  byId('timing').append(label(text, input));
  return show;
}

function mountTiming() {
  const sweep = numberField('Sweep, s', 'auto', (seconds) => send({ command: 'sweep', seconds }));
  const rate = numberField('Rate, 1/s', 'auto', (hertz) => send({ command: 'rate', hertz }));
  const scale = numberField('Time scale', '1', (value) => send({ command: 'time-scale', value: value ?? 1 }));
  on('machine', (machine) => {
    sweep(machine.sweep);
    rate(machine.rate);
  });
  on('patch', (patch) => scale(patch.time_scale));
}

function mountHistory() {
  for (const [id, word, keys] of [['undo', 'Undo', ['Ctrl+Z']], ['redo', 'Redo', ['Ctrl+Y', 'Ctrl+Shift+Z']]]) {
    const step = byId(id);
    const run = () => { if (step.getAttribute('aria-disabled') !== 'true') send({ command: id }); };
    step.addEventListener('click', run);
    for (const key of keys) bind(key, word, run);
    on('patch', (patch) => {
      const text = patch[id] === null ? `Nothing to ${id}` : `${word}: ${patch[id]}`;
      // The button keeps the focus when there is nothing left, so it is not `disabled`.
      step.setAttribute('aria-disabled', String(patch[id] === null));
      step.setAttribute('aria-label', text);
      step.title = `${text} (${keys[0]})`;
    });
  }
}

/** Connects all controls of the machine. */
export function mountControls() {
  mountModes();
  mountPause();
  mountSpeed();
  mountTime();
  mountOverload();
  mountTiming();
  mountHistory();
}
