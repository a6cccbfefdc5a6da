/** One test for each wish that users of patching programs have, in the order of the list. */

import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtemp, readdir, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { promisify } from 'node:util';

import {
  boardStatus, clickJacks, cordIs, cordLine, cordNode, drag, hasCord, inputJack, looseCords, middleOf, outputJack, pull, showBoard,
} from './board.mjs';
import { smallTargets } from './fingers.mjs';
import { PATCHCORD, ROOT } from './hosts.mjs';
import {
  command, downloadOf, exportOf, FIG_8_16, gallery, kept, knobOf, MASS_AND_SPRING, modeButton, openFile, openPanel, parameterIs, parameterOf, ready,
  redoButton, rowsOf, scopeOf, select, stateOf, sweepOnce, type, undoButton, until, VAN_DER_POL,
} from './panel.mjs';

const LORENZ = 'patches/lessons/lorenz.json';

const titleOf = async (patch) => JSON.parse(await readFile(join(ROOT, patch), 'utf8')).title;

test('wish 1: cords by drag from either end, by two clicks, by the keyboard; a dropped cord stays', async (t) => {
  const page = await openPanel(t, { height: 1400 });
  await showBoard(page);
  await pull(page, 'B1', 'P1.in');
  // From the output. Other cords are plugged in there, so that Shift takes a new one.
  await page.keyboard.down('Shift');
  await drag(page, outputJack(page, 'B1'), inputJack(page, 'P1.in'));
  await page.keyboard.up('Shift');
  await cordIs(page, 'B1', 'P1.in', true);
  await pull(page, 'B1', 'P1.in');
  await drag(page, inputJack(page, 'P1.in'), outputJack(page, 'B1'));
  await cordIs(page, 'B1', 'P1.in', true);
  // Dropped next to the jacks, it stays and can be plugged in again.
  await drag(page, inputJack(page, 'P1.in'), [15, 70]);
  await looseCords(page).first().waitFor();
  assert.ok(!await hasCord(page, 'B1', 'P1.in'));
  await page.keyboard.press('Control+z');
  await cordIs(page, 'B1', 'P1.in', true);
  assert.equal(await looseCords(page).count(), 0);
  // Two clicks.
  await pull(page, 'B1', 'P1.in');
  await clickJacks(page, outputJack(page, 'B1'), inputJack(page, 'P1.in'));
  await cordIs(page, 'B1', 'P1.in', true);
  // The names of the jacks.
  await pull(page, 'B1', 'P1.in');
  await cordLine(page).fill('P1.in <- B1');
  await cordLine(page).press('Enter');
  await cordIs(page, 'B1', 'P1.in', true);
});

test('wish 2: colours of cords differ, hovering dims the others, width and opacity, cords are removed and elements stay', async (t) => {
  const page = await openPanel(t, { height: 1400 });
  await showBoard(page);
  const cords = page.locator('#board .cords .cord');
  const classes = await cords.evaluateAll((nodes) => nodes.map((node) => node.getAttribute('class').match(/cord-\d/)[0]));
  assert.ok(new Set(classes).size >= 5, `colours: ${classes}`);
  /** Waits until these cords are marked and all others are dimmed. */
  const marked = (what, ...goals) => until(`${what} marks its cords`, () => cords.evaluateAll((nodes, keys) => {
    const opacity = (node) => Number(getComputedStyle(node).opacity);
    const [active, others] = [nodes.filter((node) => node.matches('.is-active')), nodes.filter((node) => !node.matches('.is-active'))];
    return active.map((node) => node.dataset.key).sort().join() === keys.sort().join()
      && others.every((node) => opacity(node) < opacity(active[0]));
  }, goals.map((goal) => `cord:B1>${goal}`)));
  await page.mouse.move(...await middleOf(outputJack(page, 'B1')));
  await marked('a jack', 'P1.in', 'M1.a', 'M1.b');
  // A plug above the lowest one has the pointer for itself.
  const { x, y, width: size } = await cordNode(page, 'B1', 'M1.b').locator('.plug-body').first().boundingBox();
  await page.mouse.move(x + 0.6 * size, y + 0.4 * size);
  await marked('a plug', 'M1.b');
  // A place of the cord away from jacks, where no other cord is above it.
  const place = await cordNode(page, 'B1', 'P1.in').locator('.cord-hit').evaluate((path) => {
    const jacks = [...document.querySelectorAll('#board .hole')].map((hole) => hole.getBoundingClientRect());
    const points = Array.from({ length: 99 }, (_, at) => path.getPointAtLength((at + 1) / 100 * path.getTotalLength()).matrixTransform(path.getScreenCTM()));
    const { x: left, y: top } = points.find((point) => document.elementFromPoint(point.x, point.y) === path
      && jacks.every((jack) => Math.hypot(jack.x - point.x, jack.y - point.y) > 40));
    return [left, top];
  });
  await page.mouse.move(...place);
  await marked('a cord', 'P1.in');
  await page.mouse.move(5, 5);
  await until('nothing is marked', async () => (await page.locator('#board .cord.is-active').count()) === 0);
  await cordNode(page, 'B1', 'M1.a').focus();
  await marked('the focus', 'M1.a');
  const width = () => cords.first().locator('.cord-body').evaluate((node) => getComputedStyle(node).strokeWidth);
  const before = await width();
  await page.getByLabel('Width and opacity of the cords').fill('0.1');
  await until('thinner cords', async () => (await width()) !== before);
  const { patch } = await stateOf(page);
  await page.getByRole('button', { name: 'Remove all cords' }).click();
  await until('no cords', async () => (await cords.count()) === 0);
  const after = (await stateOf(page)).patch;
  assert.deepEqual(after.elements.map(({ name }) => name), patch.elements.map(({ name }) => name));
});

