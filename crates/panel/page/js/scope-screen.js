/** Draws traces against time and X-Y curves with the brightness of a phosphor. */

import { clip, drawGrid, FULL_SCALE, layout, scales } from './scope-grid.js';

/** Levels of brightness. The one above the brightest is for overload. */
const LEVELS = 8;
/** Brightness of finished traces. */
const DIM = 0.4;
/** Seconds in which a finished curve fades if it is not stored. */
const AFTERGLOW = 0.5;
/** Milliseconds between traces below which the finished one is as bright as the present one. */
const STEADY = 300;
/** What remains of a faded trace, and the part that one step removes: smaller steps would leave a rest in 8 bits. */
const [FADED, FADE] = [0.03, 0.1];
/** Least brightness of a long curve, so that its newest part is visible. */
const LEAST_EXPOSURE = 0.1;

const lows = new Float32Array(1 << 13);
const highs = new Float32Array(1 << 13);
const levels = new Float32Array(1 << 13);

/** Colours of a scope from the theme. */
function palette(element) {
  const style = getComputedStyle(element);
  const get = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    grid: get('grid'), ink: get('scope-ink'), bad: get('scope-bad'), traces: [get('trace-1'), get('trace-2')], dark: true,
    font: style.fontFamily, size: parseFloat(style.fontSize) * 0.8,
  };
}

/** The beam: lines with a brightness. Lines of one brightness that follow each other are one path. */
class Beam {
  begin(context, scene, colour, strength) {
    Object.assign(this, { context, scene, colour, strength, level: -1 });
    clip(context, scene.view);
    context.lineJoin = 'round';
  }

  line(x1, y1, x2, y2, level) {
    if (level !== this.level) {
      this.paint();
      this.level = level;
      this.x = NaN;
      this.context.beginPath();
    }
    if (x1 !== this.x || y1 !== this.y) this.context.moveTo(x1, y1);
    this.context.lineTo(x2, y2);
    [this.x, this.y, this.lines] = [x2, y2, this.lines + 1];
  }

  paint() {
    const { context, scene: { view, colours }, level } = this;
    this.lines = 0;
    if (level < 0) return;
    const bright = this.strength * (0.22 + (0.78 * Math.min(level, LEVELS - 1)) / (LEVELS - 1));
    context.strokeStyle = level === LEVELS ? colours.bad : this.colour;
    if (colours.dark && bright > 0.3) {
      context.lineWidth = 6 * view.ratio;
      context.globalAlpha = 0.25 * (bright - 0.3);
      context.stroke();
    }
    context.lineWidth = 1.6 * view.ratio;
    context.globalAlpha = bright;
    context.stroke();
  }

  split() {
    this.paint();
    this.level = -1;
  }

  end() {
    this.paint();
    this.context.restore();
  }
}

const beam = new Beam();

/**
 * Draws a trace against time. A smooth trace is a line through the middles of its columns. A column that reaches
 * beyond this line (noise, an edge) is a bar. The longer the way of the beam in a column, the darker it is.
 */
function drawColumns(context, scene, columns, channel, from, to, strength) {
  const { view, colours, model } = scene;
  const { gain, zero } = scales(view, model.controls)[channel];
  const width = view.across / model.trace.total;
  const middle = (at) => (lows[at] + highs[at]) / 2;
  let bright = LEVELS;
  for (let at = from; at < to; at += 1) {
    const [low, high] = [columns[2 * at], columns[2 * at + 1]];
    const [one, other] = [zero + gain * low, zero + gain * high];
    [lows[at], highs[at]] = low <= high ? [Math.min(one, other), Math.max(one, other)] : [NaN, NaN];
    const way = Math.max(highs[at] - lows[at], at > from ? Math.abs(middle(at) - middle(at - 1)) || 0 : 0);
    const level = LEVELS - 1 - 0.8 * Math.log2(Math.hypot(width, way) / width);
    // Brightness follows slowly, so that a smooth trace is not a chain of pieces.
    if (Math.abs(level - bright) > 0.9) bright = Math.max(0, Math.round(level)) || 0;
    levels[at] = model.lit[channel] && (high >= FULL_SCALE || low <= -FULL_SCALE) ? LEVELS : Math.min(bright, LEVELS - 1);
  }
  const [dash, period] = channel === 1 ? [10 * view.ratio, 14 * view.ratio] : [0, 1];
  let way = 0;
  beam.begin(context, scene, colours.traces[channel], strength);
  for (let at = from; at < to; at += 1) {
    const here = middle(at);
    if (here !== here) continue;
    const x = view.x + (at + 0.5) * width;
    const before = at > from ? middle(at - 1) : NaN;
    const after = at + 1 < to ? middle(at + 1) : NaN;
    const length = Math.hypot(width, here - before);
    // The second channel is dashed along its way.
    if (length === length && (dash === 0 || length > dash || way % period < dash)) beam.line(x - width, before, x, here, levels[at]);
    way += length || 0;
    const [start, end] = [(before + here) / 2 || here, (after + here) / 2 || here];
    const isAlone = before !== before && after !== after;
    if (isAlone || lows[at] < Math.min(start, here, end) - view.ratio || highs[at] > Math.max(start, here, end) + view.ratio) {
      beam.line(x, lows[at], x, highs[at] + (isAlone ? view.ratio : 0), levels[at]);
    }
  }
  beam.end();
}

