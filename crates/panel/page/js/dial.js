/** One dial: a knob with a scale, and a field in which its value can be typed exactly. */

import { el, format, svg } from './dom.js';

/** The angle from the top to an end of the scale of a dial of one turn, in degrees. */
const SWEEP = 135;
/** A turn of the wheel sooner after one elsewhere still scrolls the page, in milliseconds. */
const SCROLLING = 400;
/** The arc of the scale, at a radius of 50. */
const ARC = 'M-35.36 35.36A50 50 0 1 1 35.36 35.36';

let scrolled = -Infinity;
addEventListener('wheel', (event) => {
  if (!event.target.closest?.('.dial')) scrolled = event.timeStamp;
}, { passive: true, capture: true });

const within = (low, value, high) => Math.min(high, Math.max(low, value));
const hasUnit = (unit) => unit && unit !== '1';

/** The next 1, 2 or 5 times a power of 10. */
function roundUp(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  return Number((decade * [1, 2, 5, 10].find((step) => step * decade >= value * 0.999999)).toPrecision(12));
}

/**
 * The scale of a dial. An end that the range does not give is near the value, and `extend` moves it.
 * @param {DialOptions} options
 */
function scaleOf({ range, whole, digits }) {
  const floor = range?.[0] ?? -Infinity;
  const ceiling = range?.[1] ?? Infinity;
  const closed = ceiling - floor < 1e12;
  const log = closed && floor > 0 && ceiling / floor > 50;
  const scale = {
    log,
    low: closed ? floor : NaN,
    high: closed ? ceiling : NaN,
    /** Moves an end of an open scale if the value is outside, or at it when a turn begins. */
    extend(value, turning) {
      if (closed) return;
      const size = value ? roundUp(2 * Math.abs(value)) : 1;
      if (Number.isNaN(scale.low)) {
        scale.low = Math.max(floor, value > 0 ? 0 : -size);
        scale.high = Math.min(ceiling, value < 0 ? 0 : size);
      }
      const spare = value ? size : scale.high - scale.low;
      if (value > scale.high || (turning && value === scale.high)) scale.high = Math.min(ceiling, spare);
      if (value < scale.low || (turning && value === scale.low)) scale.low = Math.max(floor, -spare);
    },
    position: (value) => within(0, log ? Math.log(value / scale.low) / Math.log(scale.high / scale.low)
      : (value - scale.low) / (scale.high - scale.low), 1),
    step: () => (whole ? 1 : 10 ** (digits ? -digits : Math.floor(Math.log10((scale.high - scale.low) / 2000)))),
    /** The value at a position, rounded to what the dial resolves. */
    value(position, fine) {
      if (position <= 0) return scale.low;
      if (position >= 1) return scale.high;
      const exact = log ? scale.low * (scale.high / scale.low) ** position : scale.low + (scale.high - scale.low) * position;
      const grid = scale.step() * (fine && !whole && !digits ? 0.1 : 1);
      const value = log && !whole ? exact.toPrecision(fine ? 5 : 4) : (Math.round(exact / grid) * grid).toPrecision(12);
      return within(scale.low, Number(value), scale.high);
    },
  };
  return scale;
}

/** The dashes that mark these positions on a path of length 1. */
export function dashes(positions, width) {
  const starts = positions.map((position) => within(0, position - width / 2, 1 - width));
  return `0 ${starts.map((start, index) => `${start - (index ? starts[index - 1] + width : 0)} ${width}`).join(' ')} 9`;
}

/** The positions of marks: decades and their multiples on a logarithmic scale, otherwise equal parts. */
function markedAt(scale, long) {
  if (!scale.log) {
    const parts = long ? 10 : 50;
    return Array.from({ length: parts + 1 }, (_, index) => index / parts);
  }
  const positions = [];
  for (let decade = Math.floor(Math.log10(scale.low)); 10 ** decade <= scale.high; decade += 1) {
    for (const factor of long ? [1] : [2, 3, 4, 5, 6, 7, 8, 9]) {
      const value = factor * 10 ** decade;
      if (value >= scale.low * 0.999 && value <= scale.high * 1.001) positions.push(scale.position(value));
    }
  }
  return positions;
}

