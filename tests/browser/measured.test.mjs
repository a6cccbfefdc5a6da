/** Measured data: a file is dropped, knobs are turned, and the search names what is missing. */

import { AxeBuilder } from '@axe-core/playwright';
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { cp, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { test } from 'node:test';
import { promisify } from 'node:util';

import { PATCHCORD, ROOT } from './hosts.mjs';
import { downloadOf, openPanel, parameterIs, parameterOf, rowsOf, stateOf, tab, type, undoButton, until } from './panel.mjs';

const SPRING = 'examples/05_missing_effect/spring.json';
const MEASURED = join(ROOT, 'examples/05_missing_effect/measured.csv');
const SENTENCE = 'viscous-friction at A1 is missing';
/** Milliseconds for a search. The engine in the browser has one thread and no compiled code. */
const SEARCH = 900_000;
/** Milliseconds in which a cancelled search has ended. */
const ENDED = 2000;

const view = (page) => page.getByRole('tabpanel', { name: 'Measured data' });
const button = (page, name) => view(page).getByRole('button', { name, exact: true });
const columnOf = (page, name) => view(page).getByRole('group', { name, exact: true });
const roleOf = (page, column) => columnOf(page, column).getByLabel('Role').locator('option:checked').textContent();
const message = (page) => view(page).getByRole('alert');
const figure = (page) => view(page).getByRole('figure');
const candidates = (page) => view(page).getByRole('list', { name: /^Effects that were tried/ }).getByRole('listitem');

/** Drops a file on the page. */
async function drop(page, path) {
  const file = { name: basename(path), text: await readFile(path, 'utf8') };
  const dataTransfer = await page.evaluateHandle(({ name, text }) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([text], name));
    return transfer;
  }, file);
  await page.dispatchEvent('body', 'drop', { dataTransfer });
}

/** The residual that the view shows: in millimetres, and as a multiple of the noise. */
async function residualOf(page) {
  const [, rms, times] = (await figure(page).textContent()).match(/rms residual\s*([\d.]+)\s*mm\s*([\d.]+) × noise/) ?? [];
  return { rms: Number(rms), times: Number(times) };
}

/** The residual of an undamped spring of 1 kg, by the closed solution. */
async function closedResidual(stiffness) {
  const rows = rowsOf(await readFile(MEASURED, 'utf8'));
  const squares = rows.map(({ t, x }) => (x - 50 * Math.cos(Math.sqrt(stiffness) * t)) ** 2);
  return Math.sqrt(squares.reduce((sum, square) => sum + square, 0) / rows.length);
}

const residualIs = (page, expected) => until(`the residual is ${expected} mm`, async () => Math.abs((await residualOf(page)).rms / expected - 1) < 0.01);

/** A panel with the spring and its measured data. */
async function openMeasured(t, options) {
  const page = await openPanel(t, { patch: SPRING, ...options });
  await drop(page, MEASURED);
  await figure(page).waitFor();
  return page;
}

test('a data file is dropped, and the search names the effect', async (t) => {
  const page = await openMeasured(t);
  assert.equal(await tab(page, 'Measured data').getAttribute('aria-selected'), 'true');
  assert.deepEqual([await roleOf(page, 't'), await roleOf(page, 'x')], ['time', 'x (mm)']);
  await residualIs(page, await closedResidual(40));
  const { times } = await residualOf(page);
  await type(page, 'k', 16);
  await residualIs(page, await closedResidual(16));
  assert.ok((await residualOf(page)).times < times, 'a better stiffness has a smaller residual');

  // The motion depends on k/m only, so one of them is fitted.
  await view(page).getByRole('checkbox', { name: 'm', exact: true }).uncheck();
  const before = (await stateOf(page)).patch.elements.map(({ name }) => name);
  await button(page, 'Search').click();
  await view(page).getByRole('progressbar').waitFor();
  await view(page).getByText(SENTENCE, { exact: true }).waitFor({ timeout: SEARCH });
  assert.ok(await candidates(page).count() > 3, 'candidates are listed');
  assert.match(await candidates(page).first().textContent(), / at .*(× noise|no fit)$/);
  const [, first, last] = (await view(page).getByText(/^Residual: /).textContent()).match(/([\d.]+) × noise before, ([\d.]+) × noise after/);
  assert.ok(Number(first) > 5 && Number(last) < 1.2, `${first} before, ${last} after`);

  const [report] = await Promise.all([page.waitForEvent('popup'), button(page, 'Report').click()]);
  await report.getByText(SENTENCE).first().waitFor();
  assert.equal(await report.evaluate(() => document.adoptedStyleSheets[0].cssRules.length > 5), true, 'the report has its styles');
  await report.close();

  await t.test('the saved experiment gives the same result with patchcord gap', async () => {
    const folder = await mkdtemp(join(tmpdir(), 'patchcord-'));
    try {
      const experiment = await downloadOf(page, () => button(page, 'Save experiment').click());
      const patch = await downloadOf(page, () => page.keyboard.press('Control+s'));
      for (const { name, content } of [experiment, patch]) await writeFile(join(folder, name), content);
      await cp(MEASURED, join(folder, basename(MEASURED)));
      const { stdout } = await promisify(execFile)(PATCHCORD, ['gap', join(folder, experiment.name)]);
      assert.ok(stdout.split('\n')[0].endsWith(SENTENCE), stdout);
    } finally {
      await rm(folder, { recursive: true });
    }
  });

  await button(page, 'Plug in').click();
  await until('the patch has new elements', async () => (await stateOf(page)).patch.elements.length > before.length);
  assert.equal(await tab(page, 'Patch panel').getAttribute('aria-selected'), 'true');
  await tab(page, 'Measured data').click();
  await until('the residual is noise', async () => (await residualOf(page)).times < 1.2);
  await undoButton(page).click();
  await until('undo removes them', async () => (await stateOf(page)).patch.elements.length === before.length);
  assert.deepEqual((await stateOf(page)).patch.elements.map(({ name }) => name), before);
});

