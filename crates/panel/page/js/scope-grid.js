/** The graticule of a scope with its overload zones and readings, and the scales of the axes. */

import { format } from './dom.js';

/** Divisions of the screen. */
export const [ACROSS, UP] = [10, 8];
/** Volts at which amplifiers overload. */
export const FULL_SCALE = 100 * (1 - 1e-6);

/** A quantity for reading: "20 µs", "−4.2 mm". */
export function si(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return '—';
  const most = { V: 0, s: 0, Hz: 2 }[unit];
  const thousands = most === undefined || value === 0 ? 0 : Math.floor(Math.log10(Math.abs(value) * (1 + 1e-9)) / 3);
  const power = Math.max(-4, Math.min(most ?? 0, thousands));
  const name = ['p', 'n', 'µ', 'm', '', 'k', 'M'][power + 4] + (unit === '1' ? '' : unit);
  return `${format(value / 1000 ** power, digits)}${name && '\u202f'}${name}`.replace('-', '−');
}

/** Name of an output with the quantity that it stands for. */
export const nameOf = ({ name, signal }) => (signal && signal !== name ? `${signal} at ${name}` : name);

/** Volts, and what they stand for. `per` is "/div" or empty. */
export function reading(volts, output, per = '', digits = 4) {
  const units = output.signal && Number.isFinite(volts) ? ` = ${si(volts * output.per_volt, output.unit, digits)}${per}` : '';
  return `${si(volts, 'V', digits)}${per}${per ? units.replace('−', '') : units}`;
}

/** Place of the graticule in device pixels. Divisions are square, so that a circle in X-Y is a circle. */
export function layout(width, height, ratio, margin) {
  const division = Math.max(4, Math.floor(Math.min((width - 1.4 * margin) / ACROSS, (height - 2 * margin) / UP)));
  const [across, up] = [ACROSS * division, UP * division];
  return { width, height, ratio, division, across, up, x: Math.round((width - across) / 2), y: Math.round((height - up) / 2) };
}

/** Pixels per volt and the pixel of 0 V, for both channels. */
export function scales({ x, y, across, up, division }, { display, channels }) {
  return channels.map(({ inverted, volts_per_division: volts, centre }, channel) => {
    const isX = display === 'plane' && channel === 0;
    const gain = ((isX === inverted ? -1 : 1) * division) / volts;
    return { isX, gain, zero: (isX ? x + across / 2 : y + up / 2) - gain * centre };
  });
}

/** Limits drawing to the graticule. */
export function clip(context, { x, y, across, up, ratio }) {
  context.save();
  context.beginPath();
  context.rect(x, y, across + ratio, up + ratio);
  context.clip();
}

/** Draws graticule, overload zones and the readings of the axes. */
export function drawGrid(context, view, colours, model) {
  const { x, y, across, up, division, ratio } = view;
  const { controls, outputs, span, trace } = model;
  const lines = (colour, alpha, list) => {
    context.globalAlpha = alpha;
    context.strokeStyle = colour;
    context.lineWidth = ratio;
    context.beginPath();
    for (const [x1, y1, x2, y2] of list) {
      context.moveTo(x1, y1);
      context.lineTo(x2, y2);
    }
    context.stroke();
  };
  const [cx, cy] = [x + across / 2 + ratio / 2, y + up / 2 + ratio / 2];
  const range = (count) => Array.from({ length: count + 1 }, (_, at) => at);
  const column = (at) => x + at * division + ratio / 2;
  const row = (at) => y + at * division + ratio / 2;
  context.clearRect(0, 0, view.width, view.height);
  lines(colours.grid, 1, [...range(ACROSS).map((at) => [column(at), y, column(at), y + up]),
    ...range(UP).map((at) => [x, row(at), x + across, row(at)])]);
  const tick = 3 * ratio;
  lines(colours.ink, 0.5, [[cx, y, cx, y + up], [x, cy, x + across, cy],
    ...range(5 * ACROSS).map((at) => [column(at / 5), cy - tick, column(at / 5), cy + tick]),
    ...range(5 * UP).map((at) => [cx - tick, row(at / 5), cx + tick, row(at / 5)])]);

  clip(context, view);
  const places = scales(view, controls);
  places.forEach(({ isX, gain, zero }, channel) => {
    for (const limit of outputs[channel] ? [FULL_SCALE, -FULL_SCALE] : []) {
      const edge = zero + gain * limit;
      const [start, end] = isX ? [x, x + across] : [y, y + up];
      const depth = gain * limit > 0 ? Math.max(edge, end) : Math.min(edge, start);
      if (depth === edge) continue;
      context.save();
      context.beginPath();
      if (isX) context.rect(Math.min(edge, depth), y, Math.abs(depth - edge), up);
      else context.rect(x, Math.min(edge, depth), across, Math.abs(depth - edge));
      context.clip();
      // The channels slant differently, so that both remain visible where they overlap.
      lines(colours.bad, 0.4, [isX ? [edge, y, edge, y + up] : [x, edge, x + across, edge],
        ...range(Math.ceil((across + up) / (9 * ratio))).map((at) => (channel === 0
          ? [x - up + 9 * ratio * at, y + up, x + 9 * ratio * at, y] : [x - up + 9 * ratio * at, y, x + 9 * ratio * at, y + up]))]);
      context.restore();
    }
  });
  context.restore();

  const size = colours.size * ratio;
  const isPlane = controls.display === 'plane';
  const text = (content, align, tx, ty, colour = colours.ink) => {
    context.textAlign = align;
    context.fillStyle = colour;
    context.fillText(content, tx, ty, 0.48 * across);
  };
  context.globalAlpha = 1;
  context.font = `${size}px ${colours.font}`;
  outputs.forEach((output, channel) => {
    if (!output) return;
    const colour = isPlane ? colours.ink : colours.traces[channel];
    const scale = reading(controls.channels[channel].volts_per_division, output, '/div', 3);
    text(`${isPlane ? 'XY'[channel] : channel + 1}  ${nameOf(output)}  ${scale}`, channel ? 'right' : 'left', channel ? x + across : x, y - 0.55 * size, colour);
    const { zero } = places[channel];
    if (isPlane || zero < y || zero > y + up) return;
    // The mark of 0 V.
    context.beginPath();
    for (const [dx, dy] of [[0, 0], [-0.6, -0.4], [-0.6, 0.4]]) context.lineTo(x + dx * size, zero + dy * size);
    context.fill();
  });
  const bottom = y + up + 1.25 * size;
  if (!isPlane) {
    text(`t = ${si(trace.left, 's', 4)}`, 'left', x, bottom);
    text(`${si(span / ACROSS, 's')}/div`, 'center', cx, bottom);
    text(si(trace.left + span, 's', 4), 'right', x + across, bottom);
  }
}
