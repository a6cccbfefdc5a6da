import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';

import { decode } from '../../page/js/frame.js';

/** A frame that a test of crates/panel/src/frame.rs writes. */
const bytes = readFileSync(new URL('../frame.bin', import.meta.url));
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);

test('a frame has everything', () => {
  assert.deepEqual(decode(buffer), {
    revision: 7,
    time: 3,
    factor: 0.5,
    moves: true,
    paused: false,
    overload: true,
    stopped: false,
    firstLamp: 2,
    repetitions: 5,
    meter: -12.5,
    nullMeter: null,
    volts: new Float32Array([100, -100, 0.25]),
    lamps: new Uint8Array([0, 0, 1]),
    scopes: [
      {
        display: 'time',
        generation: 2,
        left: 0,
        columnSeconds: 1,
        reached: 4,
        channels: [new Float32Array([0, 10, 10, 20, 20, 30, -30, 30]), null],
      },
      {
        display: 'plane',
        generation: 4,
        first: 0,
        points: new Float32Array([0, 0, -1, 10, 0, 1, 10, 10, 1, 0, 10, 0]),
      },
    ],
  });
});

test('arrays are views of the buffer', () => {
  const frame = decode(buffer);
  const arrays = [frame.volts, frame.lamps, frame.scopes[0].channels[0], frame.scopes[1].points];
  assert.ok(arrays.every((array) => array.buffer === buffer));
});

test('other data are refused', () => {
  assert.throws(() => decode(new ArrayBuffer(100)), /not a frame/);
  for (let length = 0; length < buffer.byteLength; length += 1) {
    assert.throws(() => decode(buffer.slice(0, length)));
  }
});