test('wish 3: undo and redo over cords, pots and modes, with visible buttons; the run continues; a reload keeps them', async (t) => {
  const page = await openPanel(t);
  await showBoard(page);
  await select(page, 'Operate');
  await type(page, 'k', 20);
  await parameterIs(page, 'k', 20);
  await pull(page, 'B1', 'P1.in');
  const time = (await until('a frame', async () => (await stateOf(page)).frame)).time;
  await undoButton(page).click();
  await cordIs(page, 'B1', 'P1.in', true);
  await undoButton(page).click();
  await parameterIs(page, 'k', 40);
  await redoButton(page).click();
  await parameterIs(page, 'k', 20);
  await until('the run continues', async () => (await stateOf(page)).frame?.time > time);
  assert.equal((await stateOf(page)).machine.mode, 'operate');
  // A reload keeps the patch and its history.
  await kept(page);
  await page.reload();
  await ready(page, await titleOf(MASS_AND_SPRING));
  await parameterIs(page, 'k', 20);
  await redoButton(page).click();
  await cordIs(page, 'B1', 'P1.in', false);
  // Modes are steps of the history too.
  await select(page, 'Hold');
  await undoButton(page).click();
  await until('the mode before', async () => (await stateOf(page)).machine.mode !== 'hold');
  await redoButton(page).click();
  await until('hold again', async () => (await stateOf(page)).machine.mode === 'hold');
});

test('wish 4: snapshots of a patch are kept, and another patch never overwrites them', async (t) => {
  const page = await openPanel(t);
  const title = await titleOf(MASS_AND_SPRING);
  await type(page, 'k', 20);
  await parameterIs(page, 'k', 20);
  // The same file with another change, and another patch.
  await openFile(page, MASS_AND_SPRING);
  await parameterIs(page, 'k', 40);
  await type(page, 'k', 10);
  await parameterIs(page, 'k', 10);
  await openFile(page, VAN_DER_POL);
  await ready(page, await titleOf(VAN_DER_POL));
  await kept(page);
  await page.reload();
  await ready(page, await titleOf(VAN_DER_POL));
  await page.getByRole('button', { name: 'Gallery', exact: true }).click();
  const recent = gallery(page).getByRole('region', { name: 'Recent' });
  const cards = recent.getByRole('button', { name: new RegExp(`^${title}`) });
  await until('two patches with changes', async () => (await cards.count()) === 2);
  // The latest one comes first.
  await cards.last().click();
  await ready(page, title);
  await parameterIs(page, 'k', 20);
  // The history is kept too.
  await undoButton(page).click();
  await parameterIs(page, 'k', 40);
});

