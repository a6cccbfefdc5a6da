/** The table of the problem check, and the search for corrections of a patch that does not solve its equations. */

import assert from 'node:assert/strict';
import { test } from 'node:test';

import { command, knobOf, openPanel, select, stateOf, type, until } from './panel.mjs';

/** Moves the cord from velocity to position into an input whose gain is 10 times too small. */
async function misplug(page) {
  const events = await command(page, { command: 'move-cord', element: 'A2', jack: 'x10', from: 'A1', to: { element: 'A2', jack: 'x1' } });
  assert.ok(events.some(({ event }) => event === 'patch'), JSON.stringify(events));
}

const table = (page) => page.getByRole('region', { name: 'Problem check' });

/** The rows of the table: output, result, expected, measured, difference, quantity. */
const rowsOf = (page) => table(page).locator('tbody tr').evaluateAll((rows) => rows.map((row) => Array.from(row.cells, (cell) => cell.textContent)));

/** Waits for a text of the table's summary. */
const summary = (page, text) => table(page).getByRole('status').getByText(text).waitFor();

test('problem check: a table compares all values with the equations, at the start and at test values', async (t) => {
  const page = await openPanel(t);
  assert.ok(await table(page).isHidden());
  await select(page, 'Problem check');
  await summary(page, 'At the start: all values agree with the equations.');
  for (const [output, result, expected, measured] of await rowsOf(page)) assert.deepEqual([result, measured], ['✓ ok', expected], output);
  await misplug(page);
  await summary(page, /^At the start: 1 of \d+ values are wrong\.$/);
  // m x'' = -k x, in volts and at 10 mm/s per volt: x'' = -40 * 80 V/s2. The wrong gain makes a tenth of it.
  const unit = '\u202fV/s2';
  assert.deepEqual((await rowsOf(page))[0], ['B1′′', '✗ fault', `−3200.000${unit}`, `−320.000${unit}`, `2880${unit}`, "x'' in mm/s2"]);
  await page.getByRole('button', { name: 'Random test values' }).click();
  await summary(page, /^Test values 1: 1 of \d+ values are wrong\.$/);
  const [first, ...others] = await rowsOf(page);
  const [expected, measured] = first.slice(2).map((text) => parseFloat(text.replace('−', '-')));
  assert.deepEqual(first.slice(0, 2), ['A2′', '✗ fault']);
  // The values in the table have three decimals.
  assert.ok(Math.abs(expected) > 1 && Math.abs(expected - 10 * measured) < 0.01, `${expected} and ${measured}`);
  for (const [output, result] of others) assert.equal(result, '✓ ok', output);
  const before = await rowsOf(page);
  await page.getByRole('button', { name: 'Random test values' }).click();
  await summary(page, /^Test values 2:/);
  assert.notDeepEqual(await rowsOf(page), before);
  await page.getByRole('button', { name: 'Values at the start' }).click();
  await summary(page, /^At the start: 1 of/);
  // Another value of a parameter changes the voltages.
  await type(page, 'x0', 40);
  await until('the table follows', async () => (await rowsOf(page))[0][2] === `−1600.000${unit}`);
  await table(page).getByRole('button', { name: 'B1′′' }).click();
  await page.locator('#schematic .ring').waitFor();
  await select(page, 'Initial condition');
  await table(page).waitFor({ state: 'hidden' });
});

test('findings: corrections of equations that the wiring does not solve are found', async (t) => {
  const page = await openPanel(t);
  const checks = page.getByRole('region', { name: 'Checks' });
  const find = checks.getByRole('button', { name: 'Find corrections' });
  assert.ok(await find.isHidden());
  await misplug(page);
  await find.waitFor();
  const remedy = /plug A1 into x10 of A2 in place of x1/;
  assert.equal(await checks.getByText(remedy).count(), 0);
  await find.click();
  await checks.getByText(remedy).first().waitFor();
  await find.waitFor({ state: 'hidden' });
  const { findings } = await stateOf(page);
  await checks.getByText(new RegExp(`^${findings.filter(({ severity }) => severity === 'error').length} errors`)).waitFor();
  // The correction corrects.
  await command(page, { command: 'move-cord', element: 'A2', jack: 'x1', from: 'A1', to: { element: 'A2', jack: 'x10' } });
  await checks.getByText('The patch has no faults').waitFor();
});

test('a fault in the wiring leaves the values of pots and initial conditions', async (t) => {
  const page = await openPanel(t);
  // B1 and B2 drive each other, so their loop with the multiplier has two solutions.
  await command(page, { command: 'unplug', element: 'B1', jack: 'in', from: 'A2' }, { command: 'plug', element: 'B1', jack: 'in', from: 'B2' },
    { command: 'plug', element: 'B2', jack: 'x1', from: 'B1' });
  await until('a fault', async () => !(await stateOf(page)).patch.runs);
  await page.locator('summary', { hasText: 'Set by parameters' }).click();
  // P1 is k / m * (1/10) / 10, and A2 begins at -x0.
  for (const [name, value] of [['P1', 0.4], ['A2 initial', -80]]) {
    const field = knobOf(page, name).getByRole('textbox');
    await until(`${name} is ${value}`, async () => Number((await field.inputValue()).replace('−', '-')) === value);
  }
});
