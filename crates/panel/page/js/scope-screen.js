/** Draws traces against time and X-Y curves with the brightness of a phosphor. */

import { within } from './dom.js';
import { drawGrid, FULL_SCALE, layout, scales } from './scope-grid.js';

const { abs, hypot, max, round } = Math;

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
/** Pixels of a dash of the second channel, and of a dash with its gap. */
const [DASH, PERIOD] = [10, 14];
/** Pixels of a path of a curve, which adds up where it is close to itself, and of a trace against time. */
const [LOOP, LONG] = [200, 2e4];

/** Colours of a scope from the theme. */
function palette(element) {
  const style = getComputedStyle(element);
  const [grid, ink, bad, ...traces] = ['grid', 'scope-ink', 'scope-bad', 'trace-1', 'trace-2']
    .map((name) => style.getPropertyValue(`--${name}`));
  return { grid, ink, bad, traces, glow: 6, font: style.fontFamily, size: parseFloat(style.fontSize) * 0.8 };
}

/** A beam draws lines on the graticule with a brightness. Lines of one brightness that follow each other are one path, up to a length. */
function beamOf(context, { view, colours }, channel, strength, most) {
  let [present, x, y, way] = [-1, NaN, NaN, 0];
  context.save();
  context.beginPath();
  context.rect(view.x, view.y, view.across + 1, view.up + 1);
  context.clip();
  context.lineJoin = 'round';
  function paint() {
    if (present < 0) return;
    const bright = strength * (0.22 + (0.78 * Math.min(present, LEVELS - 1)) / (LEVELS - 1));
    context.strokeStyle = present === LEVELS ? colours.bad : colours.traces[channel];
    for (const [lineWidth, globalAlpha] of [[colours.glow, 0.25 * (bright - 0.3)], [1.6, bright]]) {
      if (!lineWidth || globalAlpha <= 0) continue;
      Object.assign(context, { lineWidth, globalAlpha });
      context.stroke();
    }
  }
  return {
    line(x1, y1, x2, y2, level) {
      // Lines of one path do not add up where they cross, those of two do.
      if (level !== present || way > most) {
        paint();
        [present, x, way] = [level, NaN, 0];
        context.beginPath();
      }
      if (x1 !== x || y1 !== y) context.moveTo(x1, y1);
      context.lineTo(x2, y2);
      [x, y] = [x2, y2];
      way += hypot(x2 - x1, y2 - y1);
    },
    end() {
      paint();
      context.restore();
    },
  };
}

/**
 * Draws a trace against time. In each column it goes to the end that is near, then to the other one. The longer this way,
 * the darker it is. Returns where it ends.
 */
function drawColumns(context, scene, columns, channel, from, to, strength) {
  const { view, model } = scene;
  const { gain, zero } = scales(view, model.controls)[channel];
  const width = view.across / model.trace.total;
  const beam = beamOf(context, scene, channel, strength, LONG);
  let [way, rise, bright, x, y] = [0, 0, LEVELS - 1, view.x + from * width, NaN];
  for (let at = from; at < to; at += 1) {
    const [low, high] = [columns[2 * at], columns[2 * at + 1]];
    let [start, end] = [zero + gain * low, zero + gain * high];
    if (abs(start - y) > abs(end - y)) [start, end] = [end, start];
    const length = hypot(width, end - start);
    const [before, left] = [y, x];
    [x, y] = [left + width, end];
    if (length !== length) continue;
    const level = LEVELS - 1 - 0.8 * Math.log2(length / width);
    // Brightness follows slowly, so that a smooth trace is not a chain of pieces.
    if (abs(level - bright) > 0.9) bright = max(0, round(level));
    const shade = model.lit[channel] && (high >= FULL_SCALE || low <= -FULL_SCALE) ? LEVELS : bright;
    const turns = rise * (end - start) < 0;
    rise = end - start;
    // The second channel is dashed along its way, where it is smooth.
    if (channel === 0 || turns || length > DASH || way % PERIOD < DASH) {
      if (abs(start - before) < 1) start = before;
      else if (before === before) beam.line(left, before, left, start, shade);
      beam.line(left, start, x, end, shade);
    }
    way += length;
  }
  beam.end();
  return [x, y];
}

/** Draws X-Y curves. It keeps the place of the beam, so that a curve can be drawn as it grows. */
class Pen {
  constructor() {
    this.reset();
  }

