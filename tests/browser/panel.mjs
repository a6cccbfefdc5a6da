/** What all browser tests share: a panel in Chromium, its state, and what a user does with it. */

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { extname, join } from 'node:path';
import { after } from 'node:test';

import { launch } from './chromium.mjs';
import { ROOT, startHost, TYPES } from './hosts.mjs';

/** Which form of the panel is tested: "server" or "folder". */
export const FORM = process.env.PANEL_FORM ?? 'server';
/** A folder with page files that replace those of the host, to try page code without a build. */
const PAGE_FILES = process.env.PANEL_PAGE;
/** Milliseconds after which a condition counts as not reached. It is no statement about speed. */
const PATIENCE = 60_000;
/** Milliseconds between two looks at a condition. */
const POLL = 25;

export const MASS_AND_SPRING = 'patches/lessons/mass-and-spring.json';
export const FIG_8_16 = 'patches/thesis/fig-8-16.json';
export const VAN_DER_POL = 'patches/lessons/van-der-pol.json';

/** Hosts by the patch that they open. */
const hosts = new Map();
const browser = launch();

after(async () => {
  await (await browser).close();
  for (const host of hosts.values()) (await host).stop();
});

/** The host that opens this patch. A static folder opens none. */
function hostOf(patch) {
  const key = FORM === 'server' ? patch : null;
  if (!hosts.has(key)) hosts.set(key, startHost(FORM, key));
  return hosts.get(key);
}

/** Replaces files of the page by those of the folder `PANEL_PAGE`. */
async function replaceFiles(context) {
  await context.route('**/*', (route) => {
    const path = new URL(route.request().url()).pathname;
    const file = join(PAGE_FILES, path === '/' ? 'index.html' : path);
    return existsSync(file) ? route.fulfill({ path: file, contentType: TYPES[extname(file)] }) : route.continue();
  });
}

/**
 * Opens an address in a window of its own. The test fails if the page reports an error.
 * @param {import('node:test').TestContext} t
 * @param {{width?: number, height?: number, dark?: boolean, touch?: boolean}} options
 * @returns {Promise<import('playwright-core').Page>}
 */
export async function openAddress(t, address, { width = 1280, height = 900, dark = false, touch = false } = {}) {
  const context = await (await browser).newContext({
    viewport: { width, height }, colorScheme: dark ? 'dark' : 'light', hasTouch: touch, reducedMotion: 'reduce',
  });
  context.setDefaultTimeout(PATIENCE);
  if (PAGE_FILES) await replaceFiles(context);
  const page = await context.newPage();
  const faults = [];
  page.on('pageerror', ({ stack, message }) => faults.push(stack ?? message));
  page.on('console', (message) => { if (message.type() === 'error') faults.push(message.text()); });
  t.after(async () => {
    await context.close();
    // The panel asks for files that a host may lack, and the browser reports that.
    assert.deepEqual(faults.filter((text) => !/\b404\b/.test(text)), [], 'errors of the page');
  });
  await page.goto(address);
  return page;
}

/**
 * Opens a panel with a patch.
 * @param {import('node:test').TestContext} t
 * @param {{patch?: string | null, width?: number, height?: number, dark?: boolean, touch?: boolean}} options
 */
export async function openPanel(t, { patch = MASS_AND_SPRING, ...options } = {}) {
  const page = await openAddress(t, (await hostOf(patch)).address, options);
  if (!patch || FORM === 'folder') await closeGallery(page);
  if (patch && FORM === 'folder') await openFile(page, patch);
  await ready(page, patch && JSON.parse(await readFile(join(ROOT, patch), 'utf8')).title);
  return page;
}

/** The gallery, when it is open. */
export const gallery = (page) => page.getByRole('dialog', { name: 'Gallery' });

/** Closes the gallery, with which a panel begins that has no patch. */
async function closeGallery(page) {
  await gallery(page).waitFor();
  await page.keyboard.press('Escape');
  await gallery(page).waitFor({ state: 'hidden' });
}

/** Opens a patch with the button of the page. */
export async function openFile(page, patch) {
  await until('the session has a patch', async () => (await stateOf(page)).patch);
  await page.getByLabel('Patch file').setInputFiles(join(ROOT, patch));
}

/** Waits for a frame of the patch with this title. */
export async function ready(page, title = null) {
  await until(`a frame of "${title}"`, async () => {
    const { patch, frame } = await stateOf(page);
    return frame && (title === null || patch.title === title);
  });
}

/** Waits for a condition. Returns its value. */
export async function until(what, condition) {
  const end = Date.now() + PATIENCE;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (Date.now() > end) assert.fail(`This did not happen: ${what}`);
    await new Promise((resolve) => { setTimeout(resolve, POLL); });
  }
}