/** Draws a dial and returns the parts that change. A skirt with a hundred divisions turns below a fixed mark. */
function drawing(many) {
  const arc = (name) => svg('path', { class: `dial-${name}`, d: ARC, pathLength: 1 });
  const parts = { filled: arc('filled'), long: arc('long'), short: arc('short') };
  parts.ends = [-41, 41].map((x) => svg('text', { class: 'dial-end', x, y: 54 }));
  const ring = (name, r, pathLength) => svg('circle', { class: `dial-${name}`, r, pathLength, transform: 'rotate(-90)' });
  parts.turning = svg('g', { class: 'dial-turning' },
    many && [ring('fine', 40, 100), ring('coarse', 39, 10)],
    many && Array.from({ length: 10 }, (_, digit) => svg('text', { class: 'dial-numeral', y: -27.5, transform: `rotate(${-36 * digit})` }, digit)),
    ring('knurl', many ? 21 : 34, 36),
    svg('path', { class: 'dial-pointer', d: many ? 'M0-8V-18' : 'M0-14V-31' }));
  parts.picture = svg('svg', { viewBox: '-64 -60 128 120', 'aria-hidden': 'true' },
    arc('track'), parts.filled, !many && [parts.short, parts.long], parts.turning,
    many && svg('path', { class: 'dial-index', d: 'M-3.5-51H3.5L0-41Z' }), parts.ends);
  return parts;
}

/**
 * Reads what was typed: a number as in JSON, and perhaps the unit.
 * @returns {number|string} the number, or what is wrong
 */
export function typed(text, unit) {
  const parts = /^\s*(-?(?:0|[1-9]\d*)(?:\.\d+)?(?:e[+-]?\d+)?)\s*(.*?)\s*$/i.exec(text);
  if (!parts || /^[\d.,]/.test(parts[2])) return `"${text.trim()}" is not a number. Write it as 2.5, -3 or 1e-3.`;
  if (!parts[2] || parts[2] === unit) return Number(parts[1]);
  return hasUnit(unit) ? `The unit is ${unit}, not ${parts[2]}.` : 'This number has no unit.';
}

/**
 * @typedef {object} DialOptions
 * @property {string} label for a screen reader
 * @property {string} unit
 * @property {[number|null, number|null]|null} [range] an absent end grows
 * @property {number} [perTurn] value of one turn, for a dial of many turns
 * @property {number} [digits] decimal places that are always shown
 * @property {boolean} [whole] whether only whole numbers are permitted
 * @property {(value: number) => Promise<any[]>} turned at most once a frame; resolves with the events of the answer
 * @property {() => void} [reset] on a double click
 * @property {() => void} [blocked] when somebody tries to turn a locked dial
 */

