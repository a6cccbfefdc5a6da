/** One dial: a knob with a scale, and a field in which its value can be typed exactly. */

import { changeDetector, decadeOf, fill, format, hasModifier, minus, parse, roundUp, template, within } from './dom.js';
import { refusalOf } from './state.js';

/** The angle from the top to an end of the scale of a dial of one turn, in degrees. */
const SWEEP = 135;
/** The value of one turn of a dial of many turns, and the decimals that such a dial resolves. */
const [TURN, DECIMALS] = [0.1, 4];
/** A turn of the wheel sooner after one elsewhere still scrolls the page, in milliseconds. */
const SCROLLING = 400;

let scrolled = -SCROLLING;
addEventListener('wheel', (event) => {
  if (!event.target.closest?.('.dial')) scrolled = event.timeStamp;
}, { passive: true, capture: true });

/** A scale. An end that the range does not give is near the value, and `extend` moves it. */
function scaleOf({ range, isWhole, hasTurns }) {
  const floor = range?.[0] ?? -Infinity;
  const ceiling = range?.[1] ?? Infinity;
  const isClosed = ceiling - floor < 1e12;
  const log = isClosed && floor > 0 && ceiling / floor > 50;
  const scale = {
    log,
    low: isClosed ? floor : NaN,
    high: isClosed ? ceiling : NaN,
    /** Moves an end if the value is outside, or at it when a turn begins. */
    extend(value, turning) {
      if (isClosed) return;
      const size = value ? roundUp(2 * Math.abs(value)) : scale.high - scale.low || 1;
      const isNew = Number.isNaN(scale.low);
      if (isNew ? value >= 0 : value > scale.high || (turning && value === scale.high)) scale.high = Math.min(ceiling, size);
      if (isNew ? value <= 0 : value < scale.low || (turning && value === scale.low)) scale.low = Math.max(floor, -size);
      scale.low ||= Math.max(floor, 0);
      scale.high ||= Math.min(ceiling, 0);
    },
    position: (value) => within(0, log ? Math.log(value / scale.low) / Math.log(scale.high / scale.low)
      : (value - scale.low) / (scale.high - scale.low), 1),
    step: () => (isWhole ? 1 : hasTurns ? 10 ** -DECIMALS : decadeOf((scale.high - scale.low) / 2000)),
    /** The value at a position, rounded to what the dial resolves. */
    value(position, fine) {
      const { low, high } = scale;
      if (position <= 0 || position >= 1) return position <= 0 ? low : high;
      const exact = log ? low * (high / low) ** position : low + (high - low) * position;
      const grid = scale.step() * (fine && !isWhole && !hasTurns ? 0.1 : 1);
      return within(low, Number(log && !isWhole ? exact.toPrecision(fine ? 5 : 4) : (Math.round(exact / grid) * grid).toPrecision(12)), high);
    },
  };
  return scale;
}

/** Draws the marks of a scale: equal parts, or decades and their multiples. */
function drawMarks(path, { log, low, high, position }, isLong) {
  fill(path, { pathLength: log ? 1 : isLong ? 10 : 50 });
  if (!log) return;
  const [dashes, width] = [[], isLong ? 0.006 : 0.003];
  let end = 0;
  for (let decade = decadeOf(low); decade < high * 1.001; decade *= 10) {
    for (let factor = 1; factor < (isLong ? 2 : 10); factor += 1) {
      const value = factor * decade;
      if (value < low * 0.999 || value > high * 1.001) continue;
      const start = within(0, position(value) - width / 2, 1 - width);
      dashes.push(start - end, width);
      end = start + width;
    }
  }
  fill(path, { 'stroke-dasharray': `0 ${dashes.join(' ')} 9` });
}

/** Reads a number, and perhaps its unit. Returns the number, or what is wrong. */
function typed(text, unit) {
  const plain = text.trim();
  const own = plain.endsWith(unit) ? plain.slice(0, plain.length - unit.length) : plain;
  return parse(own) ?? `"${plain}" is not a number${unit && ` in ${unit}`}. Write it as 2.5, -3 or 1e-3.`;
}

/**
 * Makes a dial, of many turns if it is that of a pot. `show` gives it the value of the session. An absent end of the range
 * grows. `turned` is called once a frame and resolves with the events of the answer. `blocked` says why a locked dial does
 * not turn.
 * @param {{label: string, unit: string, range?: (number|null)[]|null, hasTurns?: boolean, isWhole?: boolean,
 *   turned: (value: number) => Promise<any[]>, reset?: () => void, blocked?: () => string}} options
 */
