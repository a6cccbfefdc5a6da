/** What the panel must be able to do, each as a user does it. */

import assert from 'node:assert/strict';
import { test } from 'node:test';

import { cordIs, cordLine, inputJack, pull, showBoard } from './board.mjs';
import {
  command, exportOf, FIG_8_16, FORM, kept, knobOf, modeButton, openPanel, parameterIs, picturesOf, probe, ready, rowsOf, scopeOf,
  select, stateOf, sweepOnce, type, undoButton, until,
} from './panel.mjs';

/** Seconds of Fig 8.16 that show the sliding velocity. */
const BEGINNING = 0.5;

const pc2 = async (page) => (await stateOf(page)).patch.elements.find(({ name }) => name === 'PC2')
  .settings.find(({ name }) => name === 'setting').value;

test('Fig 8.16: PC2 is turned by its parameter and by itself, and the trace changes', async (t) => {
  const page = await openPanel(t, { patch: FIG_8_16 });
  await page.getByLabel('Sweep, s').fill(String(BEGINNING));
  await page.keyboard.press('Enter');
  await until('the sweep is shorter', async () => (await stateOf(page)).machine.sweep === BEGINNING);
  await probe(page, 1, 'PC2', 'B2');
  await sweepOnce(page);
  const [before, pictures] = [String((await exportOf(page, 1, 'CSV')).content), await picturesOf(page, 1)];

  const knob = knobOf(page, 'VcL').getByRole('slider');
  const setting = await pc2(page);
  await knob.focus();
  for (let turns = 0; turns < 5; turns += 1) await page.keyboard.press('PageDown');
  await until('PC2 follows VcL', async () => (await pc2(page)) > 1.5 * setting);
  await sweepOnce(page);
  const turned = String((await exportOf(page, 1, 'CSV')).content);
  assert.notEqual(turned, before, 'the trace after VcL was turned');
  assert.notEqual(await picturesOf(page, 1), pictures, 'the picture after VcL was turned');

  await page.locator('summary', { hasText: 'Set by parameters' }).click();
  await knobOf(page, 'PC2').getByRole('button', { name: /^Unlock PC2/ }).click();
  await type(page, 'PC2', 0.02);
  await until('PC2 has its own setting', async () => (await pc2(page)) === 0.02);
  await sweepOnce(page);
  assert.notEqual(String((await exportOf(page, 1, 'CSV')).content), turned, 'the trace after PC2 was turned');
});

test('the voltmeter shows the voltage of its output in five digits', async (t) => {
  const page = await openPanel(t);
  await sweepOnce(page);
  await page.getByLabel('Output at the voltmeter').selectOption('A1');
  const volts = await until('the meter is connected', async () => {
    const { frame } = await stateOf(page);
    return frame?.meter !== null && Math.abs(frame.meter - frame.volts.A1) < 1e-5 && frame.meter;
  });
  const meter = page.getByRole('meter', { name: 'Voltmeter' });
  const shown = () => meter.textContent().then((text) => Number(text.match(/^([+−][\d.]+) V/)?.[1].replace('−', '-')));
  await until(`the meter shows ${volts} V`, async () => Math.abs(await shown() - volts) <= 0.51e-3);
  // The closed solution at the end of the run, in volts: v = -x0 w sin(w t), at 10 mm/s per volt.
  const w = Math.sqrt(40);
  assert.ok(Math.abs(volts + 8 * w * Math.sin(3 * w)) < 0.01, `${volts} V`);
});

test('an overload lights the lamps, and the first one is marked', async (t) => {
  const page = await openPanel(t, { patch: 'patches/lessons/two-phase-oscillator.json' });
  // Without its negative feedback the oscillation grows until an amplifier is overloaded.
  await type(page, 'damp', 0);
  await parameterIs(page, 'damp', 0);
  await sweepOnce(page);
  const [table] = (await command(page, { command: 'run' })).filter(({ event }) => event === 'table');
  const [first] = table.overloads;
  assert.ok(first, 'the run is overloaded');
  const lamps = page.getByRole('region', { name: 'Overload lamps' });
  await lamps.getByRole('button', { name: `${first}, overload lamp lit first` }).waitFor();
  assert.equal(await lamps.getByRole('button', { name: /lit first$/ }).count(), 1);
  await lamps.getByText(new RegExp(`^Overload. First: ${first} at`)).waitFor();
  await page.getByRole('region', { name: 'Machine' }).getByText(`Overload: ${first}`).waitFor();
  await select(page, 'Initial condition');
  await page.getByRole('region', { name: 'Machine' }).getByText('No overload').waitFor();
});