test('wish 5: the patch is in the address, and ?patch= opens a file', async (t) => {
  const page = await openPanel(t);
  await type(page, 'k', 20);
  await parameterIs(page, 'k', 20);
  await page.getByRole('button', { name: 'Share', exact: true }).click();
  const link = await page.getByRole('dialog', { name: 'Share this patch' }).getByLabel('Link').inputValue();
  assert.match(link, /#p=[\w-]+&name=/);
  const other = await page.context().newPage();
  await other.goto(link);
  await ready(other, await titleOf(MASS_AND_SPRING));
  await parameterIs(other, 'k', 20);
  await other.goto(new URL('?patch=lessons/lorenz.json', link).href);
  await ready(other, await titleOf(LORENZ));
});

test('wish 6: the gallery has every lesson, figure and example', async (t) => {
  const page = await openPanel(t, { patch: null });
  await page.keyboard.press('g');
  await gallery(page).waitFor();
  const cards = await gallery(page).locator('a').evaluateAll((links) => links.map((link) => ({
    path: new URLSearchParams(link.search).get('patch'), words: link.textContent, isDrawn: link.querySelector('img').naturalWidth > 0,
  })));
  const folders = ['lessons', 'thesis', 'others', 'problems', 'measured'].map((folder) => [folder, join('patches', folder)]);
  for (const [folder, place] of [...folders, ['examples/05_missing_effect', 'examples/05_missing_effect']]) {
    for (const name of await readdir(join(ROOT, place))) {
      if (!/(?<!\.experiment)\.json$/.test(name)) continue;
      const card = cards.find(({ path }) => path === `${folder}/${name}`);
      assert.ok(card?.words.length > 10, `${folder}/${name} is in the gallery`);
      assert.ok(card.isDrawn, `${folder}/${name} has a picture`);
    }
  }
  // One click opens a patch that is found by its words, and runs it.
  await gallery(page).getByRole('searchbox').fill('lorenz flow');
  await gallery(page).getByRole('status').getByText('1 found').waitFor();
  await gallery(page).getByRole('link').click();
  await ready(page, await titleOf(LORENZ));
  await until('a run', async () => (await stateOf(page)).frame?.time > 0);
});

test('wish 7: the same file with the same bits in the panel and in the command', async (t) => {
  const folder = await mkdtemp(join(tmpdir(), 'patchcord-'));
  t.after(() => rm(folder, { recursive: true }));
  for (const patch of [MASS_AND_SPRING, VAN_DER_POL]) {
    const page = await openPanel(t, { patch });
    const [table] = (await command(page, { command: 'run' })).filter(({ event }) => event === 'table');
    const csv = join(folder, 'run.csv');
    await promisify(execFile)(PATCHCORD, ['run', patch, '--csv', csv], { cwd: ROOT });
    assert.equal(table.csv, await readFile(csv, 'utf8'), patch);
    // Saving gives the same document.
    const saved = await downloadOf(page, () => page.getByRole('button', { name: 'Save' }).click());
    assert.equal(String(saved.content), await readFile(join(ROOT, patch), 'utf8'), patch);
  }
});

test('wish 8: pots act in a run, pause, speeds, back to an earlier time', async (t) => {
  const page = await openPanel(t);
  await select(page, 'Operate');
  await until('time', async () => (await stateOf(page)).frame?.time > 0.3);
  const { patch, frame } = await stateOf(page);
  const setting = (state) => state.patch.elements.find(({ name }) => name === 'P1').settings.find(({ name }) => name === 'setting').value;
  await knobOf(page, 'k').getByRole('slider').press('PageUp');
  const later = await until('the pot follows', async () => { const now = await stateOf(page); return now.frame && setting(now) !== setting({ patch }) && now; });
  assert.ok(later.frame.time >= frame.time, 'the run was not started again');

  await page.getByRole('button', { name: 'Pause' }).click();
  await until('pause', async () => (await stateOf(page)).frame?.paused);
  const stands = (await stateOf(page)).frame.time;
  assert.equal((await stateOf(page)).machine.mode, 'operate');
  await page.getByRole('button', { name: 'Continue' }).click();
  await until('time moves', async () => (await stateOf(page)).frame?.time > stands);
  for (const [name, speed] of [['Half speed', 0.5], ['Double speed', 2], ['Maximum speed', null], ['Real time', 1]]) {
    await page.getByRole('button', { name }).click();
    await until(name, async () => (await stateOf(page)).machine.speed === speed);
  }
  await select(page, 'Hold');
  const slider = page.getByRole('slider', { name: /Time in this run/ });
  const end = await until('hold', async () => { const now = (await stateOf(page)).frame; return now && !now.moves && now.time; });
  const goal = end / 2;
  await slider.fill(String(goal));
  const back = await until('the earlier time', async () => { const now = (await stateOf(page)).frame; return now && Math.abs(now.time - goal) < 0.01 && now; });
  assert.equal(back.moves, false);
});

test('wish 9: time base, trigger, two cursors, X-Y with persistence, CSV with a time column', async (t) => {
  const page = await openPanel(t);
  const scope = scopeOf(page, 1);
  await sweepOnce(page);
  const rows = rowsOf(String((await exportOf(page, 1, 'CSV')).content));
  assert.ok(rows.length > 900, `${rows.length} rows`);
  const w = Math.sqrt(40);
  rows.forEach(({ t: time, x_min: low, x_max: high }, index) => {
    if (index > 0) assert.ok(time > rows[index - 1].t, 'the time rises');
    const x = 80 * Math.cos(w * time);
    assert.ok(low - 0.01 <= x && x <= high + 0.01, `x at ${time} s is ${x}, not from ${low} to ${high}`);
  });
  await scope.getByLabel('Time base').selectOption('0.2');
  await until('200 ms/div', async () => (await stateOf(page)).scopes[0].seconds_per_division === 0.2);
  await scope.locator('summary', { hasText: 'Trigger' }).click();
  await scope.getByLabel('A trace begins with').selectOption('level');
  await scope.getByLabel('Slope').selectOption('falling');
  await until('the trigger', async () => {
    const { trigger } = (await stateOf(page)).scopes[0];
    return trigger.mode === 'level' && !trigger.rising;
  });
  await scope.getByLabel('A trace begins with').selectOption('each run');
  // Another sweep with the new time base.
  await sweepOnce(page);
  await scope.getByRole('checkbox', { name: 'Cursors' }).check();
  const cursors = [1, 2].map((number) => scope.getByRole('slider', { name: `Cursor ${number}` }));
  for (const cursor of cursors) await cursor.waitFor();
  const reading = () => scope.getByRole('row', { name: /^t / }).textContent();
  const first = await until('a reading', reading);
  await cursors[0].focus();
  await page.keyboard.press('ArrowLeft');
  await until('the cursor moves', async () => (await reading()) !== first);
  await scope.getByLabel('Display').selectOption('X-Y');
  await scope.locator('summary', { hasText: 'More' }).click();
  await scope.getByLabel('Persistence').selectOption('2');
  await until('X-Y with persistence', async () => {
    const { display, persistence } = (await stateOf(page)).scopes[0];
    return display === 'plane' && persistence === 2;
  });
});

test('wish 10: targets of 44 px for fingers, a lock, pinch', async (t) => {
  const page = await openPanel(t, { width: 412, height: 915, touch: true });
  await showBoard(page);
  assert.deepEqual(await smallTargets(page), []);
  await page.getByRole('button', { name: 'Lock', exact: true }).click();
  await cordNode(page, 'B1', 'P1.in').focus();
  await page.keyboard.press('Delete');
  await boardStatus(page).getByText(/locked/).waitFor();
  assert.ok(await hasCord(page, 'B1', 'P1.in'));
  // Two fingers that move apart.
  const canvas = page.getByRole('application');
  const shown = () => canvas.getAttribute('viewBox');
  const { x, y, width, height } = await canvas.boundingBox();
  const before = await shown();
  const client = await page.context().newCDPSession(page);
  const fingers = (apart) => [-apart, apart].map((by, id) => ({ x: x + width / 2 + by, y: y + height / 2, id }));
  await client.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: fingers(30) });
  for (const apart of [40, 60, 80]) await client.send('Input.dispatchTouchEvent', { type: 'touchMove', touchPoints: fingers(apart) });
  await client.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
  await until('the panel is larger', async () => Number((await shown()).split(' ')[2]) < Number(before.split(' ')[2]));
});

