/**
 * Makes the pictures of docs/panel.md: `node screenshots.mjs [NAME...]`. The server of the command shows Fig 8.16 at a fixed
 * problem time, or measured data of a spring, so the pictures change only if the page does.
 */

import { mkdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';

import { launch } from './chromium.mjs';
import { ROOT, startHost } from './hosts.mjs';

const PATCH = 'patches/thesis/fig-8-16.json';
const TITLE = 'Final simulation circuit';
/** A patch with measured data, and what the search finds. */
const SPRING = 'examples/05_missing_effect/spring.json';
const MEASURED = join(ROOT, 'examples/05_missing_effect/measured.csv');
const FOUND = 'viscous-friction at A1 is missing';
const FOLDER = join(ROOT, 'docs/pictures/panel');
/** Seconds of the run, and the time at its end as the page writes it. */
const [RUN, END] = ['0.8', '0.8000'];
/** Volts per division of the channels of scope 1, and of both axes of scope 2. */
const SCALES = [['10', '10'], ['5', '5']];
/** Milliseconds in which a trace has faded and the page rests. */
const REST = 1500;
const QUALITY = 0.85;
const LARGEST = 250_000;

const desk = { width: 1280, height: 1000 };
const large = { width: 1920, height: 1080 };
/** What each picture shows: the window, keys that are pressed at the end, a part of the page, and what comes before. */
const PICTURES = {
  '1280-light': desk,
  '1280-dark': { ...desk, dark: true },
  '1920-light': large,
  '1920-dark': { ...large, dark: true },
  'phone-light': { width: 390, height: 844, touch: true },
  'phone-dark': { width: 390, height: 844, touch: true, dark: true },
  schematic: { ...large, keys: '1vv', part: '.views' },
  board: { ...large, keys: '2vv', part: '.views' },
  equations: { ...large, keys: '3vv', part: '.views' },
  gallery: { ...desk, keys: 'g' },
  measured: { ...large, keys: 'vv', part: '.views', patch: SPRING, prepare: search },
};

/** Runs the patch once and leaves it in hold. */
async function run(page) {
  await page.locator('#title', { hasText: TITLE }).waitFor();
  for (const [index, scales] of SCALES.entries()) {
    const lists = page.getByRole('group', { name: `Scope ${index + 1}`, exact: true }).getByRole('combobox', { name: 'Per division' });
    for (const [channel, volts] of scales.entries()) await lists.nth(channel).selectOption(volts);
  }
  await page.getByLabel('Sweep, s').fill(RUN);
  await page.getByLabel('Sweep, s').press('Enter');
  await page.getByRole('button', { name: 'Maximum speed' }).click();
  await page.getByRole('button', { name: 'Single sweep' }).click();
  await page.locator('#time', { hasText: END }).waitFor();
}

/** Opens measured data and searches for what the patch lacks. */
async function search(page) {
  await page.getByLabel('Patch file or data file').setInputFiles(MEASURED);
  const view = page.getByRole('tabpanel', { name: 'Measured data' });
  // The motion depends on k/m only, so one of them is fitted.
  await view.getByRole('checkbox', { name: 'm', exact: true }).uncheck();
  await view.getByRole('button', { name: 'Search', exact: true }).click();
  await view.getByText(FOUND, { exact: true }).waitFor();
}

/** Chromium writes PNG and JPEG only, but its pages write WebP, which is smaller and has sharper text. */
async function webp(browser, png) {
  const page = await browser.newPage();
  const text = await page.evaluate(async ({ data, quality }) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const canvas = new OffscreenCanvas(image.width, image.height);
    canvas.getContext('2d').drawImage(image, 0, 0);
    const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: 'image/webp', quality })).arrayBuffer());
    return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
  }, { data: png.toString('base64'), quality: QUALITY });
  await page.close();
  return Buffer.from(text, 'base64');
}

async function draw(browser, name) {
  const { keys = '', part = null, dark = false, touch = false, patch = PATCH, prepare = run, ...viewport } = PICTURES[name];
  const host = await startHost('server', patch);
  const context = await browser.newContext({
    viewport, colorScheme: dark ? 'dark' : 'light', hasTouch: touch, reducedMotion: 'reduce', locale: 'en-GB',
  });
  const page = await context.newPage();
  await page.goto(host.address);
  await prepare(page);
  for (const key of keys) await page.keyboard.press(key);
  await page.evaluate(() => {
    document.activeElement.blur();
    scrollTo(0, 0);
  });
  await page.mouse.move(0, 0);
  await page.waitForTimeout(REST);
  const content = await webp(browser, await (part ? page.locator(part) : page).screenshot());
  await context.close();
  host.stop();
  if (content.length > LARGEST) throw new Error(`${name} has ${content.length} bytes, and the limit is ${LARGEST}.`);
  await writeFile(join(FOLDER, `${name}.webp`), content);
  console.log(`${name}.webp: ${(content.length / 1000).toFixed(0)} kB`);
}

const names = process.argv.length > 2 ? process.argv.slice(2) : Object.keys(PICTURES);
const unknown = names.find((name) => !(name in PICTURES));
if (unknown) {
  console.error(`There is no picture "${unknown}". The pictures are: ${Object.keys(PICTURES).join(', ')}.`);
  process.exit(1);
}
await mkdir(FOLDER, { recursive: true });
const browser = await launch();
try {
  for (const name of names) await draw(browser, name);
} finally {
  await browser.close();
}
