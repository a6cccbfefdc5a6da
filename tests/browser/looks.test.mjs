/** Exports, themes, narrow pages, and the rules of axe-core for accessible pages. */

import { AxeBuilder } from '@axe-core/playwright';
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { inputJack, middleOf, showBoard } from './board.mjs';
import { FINGER, jackDistance, painted, smallInDialog, smallTargets, touch } from './fingers.mjs';
import { cutTexts, misplaced, pageWidth, typeSize } from './layout.mjs';
import { exportOf, FIG_8_16, openPanel, scopeOf, select, stateOf, sweepOnce, tab, type, until, VAN_DER_POL } from './panel.mjs';

const VIEWS = ['Schematic', 'Patch panel', 'Equations', 'Measured data'];
/** Widths at both ends of every layout, and usual ones. */
const WIDTHS = [360, 412, 700, 768, 999, 1000, 1024, 1100, 1280, 1399, 1400, 1680, 1699, 1700, 1920];
/** The faceplates, and the classes of their pictures. */
const PLATES = { 'solartron-1451': 'solartron', plain: 'plain', 'the-analog-thing': 'thing' };
/** How much larger the type of drawings is in projector mode, at least. Type of the page grows from 15 to 20 pixels. */
const LARGER = 1.05;

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
        const wide = await pageWidth(page);
        assert.ok(wide <= width, `${view} at ${width} px is ${wide} px wide`);
      }
    }
  });
}

for (const [name, options, key] of [['a mouse', {}, ''], ['fingers', { touch: true }, ''], ['a projector', {}, 'l']]) {
  test(`controls are in their cards and next to each other, and texts are not cut: ${name}`, async (t) => {
    const page = await openPanel(t, { patch: FIG_8_16, ...options });
    await showBoard(page);
    if (key) await page.keyboard.press(key);
    for (const width of WIDTHS) {
      for (const height of [768, 1050]) {
        await page.setViewportSize({ width, height });
        assert.deepEqual([...await misplaced(page), ...await cutTexts(page)], [], `at ${width} x ${height} px`);
        assert.ok(await pageWidth(page) <= width, `at ${width} px the page is ${await pageWidth(page)} px wide`);
      }
    }
  });
}

test('the menus of scopes open within the page', async (t) => {
  const page = await openPanel(t, { touch: true });
  for (const width of WIDTHS) {
    await page.setViewportSize({ width, height: 900 });
    for (const menu of await page.locator('.scope .popover').all()) {
      await menu.evaluate((node) => { node.open = true; });
      const [button, box] = await Promise.all(['summary', ':scope > div'].map((part) => menu.locator(part).boundingBox()));
      assert.ok(box.x >= 0 && box.x + box.width <= width, `at ${width} px from ${box.x} to ${box.x + box.width}`);
      const gap = button.y - box.y - box.height;
      assert.ok(gap >= 0 && gap < 10, `at ${width} px it is ${gap} px above its button`);
      await menu.evaluate((node) => { node.open = false; });
    }
  }
});

test('a projector enlarges the type of both drawings, and they fit again without it', async (t) => {
  const page = await openPanel(t, { patch: FIG_8_16, width: 1920, height: 1080 });
  for (const [view, drawing] of [['Schematic', '.schematic'], ['Patch panel', '.board-canvas']]) {
    await showView(page, view);
    await until(`texts of the ${view}`, () => typeSize(page, drawing));
    await painted(page);
    const before = await typeSize(page, drawing);
    await page.getByRole('button', { name: 'Large type for a projector' }).click();
    await until('larger type', async () => await typeSize(page, drawing) > LARGER * before);
    await page.getByRole('button', { name: 'Large type for a projector' }).click();
    await until('the type of before', async () => Math.abs(await typeSize(page, drawing) - before) < 0.01 * before);
  }
});