  reset() {
    Object.assign(this, { x: NaN, y: NaN, seconds: 0, time: 0, way: 0, level: 0, exposure: 0 });
  }

  /** Draws the present curve. */
  begin(context, scene) {
    this.reset();
    this.draw(context, scene, scene.model.trace.finished, scene.model.trace.count, 1);
  }

  /** Follows points. Those closer than a pixel are one. */
  follow({ view, model: { trace: { points }, controls } }, from, to, visit) {
    const [across, up] = scales(view, controls);
    for (let at = 3 * from; at < 3 * to; at += 3) {
      const [volts, other, seconds] = [points[at], points[at + 1], points[at + 2]];
      const [x, y] = [across.zero + across.gain * volts, up.zero + up.gain * other];
      this.seconds = max(0, this.seconds + seconds);
      if (seconds < 0 || this.x !== this.x) [this.x, this.y, this.seconds] = [x, y, 0];
      const length = hypot(x - this.x, y - this.y);
      if (length < 0.8) continue;
      visit(length, x, y, max(abs(volts), abs(other)));
      [this.x, this.y, this.seconds] = [x, y, 0];
    }
  }

  /**
   * Draws points. A long curve is darker, so that it shows where it is dense. Returns whether all of it must be drawn
   * again: where lines have added up to full brightness, the darker ones would not fit to them.
   */
  draw(context, scene, from, to, strength) {
    const { view, model: { lit, controls: { persistence } } } = scene;
    const { x, y, seconds } = this;
    let ahead = this.way;
    this.follow(scene, from, to, (length) => { ahead += length; });
    Object.assign(this, { x, y, seconds });
    const exposure = max(LEAST_EXPOSURE, 1 / (1 + (5 * ahead) / (view.across * view.up)));
    if (exposure < 0.7 * this.exposure) {
      // A curve that fades keeps what has faded.
      if (!persistence) return true;
      darken(context, view, 1 - exposure / this.exposure);
      this.exposure = 0;
    }
    this.exposure ||= exposure;
    const beam = beamOf(context, scene, 0, strength * this.exposure, LOOP);
    this.follow(scene, from, to, (length, x, y, volts) => {
      this.time += this.seconds;
      this.way += length;
      // The usual pace has medium brightness.
      const level = 4.5 + 1.5 * Math.log2((this.seconds * this.way) / (length * this.time) || 1);
      // Steps that are visible would have a border where neighbouring lines reach them.
      if (abs(level - this.level) > 0.2) this.level = round(4 * within(0, level, LEVELS - 1)) / 4;
      beam.line(this.x, this.y, x, y, (lit[0] || lit[1]) && volts >= FULL_SCALE ? LEVELS : this.level);
    });
    beam.end();
    return false;
  }
}

function darken(context, { x, y, across, up }, globalAlpha) {
  Object.assign(context, { globalAlpha, globalCompositeOperation: 'destination-out' });
  context.fillRect(x, y, across + 2, up + 2);
  context.globalCompositeOperation = 'source-over';
}

/**
 * The present trace, and the one before where the present one has not arrived. Returns where the beams are, unless they
 * are too fast.
 */
function drawLive(context, scene) {
  const { outputs, trace: { total, reached, period, columns } } = scene.model;
  const isSteady = period < STEADY;
  const next = reached + (isSteady || reached === 0 ? 0 : Math.ceil(total / 100));
  return columns.map((each, channel) => {
    if (!outputs[channel]) return [];
    drawColumns(context, scene, each, channel, next, total, isSteady ? 1 : DIM);
    const end = drawColumns(context, scene, each, channel, 0, reached, 1);
    return isSteady || reached >= total ? [] : end;
  });
}

function drawStored(context, scene, { columns, at }) {
  const { controls: { persistence }, trace } = scene.model;
  const strength = DIM * FADED ** ((trace.clock - at) / (persistence || Infinity));
  columns.forEach((each, channel) => drawColumns(context, scene, each, channel, 0, trace.total, strength));
}

/** Draws all traces: finished ones on one layer, the present one on another, or both on one. */
export function drawTraces(old, live, scene, pen = new Pen()) {
  const { trace } = scene.model;
  if (trace.plane) {
    pen.draw(old, scene, 0, trace.finished, DIM);
    pen.begin(live, scene);
  } else {
    for (const entry of trace.stored) drawStored(old, scene, entry);
    scene.beams = drawLive(live, scene);
  }
}

