/** The graticule of a scope with its overload zones and readings, and the scales of the axes. */

import { quantity } from './dom.js';
import { nameOf, reading } from './probes.js';

/** Divisions of the screen. */
export const [ACROSS, UP] = [10, 8];
/** Volts at which amplifiers overload. */
export const FULL_SCALE = 100 * (1 - 1e-6);

/**
 * Place of the graticule in pixels. Divisions of an X-Y screen are square, so that a circle is a circle. Those of a
 * screen against time use its width.
 */
export function layout(width, height, margin, isPlane) {
  const [free, high] = [Math.floor((width - 1.4 * margin) / ACROSS), Math.floor((height - 2 * margin) / UP)];
  const least = Math.max(4, Math.min(free, high));
  const [dx, dy] = isPlane ? [least, least] : [Math.max(4, free), Math.max(least, Math.min(high, 1.7 * free))];
  const [across, up] = [ACROSS * dx, UP * dy];
  return { width, height, dx, dy, across, up, x: Math.round((width - across) / 2), y: Math.round((height - up) / 2) };
}

/** Pixels per volt and the pixel of 0 V, for both channels. */
export function scales({ x, y, across, up, dx, dy }, { display, channels }) {
  return channels.map(({ inverted, volts_per_division: volts, centre }, channel) => {
    const isX = display === 'plane' && channel === 0;
    const gain = ((isX === inverted ? -1 : 1) * (isX ? dx : dy)) / volts;
    return { isX, gain, zero: (isX ? x + across / 2 : y + up / 2) - gain * centre };
  });
}

/** A function that writes texts in one size. */
export function writer(context, { view, colours }, size) {
  context.font = `${size}px ${colours.font}`;
  return (text, textAlign, x, y, fillStyle = colours.ink) => {
    Object.assign(context, { globalAlpha: 1, textAlign, fillStyle });
    // Two texts fit into a line.
    context.fillText(text, x, y, (Math.max(view.across, view.width - 4 * size) - size) / 2);
  };
}

/** Draws graticule, overload zones and the readings of the axes. */
export function drawGrid(context, scene) {
  const { view, colours, model: { controls, outputs, span, trace } } = scene;
  const { x, y, across, up, dx, dy, width } = view;
  const { size } = colours;
  const isPlane = controls.display === 'plane';
  const lines = (strokeStyle, globalAlpha, list, lineWidth = 1) => {
    Object.assign(context, { globalAlpha, strokeStyle, lineWidth });
    context.beginPath();
    for (const [x1, y1, x2, y2] of list) {
      context.moveTo(x1, y1);
      context.lineTo(x2, y2);
    }
    context.stroke();
  };
  const range = (count, make) => Array.from({ length: count + 1 }, (_, at) => make(at));
  const upright = (at, from = y, to = y + up) => [x + at * dx + 0.5, from, x + at * dx + 0.5, to];
  const level = (at, from = x, to = x + across) => [from, y + at * dy + 0.5, to, y + at * dy + 0.5];
  const [cx, cy] = [x + across / 2 + 0.5, y + up / 2 + 0.5];
  lines(colours.grid, 1, [...range(ACROSS, (at) => upright(at)), ...range(UP, (at) => level(at))]);
  lines(colours.ink, 0.5, [upright(ACROSS / 2), level(UP / 2),
    ...range(5 * ACROSS, (at) => upright(at / 5, cy - 3, cy + 3)), ...range(5 * UP, (at) => level(at / 5, cx - 3, cx + 3))]);

  const text = writer(context, scene, size);
  scales(view, controls).forEach(({ isX, gain, zero }, channel) => {
    const output = outputs[channel];
    if (!output) return;
    const colour = isPlane ? colours.ink : colours.traces[channel];
    const volts = controls.channels[channel].volts_per_division;
    const name = `${isPlane ? 'XY'[channel] : channel + 1}  `;
    const long = `${name}${nameOf(output)}  ${reading(volts, output, '/div', 3)}`;
    const isLong = context.measureText?.(long).width > 0.44 * width;
    const edge = isPlane ? Math.min(x, size) : x;
    text(isLong ? `${name}${output.signal ?? output.name}  ${quantity(volts, 'V', 3)}/div` : long,
      channel ? 'end' : 'start', channel ? width - edge : edge, y - 0.55 * size, colour);
    if (!isPlane && zero > y && zero < y + up) text('►', 'end', x, zero + 0.35 * size, colour);
    for (const limit of [FULL_SCALE, -FULL_SCALE]) {
      const [start, end] = isX ? [x, x + across] : [y, y + up];
      const edge = zero + gain * limit;
      const [from, to] = gain * limit > 0 ? [Math.max(start, edge), end] : [start, Math.min(end, edge)];
      const line = (at) => [isX ? [at, y, at, y + up] : [x, at, x + across, at]];
      if (to - from < 1) continue;
      lines(colours.bad, 0.5, line(edge));
      lines(colours.bad, 0.14, line((from + to) / 2), to - from);
    }
  });
  if (isPlane) return;
  const bottom = y + up + 1.25 * size;
  text(`t = ${quantity(trace.left, 's')}`, 'start', x, bottom);
  text(`${quantity(span / ACROSS, 's', 3)}/div`, 'center', cx, bottom);
  text(quantity(trace.left + span, 's'), 'end', x + across, bottom);
}
