/** Pictures and tables of a scope, as downloads. */

import { quantity, svg } from './dom.js';
import { download } from './files.js';
import { ACROSS, drawGrid, layout, scales, UP, writer } from './scope-grid.js';
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

/** Colours on paper. */
const PAPER = { size: 13, font: 'sans-serif', grid: '#d5d9dd', ink: '#30363b', bad: '#c8102e', traces: ['#0a5cad', '#b34700'] };

/** Writes the title and the values along the axes, in the unit of each channel. */
function drawAxes(context, scene) {
  const { view, model: { controls, outputs, title } } = scene;
  const { x, y, across, up, dx, dy } = view;
  const size = PAPER.size * view.ratio;
  writer(context, scene, 1.15 * PAPER.size)(title, 'center', view.width / 2, y - 2.2 * size);
  const text = writer(context, scene, 0.85 * PAPER.size);
  scales(view, controls).forEach(({ isX, gain, zero }, channel) => {
    const output = outputs[channel];
    const isTime = controls.display === 'time';
    for (let at = isX ? 1 : 0; output && at <= (isX ? ACROSS : UP); at += 2) {
      const place = isX ? x + at * dx : y + at * dy;
      const value = quantity(((place - zero) / gain) * output.per_volt, '1', 3);
      if (isX) text(value, 'center', place, y + up + 1.3 * size);
      else if (isTime && channel === 1) text(value, 'left', x + across + 0.5 * size, place + 0.3 * size, PAPER.traces[1]);
      else text(value, 'right', x - 0.9 * size, place + 0.3 * size, isTime ? PAPER.traces[0] : PAPER.ink);
    }
  });
}

/** Draws everything at so many pixels for one of the drawing. */
function drawAll(page, traces, ratio, model) {
  const view = layout(ratio * WIDTH, ratio * HEIGHT, ratio, ratio * MARGIN, true);
  const scene = { view, model, colours: PAPER };
  drawGrid(page, scene);
  drawAxes(page, scene);
  drawTraces(traces, traces, scene);
}

function drawing(model) {
  const root = svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, 'font-family': PAPER.font },
    svg('title', {}, model.title), svg('rect', { width: WIDTH, height: HEIGHT, fill: '#fff' }));
  const recorder = new Recorder(root);
  drawAll(recorder, recorder, 1, model);
  return new XMLSerializer().serializeToString(root);
}

function picture(model) {
  const [page, traces] = [0, 1].map(() => new OffscreenCanvas(2 * WIDTH, 2 * HEIGHT).getContext('2d'));
  drawAll(page, traces, 2, model);
  page.drawImage(traces.canvas, 0, 0);
  Object.assign(page, { globalCompositeOperation: 'destination-over', globalAlpha: 1, fillStyle: '#fff' });
  page.fillRect(0, 0, 2 * WIDTH, 2 * HEIGHT);
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
  return `${lines.join('\n')}\n`;
}

/** Saves the screen as "svg", "png" or "csv". */
export async function save(kind, model, stem) {
  const [make, type] = { svg: [drawing, 'image/svg+xml'], png: [picture, 'image/png'], csv: [table, 'text/csv'] }[kind];
  download(`${stem}.${kind}`, await make(model), type);
}
