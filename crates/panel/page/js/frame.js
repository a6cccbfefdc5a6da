// Frames as crates/panel/src/frame.rs documents them.

/**
 * The present trace against time. A channel in use has minimum and maximum of each column in turn, NaN if it is empty.
 * @typedef {{display: 'time', generation: number, left: number, columnSeconds: number, reached: number,
 *   channels: [Float32Array|null, Float32Array|null]}} TimePicture
 */
/**
 * New points of an X-Y curve: x, y and seconds for each. They replace those from index `first` on.
 * @typedef {{display: 'plane', generation: number, first: number, points: Float32Array}} PlanePicture
 */
/**
 * @typedef {{revision: number, time: number, factor: number, moves: boolean, paused: boolean,
 *   overload: boolean, stopped: boolean, firstLamp: number|null, repetitions: number, meter: number|null,
 *   nullMeter: number|null, volts: Float32Array, lamps: Uint8Array, scopes: (TimePicture|PlanePicture)[]}} Frame
 */

/**
 * The content of a frame, except for the mode, which the events have too. Arrays of numbers are views of the buffer. They need a machine that is little-endian, as all
 * are that run browsers.
 * @param {ArrayBuffer} buffer
 * @returns {Frame}
 */
export function decode(buffer) {
  const view = new DataView(buffer);
  let at = 0;
  const u32 = () => view.getUint32((at += 4) - 4, true);
  const f64 = () => view.getFloat64((at += 8) - 8, true);
  const volts = () => { const value = f64(); return Number.isNaN(value) ? null : value; };
  const floats = (count) => new Float32Array(buffer, (at += 4 * count) - 4 * count, count);
  const picture = () => {
    const [isPlane, generation, used] = [u32(), u32(), u32()];
    if (isPlane) return { display: 'plane', generation, first: used && u32(), points: floats(used && 3 * u32()) };
    const [left, columnSeconds, reached, bits] = [f64(), f64(), u32(), u32()];
    const channels = [1, 2].map((bit) => (bits & bit ? floats(2 * reached) : null));
    return { display: 'time', generation, left, columnSeconds, reached, channels };
  };

  if (u32() !== 0x31464350) throw new Error('The data of the machine are not a frame.');
  const frame = { revision: u32(), time: f64(), factor: f64() };
  // Four bytes: the mode, flags, and two for the lamp that lit first.
  const word = u32();
  const lamp = word >>> 16;
  ['moves', 'paused', 'overload', 'stopped'].forEach((name, bit) => { frame[name] = ((word >> (8 + bit)) & 1) > 0; });
  Object.assign(frame, { firstLamp: lamp ? lamp - 1 : null, repetitions: u32(), meter: volts(), nullMeter: volts() });
  const outputs = u32();
  frame.volts = floats(outputs);
  frame.lamps = new Uint8Array(buffer, at, outputs);
  at += Math.ceil(outputs / 4) * 4;
  frame.scopes = [picture(), picture()];
  return frame;
}