test('wish 11: keys select modes and speeds, and controls have names and values for screen readers', async (t) => {
  const page = await openPanel(t);
  const { keyboard } = page;
  for (const [key, name] of [['o', 'Operate'], ['h', 'Hold'], ['i', 'Initial condition'], ['r', 'Repetitive'], ['p', 'Pot set'],
    ['c', 'Problem check'], ['s', 'Single sweep']]) {
    await keyboard.press(key);
    const mode = { s: ['single', 'hold'] }[key] ?? [name.toLowerCase().replace(' ', '-')];
    await until(name, async () => mode.includes((await stateOf(page)).machine.mode));
  }
  await keyboard.press('i');
  await keyboard.press('Space');
  await until('pause', async () => (await stateOf(page)).machine.paused);
  const speedIs = (speed) => until(`speed ${speed}`, async () => (await stateOf(page)).machine.speed === speed);
  await keyboard.press('.');
  await speedIs(2);
  // Keys that follow each other faster than the session answers.
  await page.evaluate(() => { for (const key of [',', ',', '.', '.', '.']) document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true })); });
  await speedIs(null);
  for (const [tabKey, view] of [['1', '#schematic'], ['2', '#board']]) {
    await keyboard.press(tabKey);
    const shown = () => page.locator(`${view} svg[viewBox]:visible`).first().getAttribute('viewBox').then((box) => Number(box.split(' ')[2]));
    // A view has another scale when its drawing comes.
    await page.locator(`${view} :is(.symbol, .jack)`).first().waitFor();
    const before = await until('the view', shown);
    for (const [key, holds] of [['+', (wide) => wide < before], ['-', (wide) => Math.abs(wide / before - 1) < 0.02], ['0', (wide) => wide >= before * 0.98]]) {
      await keyboard.press(key);
      await until(`${key} in ${view}`, async () => holds(await shown()));
    }
  }
  await keyboard.press('?');
  await page.getByRole('dialog', { name: 'Keys' }).waitFor();
  await keyboard.press('Escape');
  await until('the list is closed', async () => (await page.getByRole('dialog').count()) === 0);
  const slider = knobOf(page, 'k').getByRole('slider');
  assert.equal(await slider.getAttribute('aria-valuetext'), '40 N/m');
  await slider.focus();
  await keyboard.press('ArrowUp');
  await until('the value is read', async () => (await slider.getAttribute('aria-valuetext')) !== '40 N/m');
  await scopeOf(page, 1).getByRole('img', { name: /^Scope 1, against time.*x at B1/ }).waitFor();
  // The focus can reach the modes from the head of the page, and it is visible.
  await keyboard.press('Tab');
  assert.notEqual(await page.evaluate(() => document.activeElement.tagName), 'BODY');
});

