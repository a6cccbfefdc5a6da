/** What the pictures of the scopes show: where a trace is dense, and the time base that fits it. */

import assert from 'node:assert/strict';
import { test } from 'node:test';

import { exportOf, FIG_8_16, openPanel, probe, scopeOf, stateOf, sweepOnce, until } from './panel.mjs';

const TWO_PHASE = 'patches/lessons/two-phase-oscillator.json';

/** Gives a scope the scales that fit its traces. Returns its controls. */
async function autoSet(page, number) {
  const erased = await stateOf(page);
  await scopeOf(page, number).getByRole('button', { name: 'Auto-set' }).click();
  await until('other scales', async () => JSON.stringify((await stateOf(page)).scopes) !== JSON.stringify(erased.scopes));
  return (await stateOf(page)).scopes[number - 1];
}

/** Draws one sweep of Fig 8.16 with scales that fit it. */
async function drawnSweep(t, ...outputs) {
  const page = await openPanel(t, { patch: FIG_8_16 });
  if (outputs.length > 0) await probe(page, 2, ...outputs);
  await sweepOnce(page);
  await autoSet(page, 2);
  await sweepOnce(page);
  return page;
}

/** The brightness of the present trace of a scope, 0 to 255, row by row, as soon as it does not change any more. */
async function brightnessOf(page, number) {
  const canvas = scopeOf(page, number).locator('canvas').last();
  let before = '';
  await until('a picture that is complete', async () => {
    const picture = await canvas.evaluate((node) => node.toDataURL());
    const isComplete = picture === before;
    before = picture;
    return isComplete;
  });
  return canvas.evaluate((node) => {
    const { data, width, height } = node.getContext('2d').getImageData(0, 0, node.width, node.height);
    return Array.from({ length: height }, (_, row) => Array.from({ length: width }, (_, column) => data[4 * (row * width + column) + 3]));
  });
}

/** The longest piece of a column that is painted: its height, and the mean brightness in its middle. */
function pieceOf(picture, column) {
  let [height, end, run] = [0, 0, 0];
  picture.forEach((row, at) => {
    run = row[column] > 60 ? run + 1 : 0;
    if (run > height) [height, end] = [run, at + 1];
  });
  const middle = picture.slice(Math.round(end - 0.7 * height), Math.round(end - 0.3 * height));
  return { height, brightness: middle.reduce((sum, row) => sum + row[column], 0) / middle.length };
}

test('a dense X-Y trace shows where it is dense, without a border where its density is the same', async (t) => {
  const page = await drawnSweep(t);
  const picture = await brightnessOf(page, 2);
  const painted = picture.flat().filter((each) => each > 20);
  assert.ok(painted.length > 5000, `${painted.length} pixels are painted`);
  for (const [name, least, most] of [['dark', 25, 95], ['medium', 120, 190], ['bright', 215, 255]]) {
    const share = painted.filter((each) => each >= least && each <= most).length / painted.length;
    assert.ok(share > 0.02, `${(100 * share).toFixed(1)} % of the pixels are ${name}`);
  }
  const pieces = picture[0].map((_, column) => pieceOf(picture, column));
  const highest = Math.max(...pieces.map(({ height }) => height));
  let compared = 0;
  pieces.slice(1).forEach((piece, at) => {
    const before = pieces[at];
    if (Math.min(piece.height, before.height) < 0.6 * highest || Math.abs(piece.height - before.height) > 3) return;
    compared += 1;
    const step = Math.abs(piece.brightness - before.brightness);
    assert.ok(step < 12, `brightness ${before.brightness.toFixed(0)} is next to ${piece.brightness.toFixed(0)} at column ${at + 1}`);
  });
  assert.ok(compared > 40, `${compared} columns were compared`);
});

test('the brightness of an exported X-Y trace follows its speed in steps that are not visible', async (t) => {
  const page = await drawnSweep(t, 'B3', 'A5');
  const { content } = await exportOf(page, 2, 'SVG');
  const widths = /stroke-width="1.6" stroke-opacity="([\d.]+)"/g;
  const opacities = [...new Set(Array.from(String(content).matchAll(widths), ([, opacity]) => Number(opacity)))].sort((one, other) => one - other);
  assert.ok(opacities.length > 12, `${opacities.length} opacities`);
  assert.ok(opacities.at(-1) > 2.5 * opacities[0], `opacities ${opacities[0]} to ${opacities.at(-1)}`);
  opacities.slice(1).forEach((opacity, at) => assert.ok(opacity < 1.2 * opacities[at], `${opacities[at]} is next to ${opacity}`));
});

test('auto-set shows a few periods of a steady oscillation, and one sweep if the oscillation ends', async (t) => {
  for (const [patch, seconds] of [[TWO_PHASE, 0.5], [FIG_8_16, 0]]) {
    const page = await openPanel(t, { patch });
    await sweepOnce(page);
    const { seconds_per_division: chosen } = await autoSet(page, 1);
    assert.equal(chosen, seconds, `${patch}: seconds per division`);
  }
});