test('a search is cancelled at once, and can be started again', async (t) => {
  const page = await openMeasured(t);
  const start = async () => {
    await button(page, 'Search').click();
    await view(page).getByRole('progressbar').waitFor();
    await until('the search has a phase', async () => (await view(page).locator('#progress-phase').textContent()) !== '');
  };
  await start();
  const cancelled = Date.now();
  await button(page, 'Cancel').click();
  await button(page, 'Search').waitFor();
  assert.ok(Date.now() - cancelled < ENDED, `${Date.now() - cancelled} ms`);
  assert.equal(await message(page).textContent(), '');
  assert.equal(await view(page).getByRole('progressbar').count(), 0);
  // The comparison continues with the same columns.
  await type(page, 'k', 20);
  await residualIs(page, await closedResidual(20));
  await start();
  await button(page, 'Cancel').click();
  await button(page, 'Search').waitFor();
});

test('a column with the wrong role is refused in words, and the last curves stay', async (t) => {
  const page = await openMeasured(t);
  const drawn = () => figure(page).locator('path').evaluateAll((paths) => paths.map((path) => path.getAttribute('d')).join());
  const role = columnOf(page, 'x').getByLabel('Role');
  const before = await drawn();
  await role.selectOption('v (mm/s)');
  await until('a message', async () => /mm\/s/.test(await message(page).textContent()));
  assert.ok(await button(page, 'Search').isDisabled(), 'nothing can be searched');
  assert.equal(await drawn(), before);
  // A column has one role, and a role has one column.
  await columnOf(page, 't').getByLabel('Role').selectOption('x (mm)');
  await role.selectOption('x (mm)');
  assert.equal(await roleOf(page, 't'), 'not used');
  await columnOf(page, 't').getByLabel('Role').selectOption('time');
  await until('no message', async () => (await message(page).textContent()) === '');
  assert.ok(await button(page, 'Search').isEnabled());
});

test('fit sets the knobs, and undo resets them', async (t) => {
  const page = await openMeasured(t);
  await view(page).getByRole('checkbox', { name: 'm', exact: true }).uncheck();
  await button(page, 'Fit').click();
  await until('k is fitted', async () => Math.abs((await parameterOf(page, 'k')) - 16) < 1.5);
  await undoButton(page).click();
  await parameterIs(page, 'k', 40);
  await residualIs(page, await closedResidual(40));
});

for (const dark of [false, true]) {
  test(`measured data fit narrow pages, and axe-core finds no fault: ${dark ? 'dark' : 'light'}`, async (t) => {
    const page = await openMeasured(t, { dark });
    for (const width of [360, 768, 1280, 1920]) {
      await page.setViewportSize({ width, height: 900 });
      await figure(page).scrollIntoViewIfNeeded();
      const wide = await page.evaluate(() => document.scrollingElement.scrollWidth);
      assert.ok(wide <= width, `${width} px is ${wide} px wide`);
      const { violations } = await new AxeBuilder({ page }).analyze();
      assert.deepEqual(violations.flatMap(({ id, nodes }) => nodes.map(({ target, failureSummary }) => `${id} at ${target}: ${failureSummary}`)), []);
    }
  });
}
