// What the page's oscilloscope keeps of the frames, and its steps and readings.

import assert from 'node:assert/strict';
import test from 'node:test';

import { quantity } from '../../page/js/dom.js';
import { reading } from '../../page/js/probes.js';
import { series } from '../../page/js/scope-controls.js';
import { scales } from '../../page/js/scope-grid.js';
import { Trace } from '../../page/js/scope-trace.js';

const time = (generation, values) => ({
  display: 'time', generation, left: 0, columnSeconds: 0.5, reached: values.length,
  channels: [Float32Array.from(values.flatMap((value) => [value, value + 2])), null],
});
const plane = (generation, first, ...points) => ({ display: 'plane', generation, first, points: Float32Array.from(points.flat()) });

test('A new trace leaves the one before in the columns that it has not reached', () => {
  const trace = new Trace();
  trace.take(time(1, [1, 2, 3, 4]), 2, false, 0);
  trace.take(time(2, [9]), 2, false, 1000);
  assert.deepEqual([0, 0.3, 0.6, 0.9].map((share) => trace.valueAt(0, share)), [10, 3, 4, 5]);
  assert.ok(Number.isNaN(trace.valueAt(1, 0)));
});

test('Finished traces are stored, and an erasure removes them together with a late frame', () => {
  const trace = new Trace();
  trace.take(time(1, [1, 2, 3, 4]), 2, true, 0);
  trace.take(time(2, [9]), 2, true, 1000);
  assert.deepEqual([...trace.stored[0].columns[0]], [1, 3, 2, 4, 3, 5, 4, 6]);
  assert.ok(Number.isNaN(trace.valueAt(0, 0.5)));
  trace.erase(2000);
  trace.take(time(2, [9, 9]), 2, true, 2010);
  trace.take(time(3, [5]), 2, true, 2030);
  assert.equal(trace.stored.length, 0);
  assert.deepEqual(trace.extent(0), [5, 7]);
});

test('The points of a frame replace provisional ones', () => {
  const trace = new Trace();
  trace.take(plane(1, 0, [0, 0, -1], [1, 1, 0.5], [2, 1, 0.25]), 1, false, 0);
  trace.take(plane(1, 2, [3, 1, 0.5], [3, 4, 1]), 1, false, 20);
  assert.deepEqual([...trace.points.subarray(0, 3 * trace.count)], [0, 0, -1, 1, 1, 0.5, 3, 1, 0.5, 3, 4, 1]);
  assert.equal(trace.replaced, 0.25);
  assert.deepEqual([trace.extent(0), trace.extent(1)], [[0, 3], [0, 4]]);
  trace.take(plane(2, 0, [7, 7, -1]), 1, true, 40);
  assert.deepEqual([trace.finished, trace.count], [4, 5]);
});

test('Points that are missing begin a new curve', () => {
  const trace = new Trace();
  trace.take(plane(1, 0, [0, 0, -1]), 1, false, 0);
  trace.take(plane(1, 5, [1, 1, 0.5]), 1, false, 20);
  assert.equal(trace.points[5], -1);
});

test('The period of a sine', () => {
  const trace = new Trace();
  const values = Array.from({ length: 1000 }, (_, at) => 50 * Math.sin((2 * Math.PI * at) / 125));
  trace.take(time(1, values), 500, false, 0);
  assert.ok(Math.abs(trace.periodOf(0) - 62.5) < 0.5);
});

test('An oscillation that ends, or that begins late, has no period', () => {
  const wave = (first, last) => Array.from({ length: 1000 }, (_, at) => (at < first || at > last ? 0 : 50 * Math.sin((2 * Math.PI * at) / 25)));
  for (const [first, last, period] of [[0, 999, 12.5], [0, 960, 12.5], [0, 900, 0], [100, 999, 0], [0, 20, 0]]) {
    const trace = new Trace();
    trace.take(time(1, wave(first, last)), 500, false, 0);
    assert.ok(Math.abs(trace.periodOf(0) - period) < 0.1, `${first} to ${last}: ${trace.periodOf(0)}`);
  }
});

test('Steps are round values from the first to the last', () => {
  assert.deepEqual(series(0.002, 0.1), [0.002, 0.0025, 0.005, 0.01, 0.02, 0.025, 0.05, 0.1]);
  assert.deepEqual(series(3, 50), [5, 10, 20, 25, 50]);
});

test('Readings', () => {
  assert.equal(quantity(2e-5, 's'), '20\u202fµs');
  assert.equal(quantity(-1500, 'mm', 4), '−1500\u202fmm');
  assert.equal(quantity(NaN, 'V'), '—');
  assert.equal(reading(-20, { signal: 'v', unit: 'mm', per_volt: -4 }), '−20\u202fV = 80\u202fmm');
});

test('Volts upwards, and downwards if the channel is inverted', () => {
  const view = { x: 0, y: 0, across: 100, up: 80, dx: 10, dy: 10 };
  const channel = { inverted: false, volts_per_division: 20, centre: 10 };
  const [up, down] = scales(view, { display: 'time', channels: [channel, { ...channel, inverted: true }] });
  assert.deepEqual([up.zero + 30 * up.gain, down.zero + 30 * down.gain], [30, 50]);
});
