/** The voltmeter and the null meter: moving-coil instruments, each with a reading in digits. */

import { dial } from './dial.js';
import { byId, changeDetector, fill, fixed, format, minus, quantity, rateLimiter, template, within, write } from './dom.js';
import { potCard } from './knobs.js';
import { fillOutputs } from './probes.js';
import { on, outputOf, selectProbe, send, state } from './state.js';

/** The angle from the middle to an end of a scale, in degrees. */
const SWEEP = 45;
/** Milliseconds between changes of the digits; faster ones cannot be read. */
const DIGITS = 120;

/** Volts with five digits, of which at most four are decimals. */
function fiveDigits(volts) {
  const before = Math.max(1, Math.floor(Math.log10(Math.abs(volts) || 1)) + 1);
  return `${volts < 0 ? '' : '+'}${fixed(volts, 5 - before)} V`;
}

/**
 * A meter with a list of outputs, and a button that takes the next output on which the user clicks. `connect` gets the
 * output, or null, and the session remembers it.
 */
function meterOf(title, connect) {
  const { node, needle, digits, volts, more, outputs, list, probe } = template('meter');
  const [hasOtherOutputs, isDue] = [changeDetector(), rateLimiter(DIGITS)];
  let [full, connected] = [1, ''];
  digits.ariaLabel = title;
  list.ariaLabel = `Output at the ${title.toLowerCase()}`;
  list.onchange = () => connect(list.value || null);
  probe.onclick = () => selectProbe(connect);
  on('probing', (listener) => { probe.ariaPressed = listener === connect; });
  return {
    node, outputs,
    /** Sets the ends of the scale. */
    range(to) {
      full = to;
      node.querySelectorAll('[transform]').forEach((text, index) => write(text, minus(format(full * (index / 2 - 1)))));
      fill(digits, { 'aria-valuemin': -full, 'aria-valuemax': full });
    },
    /** Shows the outputs of the patch. Returns whether they have changed. */
    update(patch) {
      if (!hasOtherOutputs(patch.outputs.map(({ name, signal }) => [name, signal]))) return false;
      fillOutputs(list, patch, 'not connected');
      list.value = connected;
      return true;
    },
    /** Shows the output at which the meter is. */
    at(output) {
      list.value = connected = output ?? '';
    },
    show(value, words) {
      needle.style.transform = `rotate(${SWEEP * within(-1.06, value / full || 0, 1.06)}deg)`;
      if (!isDue()) return;
      const isKnown = Number.isFinite(value);
      write(volts, isKnown ? fiveDigits(value) : '– V');
      write(more, isKnown ? words(value) : '');
      fill(digits, { 'aria-valuenow': value || 0,
        'aria-valuetext': isKnown ? `${volts.textContent} ${more.textContent}` : 'not connected' });
    },
  };
}

const voltmeter = meterOf('Voltmeter', (output) => send('meter', { output }));
voltmeter.range(100);
on('patch', voltmeter.update);
on('machine', ({ meter }) => voltmeter.at(meter));
on('frame', ({ meter }) => voltmeter.show(meter, (volts) => {
  const { signal, per_volt: perVolt, unit } = outputOf(state.machine.meter) ?? {};
  return signal ? `${signal} ${quantity(volts * perVolt, unit, 5)}` : '';
}));
byId('voltmeter').append(voltmeter.node);

/** The output at the null meter, and the card of its pot. */
let [output, pot] = [null, null];
const connect = (change) => send('null-meter', { ...state.machine.null_meter, ...change });
const nullMeter = meterOf('Null meter', (name) => connect({ output: name }));
const reference = dial({
  label: 'Reference divider', unit: '1', range: [-1, 1], hasTurns: true, turned: (divider) => connect({ divider }),
});
reference.show(0);
nullMeter.range(10);
byId('null-meter').append(nullMeter.node);
byId('null-output').append(nullMeter.outputs);
byId('null-divider').append(reference.node);
byId('null-range').onchange = ({ target }) => nullMeter.range(Number(target.value));
byId('null-mode').onclick = () => send('mode', { mode: 'pot-set' });

/** Shows the pot at the null meter, if there is one. */
function placePot() {
  pot = output && potCard(output, state.patch);
  byId('null-pot').replaceChildren(pot?.node ?? '');
}

on('machine', ({ mode, null_meter: present }) => {
  byId('null-mode').ariaPressed = mode === 'pot-set';
  reference.show(present.divider);
  nullMeter.at(present.output);
  if (present.output === output) return;
  output = present.output;
  placePot();
});
on('patch', (patch) => {
  if (nullMeter.update(patch)) placePot();
  else pot?.refresh(patch);
});
on('frame', (frame) => nullMeter.show(frame.nullMeter, (volts) => (Math.abs(volts) < 0.005 ? 'at zero' : '')));
