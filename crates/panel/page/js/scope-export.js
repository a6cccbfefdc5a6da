/** Pictures and tables of a scope, as downloads. */

import { svg } from './dom.js';
import { ACROSS, drawGrid, layout, scales, si, UP } from './scope-grid.js';
import { drawTraces } from './scope-screen.js';

/** Size of a picture, and the space around the graticule. */
const [WIDTH, HEIGHT, MARGIN] = [900, 740, 56];

/** The part of a 2D context that the screen uses, as SVG: what is stroked, filled or written becomes an element. */
class Recorder {
  globalAlpha = 1;
  lineWidth = 1;
  font = '12px sans-serif';
  textAlign = 'left';
  path = [];
  clips = 0;

  constructor(root) {
    this.groups = [root];
  }

  add(tag, attributes, ...children) {
    this.groups.at(-1).append(svg(tag, attributes, ...children));
  }

  beginPath() { this.path = []; }
  moveTo(x, y) { this.path.push(`M${x.toFixed(1)} ${y.toFixed(1)}`); }
  lineTo(x, y) { this.path.push(`${this.path.length > 0 ? 'L' : 'M'}${x.toFixed(1)} ${y.toFixed(1)}`); }
  rect(x, y, width, height) { this.path.push(`M${x} ${y}h${width}v${height}h${-width}z`); }
  clearRect() {}
  fillRect() {}
  save() { this.groups.push(this.groups.at(-1)); }
  restore() { this.groups.pop(); }

  clip() {
    this.clips += 1;
    this.add('clipPath', { id: `c${this.clips}` }, svg('path', { d: this.path.join('') }));
    const group = svg('g', { 'clip-path': `url(#c${this.clips})` });
    this.groups.pop().append(group);
    this.groups.push(group);
  }

  stroke() {
    this.add('path', {
      d: this.path.join(''), fill: 'none', stroke: this.strokeStyle, 'stroke-width': this.lineWidth,
      'stroke-opacity': Number(this.globalAlpha.toFixed(3)), 'stroke-linejoin': 'round',
    });
  }

  fill() { this.add('path', { d: this.path.join(''), fill: this.fillStyle }); }

  fillText(text, x, y) {
    const anchor = { left: 'start', center: 'middle', right: 'end' }[this.textAlign];
    this.add('text', { x, y, fill: this.fillStyle, 'text-anchor': anchor, 'font-size': parseFloat(this.font) }, text);
  }
}

/** Colours on paper or on a dark page. */
const colours = (dark) => ({
  dark, size: 13, font: 'sans-serif', ...(dark
    ? { page: '#0b1512', grid: '#29433a', ink: '#c4d6ce', bad: '#ff6b5e', traces: ['#7df0b0', '#ffc66b'] }
    : { page: '#ffffff', grid: '#d5d9dd', ink: '#30363b', bad: '#c8102e', traces: ['#0a5cad', '#b34700'] }),
});

/** Writes the title and the values along the axes, in the unit of each channel. */
function drawAxes(context, view, paint, { controls, outputs, title }) {
  const size = paint.size * view.ratio;
  const text = (content, align, x, y, colour) => {
    context.textAlign = align;
    context.fillStyle = colour;
    context.fillText(content, x, y);
  };
  context.globalAlpha = 1;
  context.font = `${1.15 * size}px ${paint.font}`;
  text(title, 'center', view.width / 2, view.y - 2.2 * size, paint.ink);
  context.font = `${0.85 * size}px ${paint.font}`;
  scales(view, controls).forEach(({ isX, gain, zero }, channel) => {
    const output = outputs[channel];
    if (!output) return;
    const colour = controls.display === 'plane' ? paint.ink : paint.traces[channel];
    for (let at = isX ? 1 : 0; at <= (isX ? ACROSS : UP); at += 2) {
      const place = (isX ? view.x : view.y) + at * view.division;
      const value = si(((place - zero) / gain) * output.per_volt, '1');
      const isRight = channel === 1 && controls.display === 'time';
      if (isX) text(value, 'center', place, view.y + view.up + 1.3 * size, colour);
      else text(value, isRight ? 'left' : 'right', isRight ? view.x + view.across + 0.5 * size : view.x - 0.9 * size, place + 0.3 * size, colour);
    }
  });
}

