/** The voltmeter and the null meter: moving-coil instruments, each with a reading in digits. */

import { dashes, dial, equal } from './dial.js';
import { button, el, format, quantity, svg } from './dom.js';
import { potCard } from './knobs.js';
import { on, selectProbe, send, state } from './state.js';

/** Natural frequency of a needle in radians per second, and its damping: it settles in 0.2 s and overshoots by 1.5 %. */
const FREQUENCY = 25;
const DAMPING = 0.8;
/** The angle from the middle to an end of a scale, in degrees. */
const SWEEP = 45;
/** Milliseconds between changes of the digits; faster ones cannot be read. */
const DIGITS = 120;
/** The ends of the null meter's scale, in volts. */
const SENSITIVITIES = { '10 V': 10, '1 V': 1, '0.1 V': 0.1, '10 mV': 0.01 };

/** Moves a needle to fractions of its scale, as a coil in a magnet would. */
function moving(needle) {
  let [at, speed, target, last, isMoving] = [0, 0, 0, 0, false];
  const step = (now) => {
    const seconds = Math.min((now - last) / 1000, 0.05) / 12;
    last = now;
    for (let index = 0; index < 12; index += 1) {
      speed += (FREQUENCY * (target - at) - 2 * DAMPING * speed) * FREQUENCY * seconds;
      at += speed * seconds;
    }
    isMoving = Math.abs(target - at) > 2e-4 || Math.abs(speed) > 1e-2;
    if (isMoving) requestAnimationFrame(step);
    else at = target;
    needle.style.transform = `rotate(${SWEEP * at}deg)`;
  };
  return (fraction) => {
    target = Math.min(1.06, Math.max(-1.06, fraction || 0));
    if (isMoving || target === at) return;
    isMoving = true;
    last = performance.now();
    requestAnimationFrame(step);
  };
}

/** The face of a meter. `mark` writes the numbers of its scale, `move` moves its needle. */
function face(symbol) {
  const arc = (name, radius, positions, width) => svg('path', {
    class: `meter-${name}`, pathLength: 1, 'stroke-dasharray': positions && dashes(positions, width),
    d: `M${-radius * Math.SQRT1_2} ${-radius * Math.SQRT1_2}A${radius} ${radius} 0 0 1 ${radius * Math.SQRT1_2} ${-radius * Math.SQRT1_2}`,
  });
  const numbers = equal(4).map((part) => svg('text', { y: -121, transform: `rotate(${SWEEP * (2 * part - 1)})` }));
  const needle = svg('path', { class: 'meter-needle', d: 'M-1.4 0L-.5-112H.5L1.4 0Z' });
  const picture = svg('svg', { class: 'meter-face', viewBox: '-110 -138 220 106', 'aria-hidden': 'true' },
    arc('mirror', 93), arc('line', 104), arc('fine', 106, equal(50), 0.004), arc('coarse', 108, equal(10), 0.006),
    numbers, svg('text', { class: 'meter-symbol', y: -62 }, symbol), needle, svg('circle', { class: 'meter-pivot', r: 42 }));
  const mark = (full) => numbers.forEach((text, index) => { text.textContent = format(full * (index / 2 - 1)).replace('-', '−'); });
  return { picture, mark, move: moving(needle) };
}

/** Volts with five digits, of which at most four are decimals. */
function fiveDigits(volts) {
  const before = Math.max(1, Math.floor(Math.log10(Math.abs(volts) || 1)) + 1);
  return `${volts < 0 ? '−' : '+'}${Math.abs(volts).toFixed(5 - before)} V`;
}

/**
 * A meter: its face, its digits, and the list of outputs with a button that takes the next output on which the user
 * clicks. `connect` gets the output, or null.
 */