export function dial(options) {
  const { label, hasTurns } = options;
  const unit = options.unit === '1' ? '' : options.unit ?? '';
  const scale = scaleOf(options);
  const { node, knob, filled, long, short, turning, low, high, field, unitText, message } = template(hasTurns ? 'dial-many' : 'dial');
  const hasOtherEnds = changeDetector();
  let [shown, latest, position, open, drag] = [NaN, undefined, 0, 0, null];
  let [isQueued, isEdited, isRefused, isLocked] = [false, false, false, false];
  unitText.textContent = unit;

  const written = (value) => (hasTurns ? value.toFixed(DECIMALS) : format(value, 6));
  const note = (text) => { message.textContent = text; };

  function drawScale() {
    if (Number.isNaN(scale.low) || !hasOtherEnds([scale.low, scale.high])) return;
    for (const [text, end, name] of [[low, scale.low, 'min'], [high, scale.high, 'max']]) {
      const short = format(end, 3);
      text.textContent = minus(short.length > 6 ? end.toExponential().replace('e+', 'e') : short);
      fill(knob, { [`aria-value${name}`]: end });
    }
    if (hasTurns) return;
    drawMarks(long, scale, true);
    drawMarks(short, scale, false);
  }

  function draw(value) {
    shown = value;
    const isKnown = !Number.isNaN(value);
    if (isKnown) scale.extend(value, false);
    drawScale();
    const at = isKnown ? scale.position(value) : 0;
    const zero = scale.low < 0 && scale.high > 0 ? scale.position(0) : 0;
    fill(filled, { 'stroke-dasharray': `0 ${Math.min(at, zero)} ${Math.abs(at - zero)} 9` });
    turning.style.transform = `rotate(${hasTurns ? 360 * (value || 0) / TURN : (2 * at - 1) * SWEEP}deg)`;
    if (!isEdited) field.value = isKnown ? written(value) : '';
    fill(knob, { 'aria-valuenow': value || 0, 'aria-valuetext': isKnown ? `${written(value)} ${unit}`.trim() : 'unknown' });
  }

  /** Shows the value of the session. While a turn is under way, answers are about earlier values. */
  function show(value) {
    const isNews = !Object.is(latest, value ?? NaN);
    latest = value ?? NaN;
    if (drag || isQueued || open || (!isNews && (isRefused || Object.is(latest, shown)))) return;
    if (isNews && !isEdited) note('');
    isRefused = false;
    draw(latest);
  }

  /** Shows and sends a value. A refused value stays visible until it is changed. */
  function turn(value) {
    if (value === shown && !isRefused) return;
    isRefused = false;
    note('');
    draw(value);
    if (isQueued) return;
    isQueued = true;
    requestAnimationFrame(async () => {
      isQueued = false;
      open += 1;
      const refusal = refusalOf(await options.turned(shown));
      open -= 1;
      if (open || isQueued) return;
      isRefused = refusal !== undefined;
      if (isRefused) note(refusal);
      else show(latest);
    });
  }

  /** Begins a turn, unless the dial is locked. */
  function mayTurn() {
    if (isLocked) note(options.blocked());
    else {
      scale.extend(shown || 0, true);
      draw(shown || within(scale.low, 0, scale.high));
      position = scale.position(shown);
    }
    return !isLocked;
  }

  /** Turns by a key or the wheel, at least by the finest step. */
  function nudge(by, isFine) {
    if (!mayTurn()) return;
    const value = scale.value(within(0, position + by, 1), isFine);
    turn(value === shown ? within(scale.low, shown + Math.sign(by) * scale.step(), scale.high) : value);
  }

  Object.assign(knob, {
    ariaLabel: label,
    onpointerdown(event) {
      if (event.button || !mayTurn()) return;
      knob.setPointerCapture(event.pointerId);
      const { left, top, width, height } = knob.getBoundingClientRect();
      const centre = [left + width / 2, top + height / 2];
      // The cap is dragged up and down; the skirt or the scale is turned around.
      const isAround = Math.hypot(event.clientX - centre[0], event.clientY - centre[1]) > width * (hasTurns ? 0.18 : 0.28);
      drag = { centre, isAround, x: event.clientX, y: event.clientY };
    },
    onpointermove({ clientX, clientY, shiftKey }) {
      if (!drag) return;
      const { centre: [left, top], isAround, x, y } = drag;
      Object.assign(drag, { x: clientX, y: clientY });
      let by = (y - clientY) / (hasTurns ? 400 : 200);
      if (isAround) {
        const angle = (Math.atan2(clientY - top, clientX - left) - Math.atan2(y - top, x - left)) * 180 / Math.PI;
        by = ((angle + 540) % 360 - 180) / (hasTurns ? 360 * (scale.high - scale.low) / TURN : 2 * SWEEP);
      }
      position = within(0, position + by * (shiftKey ? 0.1 : 1), 1);
      turn(scale.value(position, shiftKey));
    },
    // This event follows when the pointer goes up and when it is cancelled.
    onlostpointercapture() {
      drag = null;
      show(latest);
    },
    ondblclick: () => options.reset?.(),
    onwheel(event) {
      if (event.timeStamp - scrolled < SCROLLING || event.ctrlKey) return;
      event.preventDefault();
      nudge((event.deltaY || event.deltaX) / (event.deltaMode ? -3 : -100) * (event.shiftKey ? 0.001 : 0.01), event.shiftKey);
    },
    onkeydown(event) {
      const arrow = (hasTurns ? 0.001 : 0.01) * (event.shiftKey ? 0.1 : 1);
      const by = {
        ArrowUp: arrow, ArrowRight: arrow, ArrowDown: -arrow, ArrowLeft: -arrow, PageUp: 0.1, PageDown: -0.1, Home: -1, End: 1
      }[event.key];
      if (!by || hasModifier(event)) return;
      event.preventDefault();
      nudge(by, event.shiftKey);
    },
  });

  function enter() {
    if (!field.value.trim()) isEdited = false;
    const answer = isEdited ? typed(field.value, unit) : shown;
    if (typeof answer === 'string') return note(answer);
    if (isEdited) turn(answer);
    isEdited = false;
    return draw(answer);
  }

  Object.assign(field, {
    ariaLabel: `${label}, exact value`,
    onfocus() {
      if (!isEdited && !Number.isNaN(shown)) field.value = shown;
      field.select();
    },
    oninput: () => { isEdited = true; },
    onblur: enter,
    onkeydown({ key }) {
      if (key === 'Enter') enter();
      if (key !== 'Escape') return;
      isEdited = false;
      note('');
      draw(shown);
    },
  });

  return {
    node, knob, show, note,
    lock(on) {
      isLocked = field.readOnly = knob.ariaReadOnly = on;
    },
  };
}
