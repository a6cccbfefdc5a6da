/** Draws the screen of a scope: graticule, traces against time and X-Y curves with the brightness of a phosphor. */

import { format } from './dom.js';

export const ACROSS = 10;
export const UP = 8;
/** Volts at which amplifiers overload. */
export const FULL_SCALE = 100;
/** Levels of brightness. Lines of one level are drawn together. One more level is for overload. */
const LEVELS = 8;
/** Segments of a curve that are drawn together. Where lines of one group cross, the crossing is no brighter. */
const GROUP = 256;
/** Columns of a screen in device pixels, at most. */
const WIDEST = 1 << 13;
/** Brightness of finished traces. */
const DIM = 0.45;
/** Seconds in which a finished curve fades if it is not stored. */
const AFTERGLOW = 0.5;
/** Milliseconds between two traces below which the trace before is as bright as the present one. */
const STEADY = 300;
/** What is left of a trace that has faded, and how much of it one step removes: fewer steps leave no rest in 8 bits. */
const [FADED, FADE] = [0.03, 0.1];
const MOST_MARKS = 36;
/** Least brightness of a long curve, so that its newest part remains visible. */
const LEAST_EXPOSURE = 0.15;

const lows = new Float32Array(WIDEST);
const highs = new Float32Array(WIDEST);
const levels = new Uint8Array(WIDEST);
const counts = new Uint32Array(LEVELS + 1);

const PREFIXES = ['p', 'n', 'µ', 'm', '', 'k', 'M'];

/** A quantity for reading: "20 µs", "−4.2 mm". */
export function si(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return '—';
  const size = Math.abs(value);
  let power = 0;
  if (size > 0 && ['V', 's', 'Hz'].includes(unit)) {
    power = Math.max(-4, Math.min(unit === 'Hz' ? 2 : 0, Math.floor(Math.log10(size * (1 + 1e-9)) / 3)));
  }
  const name = PREFIXES[power + 4] + (unit === '1' ? '' : unit);
  return `${format(value / 1000 ** power, digits) || 0}${name && '\u202f'}${name}`.replace('-', '−');
}

/** Colours of a scope from the theme. */
export function palette(element) {
  const style = getComputedStyle(element);
  const get = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    screen: get('screen'), grid: get('grid'), ink: get('scope-ink') || get('muted'), bad: get('bad'),
    traces: [get('trace-1'), get('trace-2')], dark: isDark(get('screen')), family: style.fontFamily,
    size: parseFloat(style.fontSize) * 0.8,
  };
}

/** Colours of a picture on a white or on a dark page. */
export function paper(dark) {
  const shared = { family: 'sans-serif', size: 12, dark };
  return dark
    ? { ...shared, screen: '#0b1512', grid: '#47635a', ink: '#b9cfc6', bad: '#ff6b5e', traces: ['#5ff0b0', '#ffc04d'] }
    : { ...shared, screen: '#ffffff', grid: '#b4bcc4', ink: '#333a40', bad: '#c8102e', traces: ['#0a5cad', '#b34700'] };
}

function isDark(colour) {
  const context = new OffscreenCanvas(1, 1).getContext('2d');
  context.fillStyle = colour;
  context.fillRect(0, 0, 1, 1);
  const [red, green, blue] = context.getImageData(0, 0, 1, 1).data;
  return 0.3 * red + 0.59 * green + 0.11 * blue < 128;
}

/** Place of the graticule, in device pixels. Divisions are square, so that a circle in X-Y is a circle. */
export function layout(width, height, ratio, size) {
  const margin = Math.round(1.9 * size * ratio);
  const division = Math.max(4, Math.floor(Math.min((width - 1.4 * margin) / ACROSS, (height - 2 * margin) / UP)));
  const [across, up] = [ACROSS * division, UP * division];
  return { width, height, ratio, division, across, up, x: Math.round((width - across) / 2), y: Math.round((height - up) / 2) };
}

/** Pixels per volt and the pixel of 0 V, along one axis. */
export function scaleOf(channel, middle, division, sign) {
  const gain = ((channel.inverted ? -sign : sign) * division) / channel.volts_per_division;
  return { gain, zero: middle - gain * channel.centre };
}

