/** The voltmeter and the null meter: moving-coil instruments, with a reading in digits. */

import { dashes, dial } from './dial.js';
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
const SENSITIVITIES = [[10, '10 V'], [1, '1 V'], [0.1, '0.1 V'], [0.01, '10 mV']];

/** Moves a needle to fractions of its scale from -1 to 1, as a coil in a magnet would. */
function moving(needle) {
  let [at, speed, target, last, isMoving] = [0, 0, 0, 0, false];
  const step = (now) => {
    const steps = 12;
    const seconds = Math.min((now - last) / 1000, 0.05) / steps;
    last = now;
    for (let index = 0; index < steps; index += 1) {
      speed += (FREQUENCY * (target - at) - 2 * DAMPING * speed) * FREQUENCY * seconds;
      at += speed * seconds;
    }
    isMoving = Math.abs(target - at) > 2e-4 || Math.abs(speed) > 1e-2;
    if (!isMoving) at = target;
    needle.style.transform = `rotate(${(SWEEP * at).toFixed(2)}deg)`;
    if (isMoving) requestAnimationFrame(step);
  };
  return (fraction) => {
    target = Math.min(1.06, Math.max(-1.06, fraction || 0));
    if (isMoving || target === at) return;
    isMoving = true;
    last = performance.now();
    requestAnimationFrame(step);
  };
}

/** The face of a meter. `mark` writes the numbers of its scale, `show` moves its needle. */
function face(name) {
  const arc = (part, radius, attributes) => {
    const end = radius * Math.SQRT1_2;
    return svg('path', { class: `meter-${part}`, d: `M${-end} ${-end}A${radius} ${radius} 0 0 1 ${end} ${-end}`, pathLength: 1, ...attributes });
  };
  const equal = (parts) => Array.from({ length: parts + 1 }, (_, index) => index / parts);
  const numbers = equal(4).map((part) => svg('text', { y: -121, transform: `rotate(${SWEEP * (2 * part - 1)})` }));
  const needle = svg('path', { class: 'meter-needle', d: 'M-1.4 14L-.5-112H.5L1.4 14Z' });
  const picture = svg('svg', { class: 'meter-face', viewBox: '-110 -140 220 124', 'aria-hidden': 'true' },
    arc('mirror', 93), arc('line', 104),
    arc('fine', 106, { 'stroke-dasharray': dashes(equal(50), 0.004) }), arc('coarse', 108, { 'stroke-dasharray': dashes(equal(10), 0.006) }),
    numbers, svg('text', { class: 'meter-name', y: -66 }, name), needle, svg('circle', { class: 'meter-pivot', r: 26 }));
  return {
    picture,
    mark: (full) => numbers.forEach((text, index) => { text.textContent = format(full * (index / 2 - 1)).replace('-', '−'); }),
    show: moving(needle),
  };
}

/** Volts with five digits, of which at most four are decimals. */
function fiveDigits(volts) {
  if (!Number.isFinite(volts)) return '–';
  const before = Math.max(1, Math.floor(Math.log10(Math.abs(volts) || 1)) + 1);
  return `${volts < 0 ? '−' : '+'}${Math.abs(volts).toFixed(5 - before)}`;
}

/** A list of outputs, and a button that takes the next output on which the user clicks. */
function picker(label, choose) {
  let drawn = '';
  const list = el('select', { 'aria-label': label, onchange: () => choose(list.value) });
  const probe = button('Probe', () => selectProbe((output) => {
    list.value = output;
    choose(list.value);
  }), { class: 'meter-probe', 'aria-pressed': 'false', title: 'Then click on an output in any view' });
  on('probing', ({ active }) => { if (!active) probe.setAttribute('aria-pressed', 'false'); });
  probe.addEventListener('click', () => probe.setAttribute('aria-pressed', 'true'));
  return {
    node: el('div', { class: 'meter-picker' }, list, probe),
    /** Shows the outputs of the patch; a choice that it does not have becomes the given one. */
    update({ outputs }, otherwise) {
      const form = JSON.stringify(outputs.map(({ name, signal }) => [name, signal]));
      const before = list.value;
      if (form !== drawn) {
        list.replaceChildren(el('option', { value: '' }, 'not connected'),
          ...outputs.map(({ name, signal }) => el('option', { value: name }, signal && signal !== name ? `${name}  ${signal}` : name)));
        list.value = before;
      }
      drawn = form;
      if (!list.value) list.value = before || !otherwise ? '' : otherwise;
      if (list.value !== before) choose(list.value);
    },
  };
}