test('a cord is pulled while the machine runs: error at the jack, undo, and the run continues', async (t) => {
  const page = await openPanel(t);
  await showBoard(page);
  await select(page, 'Operate');
  const before = await until('time', async () => { const { time } = (await stateOf(page)).frame ?? {}; return time > 0.1 && time; });
  await pull(page, 'B1', 'P1.in');
  const jack = inputJack(page, 'P1.in');
  await until('the error is at the jack', async () => /Error: /.test(await jack.getAttribute('aria-label')));
  await jack.locator('.mark.error').waitFor();
  await page.getByRole('region', { name: 'Checks' }).getByText(/P1/).first().waitFor();
  await undoButton(page).click();
  await cordIs(page, 'B1', 'P1.in', true);
  await until('the error has disappeared', async () => !/Error: /.test(await jack.getAttribute('aria-label')));
  const { frame, machine } = await until('a frame', async () => { const now = await stateOf(page); return now.frame && now; });
  assert.equal(machine.mode, 'operate');
  assert.ok(frame.time > before, `time ${frame.time} s after ${before} s`);
});

test('the X-Y scope draws the ellipse of an oscillator', async (t) => {
  const page = await openPanel(t);
  await scopeOf(page, 1).getByLabel('Display').selectOption('X-Y');
  await until('X-Y display', async () => (await stateOf(page)).scopes[0].display === 'plane');
  await sweepOnce(page);
  const rows = rowsOf(String((await exportOf(page, 1, 'CSV')).content));
  const w = Math.sqrt(40);
  assert.ok(rows.length > 50, `${rows.length} points`);
  for (const { x, v } of rows) {
    const radius = Math.hypot(x / 80, v / (80 * w));
    assert.ok(Math.abs(radius - 1) < 1e-3, `(${x}, ${v}) is at ${radius} of the ellipse`);
  }
  // The beam has passed all quarters and is back where it began after one period.
  const quarters = new Set(rows.map(({ x, v }) => `${Math.sign(x)} ${Math.sign(v)}`));
  for (const quarter of ['1 1', '1 -1', '-1 1', '-1 -1']) assert.ok(quarters.has(quarter), `quarter ${quarter}`);
  const [{ x: x0 }] = rows;
  const again = rows.filter(({ t: time }) => Math.abs(time - 2 * Math.PI / w) < 0.02);
  assert.ok(again.some(({ x }) => Math.abs(x - x0) < 0.5), 'closed after a period');
});

test('an oscillator is patched in an empty panel by keys only', async (t) => {
  const page = await openPanel(t, { patch: null });
  const { keyboard } = page;
  await keyboard.press('2');
  await cordLine(page).waitFor();
  const add = async (kind, count) => {
    await keyboard.press('a');
    await page.getByRole('combobox', { name: 'Kind of element' }).waitFor();
    await keyboard.type(kind);
    await page.getByRole('option', { selected: true }).filter({ hasText: kind }).waitFor();
    await keyboard.press('Enter');
    return until(`${kind} is added`, async () => {
      const own = (await stateOf(page)).patch.elements.filter((each) => each.kind === kind);
      return own.length === count && own.at(-1).name;
    });
  };
  const [a, b, c] = [await add('integrator', 1), await add('integrator', 2), await add('inverter', 1)];
  const patch = async (from, to) => {
    await keyboard.press('/');
    await keyboard.type(`${from} ${to}`);
    await keyboard.press('Enter');
    await cordIs(page, from, to, true);
    // Letters are keys again when the focus has left the field.
    await keyboard.press('Escape');
  };
  await patch(a, `${b}.x1`);
  await patch(b, `${c}.in`);
  await patch(c, `${a}.x1`);
  // The initial condition, with the Tab key from the head of the page.
  await page.evaluate(() => document.activeElement.blur());
  const field = knobOf(page, `${a} initial`).getByRole('textbox');
  for (let presses = 0; presses < 200 && !(await field.evaluate((node) => node === document.activeElement)); presses += 1) await keyboard.press('Tab');
  await keyboard.type('50');
  await keyboard.press('Enter');
  await until('the voltage at the start', async () => (await stateOf(page)).frame?.volts[a] === 50);
  await keyboard.press('Tab');
  await keyboard.press('o');
  const { frame } = await until('the oscillation', async () => { const now = await stateOf(page); return now.frame?.time > 1 && now; });
  // a' = c = -b... with inverting integrators: a = 50 cos t, b = -50 sin t.
  assert.ok(Math.abs(frame.volts[a] - 50 * Math.cos(frame.time)) < 0.05, `${frame.volts[a]} V at ${frame.time} s`);
  assert.ok(Math.abs(Math.abs(frame.volts[b]) - 50 * Math.abs(Math.sin(frame.time))) < 0.05, `${frame.volts[b]} V at ${frame.time} s`);
});

test('the time from the start of the page to the first trace is reported', async (t) => {
  const page = await openPanel(t);
  const { title } = (await stateOf(page)).patch;
  await kept(page);
  await page.reload();
  await ready(page, title);
  await modeButton(page, 'Operate').click();
  await until('the trace', async () => (await stateOf(page)).frame?.time > 0);
  t.diagnostic(`${FORM}: first frame with a moving trace ${(await page.evaluate(() => performance.now())).toFixed(0)} ms after the page began to load`);
});

test('the panel runs with the network off', { skip: FORM === 'server' && 'the server is the engine' }, async (t) => {
  const page = await openPanel(t);
  await page.context().setOffline(true);
  await sweepOnce(page);
  await exportOf(page, 1, 'SVG');
});