export function scales(view, controls) {
  const middle = view.y + view.up / 2;
  const plane = controls.display === 'plane';
  return controls.channels.map((channel, at) => (plane && at === 0
    ? scaleOf(channel, view.x + view.across / 2, view.division, 1)
    : scaleOf(channel, middle, view.division, -1)));
}

/** Volts per division, and units per division if the voltage stands for a quantity. */
export function perDivision(channel, output) {
  const volts = `${si(channel.volts_per_division, 'V')}/div`;
  return output?.signal ? `${volts} = ${si(channel.volts_per_division * Math.abs(output.per_volt), output.unit)}/div` : volts;
}

export const nameOf = (output) => (output?.signal && output.signal !== output.name ? `${output.signal} at ${output.name}` : output?.name ?? '');

/** Draws graticule, overload zones and the readings of the axes. */
export function drawGrid(context, view, colours, model) {
  const { x, y, across, up, division, ratio } = view;
  context.clearRect(0, 0, view.width, view.height);
  const lines = (width, alpha, paint) => {
    context.globalAlpha = alpha;
    context.lineWidth = width * ratio;
    context.beginPath();
    paint();
    context.stroke();
  };
  const line = (x1, y1, x2, y2) => { context.moveTo(x1, y1); context.lineTo(x2, y2); };
  const half = ratio / 2;
  context.strokeStyle = colours.grid;
  lines(1, 0.55, () => {
    for (let at = 0; at <= ACROSS; at += 1) line(x + at * division + half, y, x + at * division + half, y + up);
    for (let at = 0; at <= UP; at += 1) line(x, y + at * division + half, x + across, y + at * division + half);
  });
  const [cx, cy] = [x + across / 2 + half, y + up / 2 + half];
  lines(1, 1, () => {
    line(cx, y, cx, y + up);
    line(x, cy, x + across, cy);
    for (let at = 0; at <= 5 * ACROSS; at += 1) tick(x + (at * division) / 5 + half, cy, 0, 3 * ratio);
    for (let at = 0; at <= 5 * UP; at += 1) tick(cx, y + (at * division) / 5 + half, 3 * ratio, 0);
  });
  function tick(tx, ty, dx, dy) { line(tx - dx, ty - dy, tx + dx, ty + dy); }
  drawZones(context, view, colours, model, lines);
  context.globalAlpha = 1;
  drawReadings(context, view, colours, model);
}

/** Hatches the voltages beyond full scale, if they are in view: one direction for each channel. */
function drawZones(context, view, colours, model, lines) {
  context.save();
  context.strokeStyle = colours.bad;
  scales(view, model.controls).forEach(({ gain, zero }, channel) => {
    if (!model.outputs[channel]) return;
    const upright = model.controls.display === 'plane' && channel === 0;
    const [from, length] = upright ? [view.x, view.across] : [view.y, view.up];
    for (const limit of [FULL_SCALE, -FULL_SCALE]) {
      const edge = zero + gain * limit;
      const towards = Math.sign(gain * limit);
      const depth = towards > 0 ? from + length - edge : edge - from;
      if (depth <= 0) continue;
      const start = towards > 0 ? Math.max(edge, from) : from;
      const extent = Math.min(depth, length);
      context.save();
      context.beginPath();
      if (upright) context.rect(start, view.y, extent, view.up);
      else context.rect(view.x, start, view.across, extent);
      context.clip();
      lines(1, 0.35, () => {
        const step = 9 * view.ratio;
        const slant = channel === 0 ? view.up : -view.up;
        for (let at = view.x - view.up; at < view.x + view.across + view.up; at += step) {
          context.moveTo(at, view.y);
          context.lineTo(at + slant, view.y + view.up);
        }
        if (upright) { context.moveTo(edge, view.y); context.lineTo(edge, view.y + view.up); }
        else { context.moveTo(view.x, edge); context.lineTo(view.x + view.across, edge); }
      });
      context.restore();
    }
  });
  context.restore();
}

