/** The controls of the machine: modes, time, speed, run, history. */

import { byId, choice, format, parse, quantity, root, within, write } from './dom.js';
import { bind } from './keys.js';
import { on, send, state } from './state.js';

/** Below this share of the wanted speed the page reports that the machine is slow. */
const SLOW = 0.95;

function mountModes() {
  const text = byId('mode-text');
  const press = choice('modes', (mode) => send('mode', { mode }));
  on('machine', ({ mode, stopped }) => {
    press(mode);
    text.dataset.stopped = Boolean(stopped);
    write(text, stopped ?? document.querySelector(`.mode[value=${mode}]`).dataset.about);
    // A first look at the panel: the button that makes a trace stands out until the machine has run.
    if (['operate', 'repetitive', 'single'].includes(mode)) delete root.dataset.first;
  });
}

function mountSpeed() {
  const press = choice('speed', (value) => send('speed', { factor: Number(value) || null }));
  /** The value of the button for a speed. The fastest one has none. */
  const valueOf = (speed) => String(speed ?? '');
  const step = (by) => {
    const buttons = [...byId('speed').children];
    const at = buttons.findIndex(({ value }) => value === valueOf(state.machine?.speed));
    buttons[within(0, (at < 0 ? 1 : at) + by, buttons.length - 1)].click();
  };
  bind(',', 'Slower', () => step(-1));
  bind('.', 'Faster', () => step(1));
  on('machine', ({ speed, rate }) => press(rate === null && valueOf(speed)));
}

function mountPause() {
  const pause = byId('pause');
  pause.onclick = () => send('pause', { paused: !state.machine?.paused });
  on('machine', ({ paused }) => { pause.dataset.paused = paused; });
}

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

/** The readout, and the slider over the run. */
function mountReadout() {
  const [scrub, value] = [byId('scrub'), byId('scrub-time')];
  let [factor, isMoved] = [1, false];
  scrub.oninput = () => {
    isMoved = true;
    value.textContent = quantity(Number(scrub.value), 's');
  };
  // The machine forgets the run after the time to which it moves back, so that it moves when the slider is let go.
  scrub.onchange = async () => {
    await send('scrub', { time: Number(scrub.value) });
    isMoved = false;
  };
  // There is no `change` if the slider is back at its place.
  scrub.onpointerup = scrub.onpointercancel = scrub.onblur = () => setTimeout(() => { isMoved = false; }, 100);
  on('machine', ({ oldest }) => { scrub.min = oldest; });
  on('frame', (frame) => {
    const { time } = frame;
    if (frame.moves) factor += 0.1 * (Math.min(frame.factor, 1) - factor);
    write(byId('time'), clock(time));
    write(byId('pace'), pace(frame, factor));
    // The lamp of the whole machine names the amplifier whose lamp lit first.
    const first = state.patch.outputs[frame.firstLamp];
    write(byId('overload'), first ? `Overload: ${first.name}` : '');
    if (isMoved) return;
    scrub.max = Math.max(time, Number(scrub.min));
    scrub.disabled = time <= Number(scrub.min);
    scrub.value = time;
    write(value, quantity(time, 's'));
  });
}

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

function mountTiming() {
  const sweep = numberField('sweep', 'seconds');
  const rate = numberField('rate', 'hertz');
  const scale = numberField('time-scale', 'value', 1);
  on('machine', (machine) => {
    sweep(machine.sweep);
    rate(machine.rate);
  });
  on('patch', (patch) => scale(patch.time_scale));
}

function mountHistory() {
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
}

mountModes();
mountPause();
mountSpeed();
mountReadout();
mountTiming();
mountHistory();