function meterOf(title, symbol, full, connect) {
  const { picture, mark, move } = face(symbol);
  let [drawn, last] = ['', 0];
  const choose = (name) => {
    list.value = name;
    connect(list.value || null);
  };
  const list = el('select', { 'aria-label': `Output at the ${title.toLowerCase()}`, onchange: () => choose(list.value) });
  const probe = button('Probe', () => {
    selectProbe(choose);
    probe.setAttribute('aria-pressed', true);
  }, { 'aria-pressed': 'false', title: 'Then click on an output in any view' });
  on('probing', ({ active }) => active || probe.setAttribute('aria-pressed', false));
  const volts = el('b', {});
  const more = el('span', {});
  const digits = el('div', { class: 'meter-digits', role: 'meter', 'aria-label': title, 'aria-valuemin': -full, 'aria-valuemax': full }, volts, more);
  mark(full);
  return {
    picture, mark, digits,
    outputs: el('div', { class: 'meter-outputs' }, list, probe),
    /**
     * Shows the outputs of the patch, and connects another one if the present one is missing. A session that has opened
     * a patch has forgotten the connection.
     */
    update({ outputs, undo }, otherwise) {
      const form = JSON.stringify(outputs.map(({ name, signal }) => [name, signal]));
      if (form === drawn && undo !== null) return;
      drawn = form;
      const before = list.value;
      list.replaceChildren(el('option', { value: '' }, 'not connected'), ...outputs.map(({ name, signal }) =>
        el('option', { value: name }, signal && signal !== name ? `${name} ${signal}` : name)));
      choose(outputs.some(({ name }) => name === before) ? before : otherwise ?? '');
    },
    show(value, fraction, words) {
      move(fraction);
      const now = performance.now();
      if (now - last < DIGITS) return;
      last = now;
      const isKnown = Number.isFinite(value);
      volts.textContent = isKnown ? fiveDigits(value) : '– V';
      more.textContent = isKnown ? words() : '';
      digits.setAttribute('aria-valuenow', value || 0);
      digits.setAttribute('aria-valuetext', isKnown ? `${volts.textContent} ${more.textContent}` : 'not connected');
    },
  };
}

function voltmeter() {
  let view;
  const meter = meterOf('Voltmeter', 'V', 100, (output) => {
    view = state.patch.outputs.find(({ name }) => name === output);
    send({ command: 'meter', output });
  });
  on('patch', (patch) => {
    meter.update(patch, patch.signals[0]?.at);
    view = patch.outputs.find(({ name }) => name === view?.name);
  });
  on('frame', ({ meter: volts }) => meter.show(volts, volts / 100,
    () => (view?.signal ? `${view.signal} ${quantity(volts * view.per_volt, view.unit, 5)}` : '')));
  return [el('h3', {}, 'Voltmeter'), meter.picture, meter.digits, meter.outputs];
}

function nullMeter() {
  let [full, output, divider, pot] = [10, null, 0, null];
  const connect = () => send({ command: 'null-meter', output, divider });
  const place = el('div', { class: 'meter-pot' });
  const meter = meterOf('Null meter', 'V', full, (name) => {
    output = name;
    pot = potCard(name, state.patch);
    place.replaceChildren(pot?.node ?? 'If you choose a pot, its dial is here.');
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
  const potSet = button('Pot set', () => send({ command: 'mode', mode: 'pot-set' }));
  on('machine', ({ mode }) => potSet.setAttribute('aria-pressed', mode === 'pot-set'));
  on('patch', (patch) => {
    meter.update(patch);
    pot?.refresh(patch);
  });
  on('frame', ({ nullMeter: volts }) => meter.show(volts, volts / full, () => (Math.abs(volts) < 0.005 ? 'at zero' : '')));
  const range = ([text, volts]) => el('label', {}, el('input', {
    type: 'radio', name: 'sensitivity', checked: volts === full,
    onchange() {
      full = volts;
      meter.mark(full);
    },
  }), el('span', {}, `±${text}`));
  const step = (text, part) => el('li', {}, text, part);
  return [el('summary', {}, 'Null meter'), meter.picture, meter.digits,
    el('fieldset', { class: 'meter-range' }, el('legend', {}, 'Full scale'), Object.entries(SENSITIVITIES).map(range)),
    el('p', {}, 'It shows the output minus the divider times the reference. To set a pot under load:'),
    el('ol', {}, step('Choose the pot.', meter.outputs), step('Select the mode.', potSet),
      step('Turn the divider to the wanted setting.', reference.node), step('Turn the pot until the needle is at zero.', place))];
}

/** Shows the voltmeter and the null meter. @param {HTMLElement} root */
export function mountMeters(root) {
  root.classList.add('meters');
  root.replaceChildren(el('div', { class: 'meter' }, voltmeter()), el('details', { class: 'meter' }, nullMeter()));
}