function drawReadings(context, view, colours, { controls, outputs, span, trace }) {
  const { ratio, x, y, across, up } = view;
  const size = colours.size * ratio;
  context.font = `${size}px ${colours.family}`;
  const [top, bottom] = [y - 0.55 * size, y + up + 1.25 * size];
  const text = (content, align, tx, ty, colour, most = across / 2.1) => {
    context.textAlign = align;
    context.fillStyle = colour;
    context.fillText(content, tx, ty, most);
  };
  outputs.forEach((output, channel) => {
    if (!output) return;
    const left = channel === 0;
    const reading = `${controls.display === 'plane' ? 'XY'[channel] : channel + 1}  ${nameOf(output)}  ${perDivision(controls.channels[channel], output)}`;
    const colour = controls.display === 'plane' ? colours.ink : colours.traces[channel];
    text(reading, left ? 'left' : 'right', left ? x : x + across, top, colour);
  });
  if (controls.display === 'plane') return;
  const start = trace.left;
  text(`t = ${si(start, 's', 4)}`, 'left', x, bottom, colours.ink, across / 4);
  text(si(start + span, 's', 4), 'right', x + across, bottom, colours.ink, across / 4);
  text(`${si(span / ACROSS, 's')}/div`, 'center', x + across / 2, bottom, colours.ink);
  // Marks of 0 V at the left edge, with the number of the channel.
  scales(view, controls).forEach(({ zero }, channel) => {
    if (!outputs[channel] || zero < y || zero > y + up) return;
    context.fillStyle = colours.traces[channel];
    context.beginPath();
    const [w, h] = [0.6 * size, 0.42 * size];
    context.moveTo(x - 1, zero);
    context.lineTo(x - w, zero - h);
    context.lineTo(x - w, zero + h);
    context.fill();
  });
}

/** Limits drawing to the graticule and sets how traces are painted. */
function begin(context, view, colours) {
  context.save();
  context.beginPath();
  context.rect(view.x, view.y, view.across + view.ratio, view.up + view.ratio);
  context.clip();
  context.lineJoin = context.lineCap = 'round';
  // Light adds up on a dark screen; ink on paper does not.
  context.globalCompositeOperation = colours.dark ? 'lighter' : 'source-over';
}

/**
 * Draws a trace against time. A smooth trace is a line through the middles of its columns. A column that reaches
 * beyond this line (noise, an edge) is a bar. The longer the way of the beam in a column, the darker it is.
 */
export function drawColumns(context, view, colours, model, columns, channel, from, to, strength) {
  const total = model.trace.total;
  const pixels = Math.min(total, view.across, WIDEST);
  const { gain, zero } = scales(view, model.controls)[channel];
  const begins = Math.floor((from * pixels) / total);
  const ends = Math.min(pixels, Math.ceil((to * pixels) / total));
  const width = view.across / pixels;
  const overloads = model.lit[channel];
  const limit = FULL_SCALE * (1 - 1e-6);
  counts.fill(0);
  for (let at = begins; at < ends; at += 1) {
    let [low, high] = [Infinity, -Infinity];
    const end = Math.min(to, Math.max(Math.floor(((at + 1) * total) / pixels), Math.floor((at * total) / pixels) + 1));
    for (let column = Math.max(from, Math.floor((at * total) / pixels)); column < end; column += 1) {
      if (columns[2 * column] < low) low = columns[2 * column];
      if (columns[2 * column + 1] > high) high = columns[2 * column + 1];
    }
    const [one, other] = [zero + gain * low, zero + gain * high];
    lows[at] = low <= high ? Math.min(one, other) : NaN;
    highs[at] = Math.max(one, other);
    const way = Math.max(highs[at] - lows[at], at > begins ? Math.abs(lows[at] + highs[at] - lows[at - 1] - highs[at - 1]) / 2 || 0 : 0);
    const bright = Math.hypot(width, way) / width;
    levels[at] = overloads && (high >= limit || low <= -limit) ? LEVELS
      : Math.max(0, LEVELS - 1 - Math.floor(1.05 * Math.log2(bright)));
    counts[levels[at]] += 1;
  }
  begin(context, view, colours);
  for (let level = 0; level <= LEVELS; level += 1) {
    if (counts[level] === 0) continue;
    context.strokeStyle = level === LEVELS ? colours.bad : colours.traces[channel];
    context.beginPath();
    trackColumns(context, level, begins, ends, view.x, width, channel === 1, view.ratio);
    const bright = strength * (level === LEVELS ? 1 : 0.2 + (0.8 * level) / (LEVELS - 1));
    glow(context, view, colours, bright);
    context.lineWidth = 1.6 * view.ratio;
    context.globalAlpha = bright;
    context.stroke();
  }
  context.restore();
}

