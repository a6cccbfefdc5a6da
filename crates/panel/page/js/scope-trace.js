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
  plane = false;
  generation = -1;
  left = 0;
  columnSeconds = 0;
  total = 0;
  reached = 0;
  /** Minimum and maximum of each column. Columns that the trace has not reached keep those of the trace before. */
  columns = [new Float32Array(0), new Float32Array(0)];
  stored = [];
  /** x, y and seconds of finished curves, then from `finished` those of the present one. */
  points = new Float32Array(3 << 12);
  count = 0;
  finished = 0;
  /** Seconds of provisional points that later points replaced. */
  replaced = 0;
  /** Seconds in which the machine moved. The phosphor fades with them, so that a held picture stays. */
  clock = 0;
  since = -Infinity;
  /** Milliseconds between the last two traces. */
  period = Infinity;
  erasedAt = -Infinity;

  erase(now) {
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
    const isFresh = data.generation !== this.generation;
    if ((data.display === 'plane') !== this.plane || (isFresh && now - this.erasedAt < LATE)) this.reset();
    this.plane = data.display === 'plane';
    if (isFresh) {
      this.period = now - this.since;
      this.since = now;
      this.begun += 1;
      this.changes += 1;
    }
    if (this.plane) this.takePlane(data, isFresh, stores);
    else this.takeTime(data, isFresh, span, stores);
    this.generation = data.generation;
  }

  takeTime(data, isFresh, span, stores) {
    const total = Math.max(data.reached, Math.min(MOST_COLUMNS, Math.round(span / data.columnSeconds) || 1));
    if (total !== this.total || data.columnSeconds !== this.columnSeconds) {
      this.reset();
      this.total = total;
      this.columns = [0, 1].map(() => new Float32Array(2 * total).fill(NaN));
    } else if (isFresh && stores && this.reached > 0) {
      if (this.stored.length === MOST_STORED) this.stored.shift();
      this.stored.push({ at: this.clock, columns: this.columns.map((columns) => columns.slice().fill(NaN, 2 * this.reached)) });
      for (const columns of this.columns) columns.fill(NaN);
    } else if (!isFresh && data.reached === this.reached && data.left === this.left) {
      return;
    }
    for (let channel = 0; channel < 2; channel += 1) {
      if (data.channels[channel]) this.columns[channel].set(data.channels[channel]);
    }
    [this.left, this.columnSeconds, this.reached] = [data.left, data.columnSeconds, data.reached];
    this.changes += 1;
  }

  takePlane(data, isFresh, stores) {
    if (isFresh) this.finished = stores ? this.count : 0;
    if (isFresh && !stores) this.count = 0;
    const more = (data.points?.length ?? 0) / 3;
    if (more === 0) return;
    const known = this.count - this.finished;
    // The last point of a frame is provisional. If more is replaced, the machine was moved back.
    if (data.first < known - 1) this.version += 1;
    for (let at = data.first; at < known; at += 1) this.replaced += this.points[3 * (this.finished + at) + 2];
    this.count = this.finished + Math.min(data.first, known);
    if (this.count + more > MOST_POINTS) {
      this.points.copyWithin(0, 3 * this.finished, 3 * this.count);
      [this.count, this.finished] = [this.count - this.finished, 0];
    }
    if (3 * (this.count + more) > this.points.length) {
      const larger = new Float32Array(Math.max(2 * this.points.length, 3 * (this.count + more)));
      larger.set(this.points);
      this.points = larger;
    }
    this.points.set(data.points, 3 * this.count);
    // A line across points that are missing would be a way that the beam never took.
    if (data.first > known || data.first === 0) this.points[3 * this.count + 2] = -1;
    this.count += more;
    this.changes += 1;
  }

  /** Minimum and maximum of a channel on the screen. */
  extent(channel) {
    let [low, high] = [Infinity, -Infinity];
    const [values, first, end, step] = this.plane ? [this.points, channel, 3 * this.count, 3]
      : [this.columns[channel], 0, 2 * this.total, 1];
    for (let at = first; at < end; at += step) {
      if (values[at] < low) low = values[at];
      if (values[at] > high) high = values[at];
    }
    return [low, high];
  }

  /** Volts of a channel at a share of the screen: the middle of a column. NaN if it has no trace there. */
  valueAt(channel, share) {
    const at = 2 * Math.min(this.total - 1, Math.floor(share * this.total));
    return this.total > 0 ? (this.columns[channel][at] + this.columns[channel][at + 1]) / 2 : NaN;
  }

  /** Mean period of a channel in seconds, from its rising passages through the middle; 0 if it has none. */
  periodOf(channel) {
    const [low, high] = this.extent(channel);
    const columns = this.columns[channel];
    let [isBelow, first, last, passages] = [false, 0, 0, 0];
    for (let column = 0; column < this.reached; column += 1) {
      if (columns[2 * column] < low + 0.35 * (high - low)) isBelow = true;
      if (!isBelow || !(columns[2 * column + 1] > low + 0.65 * (high - low))) continue;
      if (passages === 0) first = column;
      [isBelow, last, passages] = [false, column, passages + 1];
    }
    return passages > 1 ? ((last - first) / (passages - 1)) * this.columnSeconds : 0;
  }
}
