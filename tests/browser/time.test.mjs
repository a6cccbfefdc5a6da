/** The time of a run: how fast it passes, and the way back in it. */

import assert from 'node:assert/strict';
import { test } from 'node:test';

import { exportOf, openPanel, ready, rowsOf, scopeOf, select, stateOf, sweepOnce, until } from './panel.mjs';

const slider = (page) => page.getByRole('slider', { name: /Time in this run/ });
const frameOf = async (page) => (await stateOf(page)).frame;

/** Waits for a frame of the resting machine at a time, within a step of 1 ms. */
const isAt = (page, time) => until(`${time} s`, async () => {
  const frame = await frameOf(page);
  return frame && !frame.moves && Math.abs(frame.time - time) < 1.1e-3 && frame;
});

/** An oscillator that takes a thousand million steps for each second, which no computer can take in real time. */
const SLOW = {
  patchcord: 1, title: 'Slow', run: { for: 1, step: 1e-9, every: 0.01 }, record: ['A1'],
  elements: {
    A1: { kind: 'integrator', in: { x1: ['A2'] }, initial: 80 }, A2: { kind: 'integrator', in: { x1: ['B1'] } }, B1: { kind: 'inverter', in: 'A1' },
  },
};

test('the panel shows by what factor a run is slower than real time', async (t) => {
  const page = await openPanel(t);
  const pace = page.getByRole('region', { name: 'Machine' }).getByText(/ times too slow for this computer$/);
  await select(page, 'Operate');
  await until('a run in real time', async () => (await frameOf(page))?.time > 0.5);
  assert.equal(await pace.count(), 0);
  await page.getByLabel('Patch file').setInputFiles({ name: 'slow.json', mimeType: 'application/json', buffer: Buffer.from(JSON.stringify(SLOW)) });
  await ready(page, SLOW.title);
  await select(page, 'Operate');
  await pace.waitFor();
  // Seconds of the clock for each second of the problem, over many frames. An advance covers at most 0.1 s.
  const measured = await page.evaluate(async () => {
    const { on, state } = await import(new URL('js/state.js', document.baseURI).href);
    return new Promise((resolve) => {
      let [count, seconds, last, begin] = [0, 0, performance.now(), state.frame.time];
      on('frame', ({ time }) => {
        const now = performance.now();
        [seconds, last, count] = [seconds + Math.min(0.1, (now - last) / 1000), now, count + 1];
        if (count === 40) resolve(seconds / (time - begin));
      });
    });
  });
  assert.ok(measured > 10, `${measured} times slower`);
  // The number is a mean over the last frames, which approaches this value.
  await until(`about ${measured.toFixed(0)} times`, async () => {
    const shown = parseFloat(await pace.textContent());
    return shown > measured / 3 && shown < 3 * measured;
  });
  await select(page, 'Hold');
  await pace.waitFor({ state: 'detached' });
});

test('everything follows the slider back and forward, and the later part of the run stays until it continues', async (t) => {
  const page = await openPanel(t);
  await sweepOnce(page);
  const end = (await frameOf(page)).time;
  const [scrub, spots] = [slider(page), scopeOf(page, 1).locator('.scope-spot')];
  const { x, y, width, height } = await scrub.boundingBox();
  const move = (share) => page.mouse.move(x + share * width, y + height / 2, { steps: 5 });
  const w = Math.sqrt(40);
  /** Checks voltages, meter and scope at the time that the slider shows. */
  async function follows() {
    const { time, volts, meter } = await isAt(page, Number(await scrub.inputValue()));
    assert.equal((await stateOf(page)).machine.mode, 'hold');
    assert.ok(Math.abs(volts.B1 - 80 * Math.cos(w * time)) < 1e-3, `${volts.B1} V at ${time} s`);
    assert.equal(Math.fround(meter), volts.B1);
    await spots.first().waitFor();
    const [screen, spot] = await Promise.all([scopeOf(page, 1).locator('canvas').first().boundingBox(), spots.first().boundingBox()]);
    const share = (spot.x + spot.width / 2 - screen.x) / screen.width;
    // The graticule is narrower than the screen.
    assert.ok(Math.abs(share - (0.04 + (0.92 * time) / end)) < 0.04, `the spot is at ${share} of the screen at ${time} s`);
    assert.equal(Number(await scrub.getAttribute('max')), end);
    return time;
  }
  await move(0.999);
  await page.mouse.down();
  const times = [];
  // The button of the mouse stays pressed.
  for (const share of [0.5, 0.2, 0.8]) {
    await move(share);
    times.push(await follows());
  }
  assert.ok(times[1] < times[0] && times[0] < times[2], times.join());
  await page.mouse.up();
  await page.keyboard.press('ArrowLeft');
  assert.ok(await follows() < times[2]);
  const rows = rowsOf(String((await exportOf(page, 1, 'CSV')).content));
  assert.ok(rows.at(-1).t > 0.99 * end, 'the trace stays');
  await scrub.focus();
  await page.keyboard.press('End');
  assert.equal(await follows(), end);
  await scrub.fill('0.5');
  await follows();
  // The run continues from here, and its end is where it is.
  await page.getByRole('button', { name: 'Real time' }).click();
  await select(page, 'Operate');
  await until('the run continues', async () => (await frameOf(page))?.time > 0.6);
  await select(page, 'Hold');
  const held = await until('hold', async () => { const frame = await frameOf(page); return frame && !frame.moves && frame; });
  await until('the slider ends here', async () => Number(await scrub.getAttribute('max')) === held.time);
  assert.ok(Math.abs(held.volts.B1 - 80 * Math.cos(w * held.time)) < 1e-3, `${held.volts.B1} V at ${held.time} s`);
});