function glow(context, view, colours, bright) {
  if (!colours.dark || bright < 0.3) return;
  context.lineWidth = 6 * view.ratio;
  context.globalAlpha = 0.14 * bright;
  context.stroke();
}

/** The path of all columns of a level. The second channel is dashed along its way. */
function trackColumns(context, level, begins, ends, left, width, dashed, ratio) {
  const [dash, period] = [9 * ratio, 14 * ratio];
  let way = 0;
  let isDown = false;
  for (let at = begins; at < ends; at += 1) {
    const middle = (lows[at] + highs[at]) / 2;
    const before = at > begins ? (lows[at - 1] + highs[at - 1]) / 2 : NaN;
    const length = Math.hypot(width, middle - before);
    const shown = !dashed || length > dash || way % period < dash;
    if (length === length) way += length;
    if (levels[at] !== level || middle !== middle) {
      isDown = false;
      continue;
    }
    const x = left + (at + 0.5) * width;
    if (before === before && shown) {
      if (!isDown) context.moveTo(x - width, before);
      context.lineTo(x, middle);
      isDown = true;
    } else {
      isDown = false;
    }
    const after = at + 1 < ends ? (lows[at + 1] + highs[at + 1]) / 2 : NaN;
    const [start, end] = [before === before ? (before + middle) / 2 : middle, after === after ? (after + middle) / 2 : middle];
    const alone = before !== before && after !== after;
    if (alone || lows[at] < Math.min(start, middle, end) - ratio || highs[at] > Math.max(start, middle, end) + ratio) {
      context.moveTo(x, lows[at]);
      context.lineTo(x, highs[at] + (alone ? 0.1 : 0));
      isDown = false;
    }
  }
}

/** Draws X-Y curves. It keeps the place of the beam, so that a curve can be drawn as it grows. */
export class Pen {
  x = NaN;
  y = NaN;
  seconds = 0;
  /** Seconds and pixels so far: their ratio is the usual pace, which has medium brightness. */
  time = 0;
  way = 0;
  exposure = 1;
  xs = new Float32Array(GROUP + 1);
  ys = new Float32Array(GROUP + 1);
  levels = new Uint8Array(GROUP + 1);
  used = 0;

  reset() {
    this.x = this.y = NaN;
    this.seconds = this.time = this.way = this.used = 0;
    this.exposure = 1;
  }

  draw(context, view, colours, model, from, to, strength) {
    const [across, up] = scales(view, model.controls);
    const { points } = model.trace;
    const overloads = model.lit[0] || model.lit[1];
    const shortest = 0.8 * view.ratio;
    begin(context, view, colours);
    for (let at = 3 * from; at < 3 * to; at += 3) {
      const x = across.zero + across.gain * points[at];
      const y = up.zero + up.gain * points[at + 1];
      const seconds = points[at + 2];
      if (seconds < 0 || this.x !== this.x) {
        this.flush(context, view, colours, strength);
        [this.x, this.y, this.seconds] = [x, y, 0];
        continue;
      }
      this.seconds += seconds;
      const length = Math.hypot(x - this.x, y - this.y);
      if (length < shortest) continue;
      this.time += this.seconds;
      this.way += length;
      const pace = (this.seconds / length) * (this.way / this.time || 1);
      const over = overloads && Math.max(Math.abs(points[at]), Math.abs(points[at + 1])) >= FULL_SCALE * (1 - 1e-6);
      const level = over ? LEVELS : Math.round(Math.min(LEVELS - 1, Math.max(0, 4 + 1.5 * Math.log2(pace))));
      this.push(x, y, level);
      if (this.used === GROUP) this.flush(context, view, colours, strength);
    }
    this.flush(context, view, colours, strength);
    context.restore();
  }

  push(x, y, level) {
    if (this.used === 0) [this.xs[0], this.ys[0]] = [this.x, this.y];
    this.used += 1;
    [this.xs[this.used], this.ys[this.used], this.levels[this.used]] = [x, y, level];
    [this.x, this.y, this.seconds] = [x, y, 0];
  }