/** Makes a dial. `show` gives it the value of the session. @param {DialOptions} options */
export function dial(options) {
  const { label, unit, perTurn, digits } = options;
  const scale = scaleOf(options);
  const many = Boolean(perTurn);
  const parts = drawing(many);
  const knob = el('div', { class: many ? 'dial is-many' : 'dial', role: 'slider', tabindex: 0, 'aria-label': label }, parts.picture);
  const field = el('input', { autocomplete: 'off', spellcheck: 'false', enterkeyhint: 'done', 'aria-label': `${label}, exact value` });
  const message = el('p', { class: 'dial-message', role: 'status' });
  const node = el('div', { class: 'dial-set' }, knob,
    el('div', { class: 'dial-window' }, field, hasUnit(unit) && el('span', {}, unit)), message);

  let shown = NaN;
  let latest = NaN;
  let position = 0;
  let drag = null;
  let isQueued = false;
  let open = 0;
  let isEdited = false;
  let isRefused = false;
  let isLocked = false;
  let ends = '';

  const written = (value) => (digits ? value.toFixed(digits) : format(value, 6));
  const note = (text) => {
    message.textContent = text;
    node.classList.toggle('is-refused', text !== '');
  };

  function drawScale() {
    const { low, high } = scale;
    if (ends === `${low} ${high}` || Number.isNaN(low)) return;
    ends = `${low} ${high}`;
    parts.ends.forEach((text, index) => { text.textContent = format(index ? high : low, 3); });
    knob.setAttribute('aria-valuemin', low);
    knob.setAttribute('aria-valuemax', high);
    parts.long.setAttribute('stroke-dasharray', dashes(markedAt(scale, true), 0.006));
    parts.short.setAttribute('stroke-dasharray', dashes(markedAt(scale, false), 0.003));
  }

  function draw(value) {
    shown = value;
    const isKnown = Number.isFinite(value);
    if (isKnown) scale.extend(value, false);
    drawScale();
    const at = isKnown ? scale.position(value) : 0;
    const zero = scale.low < 0 && scale.high > 0 ? scale.position(0) : 0;
    parts.filled.setAttribute('stroke-dasharray', `0 ${Math.min(at, zero)} ${Math.abs(at - zero)} 9`);
    parts.turning.style.transform = `rotate(${many ? 360 * (value || 0) / perTurn : (2 * at - 1) * SWEEP}deg)`;
    if (!isEdited) field.value = isKnown ? written(value) : '';
    knob.setAttribute('aria-valuenow', isKnown ? value : scale.low || 0);
    knob.setAttribute('aria-valuetext', isKnown ? `${written(value)}${hasUnit(unit) ? ` ${unit}` : ''}` : 'unknown');
  }

  /** Shows the value of the session. While a turn is under way, answers are about earlier values. */
  function show(value) {
    const isNews = !Object.is(latest, value ?? NaN);
    latest = value ?? NaN;
    if (drag || isQueued || open || (isRefused && !isNews)) return;
    if (isNews && !isEdited) note('');
    isRefused = false;
    draw(latest);
  }

  /** Sends the value, once a frame. A refused value stays visible until it is changed. */
  function turn(value) {
    if (Object.is(value, shown) && !isRefused) return;
    isRefused = false;
    note('');
    draw(value);
    if (isQueued) return;
    isQueued = true;
    requestAnimationFrame(async () => {
      isQueued = false;
      open += 1;
      const refusal = (await options.turned(shown)).find(({ event }) => event === 'refused');
      open -= 1;
      if (open || isQueued) return;
      isRefused = Boolean(refusal);
      if (refusal) note(refusal.message);
      else show(latest);
    });
  }

  /** Begins a turn, unless the dial is locked. */
  function mayTurn() {
    if (isLocked) options.blocked?.();
    if (isLocked) return false;
    scale.extend(shown || 0, true);
    if (Number.isNaN(shown)) draw(within(scale.low, 0, scale.high));
    position = scale.position(shown);
    return true;
  }

  function move(by, fine) {
    position = within(0, position + by, 1);
    turn(scale.value(position, fine));
  }

  /** Turns by a key or the wheel, at least by the finest step. */
  function nudge(by, fine) {
    if (!mayTurn()) return;
    const value = scale.value(within(0, position + by, 1), fine);
    turn(value === shown ? within(scale.low, shown + Math.sign(by) * scale.step(), scale.high) : value);
  }

  const listen = (target, listeners) => Object.entries(listeners).forEach(([name, listener]) => target.addEventListener(name, listener));
  const release = () => {
    if (!drag) return;
    drag = null;
    show(latest);
  };

  listen(knob, {
    pointerdown(event) {
      if (event.button !== 0 || !mayTurn()) return;
      knob.setPointerCapture(event.pointerId);
      const box = knob.getBoundingClientRect();
      const centre = [box.left + box.width / 2, box.top + box.height / 2];
      // The cap is dragged up and down; the skirt or the scale is turned around.
      const isAround = Math.hypot(event.clientX - centre[0], event.clientY - centre[1]) > box.width * (many ? 0.18 : 0.28);
      drag = { centre, isAround, x: event.clientX, y: event.clientY };
    },
    pointermove(event) {
      if (!drag) return;
      const { centre: [left, top], x, y } = drag;
      drag.x = event.clientX;
      drag.y = event.clientY;
      let by = (y - event.clientY) / (many ? 400 : 200);
      if (drag.isAround) {
        const angle = Math.atan2(event.clientY - top, event.clientX - left) - Math.atan2(y - top, x - left);
        const degrees = ((angle * 180 / Math.PI + 540) % 360) - 180;
        by = degrees / (many ? 360 * (scale.high - scale.low) / perTurn : 2 * SWEEP);
      }
      move(by * (event.shiftKey ? 0.1 : 1), event.shiftKey);
    },
    pointerup: release,
    pointercancel: release,
    lostpointercapture: release,
    dblclick: () => options.reset?.(),
    keydown(event) {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const arrow = (many ? 0.001 : 0.01) * (event.shiftKey ? 0.1 : 1);
      const by = { ArrowUp: arrow, ArrowRight: arrow, ArrowDown: -arrow, ArrowLeft: -arrow, PageUp: 0.1, PageDown: -0.1, Home: -2, End: 2 }[event.key];
      if (!by) return;
      event.preventDefault();
      nudge(by, event.shiftKey);
    },
  });
  knob.addEventListener('wheel', (event) => {
    if (event.timeStamp - scrolled < SCROLLING || event.ctrlKey) return;
    event.preventDefault();
    nudge((event.deltaY || event.deltaX) / (event.deltaMode ? -3 : -100) * (event.shiftKey ? 0.001 : 0.01), event.shiftKey);
  }, { passive: false });

  const enter = () => {
    if (!isEdited) return;
    const answer = typed(field.value, unit);
    if (typeof answer === 'string') {
      note(answer);
      return;
    }
    isEdited = false;
    turn(answer);
    draw(answer);
  };
  listen(field, {
    focus() {
      if (!isEdited && !Number.isNaN(shown)) field.value = String(shown);
      field.select();
    },
    input: () => { isEdited = true; },
    keydown(event) {
      if (event.key === 'Enter') enter();
      if (event.key !== 'Escape') return;
      isEdited = false;
      note('');
      draw(shown);
    },
    blur() {
      enter();
      draw(shown);
    },
  });

  return {
    node,
    knob,
    show,
    note,
    lock(on) {
      isLocked = on;
      field.readOnly = on;
      node.classList.toggle('is-locked', on);
      knob.setAttribute('aria-readonly', String(on));
    },
  };
}
