/** Pictures and tables of a scope, as downloads. */

import { svg } from './dom.js';
import { drawPicture, layout, paper } from './scope-screen.js';

const [WIDTH, HEIGHT] = [900, 760];

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
  lineTo(x, y) { this.path.push(`L${x.toFixed(1)} ${y.toFixed(1)}`); }
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
      'stroke-opacity': Number(this.globalAlpha.toFixed(3)), 'stroke-linejoin': 'round', 'stroke-linecap': 'round',
    });
  }

  fill() { this.add('path', { d: this.path.join(''), fill: this.fillStyle }); }

  fillText(text, x, y) {
    const anchor = { left: 'start', center: 'middle', right: 'end' }[this.textAlign];
    this.add('text', { x, y, fill: this.fillStyle, 'text-anchor': anchor, 'font-size': parseFloat(this.font) }, text);
  }
}

function drawing(model) {
  const root = svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, 'font-family': 'sans-serif' },
    svg('title', {}, model.title), svg('rect', { width: WIDTH, height: HEIGHT, fill: '#fff' }));
  drawPicture(new Recorder(root), layout(WIDTH, HEIGHT, 1, 28), paper(false), model);
  return new Blob([new XMLSerializer().serializeToString(root)], { type: 'image/svg+xml' });
}

function picture(model, dark) {
  const canvas = new OffscreenCanvas(2 * WIDTH, 2 * HEIGHT);
  const context = canvas.getContext('2d');
  const colours = paper(dark);
  drawPicture(context, layout(canvas.width, canvas.height, 2, 28), colours, model);
  context.globalCompositeOperation = 'destination-over';
  context.fillStyle = colours.screen;
  context.fillRect(0, 0, canvas.width, canvas.height);
  return canvas.convertToBlob();
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
