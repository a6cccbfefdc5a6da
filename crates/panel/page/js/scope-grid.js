/** The graticule of a scope with its overload zones and readings, and the scales of the axes. */

import { quantity } from './dom.js';
import { nameOf, reading } from './probes.js';

/** Divisions of the screen. */
export const [ACROSS, UP] = [10, 8];
/** Volts at which amplifiers overload. */
export const FULL_SCALE = 100 * (1 - 1e-6);

/**
 * Place of the graticule in device pixels. Divisions of an X-Y screen are square, so that a circle is a circle. Those of
 * a screen against time use its width.
 */
export function layout(width, height, ratio, margin, isPlane) {
  const [free, high] = [Math.floor((width - 1.4 * margin) / ACROSS), Math.floor((height - 2 * margin) / UP)];
  const least = Math.max(4, Math.min(free, high));
  const [dx, dy] = [isPlane ? least : Math.max(4, free), isPlane || high < 4 ? least : Math.min(high, 1.7 * free)];
  const [across, up] = [ACROSS * dx, UP * dy];
  const most = 0.48 * (width - 1.4 * margin);
  return { width, height, ratio, most, dx, dy, across, up, x: Math.round((width - across) / 2), y: Math.round((height - up) / 2) };
}

/** Pixels per volt and the pixel of 0 V, for both channels. */
export function scales({ x, y, across, up, dx, dy }, { display, channels }) {
  return channels.map(({ inverted, volts_per_division: volts, centre }, channel) => {
    const isX = display === 'plane' && channel === 0;
    const gain = ((isX === inverted ? -1 : 1) * (isX ? dx : dy)) / volts;
    return { isX, gain, zero: (isX ? x + across / 2 : y + up / 2) - gain * centre };
  });
}

/** Limits drawing to a rectangle, at first to the graticule. */
export function clip(context, { x, y, across, up, ratio }, rect = [x, y, across + ratio, up + ratio]) {
  context.save();
  context.beginPath();
  context.rect(...rect);
  context.clip();
}

/** A function that writes texts in one size, in pixels of the page. */
export function writer(context, { view, colours }, size) {
  context.globalAlpha = 1;
  context.font = `${size * view.ratio}px ${colours.font}`;
  return (text, align, x, y, colour = colours.ink) => {
    context.textAlign = align;
    context.fillStyle = colour;
    context.fillText(text, x, y, view.most);
  };
}

/** Draws graticule, overload zones and the readings of the axes. */
export function drawGrid(context, scene) {
  const { view, colours, model: { controls, outputs, span, trace } } = scene;
  const { x, y, across, up, dx, dy, ratio } = view;
  const lines = (colour, alpha, list) => {
    Object.assign(context, { globalAlpha: alpha, strokeStyle: colour, lineWidth: ratio });
    context.beginPath();
    for (const [x1, y1, x2, y2] of list) {
      context.moveTo(x1, y1);
      context.lineTo(x2, y2);
    }
    context.stroke();
  };
  const range = (count, make) => Array.from({ length: count + 1 }, (_, at) => make(at));
  const column = (at) => x + at * dx + ratio / 2;
  const row = (at) => y + at * dy + ratio / 2;
  const [cx, cy, tick] = [column(ACROSS / 2), row(UP / 2), 3 * ratio];
  context.clearRect(0, 0, view.width, view.height);
  lines(colours.grid, 1, [...range(ACROSS, (at) => [column(at), y, column(at), y + up]), ...range(UP, (at) => [x, row(at), x + across, row(at)])]);
  lines(colours.ink, 0.5, [[cx, y, cx, y + up], [x, cy, x + across, cy],
    ...range(5 * ACROSS, (at) => [column(at / 5), cy - tick, column(at / 5), cy + tick]),
    ...range(5 * UP, (at) => [cx - tick, row(at / 5), cx + tick, row(at / 5)])]);

  const places = scales(view, controls);
  places.forEach(({ isX, gain, zero }, channel) => {
    for (const limit of outputs[channel] ? [FULL_SCALE, -FULL_SCALE] : []) {
      const [start, end] = isX ? [x, x + across] : [y, y + up];
      const edge = zero + gain * limit;
      const [from, to] = gain * limit > 0 ? [Math.max(start, edge), end] : [start, Math.min(end, edge)];
      if (to <= from) continue;
      clip(context, view, isX ? [from, y, to - from, up] : [x, from, across, to - from]);
      // The channels slant differently, so that both remain visible where they overlap.
      lines(colours.bad, 0.4, [isX ? [edge, y, edge, y + up] : [x, edge, x + across, edge],
        ...range(Math.ceil((across + up) / (9 * ratio)), (at) => [x - up + 9 * ratio * at, y + (channel ? 0 : up), x + 9 * ratio * at, y + (channel ? up : 0)])]);
      context.restore();
    }
  });

  const size = colours.size * ratio;
  const isPlane = controls.display === 'plane';
  const text = writer(context, scene, colours.size);
  outputs.forEach((output, channel) => {
    if (!output) return;
    const volts = controls.channels[channel].volts_per_division;
    const begin = `${isPlane ? 'XY'[channel] : channel + 1}  `;
    const long = `${begin}${nameOf(output)}  ${reading(volts, output, '/div', 3)}`;
    const isShort = context.measureText?.(long).width > view.most;
    const edge = isPlane ? Math.min(x, size) : x;
    text(isShort ? `${begin}${output.signal ?? output.name}  ${quantity(volts, 'V', 3)}/div` : long, channel ? 'right' : 'left', channel ? view.width - edge : edge, y - 0.55 * size,
      isPlane ? colours.ink : colours.traces[channel]);
    const { zero } = places[channel];
    if (isPlane || zero < y || zero > y + up) return;
    // The mark of 0 V.
    context.beginPath();
    for (const [right, down] of [[0, 0], [-0.6, -0.4], [-0.6, 0.4]]) context.lineTo(x + right * size, zero + down * size);
    context.fill();
  });
  const bottom = y + up + 1.25 * size;
  if (isPlane) return;
  text(`t = ${quantity(trace.left, 's')}`, 'left', x, bottom);
  text(`${quantity(span / ACROSS, 's', 3)}/div`, 'center', cx, bottom);
  text(quantity(trace.left + span, 's'), 'right', x + across, bottom);
}