  flush(context, view, colours, strength) {
    if (this.used === 0) return;
    // A long curve is drawn darker, so that it shows where it is dense instead of filling the screen.
    const exposure = Math.max(LEAST_EXPOSURE, 1 / (1 + (3 * this.way * view.ratio) / (view.across * view.up)));
    if (exposure < 0.7 * this.exposure) {
      // What was drawn at the former exposure follows.
      context.globalCompositeOperation = 'destination-out';
      context.globalAlpha = 1 - exposure / this.exposure;
      context.fillRect(view.x, view.y, view.across + 1, view.up + 1);
      context.globalCompositeOperation = colours.dark ? 'lighter' : 'source-over';
      this.exposure = exposure;
    }
    let seen = 0;
    for (let at = 1; at <= this.used; at += 1) seen |= 1 << this.levels[at];
    for (let level = 0; level <= LEVELS; level += 1) {
      if (!(seen & (1 << level))) continue;
      context.strokeStyle = level === LEVELS ? colours.bad : colours.traces[0];
      context.beginPath();
      let isDown = false;
      for (let at = 1; at <= this.used; at += 1) {
        if (this.levels[at] === level) {
          if (!isDown) context.moveTo(this.xs[at - 1], this.ys[at - 1]);
          context.lineTo(this.xs[at], this.ys[at]);
        }
        isDown = this.levels[at] === level;
      }
      const bright = strength * exposure * (0.16 + (0.84 * Math.min(level, LEVELS - 1)) / (LEVELS - 1));
      glow(context, view, colours, bright);
      context.lineWidth = 1.5 * view.ratio;
      context.globalAlpha = bright;
      context.stroke();
    }
    this.used = 0;
  }
}

/** Paints all of a screen on one canvas, for a picture. */
export function drawPicture(context, view, colours, model) {
  drawGrid(context, view, colours, model);
  const { trace } = model;
  if (trace.plane) {
    const pen = new Pen();
    pen.draw(context, view, colours, model, 0, trace.finished, DIM);
    pen.draw(context, view, colours, model, trace.finished, trace.count, 1);
    return;
  }
  for (const { columns } of trace.stored) {
    columns.forEach((each, channel) => drawColumns(context, view, colours, model, each, channel, 0, trace.total, DIM));
  }
  drawLive(context, view, colours, model);
}

/** The present trace, and the one before where the present one has not arrived. */
function drawLive(context, view, colours, model) {
  const { trace } = model;
  const steady = trace.period < STEADY;
  const gap = steady ? 0 : Math.ceil(trace.total / 100);
  trace.columns.forEach((columns, channel) => {
    if (!model.outputs[channel]) return;
    const next = trace.reached + gap;
    if (next < trace.total) {
      drawColumns(context, view, colours, model, columns, channel, next, trace.total, steady ? 1 : DIM);
    }
    if (trace.reached > 0) drawColumns(context, view, colours, model, columns, channel, 0, trace.reached, 1);
  });
}

/** The layers of a screen: graticule, finished traces, present trace. A layer is drawn only if it has changed. */
export class Screen {
  view = layout(10, 10, 1, 12);
  colours = null;
  /** Whether everything must be drawn again. */
  stale = true;
  version = -1;
  changes = -1;
  begun = 0;
  left = NaN;
  /** Number of points drawn, with those that were dropped. */
  drawn = 0;
  /** Numbers of points at the last steps of fading. */
  marks = [];
  /** The clock of the trace at the last step of fading. */
  faded = 0;
  pen = new Pen();