test('wish 12: every wrong move gets the message of the checker at the jack', async (t) => {
  const page = await openPanel(t, { height: 1400 });
  await showBoard(page);
  // A jack that takes one cord.
  await cordLine(page).fill('A1 P1.in');
  await cordLine(page).press('Enter');
  await boardStatus(page).getByText(/\S/).waitFor();
  const refusal = page.locator('#board').getByRole('alert');
  await refusal.waitFor();
  assert.match(await refusal.textContent(), /P1/);
  assert.ok(!await hasCord(page, 'A1', 'P1.in'));
  // Two outputs.
  await clickJacks(page, outputJack(page, 'A1'), outputJack(page, 'B1'));
  await refusal.getByText(/Both are outputs/).waitFor();
  await page.keyboard.press('Escape');
  // An open input.
  await pull(page, 'B1', 'P1.in');
  await until('the error at P1.in', async () => /Error: /.test(await inputJack(page, 'P1.in').getAttribute('aria-label')));
});

test('another patch replaces the first one, and a file with faults is reported', async (t) => {
  const page = await openPanel(t);
  await openFile(page, FIG_8_16);
  await ready(page, await titleOf(FIG_8_16));
  await page.getByLabel('Patch file').setInputFiles({ name: 'broken.json', mimeType: 'application/json', buffer: Buffer.from('{') });
  await page.getByRole('complementary', { name: 'Messages' }).getByText(/\S/).first().waitFor();
  await modeButton(page, 'Operate').waitFor();
});
