// Frames as crates/panel/src/frame.rs documents them.

/** The modes of the machine in the order of their numbers. */
const MODES = ['pot-set', 'problem-check', 'initial-condition', 'operate', 'hold', 'repetitive', 'single'];

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
 * @typedef {{revision: number, time: number, factor: number, mode: string, moves: boolean, paused: boolean,
 *   overload: boolean, stopped: boolean, firstLamp: number|null, repetitions: number, meter: number|null,
 *   nullMeter: number|null, volts: Float32Array, lamps: Uint8Array, scopes: (TimePicture|PlanePicture)[]}} Frame
 */

/**
 * The content of a frame. Arrays of numbers are views of the buffer. They need a machine that is little-endian, as all
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

  if (u32() !== 0x31464350) throw new Error('The data of the machine are not a frame.');
  const frame = { revision: u32(), time: f64(), factor: f64() };
  const flags = view.getUint8(25);
  const firstLamp = view.getUint16(26, true);
  Object.assign(frame, {
    mode: MODES[view.getUint8(24)],
    moves: (flags & 1) > 0,
    paused: (flags & 2) > 0,
    overload: (flags & 4) > 0,
    stopped: (flags & 8) > 0,
    firstLamp: firstLamp ? firstLamp - 1 : null,
  });
  at = 28;
  frame.repetitions = u32();
  frame.meter = volts();
  frame.nullMeter = volts();
  const outputs = u32();
  frame.volts = floats(outputs);
  frame.lamps = new Uint8Array(buffer, at, outputs);
  at += Math.ceil(outputs / 4) * 4;

  const picture = () => {
    const isPlane = u32() === 1;
    const generation = u32();
    const used = u32();
    if (isPlane) {
      const first = used ? u32() : 0;
      return { display: 'plane', generation, first, points: floats(used ? 3 * u32() : 0) };
    }
    const left = f64();
    const columnSeconds = f64();
    const reached = u32();
    const bits = u32();
    const channels = [1, 2].map((bit) => (bits & bit ? floats(2 * reached) : null));
    return { display: 'time', generation, left, columnSeconds, reached, channels };
  };
  frame.scopes = [picture(), picture()];
  return frame;
}
