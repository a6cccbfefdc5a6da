/**
 * The figures of measured data: measured and simulated samples, and below them the residual. Colours and styles are in the
 * style sheet.
 *
 * @typedef {{name: string, test: boolean, time: number[], measured: (number | null)[], simulated: (number | null)[],
 *   residual: (number | null)[]}} Samples  a record
 * @typedef {{signal: string, unit: string, records: Samples[], rms: number | null, noise: number | null,
 *   offset: number | null}} Curves  an output
 */

import { byId, format, minus, partsOf, place, quantity, roundUp, svg, template } from './dom.js';

/** The parts of the view. */
export const view = partsOf(byId('measured'));

/** Pixels for the values at the left, between records, above an area, and below all. */
const [LEFT, GAP, ABOVE, BELOW] = [64, 8, 30, 44];

/** @type {(Record<string, any> & {output?: Curves})[]} */
let figures = [];

/** Round values between two values, about `count` of them. */
function ticks(low, high, count) {
  const step = roundUp((high - low) / count);
  const first = Math.ceil(low / step - 0.001);
  return Array.from({ length: high / step + 1.001 - first }, (_, at) => (first + at) * step);
}

/** Draws a figure for the present size of its picture. */
function draw({ plot, output: { unit, records, noise } }) {
  const { clientWidth: width, clientHeight: height } = plot;
  if (!width) return;
  const shape = (tag, look, at, ...inside) => svg(tag, { class: `plot-${look}`, ...at }, inside);
  const text = (look, x, y, words) => plot.append(shape('text', look, { x, y }, words));
  const all = (...kinds) => kinds.flatMap((kind) => records.flatMap((record) => record[kind])).filter((value) => value !== null);
  const samples = all('measured', 'simulated');
  const [low, high] = [Math.min(...samples), Math.max(...samples)];
  const room = 0.05 * (high - low) || 1;
  const most = roundUp(Math.max(2 * noise, ...all('residual').map(Math.abs)) || 1);
  const tall = height - 2 * ABOVE - BELOW;
  const areas = [['value', 0.6 * tall, low - room, high + room, 'measured', 'simulated'], ['residual', 0.4 * tall, -most, most, 'band', 'zero', 'residual']];
  const span = ({ time }) => time.at(-1) - time[0] || 1;
  // Records are next to each other, and a second is equally wide in all of them.
  const perSecond = (width - LEFT - GAP * records.length) / records.reduce((sum, record) => sum + span(record), 0);
  let from = LEFT;
  plot.replaceChildren();
  for (const record of records) {
    const { time, test } = record;
    const wide = span(record) * perSecond;
    const x = (seconds) => (seconds - time[0]) * perSecond;
    let top = ABOVE;
    for (const [name, up, least, largest, ...kinds] of areas) {
      const y = (value) => (up * (largest - value)) / (largest - least);
      const values = ticks(least, largest, Math.max(2, up / 40));
      const row = (value) => `M0 ${y(value)}H${wide}`;
      const curve = (kind) => record[kind].map((value, at, own) => {
        if (value === null) return '';
        const point = `${x(time[at]).toFixed(1)} ${y(value).toFixed(1)}`;
        return kind === 'measured' ? `M${point}h0` : ((own[at - 1] ?? null) === null ? 'M' : 'L') + point;
      }).join('');
      const lines = { grid: values.map(row).join(''), band: `${row(2 * noise)}V${y(-2 * noise)}H0`, zero: row(0) };
      if (from === LEFT) {
        text('name', 0, top - 14, unit === '1' ? name : `${name} in ${unit}`);
        for (const value of values) text('value', LEFT - 6, top + y(value), minus(format(value)));
      }
      plot.append(shape('svg', test ? 'test' : 'train', { x: from, y: top, width: wide, height: up }, shape('rect', 'back'),
        ...['grid', ...kinds].map((kind) => shape('path', kind, { d: lines[kind] ?? curve(kind) }))));
      top += up + ABOVE;
    }
    for (const value of ticks(time[0], time.at(-1), Math.max(1, wide / 80))) text('time', from + x(value), height - 26, minus(format(value)));
    if (wide > 56) text('time', from + wide / 2, height - 6, test ? 'validation' : 'training');
    from += wide + GAP;
  }
  text('name', 0, height - 26, 't in s');
}

/** Shows the curves. The figures stay if their number does. @param {{outputs: Curves[]}} event */
export function showCurves({ outputs }) {
  if (figures.length !== outputs.length) figures = place(view.figures, outputs.map(() => template('figure')));
  outputs.forEach((output, at) => {
    const { signal, unit, rms, noise, offset } = output;
    const figure = Object.assign(figures[at], { output });
    figure.name.textContent = figure.plot.ariaLabel = signal;
    figure.rms.textContent = quantity(rms, unit, 3);
    figure.noise.textContent = noise && `${quantity(rms / noise, '', 3)} × noise`;
    figure.offset.textContent = offset && `after an offset of ${quantity(offset, unit, 3)}`;
    draw(figure);
  });
}

// A size is also known when the view is shown.
new ResizeObserver(() => figures.forEach(draw)).observe(view.figures);