/** The session as the page knows it, with the voltages of the latest frame by the names of the outputs. */
export function stateOf(page) {
  return page.evaluate(async () => {
    const { state } = await import(new URL('js/state.js', document.baseURI).href);
    const { patch, machine, scopes, findings, frame, hello } = state;
    const { scopes: pictures, volts, lamps, ...rest } = frame ?? {};
    const byName = (values) => Object.fromEntries((patch?.outputs ?? []).map(({ name }, index) => [name, values[index]]));
    return {
      patch, machine, scopes, findings, machines: hello?.machines,
      frame: frame && { ...rest, volts: byName(volts), lamps: byName(lamps) },
    };
  });
}

/** Sends commands as the page does, for what no control does. Returns the events. */
export function command(page, ...commands) {
  return page.evaluate(async (list) => {
    const { sendAll } = await import(new URL('js/state.js', document.baseURI).href);
    return sendAll(list);
  }, commands);
}

export const modeButton = (page, name) => page.getByRole('group', { name: 'Mode' }).getByRole('button', { name, exact: true });
export const knobOf = (page, name) => page.getByRole('group', { name, exact: true });
export const scopeOf = (page, number) => page.getByRole('group', { name: `Scope ${number}`, exact: true });
export const undoButton = (page) => page.getByRole('group', { name: 'History' }).getByRole('button').first();
export const redoButton = (page) => page.getByRole('group', { name: 'History' }).getByRole('button').last();
export const tab = (page, name) => page.getByRole('tab', { name, exact: true });

/** Selects a mode and waits until the machine is in it. */
export async function select(page, name) {
  const button = modeButton(page, name);
  await button.click();
  await until(`mode ${name}`, async () => (await button.getAttribute('aria-pressed')) === 'true');
}

/** Runs the sweep of the patch once, as fast as possible, and waits for its end. */
export async function sweepOnce(page) {
  await select(page, 'Initial condition');
  await page.getByRole('button', { name: 'Maximum speed' }).click();
  await until('the start of the sweep', async () => (await stateOf(page)).frame?.time === 0);
  await modeButton(page, 'Single sweep').click();
  await until('the end of the sweep', async () => {
    const { frame, machine } = await stateOf(page);
    return frame && !frame.moves && Math.abs(frame.time - machine.sweep) < 1e-9 * machine.sweep;
  });
}

/** Types a value into the field of a knob. */
export async function type(page, knob, value) {
  const field = knobOf(page, knob).getByRole('textbox');
  await field.fill(String(value));
  await field.press('Enter');
}

/** Waits until a parameter has a value. */
export function parameterIs(page, name, value) {
  return until(`${name} is ${value}`, async () => (await parameterOf(page, name)) === value);
}

export async function parameterOf(page, name) {
  return (await stateOf(page)).patch.parameters.find((each) => each.name === name).value;
}

/** The file that the page gives to the user after an action. */
export async function downloadOf(page, action) {
  const [download] = await Promise.all([page.waitForEvent('download'), action()]);
  return { name: download.suggestedFilename(), content: await readFile(await download.path()) };
}

/** Exports a scope as "SVG", "PNG" or "CSV". */
export function exportOf(page, scope, format) {
  return downloadOf(page, async () => {
    const entry = scopeOf(page, scope).getByRole('button', { name: `Export as ${format}` });
    if (!await entry.isVisible()) await scopeOf(page, scope).locator('summary', { hasText: 'More' }).click();
    await entry.click();
  });
}

/** Waits until the browser keeps the present state of the patch. */
export function kept(page) {
  return until('the patch is kept', () => page.evaluate(async () => {
    const { keep } = await import(new URL('js/autosave.js', document.baseURI).href);
    return keep();
  }));
}

/** The rows of a CSV file as objects by column. Lines with # are left out. */
export function rowsOf(csv) {
  const [head, ...lines] = csv.trim().split('\n').filter((line) => !line.startsWith('#'));
  const names = head.split(',');
  return lines.map((line) => Object.fromEntries(line.split(',').map((cell, index) => [names[index], cell === '' ? NaN : Number(cell)])));
}

/** The pictures on the screen of a scope, as a text that differs if they do. */
export function picturesOf(page, number) {
  return scopeOf(page, number).locator('canvas').evaluateAll((canvases) => canvases.map((canvas) => canvas.toDataURL()).join());
}

/** Places the probes of a scope. */
export async function probe(page, number, ...outputs) {
  for (const [index, output] of outputs.entries()) {
    await scopeOf(page, number).getByRole('group', { name: new RegExp(`channel ${index + 1}`, 'i') }).getByRole('combobox', { name: 'Probe', exact: true }).selectOption(output);
  }
  await until(`probes of scope ${number}`, async () => {
    const { channels } = (await stateOf(page)).scopes[number - 1];
    return outputs.every((output, index) => channels[index].output === output);
  });
}
