/** What a scope has on its screen: the columns or points of the frames, and the traces that are stored. */

/** Most points of curves, and most stored traces, that are kept for drawing them again. */
const [MOST_POINTS, MOST_STORED] = [1 << 18, 24];
/** Most columns: more are a time base that the session does not have yet. */
const MOST_COLUMNS = 1 << 12;
/** Milliseconds after an erasure in which the next trace removes what late frames brought. */
const LATE = 500;

export class Trace {
  /** They grow when everything must be drawn again, when anything changes, when a trace begins. */
  version = 0;
  changes = 0;
  begun = 0;
  left = 0;
  /** Minimum and maximum of each column. Columns that the trace has not reached keep those of the trace before. */
  columns = [[], []];
  stored = [];
  /** x, y and seconds of finished curves, then from `finished` those of the present one. */
  points = new Float32Array(3 << 12);
  /** Seconds of provisional points that later points replaced. */
  replaced = 0;
  /** Seconds in which the machine moved. The phosphor fades with them, so that a held picture stays. */
  clock = 0;
  /** Milliseconds between the last two traces. */
  period = Infinity;
  erasedAt = -Infinity;

  constructor() {
    this.reset();
  }

  erase(now = performance.now()) {
    this.erasedAt = now;
    this.reset();
  }

  reset() {
    this.total = this.reached = this.count = this.finished = this.stored.length = 0;
    this.since = -Infinity;
    this.version += 1;
  }

  /** Takes over a frame's part for this scope. `span` is the width of the screen in seconds. */
  take(data, span, stores, now) {
    const { generation, display } = data;
    const [isFresh, plane] = [generation !== this.generation, display === 'plane'];
    if (plane !== this.plane || (isFresh && now - this.erasedAt < LATE)) this.reset();
    Object.assign(this, { plane, generation });
    if (isFresh) {
      this.period = now - this.since;
      this.since = now;
      this.begun += 1;
    }
    const changes = plane ? this.takePlane(data, isFresh, stores) : this.takeTime(data, isFresh, span, stores);
    if (isFresh || changes) this.changes += 1;
  }

  /** Takes over columns, and returns whether there are any. */
  takeTime({ channels, left, columnSeconds, reached }, isFresh, span, stores) {
    const total = Math.max(reached, Math.min(MOST_COLUMNS, Math.round(span / columnSeconds) || 1));
    if (total !== this.total || columnSeconds !== this.columnSeconds) {
      this.reset();
      this.columns = channels.map(() => new Float32Array(2 * total).fill(NaN));
    } else if (isFresh && stores && this.reached > 0) {
      if (this.stored.length === MOST_STORED) this.stored.shift();
      this.stored.push({ at: this.clock, columns: this.columns.map((columns) => columns.slice().fill(NaN, 2 * this.reached)) });
      for (const columns of this.columns) columns.fill(NaN);
    } else if (!isFresh && reached === this.reached && left === this.left) return false;
    channels.forEach((values, channel) => { if (values) this.columns[channel].set(values); });
    return Object.assign(this, { left, columnSeconds, reached, total });
  }

  /** Takes over points, and returns whether there are any. */
  takePlane({ first, points: added = [] }, isFresh, stores) {
    if (isFresh && !stores) this.count = 0;
    if (isFresh) this.finished = this.count;
    const more = added.length / 3;
    if (more === 0) return false;
    const known = this.count - this.finished;
    // The last point of a frame is provisional. If more is replaced, the machine was moved back.
    if (first < known - 1) this.version += 1;
    for (let at = first; at < known; at += 1) this.replaced += this.points[3 * (this.finished + at) + 2];
    this.count = this.finished + Math.min(first, known);
    if (this.count + more > MOST_POINTS) {
      this.points.copyWithin(0, 3 * this.finished, 3 * this.count);
      [this.count, this.finished] = [this.count - this.finished, 0];
    }
    const { count, points } = this;
    if (3 * (count + more) > points.length) {
      this.points = new Float32Array(6 * (count + more));
      this.points.set(points);
    }
    this.points.set(added, 3 * count);
    // A line across points that are missing would be a way that the beam never took.
    if (first > known || first === 0) this.points[3 * count + 2] = -1;
    return (this.count += more);
  }

  /** Minimum and maximum of a channel on the screen. */
  extent(channel) {
    const { plane, points, columns, count, total } = this;
    let [low, high] = [Infinity, -Infinity];
    const [values, first, end, step] = plane ? [points, channel, 3 * count, 3] : [columns[channel], 0, 2 * total, 1];
    for (let at = first; at < end; at += step) {
      if (values[at] < low) low = values[at];
      if (values[at] > high) high = values[at];
    }
    return [low, high];
  }

  /** Volts of a channel at a share of the screen: the middle of a column. NaN if it has no trace there. */
  valueAt(channel, share) {
    const [at, values] = [2 * Math.min(this.total - 1, Math.floor(share * this.total)), this.columns[channel]];
    return (values[at] + values[at + 1]) / 2;
  }

  /**
   * Mean period of a channel in seconds, from its rising passages through the middle. 0 if it has none, or if it does not
   * oscillate all the time: then a few periods would not show its essential motion.
   */
  periodOf(channel) {
    const [low, high] = this.extent(channel);
    const columns = this.columns[channel];
    const at = [0];
    let isBelow = false;
    for (let column = 0; column < this.reached; column += 1) {
      if (columns[2 * column] < low + 0.35 * (high - low)) isBelow = true;
      if (!isBelow || !(columns[2 * column + 1] > low + 0.65 * (high - low))) continue;
      isBelow = false;
      at.push(column);
    }
    const period = (at.at(-1) - at[1]) / (at.length - 2);
    at.push(this.reached);
    return at.every((column, index) => !(column - at[index - 1] > 2.5 * period)) ? period * this.columnSeconds || 0 : 0;
  }
}