/** A reading in digits that a screen reader finds as a meter. */
function digital(label, low, high) {
  const volts = el('b', {});
  const other = el('span', {});
  const node = el('div', { class: 'meter-digits', role: 'meter', 'aria-label': label, 'aria-valuemin': low, 'aria-valuemax': high }, volts, other);
  let last = 0;
  return {
    node,
    show(value, more) {
      const now = performance.now();
      if (now - last < DIGITS) return;
      last = now;
      volts.textContent = `${fiveDigits(value)} V`;
      other.textContent = more;
      node.setAttribute('aria-valuenow', Number.isFinite(value) ? value : 0);
      node.setAttribute('aria-valuetext', Number.isFinite(value) ? `${volts.textContent} ${more}` : 'not connected');
    },
  };
}

/** Sends a connection again if the session has forgotten it, once for each patch. */
function keeper(connect) {
  let isAsked = false;
  on('patch', () => { isAsked = false; });
  return (output, value) => {
    if (!output || !Number.isNaN(value) || isAsked) return;
    isAsked = true;
    connect();
  };
}

function voltmeter() {
  const { picture, mark, show } = face('V');
  mark(100);
  let output = '';
  let view = null;
  const connect = () => send({ command: 'meter', output: output || null });
  const outputs = picker('Output at the voltmeter', (name) => {
    output = name;
    view = state.patch.outputs.find((one) => one.name === name);
    connect();
  });
  const digits = digital('Voltmeter', -100, 100);
  const keep = keeper(connect);
  on('patch', (patch) => {
    outputs.update(patch, patch.signals[0]?.at);
    view = patch.outputs.find((one) => one.name === output);
  });
  on('frame', ({ meter }) => {
    keep(output, meter);
    show(meter / 100);
    digits.show(meter, view?.signal && Number.isFinite(meter) ? `${view.signal} ${quantity(meter * view.per_volt, view.unit, 5)}` : '');
  });
  return el('section', { class: 'meter', 'aria-label': 'Voltmeter' }, el('h3', {}, 'Voltmeter'), picture, digits.node, outputs.node);
}

/** The switch of the null meter's sensitivity. */
function sensitivities(choose) {
  const radio = ([full, text], index) => el('label', {},
    el('input', { type: 'radio', name: 'sensitivity', checked: index === 0, onchange: () => choose(full) }), el('span', {}, `±${text}`));
  return el('fieldset', { class: 'meter-range' }, el('legend', {}, 'Sensitivity'), SENSITIVITIES.map(radio));
}

function nullMeter() {
  const { picture, mark, show } = face('null');
  let [full, output, divider, pot] = [10, '', 0, null];
  mark(full);
  const connect = () => send({ command: 'null-meter', output: output || null, divider });
  const place = el('div', { class: 'meter-pot' });
  const outputs = picker('Output at the null meter', (name) => {
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
  const mode = button('Pot set', () => send({ command: 'mode', mode: 'pot-set' }), { 'aria-pressed': 'false' });
  on('machine', (machine) => mode.setAttribute('aria-pressed', String(machine.mode === 'pot-set')));
  const digits = digital('Null meter', -10, 10);
  const keep = keeper(connect);
  on('patch', (patch) => {
    outputs.update(patch);
    const element = pot && patch.elements.find(({ name }) => name === pot.control.place.element);
    const view = element?.settings.find(({ name }) => name === 'setting');
    if (view) pot.update(view, patch);
  });
  on('frame', ({ nullMeter: volts }) => {
    keep(output, volts);
    show(volts / full);
    digits.show(volts, Math.abs(volts) < 5e-3 ? 'balanced' : '');
  });
  const step = (text, ...parts) => el('li', {}, el('p', {}, text), parts);
  return el('section', { class: 'meter', 'aria-label': 'Null meter' }, el('h3', {}, 'Null meter'), picture, digits.node,
    sensitivities((value) => {
      full = value;
      mark(full);
    }),
    el('p', { class: 'meter-about' }, 'It shows the output minus the divider\'s share of the reference. To set a pot under load:'),
    el('ol', { class: 'meter-steps' },
      step('Choose the pot.', outputs.node), step('Select the mode.', mode),
      step('Turn the divider to the wanted setting.', reference.node), step('Turn the pot until the needle is at zero.', place)));
}

/** Shows the voltmeter and the null meter. @param {HTMLElement} root */
export function mountMeters(root) {
  root.classList.add('meters');
  root.replaceChildren(voltmeter(), nullMeter());
}