/** Draws X-Y curves. It keeps the place of the beam, so that a curve can be drawn as it grows. */
class Pen {
  constructor() {
    this.reset();
  }

  reset() {
    this.x = this.y = NaN;
    this.seconds = this.time = this.way = this.level = 0;
    this.exposure = 1;
  }

  /** A long curve is drawn darker, so that it shows where it is dense. What is already drawn follows. */
  expose(context, view) {
    const exposure = Math.max(LEAST_EXPOSURE, 1 / (1 + (5 * this.way * view.ratio) / (view.across * view.up)));
    if (exposure > 0.7 * this.exposure) return;
    darken(context, view, 1 - exposure / this.exposure);
    this.exposure = exposure;
  }

  draw(context, scene, from, to, strength) {
    const { view, colours, model } = scene;
    const [across, up] = scales(view, model.controls);
    const { points } = model.trace;
    const isLit = model.lit[0] || model.lit[1];
    this.expose(context, view);
    beam.begin(context, scene, colours.traces[0], strength * this.exposure);
    for (let at = 3 * from; at < 3 * to; at += 3) {
      const [x, y] = [across.zero + across.gain * points[at], up.zero + up.gain * points[at + 1]];
      this.seconds = Math.max(0, this.seconds + points[at + 2]);
      if (points[at + 2] < 0 || this.x !== this.x) [this.x, this.y, this.seconds] = [x, y, 0];
      const length = Math.hypot(x - this.x, y - this.y);
      if (length < 0.8 * view.ratio) continue;
      this.time += this.seconds;
      this.way += length;
      // The usual pace has medium brightness.
      const level = 4.5 + 1.5 * Math.log2((this.seconds * this.way) / (length * this.time) || 1);
      if (Math.abs(level - this.level) > 0.7) this.level = Math.round(Math.min(LEVELS - 1, Math.max(0, level)));
      const isOver = isLit && Math.max(Math.abs(points[at]), Math.abs(points[at + 1])) >= FULL_SCALE;
      // Lines of one path do not add up where they cross, those of two do.
      if (beam.lines > 200) beam.split();
      beam.line(this.x, this.y, x, y, isOver ? LEVELS : this.level);
      [this.x, this.y, this.seconds] = [x, y, 0];
    }
    beam.end();
  }
}

function darken(context, view, alpha) {
  context.globalAlpha = alpha;
  context.globalCompositeOperation = 'destination-out';
  context.fillRect(view.x, view.y, view.across + 2, view.up + 2);
  context.globalCompositeOperation = 'source-over';
}

/** The present trace, and the one before where the present one has not arrived. */
function drawLive(context, scene) {
  const { outputs, trace: { total, reached, period, columns } } = scene.model;
  const isSteady = period < STEADY;
  const next = reached + (isSteady || reached === 0 ? 0 : Math.ceil(total / 100));
  columns.forEach((each, channel) => {
    if (!outputs[channel]) return;
    if (next < total) drawColumns(context, scene, each, channel, next, total, isSteady ? 1 : DIM);
    if (reached > 0) drawColumns(context, scene, each, channel, 0, reached, 1);
  });
}

function drawStored(context, scene, { columns, at }) {
  const { controls: { persistence }, trace } = scene.model;
  const strength = persistence > 0 ? DIM * FADED ** ((trace.clock - at) / persistence) : DIM;
  columns.forEach((each, channel) => drawColumns(context, scene, each, channel, 0, trace.total, strength));
}