/** The layers of a screen: graticule, finished traces, present trace. A layer is drawn only if it has changed. */
export class Screen {
  view = layout(10, 10, 1);
  isStale = true;
  pen = new Pen();
  /** Where the beams of a trace against time are. */
  beams = [[], []];
  /** The trace as it is drawn: its counts, the points of its present curve, its last stored trace. */
  drawn = {};
  /** The clock of the trace at the last step of fading. */
  faded = 0;

  constructor(box, model) {
    Object.assign(this, { box, model, layers: [...box.querySelectorAll('canvas')].map((canvas) => canvas.getContext('2d')) });
  }

  resize() {
    const { box: { clientWidth, clientHeight }, layers, model } = this;
    this.colours = palette(this.box);
    this.view = layout(clientWidth, clientHeight, 1.9 * this.colours.size, model.controls?.display === 'plane');
    for (const context of layers) {
      context.canvas.width = round(clientWidth * devicePixelRatio);
      context.canvas.height = round(clientHeight * devicePixelRatio);
      context.scale(devicePixelRatio, devicePixelRatio);
    }
    this.isStale = true;
  }

  clear(context) {
    context.clearRect(0, 0, this.view.width, this.view.height);
  }

  /** Draws what has changed since the last time. */
  draw() {
    const { layers: [grid, old, live], pen, drawn, model: { trace } } = this;
    const { left, version, changes, begun, stored, plane } = trace;
    const newest = stored.at(-1);
    if (this.isStale || drawn.left !== left) {
      this.clear(grid);
      drawGrid(grid, this);
    }
    if (this.isStale || drawn.version !== version) {
      this.clear(old);
      this.clear(live);
      pen.reset();
      drawTraces(old, live, this, pen);
      this.faded = trace.clock;
    } else {
      this.fade(old, live);
      if (drawn.changes === changes) return;
      if (plane) this.extend(old, live);
      else {
        if (newest && newest !== drawn.newest) drawStored(old, this, newest);
        this.clear(live);
        this.beams = drawLive(live, this);
      }
    }
    this.isStale = false;
    trace.replaced = 0;
    this.drawn = { left, version, changes, begun, newest, points: trace.count - trace.finished };
  }

  /** Draws the new points of a curve. */
  extend(old, live) {
    const { pen, drawn: { begun, points }, view: { width, height }, model: { trace } } = this;
    let from = trace.replaced > 0 ? points - 1 : points;
    if (begun !== trace.begun) {
      old.globalAlpha = DIM;
      old.drawImage(live.canvas, 0, 0, width, height);
      this.clear(live);
      pen.reset();
      from = 0;
    } else pen.seconds -= trace.replaced;
    if (!pen.draw(live, this, trace.finished + max(0, from), trace.count, 1)) return;
    this.clear(live);
    pen.begin(live, this);
  }

  /** Fades finished traces, and curves behind the spot. */
  fade(old, live) {
    const { pen, view, model: { trace: { plane, clock }, controls: { persistence, store } } } = this;
    const seconds = persistence || (plane && !store ? AFTERGLOW : Infinity);
    const steps = (clock - this.faded) / seconds * Math.log(FADED) / Math.log(1 - FADE);
    if (steps >= 0 && steps < 1 && seconds < Infinity) return;
    this.faded = clock;
    if (!(steps >= 1)) return;
    const left = (1 - FADE) ** steps;
    darken(old, view, 1 - left);
    if (!plane || !persistence) return;
    darken(live, view, 1 - left);
    pen.time *= left;
    pen.way *= left;
  }

  /**
   * Place of a channel's spot; null if it is not on the screen. `back` has the time and the voltages of a machine that was
   * moved back: its spot is on the trace, which stays.
   */
  spot(channel, back) {
    const { view, pen, beams, model: { trace, controls, span } } = this;
    const place = back && scales(view, controls).map(({ gain, zero }, index) => zero + gain * back.volts[index]);
    const ends = trace.plane ? [place || [pen.x, pen.y], []] : beams;
    const [x, y] = place && !trace.plane ? [view.x + view.across * (back.time - trace.left) / span, place[channel]] : ends[channel];
    return x >= view.x && x - view.x <= view.across && y >= view.y && y - view.y <= view.up ? [x, y] : null;
  }
}