  /** @param {HTMLElement} box @param {HTMLCanvasElement[]} canvases */
  constructor(box, canvases) {
    this.box = box;
    this.canvases = canvases;
    [this.grid, this.old, this.live] = canvases.map((canvas) => canvas.getContext('2d'));
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(this.box.clientWidth * ratio), Math.round(this.box.clientHeight * ratio)];
    this.colours = palette(this.box);
    this.view = layout(width, height, ratio, this.colours.size);
    for (const canvas of this.canvases) [canvas.width, canvas.height] = [width, height];
    this.stale = true;
  }

  /** Draws what has changed since the last time. */
  draw(model) {
    const { trace } = model;
    const { view, colours } = this;
    if (this.stale || this.left !== trace.left) drawGrid(this.grid, view, colours, model);
    this.left = trace.left;
    if (this.stale || this.version !== trace.version) {
      this.redraw(model);
    } else {
      this.fade(model);
      if (this.changes !== trace.changes) this.extend(model);
    }
    this.stale = false;
    [this.version, this.changes, this.begun] = [trace.version, trace.changes, trace.begun];
  }

  clear(context) {
    context.clearRect(0, 0, this.view.width, this.view.height);
  }

  redraw(model) {
    const { trace, controls } = model;
    this.clear(this.old);
    this.clear(this.live);
    this.pen.reset();
    if (!trace.plane) {
      for (const entry of trace.stored) this.drawStored(model, entry);
      drawLive(this.live, this.view, this.colours, model);
      return;
    }
    this.pen.draw(this.old, this.view, this.colours, model, 0, trace.finished, DIM);
    // The parts of a fading curve, from the faintest to the brightest.
    let from = trace.finished;
    const steps = controls.persistence > 0 ? this.marks.length : 0;
    for (let at = 0; at <= steps; at += 1) {
      const to = at < steps ? Math.max(from, this.marks[at] - trace.dropped) : trace.count;
      this.pen.draw(this.live, this.view, this.colours, model, from, Math.min(to, trace.count), (1 - FADE) ** (steps - at));
      from = to;
    }
    this.drawn = trace.dropped + trace.count;
  }

  drawStored(model, entry) {
    const { persistence } = model.controls;
    const strength = persistence > 0 ? DIM * FADED ** ((model.trace.clock - entry.at) / persistence) : DIM;
    entry.isDrawn = true;
    if (strength < FADED * DIM) return;
    entry.columns.forEach((columns, channel) => drawColumns(
      this.old, this.view, this.colours, model, columns, channel, 0, model.trace.total, strength,
    ));
  }

  extend(model) {
    const { trace } = model;
    if (!trace.plane) {
      for (const entry of trace.stored) if (!entry.isDrawn) this.drawStored(model, entry);
      this.clear(this.live);
      drawLive(this.live, this.view, this.colours, model);
      return;
    }
    if (this.begun !== trace.begun) {
      this.old.globalAlpha = DIM;
      this.old.drawImage(this.live.canvas, 0, 0);
      this.clear(this.live);
      this.pen.reset();
      this.marks.length = 0;
      this.drawn = trace.dropped + trace.finished;
    }
    this.pen.draw(this.live, this.view, this.colours, model, Math.max(0, this.drawn - trace.dropped), trace.count, 1);
    this.drawn = trace.dropped + trace.count;
  }

  /** Fades finished traces, and curves behind the spot, in steps that 8 bits resolve. */
  fade({ trace, controls }) {
    const lasts = controls.persistence || (trace.plane && !controls.store ? AFTERGLOW : 0);
    const step = lasts * (Math.log(1 - FADE) / Math.log(FADED));
    const due = lasts > 0 ? Math.floor((trace.clock - this.faded) / step) : 0;
    if (lasts === 0) this.faded = trace.clock;
    if (due <= 0) return;
    this.faded += due * step;
    const left = (1 - FADE) ** due;
    this.darken(this.old, 1 - left);
    if (!trace.plane || controls.persistence === 0) return;
    this.darken(this.live, 1 - left);
    this.pen.time *= left;
    this.pen.way *= left;
    this.marks.push(this.drawn);
    if (this.marks.length > MOST_MARKS) this.marks.shift();
  }

  darken(context, alpha) {
    context.globalAlpha = alpha;
    context.globalCompositeOperation = 'destination-out';
    context.fillRect(0, 0, this.view.width, this.view.height);
    context.globalCompositeOperation = 'source-over';
    context.globalAlpha = 1;
  }

  /** Place of a channel's spot in CSS pixels; null if it is not on the screen. */
  spot({ trace, controls, outputs }, channel) {
    const { view } = this;
    let [x, y] = [this.pen.x, this.pen.y];
    if (!trace.plane) {
      if (!outputs[channel] || trace.reached === 0 || trace.reached >= trace.total || trace.period < STEADY) return null;
      const { gain, zero } = scales(view, controls)[channel];
      x = view.x + (view.across * trace.reached) / trace.total;
      y = zero + gain * trace.valueAt(channel, (trace.reached - 0.5) / trace.total);
    } else if (channel === 1) {
      return null;
    }
    const isInside = x >= view.x && x <= view.x + view.across && y >= view.y && y <= view.y + view.up;
    return isInside ? [x / view.ratio, y / view.ratio] : null;
  }
}
