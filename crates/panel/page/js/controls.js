/** The controls of the machine: modes, time, speed, run, history. */

import { byId, choice, format, parse, quantity, root, within, write } from './dom.js';
import { bind } from './keys.js';
import { on, send, state } from './state.js';

/** Below this share of the wanted speed the page reports that the machine is slow. */
const SLOW = 0.95;

// Modes.

const text = byId('mode-text');
const pressMode = choice('modes', (mode) => send('mode', { mode }));
on('machine', ({ mode, stopped }) => {
  pressMode(mode);
  text.dataset.stopped = Boolean(stopped);
  write(text, stopped ?? document.querySelector(`.mode[value=${mode}]`).dataset.about);
  // A first look at the panel: the button that makes a trace stands out until the machine has run.
  if (['operate', 'repetitive', 'single'].includes(mode)) delete root.dataset.first;
});

// Speed and pause.

const buttons = [...byId('speed').children];
const pressSpeed = choice('speed', (value) => send('speed', { factor: Number(value) || null }));
/** The button of the speed that was chosen last: keys can be faster than the answers. */
let at = 1;

function step(by) {
  at = within(0, at + by, buttons.length - 1);
  buttons[at].click();
}

bind(',', 'Slower', () => step(-1));
bind('.', 'Faster', () => step(1));
on('machine', ({ speed, rate }) => {
  // The button of the highest speed has no value.
  const present = String(speed ?? '');
  pressSpeed(rate === null && present);
  at = buttons.findIndex(({ value }) => value === present);
  if (at < 0) at = 1;
});

const pause = byId('pause');
pause.onclick = () => send('pause', { paused: !state.machine?.paused });
on('machine', ({ paused }) => { pause.dataset.paused = paused; });

// The readout, and the slider over the run.

/** Seconds with as many decimals as the length of the run needs, so that the digits stay in their places. */
const clock = (time) => time.toFixed(within(1, 3 - Math.floor(Math.log10(state.machine?.sweep || 1)), 6));

/** Why the time stands or runs slowly, in few words. */
function pace(frame, factor) {
  if (frame.stopped) return 'stopped';
  if (frame.paused) return 'paused';
  if (!frame.moves) return 'at rest';
  if (factor < SLOW) return `${quantity(1 / factor, '', 2)} times too slow for this computer`;
  return state.machine?.speed === null && state.machine?.rate === null ? 'as fast as possible' : 'running';
}

const [scrub, value] = [byId('scrub'), byId('scrub-time')];
/** The answer to the last command while the slider is moved. One command is on its way, and a new one replaces one that waits. */
let [factor, moved] = [1, null];
scrub.oninput = () => {
  value.textContent = quantity(Number(scrub.value), 's');
  moved = send('scrub', { time: Number(scrub.value) });
};
// When it is let go, the slider follows the machine again. There is no `change` if it is back at its place.
scrub.onchange = scrub.onpointerup = scrub.onpointercancel = scrub.onblur = async () => {
  const last = moved;
  await last;
  if (moved === last) moved = null;
};
on('frame', (frame) => {
  const { time } = frame;
  if (frame.moves) factor += 0.1 * (Math.min(frame.factor, 1) - factor);
  write(byId('time'), clock(time));
  write(byId('pace'), pace(frame, factor));
  // The lamp of the whole machine names the amplifier whose lamp lit first.
  const first = state.patch.outputs[frame.firstLamp];
  write(byId('overload'), first ? `Overload: ${first.name}` : '');
  if (moved) return;
  scrub.min = state.machine.oldest ?? time;
  scrub.max = state.machine.latest ?? time;
  scrub.disabled = scrub.min === scrub.max;
  scrub.value = time;
  write(value, quantity(time, 's'));
});

// The fields, and the history.

/** The field for an argument of a command. An empty field goes back to what the patch or the machine gives by default. */
function numberField(command, argument, otherwise = null) {
  const input = byId(command);
  // A text that is no number stays, so that it can be corrected.
  input.onchange = () => {
    const value = parse(input.value);
    input.ariaInvalid = input.value.trim() !== '' && value === null;
    if (input.ariaInvalid === 'false') send(command, { [argument]: value ?? otherwise });
  };
  input.onkeydown = ({ key }) => { if (key === 'Enter' || key === 'Escape') input.blur(); };
  return (value) => { if (document.activeElement !== input && input.ariaInvalid !== 'true') input.value = format(value, 6); };
}

const sweep = numberField('sweep', 'seconds');
const rate = numberField('rate', 'hertz');
const scale = numberField('time-scale', 'value', 1);
on('machine', (machine) => {
  sweep(machine.sweep);
  rate(machine.rate);
});
on('patch', (patch) => scale(patch.time_scale));

for (const id of ['undo', 'redo']) {
  const button = byId(id);
  button.onclick = () => { if (button.ariaDisabled !== 'true') send(id); };
  on('patch', ({ [id]: step }) => {
    // The button keeps the focus when there is nothing left, so it is not `disabled`.
    button.ariaDisabled = step === null;
    button.ariaLabel = step === null ? `Nothing to ${id}` : `${button.dataset.action}: ${step}`;
    button.title = `${button.ariaLabel} (${button.dataset.keys})`;
  });
}
