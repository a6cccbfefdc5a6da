/** Pictures and tables of a scope, as downloads. */

import { quantity, svg } from './dom.js';
import { download } from './files.js';
import { ACROSS, drawGrid, layout, scales, UP, writer } from './scope-grid.js';
import { drawTraces } from './scope-screen.js';

/** Size of a picture, and the space around the graticule. */
const [width, height, MARGIN] = [900, 740, 56];
const SVG = 'image/svg+xml';
/** Colours on paper. */
const PAPER = { size: 13, font: 'sans-serif', grid: '#d5d9dd', ink: '#30363b', bad: '#c8102e', traces: ['#0a5cad', '#b34700'] };

/** The part of a 2D context that the screen uses, as SVG: what is stroked or written becomes an element. */
class Recorder {
  constructor(root) {
    this.groups = [root];
  }

  add(tag, attributes, text) {
    return this.groups[0].appendChild(svg(tag, attributes, text));
  }

  save() {}
  beginPath() { this.path = ''; }
  moveTo(...at) { this.path += `M${at.map((each) => each.toFixed(1))}`; }
  lineTo(...at) { this.path += `L${at.map((each) => each.toFixed(1))}`; }
  rect(...box) { this.box = box; }
  restore() { this.groups.shift(); }

  clip() {
    const [x, y, wide, high] = this.box;
    this.groups.unshift(this.add('svg', { x, y, width: wide, height: high, viewBox: this.box.join(' ') }));
  }

  stroke() {
    this.add('path', {
      d: this.path, fill: 'none', stroke: this.strokeStyle, 'stroke-width': this.lineWidth,
      'stroke-opacity': this.globalAlpha.toFixed(3), 'stroke-linejoin': 'round',
    });
  }

  fillText(text, x, y) {
    this.add('text', { x, y, fill: this.fillStyle, 'text-anchor': this.textAlign.replace('center', 'middle'), 'font-size': parseFloat(this.font) }, text);
  }
}

/** Writes the title and the values along the axes, in the unit of each channel. */
function drawAxes(context, scene) {
  const { view: { x, y, across, up, dx, dy }, model: { controls, outputs, title } } = scene;
  const { size, traces, ink } = PAPER;
  writer(context, scene, 1.15 * size)(title, 'center', width / 2, y - 2.2 * size);
  const text = writer(context, scene, 0.85 * size);
  scales(scene.view, controls).forEach(({ isX, gain, zero }, channel) => {
    const output = outputs[channel];
    const isTime = controls.display === 'time';
    const [side, align] = isTime && channel ? [x + across + 0.5 * size, 'start'] : [x - 0.9 * size, 'end'];
    for (let at = isX ? 1 : 0; output && at <= (isX ? ACROSS : UP); at += 2) {
      const place = isX ? x + at * dx : y + at * dy;
      const value = quantity(((place - zero) / gain) * output.per_volt, '1', 3);
      if (isX) text(value, 'center', place, y + up + 1.3 * size);
      else text(value, align, side, place + 0.3 * size, isTime ? traces[channel] : ink);
    }
  });
}

function drawing(model) {
  const [page, lines] = [svg('g'), svg('g')];
  const scene = { view: layout(width, height, MARGIN, true), model, colours: PAPER };
  const [grid, traces] = [page, lines].map((group) => new Recorder(group));
  drawGrid(grid, scene);
  drawAxes(grid, scene);
  drawTraces(traces, traces, scene);
  return new XMLSerializer().serializeToString(svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height, 'font-family': PAPER.font },
    svg('title', {}, model.title), svg('rect', { width, height, fill: '#fff' }), page, lines));
}

/** The drawing in pixels, two for one. */
async function picture(model) {
  const image = new Image();
  image.src = `data:${SVG},${encodeURIComponent(drawing(model))}`;
  await image.decode();
  const canvas = new OffscreenCanvas(2 * width, 2 * height);
  canvas.getContext('2d').drawImage(image, 0, 0, 2 * width, 2 * height);
  return canvas.convertToBlob();
}

/** A table in the form of `patchcord run --csv`: lines with the units, a line of names, a line for each time. */
function table({ trace, outputs }) {
  const { plane, points, columns, left, columnSeconds } = trace;
  const channels = [0, 1].filter((channel) => outputs[channel]);
  const round = (number, digits) => Number(number.toPrecision(digits));
  const value = (volts, channel) => (Number.isNaN(volts) ? '' : round(volts * outputs[channel].per_volt, 8));
  const heads = [['t', 's'], ...channels.flatMap((channel) => {
    const { signal, name, unit } = outputs[channel];
    return (plane ? [''] : ['_min', '_max']).map((end) => [(signal ?? name).replace(/[,#\s]+/g, '_') + end, unit]);
  })];
  const lines = [...heads.map(([name, unit]) => `# ${name}: ${unit}`), [...plane ? ['curve'] : [], ...heads.map(([name]) => name)]];
  let [curve, time] = [0, 0];
  for (let at = 0; at < (plane ? trace.count : trace.reached || trace.total); at += 1) {
    if (plane) {
      const [x, y, seconds] = points.subarray(3 * at);
      [curve, time] = seconds < 0 || at === 0 ? [curve + 1, 0] : [curve, time + seconds];
      lines.push([curve, round(time, 9), value(x, 0), value(y, 1)]);
    } else {
      lines.push([round(left + (at + 0.5) * columnSeconds, 12), ...channels.flatMap((channel) => {
        const ends = [0, 1].map((end) => value(columns[channel][2 * at + end], channel));
        return outputs[channel].per_volt < 0 ? ends.reverse() : ends;
      })]);
    }
  }
  return `${lines.join('\n')}\n`;
}

/** Saves the screen as "svg", "png" or "csv". */
export async function save(kind, model, stem) {
  const [make, type] = { svg: [drawing, SVG], png: [picture, 'image/png'], csv: [table, 'text/csv'] }[kind];
  download(`${stem}.${kind}`, await make(model), type);
}
