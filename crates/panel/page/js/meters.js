/** The voltmeter and the null meter: moving-coil instruments, each with a reading in digits. */

import { dial } from './dial.js';
import { byId, fill, format, minus, quantity, template, within, write } from './dom.js';
import { potCard } from './knobs.js';
import { fillOutputs } from './probes.js';
import { emit, on, selectProbe, send, state } from './state.js';

/** The angle from the middle to an end of a scale, in degrees. */
const SWEEP = 45;
/** Milliseconds between changes of the digits; faster ones cannot be read. */
const DIGITS = 120;

/** Volts with five digits, of which at most four are decimals. */
function fiveDigits(volts) {
  const before = Math.max(1, Math.floor(Math.log10(Math.abs(volts) || 1)) + 1);
  return minus(`${volts < 0 ? '' : '+'}${volts.toFixed(5 - before)} V`);
}

/**
 * A meter with a list of outputs, and a button that takes the next output on which the user clicks. `command` is the
 * name of its command, `connect` gets the output, or null.
 */
function meterOf(command, title, connect) {
  const { node, needle, digits, volts, more, outputs, list, probe } = template('meter');
  let [full, drawn, last] = [1, '', 0];
  const choose = (output) => emit('meter', { meter: command, output: output || null });
  digits.ariaLabel = title;
  list.ariaLabel = `Output at the ${title.toLowerCase()}`;
  list.onchange = () => choose(list.value);
  probe.onclick = () => {
    selectProbe(choose);
    probe.ariaPressed = true;
  };
  on('probing', (waits) => { if (!waits) probe.ariaPressed = false; });
  // The menu of the schematic connects a meter too.
  on('meter', ({ meter, output }) => {
    if (meter !== command) return;
    list.value = output ?? '';
    connect(output);
  });
  return {
    node, outputs,
    /** Sets the ends of the scale. */
    range(to) {
      full = to;
      node.querySelectorAll('[transform]').forEach((text, index) => write(text, minus(format(full * (index / 2 - 1)))));
      fill(digits, { 'aria-valuemin': -full, 'aria-valuemax': full });
    },
    /**
     * Shows the outputs of the patch, and connects another one if the present one is missing. A session that has opened
     * a patch has forgotten the connection.
     */
    update(patch, otherwise) {
      const { outputs: present, undo } = patch;
      const form = JSON.stringify(present.map(({ name, signal }) => [name, signal]));
      if (form === drawn && undo !== null) return;
      drawn = form;
      const before = list.value;
      fillOutputs(list, patch, 'not connected');
      choose(present.some(({ name }) => name === before) ? before : otherwise);
    },
    show(value, words) {
      needle.style.transform = `rotate(${SWEEP * within(-1.06, value / full || 0, 1.06)}deg)`;
      const now = performance.now();
      if (now - last < DIGITS) return;
      last = now;
      const isKnown = Number.isFinite(value);
      write(volts, isKnown ? fiveDigits(value) : '– V');
      write(more, isKnown ? words(value) : '');
      fill(digits, { 'aria-valuenow': value || 0,
        'aria-valuetext': isKnown ? `${volts.textContent} ${more.textContent}` : 'not connected' });
    },
  };
}

function mountVoltmeter() {
  let view;
  const meter = meterOf('meter', 'Voltmeter', (output) => {
    view = state.patch.outputs.find(({ name }) => name === output);
    send({ command: 'meter', output });
  });
  meter.range(100);
  on('patch', (patch) => {
    meter.update(patch, patch.signals[0]?.at);
    view = patch.outputs.find(({ name }) => name === view?.name);
  });
  on('frame', (frame) => meter.show(frame.meter, (volts) =>
    (view?.signal ? `${view.signal} ${quantity(volts * view.per_volt, view.unit, 5)}` : '')));
  byId('voltmeter').append(meter.node);
}

function mountNullMeter() {
  let [output, divider, pot] = [null, 0, null];
  const connect = () => send({ command: 'null-meter', output, divider });
  const meter = meterOf('null-meter', 'Null meter', (name) => {
    output = name;
    pot = potCard(name, state.patch);
    byId('null-pot').replaceChildren(pot?.node ?? 'If you choose a pot, its dial is here.');
    connect();
  });
  const reference = dial({
    label: 'Reference divider', unit: '1', range: [-1, 1], perTurn: 0.1, digits: 4,
    turned(value) {
      divider = value;
      reference.show(value);
      return connect();
    },
  });
  reference.show(0);
  meter.range(10);
  byId('null-meter').append(meter.node);
  byId('null-output').append(meter.outputs);
  byId('null-divider').append(reference.node);
  byId('null-range').onchange = ({ target }) => meter.range(Number(target.value));
  byId('null-mode').onclick = () => send({ command: 'mode', mode: 'pot-set' });
  on('machine', ({ mode }) => { byId('null-mode').ariaPressed = mode === 'pot-set'; });
  on('patch', (patch) => {
    meter.update(patch);
    pot?.refresh(patch);
  });
  on('frame', (frame) => meter.show(frame.nullMeter, (volts) => (Math.abs(volts) < 0.005 ? 'at zero' : '')));
}

/** Shows the voltmeter and the null meter. */
export function mountMeters() {
  mountVoltmeter();
  mountNullMeter();
}
