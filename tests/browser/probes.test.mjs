/** Probes on the patch panel: the menu at a jack, and the banner while a probe waits. */

import assert from 'node:assert/strict';
import { test } from 'node:test';

import { inputJack, looseCords, middleOf, outputJack, showBoard } from './board.mjs';
import { FINGER, jackDistance } from './fingers.mjs';
import { openPanel, stateOf, until } from './panel.mjs';

const menu = (page) => page.getByRole('dialog').filter({ has: page.getByRole('button', { name: 'Voltmeter' }) });
const meterIs = (page, output) => until(`the voltmeter is at ${output}`, async () => (await stateOf(page)).machine.meter === output);

/** Chooses a probe in the menu, which must be about this output. */
async function choose(page, title, probe) {
  await menu(page).getByRole('heading', { name: title, exact: true }).waitFor();
  await menu(page).getByRole('button', { name: probe }).click();
  await menu(page).waitFor({ state: 'hidden' });
}

test('the menu of probes opens at a jack: by the right button and by keys', async (t) => {
  const page = await openPanel(t, { height: 1400 });
  await showBoard(page);
  await page.mouse.click(...await middleOf(outputJack(page, 'A1')), { button: 'right' });
  await choose(page, 'v at A1', 'Voltmeter');
  await meterIs(page, 'A1');
  // An input with one cord has the voltage of its output.
  await page.mouse.click(...await middleOf(inputJack(page, 'P2.in')), { button: 'right' });
  await choose(page, 'M1', 'Scope 2, channel 1');
  await until('the channel is at M1', async () => (await stateOf(page)).scopes[1].channels[0].output === 'M1');
  await outputJack(page, 'A2').focus();
  await page.keyboard.press('m');
  await choose(page, 'A2', 'Voltmeter');
  await meterIs(page, 'A2');
  await page.keyboard.press('Shift+F10');
  await choose(page, 'A2', 'Null meter');
  await until('the null meter is at A2', async () => (await stateOf(page)).machine.null_meter.output === 'A2');
  // The panel does not follow the pointer afterwards, and a click begins a cord as before.
  const canvas = page.getByRole('application');
  const shown = await canvas.getAttribute('viewBox');
  const [x, y] = await middleOf(outputJack(page, 'B1'));
  await page.mouse.click(x, y, { button: 'right' });
  await menu(page).waitFor();
  await page.keyboard.press('Escape');
  await menu(page).waitFor({ state: 'hidden' });
  await page.mouse.move(x + 40, y + 60, { steps: 4 });
  assert.equal(await canvas.getAttribute('viewBox'), shown);
  await page.mouse.click(...await middleOf(outputJack(page, 'A2')));
  await page.locator('#board .is-draft').waitFor();
  await page.keyboard.press('Escape');
  assert.equal(await menu(page).count() + await looseCords(page).count(), 0);
});

test('a long touch opens the menu of probes, a short one begins a cord', async (t) => {
  const page = await openPanel(t, { height: 1400, touch: true });
  await showBoard(page);
  const client = await page.context().newCDPSession(page);
  const touch = (type, ...points) => client.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y]) => ({ x, y })) });
  const place = await middleOf(outputJack(page, 'A1'));
  await touch('touchStart', place);
  await menu(page).waitFor();
  await touch('touchEnd');
  await choose(page, 'v at A1', 'Voltmeter');
  await meterIs(page, 'A1');
  // The first touch enlarges the panel, so that a finger can choose between its jacks.
  await page.touchscreen.tap(...place);
  await until('large jacks', async () => await jackDistance(page) >= FINGER);
  await page.touchscreen.tap(...await middleOf(outputJack(page, 'A1')));
  await page.locator('#board .is-draft').waitFor();
  assert.ok(await menu(page).isHidden());
});

test('a probe that waits moves nothing, and is placed at any jack', async (t) => {
  const page = await openPanel(t, { height: 1400 });
  await showBoard(page);
  const jack = inputJack(page, 'P2.in');
  const before = await middleOf(jack);
  await page.locator('#voltmeter').getByRole('button').click();
  await page.getByRole('status').getByText('Click an output in any view').waitFor();
  assert.deepEqual(await middleOf(jack), before);
  await page.mouse.click(...before);
  await meterIs(page, 'M1');
  await page.getByText('Click an output in any view').waitFor({ state: 'hidden' });
  assert.equal(await page.locator('#board .is-draft').count(), 0);
});