/** Draws all traces: finished ones on one layer, the present one on another, or both on one. */
export function drawTraces(old, live, scene, pen = new Pen()) {
  const { trace } = scene.model;
  if (trace.plane) {
    pen.draw(old, scene, 0, trace.finished, DIM);
    // Parts, so that the brightness of a long curve is adapted on the way.
    for (let at = trace.finished; at < trace.count; at += 2000) {
      pen.draw(live, scene, at, Math.min(at + 2000, trace.count), 1);
    }
  } else {
    for (const entry of trace.stored) drawStored(old, scene, entry);
    drawLive(live, scene);
  }
}

/** The layers of a screen: graticule, finished traces, present trace. A layer is drawn only if it has changed. */
export class Screen {
  view = layout(10, 10, 1, 1);
  isStale = true;
  pen = new Pen();
  begun = 0;
  /** Points of the present curve, and stored traces, that are drawn. */
  drawn = 0;
  newest = null;
  /** The clock of the trace at the last step of fading. */
  faded = 0;

  constructor(box, model) {
    [this.grid, this.old, this.live] = [...box.querySelectorAll('canvas')].map((canvas) => canvas.getContext('2d'));
    [this.box, this.model] = [box, model];
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [this.box.clientWidth, this.box.clientHeight].map((size) => Math.round(size * ratio));
    this.colours = palette(this.box);
    this.view = layout(width, height, ratio, 1.9 * this.colours.size * ratio, this.model.controls?.display === 'plane');
    for (const { canvas } of [this.grid, this.old, this.live]) if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    this.isStale = true;
  }

  clear(context) {
    context.clearRect(0, 0, this.view.width, this.view.height);
  }

  /** Draws what has changed since the last time. */
  draw() {
    const { old, live, pen, model: { trace } } = this;
    if (this.isStale || this.left !== trace.left) drawGrid(this.grid, this);
    if (this.isStale || this.version !== trace.version) {
      this.clear(old);
      this.clear(live);
      pen.reset();
      drawTraces(old, live, this, pen);
      this.faded = trace.clock;
    } else {
      this.fade();
      if (this.changes === trace.changes) return;
      if (trace.plane) {
        this.extend();
      } else {
        const newest = trace.stored.at(-1);
        if (newest && newest !== this.newest) drawStored(old, this, newest);
        this.clear(live);
        drawLive(live, this);
      }
    }
    this.isStale = false;
    trace.replaced = 0;
    [this.left, this.version, this.changes, this.begun] = [trace.left, trace.version, trace.changes, trace.begun];
    [this.newest, this.drawn] = [trace.stored.at(-1), trace.count - trace.finished];
  }

  /** Draws the new points of a curve. */
  extend() {
    const { pen, old, live, model: { trace } } = this;
    if (this.begun !== trace.begun) {
      old.globalAlpha = DIM;
      old.drawImage(live.canvas, 0, 0);
      this.clear(live);
      pen.reset();
      this.drawn = 0;
    } else {
      pen.seconds -= trace.replaced;
    }
    const from = trace.replaced > 0 ? this.drawn - 1 : this.drawn;
    pen.draw(live, this, trace.finished + Math.max(0, from), trace.count, 1);
  }

  /** Fades finished traces, and curves behind the spot. */
  fade() {
    const { pen, model: { trace: { plane, clock }, controls: { persistence, store } } } = this;
    const seconds = persistence || (plane && !store ? AFTERGLOW : Infinity);
    const step = seconds * (Math.log(1 - FADE) / Math.log(FADED));
    if (seconds === Infinity || clock < this.faded) this.faded = clock;
    if (clock - this.faded < step) return;
    const left = (1 - FADE) ** ((clock - this.faded) / step);
    this.faded = clock;
    darken(this.old, this.view, 1 - left);
    if (!plane || persistence === 0) return;
    darken(this.live, this.view, 1 - left);
    pen.time *= left;
    pen.way *= left;
  }

  /** Place of a channel's spot in CSS pixels; null if it is not on the screen. */
  spot(channel) {
    const { view, pen, model: { trace, controls, outputs } } = this;
    let [x, y] = channel === 0 ? [pen.x, pen.y] : [NaN, NaN];
    if (!trace.plane) {
      if (!outputs[channel] || trace.reached === 0 || trace.reached >= trace.total || trace.period < STEADY) return null;
      const { gain, zero } = scales(view, controls)[channel];
      x = view.x + (view.across * trace.reached) / trace.total;
      y = zero + gain * trace.valueAt(channel, (trace.reached - 0.5) / trace.total);
    }
    const isInside = x >= view.x && x <= view.x + view.across && y >= view.y && y <= view.y + view.up;
    return isInside ? [x / view.ratio, y / view.ratio] : null;
  }
}
