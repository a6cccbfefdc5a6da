/** What a scope has on its screen: the columns or points of the frames, and the traces that are stored. */

/** Most points of a curve that are kept for redrawing. If there are more, the oldest half is dropped. */
const MOST_POINTS = 1 << 18;
/** Most stored traces that are kept for redrawing. */
const MOST_STORED = 24;
/** Most columns of a trace. A frame with more belongs to a time base that has just been changed. */
const MOST_COLUMNS = 1 << 13;

export class Trace {
  /** Grows when everything must be drawn again. */
  version = 0;
  /** Grows with every change. */
  changes = 0;
  /** Grows when a trace begins. */
  begun = 0;
  plane = false;
  generation = -1;
  /** Numbers of the frames that are ignored after the screen was erased. */
  erased = -1;
  left = 0;
  columnSeconds = 0;
  total = 0;
  reached = 0;
  /** Minimum and maximum of each column. Columns that the trace has not reached keep those of the trace before. */
  columns = [new Float32Array(0), new Float32Array(0)];
  /** @type {{at: number, columns: Float32Array[]}[]} */
  stored = [];
  points = new Float32Array(3 << 10);
  count = 0;
  /** Points before it belong to finished curves. */
  finished = 0;
  /** Points that were dropped. */
  dropped = 0;
  next = 0;
  /** Seconds in which the machine moved: the phosphor fades with them, so that a held picture stays. */
  clock = 0;
  /** Milliseconds at which the trace began, and between the last two beginnings. */
  since = 0;
  period = Infinity;

  reset() {
    this.total = this.reached = this.count = this.finished = this.next = 0;
    this.stored.length = 0;
    this.version += 1;
    this.changes += 1;
  }

  /** Erases the screen. Frames that are still on their way show the erased trace and are ignored. */
  erase() {
    this.erased = this.generation;
    this.reset();
  }

  /**
   * Takes over a frame's part for this scope.
   * @param {any} data
   * @param {number} span seconds from the left to the right edge
   * @param {boolean} stores whether finished traces stay
   * @param {number} now milliseconds
   */
  take(data, span, stores, now) {
    if (data.generation === this.erased) return;
    const plane = data.display === 'plane';
    if (plane !== this.plane || this.erased >= 0) {
      this.plane = plane;
      this.generation = this.erased = -1;
      this.reset();
    }
    const fresh = data.generation !== this.generation;
    if (fresh) {
      this.period = now - this.since;
      this.since = now;
    }
    if (plane) this.takePlane(data, fresh, stores);
    else this.takeTime(data, fresh, span, stores);
  }

  takeTime(data, fresh, span, stores) {
    const total = Math.max(data.reached, Math.round(span / data.columnSeconds) || 1);
    if (total > MOST_COLUMNS) return;
    if (total !== this.total || data.columnSeconds !== this.columnSeconds) {
      this.reset();
      this.total = total;
      this.columnSeconds = data.columnSeconds;
      this.columns = [new Float32Array(2 * total).fill(NaN), new Float32Array(2 * total).fill(NaN)];
    } else if (fresh && stores && this.reached > 0) {
      this.store();
    }
    if (!fresh && data.reached === this.reached && data.left === this.left) return;
    for (let channel = 0; channel < 2; channel += 1) {
      const from = data.channels[channel];
      if (!from) this.columns[channel].fill(NaN);
      else this.columns[channel].set(from);
    }
    this.generation = data.generation;
    this.left = data.left;
    this.reached = data.reached;
    this.changes += 1;
    if (fresh) this.begun += 1;
  }

  /** Keeps the present trace. The oldest one gives its memory to it if there are many. */
  store() {
    const old = this.stored.length === MOST_STORED ? this.stored.shift() : null;
    const entry = old ?? { at: 0, columns: this.columns.map((columns) => columns.slice()) };
    entry.at = this.clock;
    this.columns.forEach((columns, channel) => {
      entry.columns[channel].set(columns);
      entry.columns[channel].fill(NaN, 2 * this.reached);
      columns.fill(NaN);
    });
    this.stored.push(entry);
  }

  takePlane(data, fresh, stores) {
    if (fresh) {
      this.generation = data.generation;
      if (!stores) this.count = 0;
      this.finished = this.count;
      this.next = 0;
      this.begun += 1;
      this.changes += 1;
    }
    const known = Math.max(0, this.next - data.first);
    const more = data.points.length / 3 - known;
    if (more <= 0) return;
    this.makeRoom(more);
    const at = 3 * this.count;
    this.points.set(known > 0 ? data.points.subarray(3 * known) : data.points, at);
    // If points are missing, a line to the first one that follows would show a path that the beam never took.
    if (data.first > this.next || this.next === 0) this.points[at + 2] = -1;
    this.count += more;
    this.next = data.first + known + more;
    this.changes += 1;
  }

  makeRoom(more) {
    if (this.count + more > MOST_POINTS) {
      const shift = this.count - Math.min(this.count, MOST_POINTS >> 1);
      this.points.copyWithin(0, 3 * shift, 3 * this.count);
      this.count -= shift;
      this.finished = Math.max(0, this.finished - shift);
      this.dropped += shift;
    }
    if (3 * (this.count + more) > this.points.length) {
      const larger = new Float32Array(Math.max(2 * this.points.length, 3 * (this.count + more)));
      larger.set(this.points.subarray(0, 3 * this.count));
      this.points = larger;
    }
  }

  /** Minimum and maximum of a channel on the screen; null if it has no trace. */
  extent(channel) {
    let low = Infinity;
    let high = -Infinity;
    const values = this.plane ? this.points : this.columns[channel];
    const end = this.plane ? 3 * this.count : values.length;
    for (let at = this.plane ? channel : 0; at < end; at += this.plane ? 3 : 1) {
      if (values[at] < low) low = values[at];
      if (values[at] > high) high = values[at];
    }
    return low <= high ? [low, high] : null;
  }

  /** Volts of a channel in the middle of a column, at a share of the screen; NaN if it has no trace there. */
  valueAt(channel, share) {
    const at = 2 * Math.min(this.total - 1, Math.floor(share * this.total));
    return this.total > 0 ? (this.columns[channel][at] + this.columns[channel][at + 1]) / 2 : NaN;
  }

  /** Mean period of a channel in seconds, from its rising passages through the middle; 0 if it has none. */
  periodOf(channel) {
    const [low, high] = this.extent(channel) ?? [0, 0];
    const [below, above] = [low + 0.35 * (high - low), low + 0.65 * (high - low)];
    let armed = false;
    let first = -1;
    let last = -1;
    let passages = 0;
    for (let column = 0; column < this.reached; column += 1) {
      if (this.columns[channel][2 * column] < below) armed = true;
      if (armed && this.columns[channel][2 * column + 1] > above) {
        armed = false;
        if (first < 0) first = column;
        last = column;
        passages += 1;
      }
    }
    return passages > 1 ? ((last - first) / (passages - 1)) * this.columnSeconds : 0;
  }
}