function drawing(model) {
  const paint = colours(false);
  const root = svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, 'font-family': paint.font },
    svg('title', {}, model.title), svg('rect', { width: WIDTH, height: HEIGHT, fill: paint.page }));
  const recorder = new Recorder(root);
  for (const draw of [drawGrid, drawAxes]) draw(recorder, layout(WIDTH, HEIGHT, 1, MARGIN), paint, model);
  drawTraces(recorder, recorder, layout(WIDTH, HEIGHT, 1, MARGIN), paint, model);
  return new Blob([new XMLSerializer().serializeToString(root)], { type: 'image/svg+xml' });
}

function picture(model, isDark) {
  const paint = colours(isDark);
  const [page, traces] = [0, 1].map(() => new OffscreenCanvas(2 * WIDTH, 2 * HEIGHT).getContext('2d'));
  const view = layout(2 * WIDTH, 2 * HEIGHT, 2, 2 * MARGIN);
  drawGrid(page, view, paint, model);
  drawAxes(page, view, paint, model);
  drawTraces(traces, traces, view, paint, model);
  page.drawImage(traces.canvas, 0, 0);
  page.globalCompositeOperation = 'destination-over';
  page.globalAlpha = 1;
  page.fillStyle = paint.page;
  page.fillRect(0, 0, view.width, view.height);
  return page.canvas.convertToBlob();
}

/** A table in the form of `patchcord run --csv`: lines with the units, a line of names, a line for each time. */
function table({ trace, outputs }) {
  const channels = [0, 1].filter((channel) => outputs[channel]);
  const names = outputs.map((output) => (output?.signal ?? output?.name ?? '').replace(/[,#\s]+/g, '_'));
  const value = (volts, channel) => (Number.isNaN(volts) ? '' : Number((volts * outputs[channel].per_volt).toPrecision(8)));
  const ends = trace.plane ? [''] : ['_min', '_max'];
  const heads = channels.flatMap((channel) => ends.map((end) => [names[channel] + end, outputs[channel].unit]));
  const lines = [['t', 's'], ...heads].map(([name, unit]) => `# ${name}: ${unit}`);
  lines.push([...(trace.plane ? ['curve'] : []), 't', ...heads.map(([name]) => name)].join(','));
  let [curve, time] = [0, 0];
  for (let at = 0; trace.plane && at < trace.count; at += 1) {
    const [x, y, seconds] = trace.points.subarray(3 * at, 3 * at + 3);
    [curve, time] = seconds < 0 || at === 0 ? [curve + 1, 0] : [curve, time + seconds];
    lines.push([curve, Number(time.toPrecision(9)), value(x, 0), value(y, 1)].join(','));
  }
  for (let at = 0; !trace.plane && at < (trace.reached || trace.total); at += 1) {
    const cells = channels.flatMap((channel) => {
      const [low, high] = [0, 1].map((end) => value(trace.columns[channel][2 * at + end], channel));
      return outputs[channel].per_volt < 0 ? [high, low] : [low, high];
    });
    lines.push([Number((trace.left + (at + 0.5) * trace.columnSeconds).toPrecision(12)), ...cells].join(','));
  }
  return new Blob([`${lines.join('\n')}\n`], { type: 'text/csv' });
}

/** Saves the screen as "svg", "white" or "dark" (PNG), or "csv". */
export async function save(kind, model, stem) {
  const blob = kind === 'csv' ? table(model) : kind === 'svg' ? drawing(model) : await picture(model, kind === 'dark');
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = `${stem}.${kind === 'white' || kind === 'dark' ? 'png' : kind}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
