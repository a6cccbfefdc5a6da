/** Exports, themes, narrow pages, and the rules of axe-core for accessible pages. */

import { AxeBuilder } from '@axe-core/playwright';
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { showBoard } from './board.mjs';
import { exportOf, FIG_8_16, openPanel, scopeOf, select, stateOf, sweepOnce, tab, until } from './panel.mjs';

const VIEWS = ['Schematic', 'Patch panel', 'Equations', 'Measured data'];

async function showView(page, name) {
  if (name === 'Patch panel') await showBoard(page);
  else await tab(page, name).click();
  await until(`the view ${name}`, async () => (await page.getByRole('tabpanel', { name }).textContent()).length > 0
    || await page.getByRole('tabpanel', { name }).locator('svg').count() > 0);
}

test('a scope is exported as a valid SVG drawing and as a PNG picture', async (t) => {
  const page = await openPanel(t);
  await sweepOnce(page);
  const { name, content } = await exportOf(page, 1, 'SVG');
  assert.match(name, /\.svg$/);
  const drawing = await page.evaluate((text) => {
    const root = new DOMParser().parseFromString(text, 'image/svg+xml').documentElement;
    return { tag: root.localName, faults: root.querySelectorAll('parsererror').length, title: root.querySelector('title')?.textContent, paths: root.querySelectorAll('path').length };
  }, String(content));
  assert.equal(drawing.tag, 'svg');
  assert.equal(drawing.faults, 0);
  assert.match(drawing.title, /scope 1/);
  assert.ok(drawing.paths > 2, `${drawing.paths} paths`);
  const picture = await exportOf(page, 1, 'PNG');
  assert.match(picture.name, /\.png$/);
  assert.equal(picture.content.subarray(1, 4).toString('latin1'), 'PNG');
  const [width, height] = [16, 20].map((at) => picture.content.readUInt32BE(at));
  assert.ok(width >= 1600 && height >= 1200, `${width} x ${height} pixels`);
  const colours = await page.evaluate(async (data) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0))]));
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, image.width, image.height);
    const found = new Set();
    for (let at = 0; at < pixels.length; at += 4) found.add(pixels.slice(at, at + 3).join());
    return { page: [...pixels.slice(0, 3)], count: found.size };
  }, picture.content.toString('base64'));
  assert.deepEqual(colours.page, [255, 255, 255], 'a white page');
  assert.ok(colours.count > 10, `${colours.count} colours`);
});

test('the theme follows the system, and a chosen theme stays', async (t) => {
  const page = await openPanel(t, { dark: true });
  const brightness = () => page.evaluate(() => getComputedStyle(document.querySelector('.machine')).backgroundColor.match(/[\d.]+/g).slice(0, 3).reduce((sum, part) => sum + Number(part), 0));
  const isDark = async () => (await brightness()) < 380;
  assert.ok(await isDark(), 'dark as the system');
  await page.getByLabel('Theme').selectOption('light');
  await until('the light theme', async () => !await isDark());
  await page.reload();
  assert.ok(!await isDark(), 'light after a reload');
  await page.getByLabel('Theme').selectOption('dark');
  await until('the dark theme', isDark);
});

for (const patch of [undefined, FIG_8_16]) {
  test(`nothing scrolls sideways from 360 px on: ${patch ?? 'mass and spring'}`, async (t) => {
    const page = await openPanel(t, { patch, width: 360, height: 740, touch: true });
    for (const width of [360, 412, 768, 1024, 1280, 1920]) {
      await page.setViewportSize({ width, height: 800 });
      for (const view of VIEWS) {
        await showView(page, view);
        const wide = await page.evaluate(() => document.scrollingElement.scrollWidth);
        assert.ok(wide <= width, `${view} at ${width} px is ${wide} px wide`);
      }
    }
  });
}

for (const dark of [false, true]) {
  test(`axe-core finds no fault: ${dark ? 'dark' : 'light'}`, async (t) => {
    const page = await openPanel(t, { dark });
    await select(page, 'Operate');
    await until('a trace', async () => (await stateOf(page)).frame?.time > 0.2);
    await select(page, 'Hold');
    await scopeOf(page, 1).getByRole('checkbox', { name: 'Cursors' }).check();
    const check = async (what) => {
      // What is closed can have faults too. A click elsewhere closes menus again.
      await page.locator('details:visible').evaluateAll((all) => { for (const details of all) details.open = true; });
      const { violations } = await new AxeBuilder({ page }).analyze();
      const faults = violations.flatMap(({ id, nodes }) => nodes.map(({ target, failureSummary }) => `${what}: ${id} at ${target}: ${failureSummary}`));
      assert.deepEqual(faults, []);
    };
    for (const view of VIEWS) {
      await t.test(view, async () => {
        await showView(page, view);
        await check(view);
      });
    }
    await t.test('dialogs', async () => {
      for (const [button, name] of [['Keys', 'Keys'], ['New', 'New patch'], ['Share', 'Share this patch'], ['Gallery', 'Gallery']]) {
        await page.getByRole('button', { name: button, exact: true }).click();
        await page.getByRole('dialog', { name }).waitFor();
        await check(name);
        await page.keyboard.press('Escape');
        await until('the dialog is closed', async () => (await page.getByRole('dialog').count()) === 0);
      }
    });
  });
}