test('the name of the overloaded amplifier is on the dark readout', async (t) => {
  const page = await openPanel(t, { patch: 'patches/lessons/two-phase-oscillator.json' });
  await type(page, 'damp', 0);
  await sweepOnce(page);
  const text = page.getByText(/^Overload: /);
  await text.waitFor();
  for (const width of WIDTHS) {
    for (const height of [768, 1050]) {
      await page.setViewportSize({ width, height });
      const [inner, outer] = await Promise.all([text, page.locator('.readout')].map((node) => node.boundingBox()));
      assert.ok(inner.x > outer.x && inner.y > outer.y && inner.x + inner.width < outer.x + outer.width
        && inner.y + inner.height < outer.y + outer.height, `at ${width} x ${height} px`);
    }
  }
});

for (const [width, height] of [[360, 740], [1280, 900], [1400, 900], [1920, 1080]]) {
  test(`all controls are large enough for fingers, also in menus and dialogs: ${width} px`, async (t) => {
    const page = await openPanel(t, { patch: FIG_8_16, width, height, touch: true });
    for (const view of VIEWS) {
      await showView(page, view);
      assert.deepEqual(await smallTargets(page), [], view);
    }
    for (const name of ['Keys', 'New', 'Share', 'Gallery']) {
      assert.deepEqual(await smallInDialog(page, () => page.getByRole('button', { name, exact: true }).click()), [], name);
    }
    await showView(page, 'Equations');
    assert.deepEqual(await smallInDialog(page, () => page.locator('.eq-name[data-output]').first().click()), [], 'probes');
    await showBoard(page);
    assert.deepEqual(await smallInDialog(page, () => page.getByRole('button', { name: 'Add element' }).click()), [], 'elements');
    await select(page, 'Problem check');
    await page.getByRole('region', { name: 'Problem check' }).waitFor();
    assert.deepEqual(await smallTargets(page), [], 'problem check');
  });

  test(`a finger chooses between jacks that are ${FINGER} px apart: ${width} px`, async (t) => {
    const page = await openPanel(t, { patch: FIG_8_16, width, height, touch: true });
    await showBoard(page);
    const held = page.locator('#board .jack.is-held');
    const jack = inputJack(page, 'B4.x1');
    assert.ok(await jackDistance(page) < FINGER, 'the whole panel is too small for fingers');
    for (const [plate, look] of Object.entries(PLATES)) {
      await page.getByLabel('Faceplate').selectOption(plate);
      await page.locator(`.board-canvas .faceplate.${look}`).waitFor();
      await painted(page);
      await page.getByRole('group', { name: 'Zoom' }).getByRole('button', { name: 'Fit' }).click();
      assert.ok(await jackDistance(page) < FINGER, plate);
      await jack.scrollIntoViewIfNeeded();
      await painted(page);
      await touch(page, await middleOf(jack));
      await until('larger jacks', async () => await jackDistance(page) >= FINGER);
      assert.equal(await held.count(), 0, 'no jack is taken');
      await touch(page, await middleOf(jack));
      await held.waitFor();
      assert.match(await held.getAttribute('aria-label'), /^B4\.x1,/);
      await page.keyboard.press('Escape');
    }
  });
}

test('a finger next to a name of an equation touches it', async (t) => {
  const page = await openPanel(t, { patch: VAN_DER_POL, width: 360, height: 740, touch: true });
  await showView(page, 'Equations');
  // Names of outputs open a menu.
  const names = page.locator('#eq-solved .eq-name[data-output]');
  const menu = page.getByRole('dialog');
  assert.ok(await names.count() > 3);
  for (const name of await names.all()) {
    await name.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await name.boundingBox();
    for (const [dx, dy] of [[0, -0.4 * FINGER], [0, 0], [0, 0.4 * FINGER]]) {
      await touch(page, [x + width / 2 + dx, y + height / 2 + dy]);
      await menu.waitFor();
      await page.keyboard.press('Escape');
      await menu.waitFor({ state: 'hidden' });
    }
  }
  // The name at the end of a line has room at its right.
  const last = await names.last().boundingBox();
  await touch(page, [last.x + last.width + 0.4 * FINGER, last.y + last.height / 2]);
  await menu.waitFor();
});

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
