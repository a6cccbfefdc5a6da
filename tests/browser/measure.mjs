/**
 * Measures the panel in Chromium and prints the tables of docs/panel.md: `node measure.mjs [server] [folder]`. Without a form,
 * the server is measured, and the static folder if it is there. The numbers count only if the computer does nothing else.
 */

import { existsSync } from 'node:fs';
import { cpus, loadavg } from 'node:os';
import { join } from 'node:path';

import { launch } from './chromium.mjs';
import { SITE, startHost } from './hosts.mjs';

const PATCH = 'thesis/fig-8-16.json';
const TITLE = 'Final simulation circuit';
const WINDOWS = [[1280, 800], [1920, 1080]];
/** Milliseconds before a measurement, and pictures in it. */
const [WARM_UP, PICTURES] = [2000, 600];
/** Turns of a knob. */
const TURNS = 40;
/** Loads of the page. */
const LOADS = 5;

const sorted = (values) => [...values].sort((one, other) => one - other);
/** The value below which this share of the values is. */
const quantile = (values, share) => sorted(values)[Math.min(values.length - 1, Math.floor(share * values.length))];
const text = (value, digits = 1) => value.toFixed(digits);

/** Selects Operate when the patch is there, and stores the time of the first picture with a trace. */
function operateAtOnce(title) {
  document.addEventListener('DOMContentLoaded', async () => {
    const { on, state } = await import(new URL('js/state.js', document.baseURI).href);
    let isOn = false;
    on('frame', ({ time }) => {
      if (!state.patch.title.startsWith(title)) return;
      if (!isOn) document.querySelector('.mode[value=operate]').click();
      isOn = true;
      // The picture is drawn before the second next one begins.
      if (time > 0) requestAnimationFrame(() => requestAnimationFrame(() => { globalThis.firstTrace ??= performance.now(); }));
    });
  });
}

async function open(browser, address, [width, height]) {
  const context = await browser.newContext({ viewport: { width, height } });
  const page = await context.newPage();
  await page.addInitScript(operateAtOnce, TITLE);
  await page.goto(address);
  for (;;) {
    const milliseconds = await page.evaluate(() => globalThis.firstTrace);
    if (milliseconds) return { context, page, milliseconds };
    await page.waitForTimeout(20);
  }
}

/** The milliseconds between pictures, and how many frames of the machine came. */
const intervals = (page, count) => page.evaluate(async (pictures) => {
  const { on } = await import(new URL('js/state.js', document.baseURI).href);
  let frames = 0;
  on('frame', () => { frames += 1; });
  const times = await new Promise((resolve) => {
    const found = [];
    const next = (now) => {
      found.push(now);
      if (found.length > pictures) resolve(found);
      else requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  });
  return { frames, intervals: times.slice(1).map((time, at) => time - times[at]) };
}, count);

/** Milliseconds from a turn of a knob to the next frame of the machine with the new value. */
const turns = (page, count) => page.evaluate(async (number) => {
  const { on, send, state } = await import(new URL('js/state.js', document.baseURI).href);
  const { name, value } = state.patch.parameters[0];
  const found = [];
  let arrive = () => {};
  on('frame', () => arrive());
  for (let turn = 1; turn <= number; turn += 1) {
    await new Promise((resolve) => { setTimeout(resolve, 50 + 7 * (turn % 5)); });
    const begin = performance.now();
    await send('parameter', { name, value: value * (1 + turn / 1000) });
    await new Promise((resolve) => { arrive = resolve; });
    found.push(performance.now() - begin);
  }
  return found;
}, count);

/** Seconds of the problem per second at maximum speed. */
const pace = (page) => page.evaluate(async () => {
  const { on } = await import(new URL('js/state.js', document.baseURI).href);
  const found = [];
  on('frame', ({ factor }) => { found.push(factor); });
  await new Promise((resolve) => { setTimeout(resolve, 3000); });
  return found;
});

/** How many cords are on the patch panel. */
const cords = (page) => page.locator('#board .cords > .cord').count();

/** Seconds of processor time of the page's thread since it was opened: in scripts, in styles with layout, and in all. */
async function work(client) {
  const { metrics } = await client.send('Performance.getMetrics');
  const of = (name) => metrics.find((metric) => metric.name === name).value;
  return { scripts: of('ScriptDuration'), layout: of('LayoutDuration') + of('RecalcStyleDuration'), all: of('TaskDuration') };
}

async function measure(browser, form, address, size) {
  const { context, page } = await open(browser, address, size);
  await page.getByRole('group', { name: 'Mode' }).getByRole('button', { name: 'Repetitive' }).click();
  await page.getByRole('tab', { name: 'Patch panel' }).click();
  // Four traces: both scopes draw two channels against time.
  await page.getByRole('group', { name: 'Scope 2', exact: true }).getByRole('combobox', { name: 'Display' }).selectOption('time');
  await page.waitForTimeout(WARM_UP);
  const client = await context.newCDPSession(page);
  await client.send('Performance.enable', { timeDomain: 'threadTicks' });
  const before = await work(client);
  const { frames, intervals: between } = await intervals(page, PICTURES);
  const after = await work(client);
  const count = await cords(page);
  const each = (name) => text(1000 * (after[name] - before[name]) / PICTURES);
  const late = await turns(page, TURNS);
  await page.getByRole('button', { name: 'Maximum speed' }).click();
  await page.waitForTimeout(WARM_UP);
  const factor = quantile(await pace(page), 0.5);
  await context.close();
  const cells = [form, size.join(' × '), count, text(1000 * between.length / between.reduce((sum, time) => sum + time, 0)),
    text(quantile(between, 0.5)), text(quantile(between, 0.99)), text(frames / PICTURES, 2), each('scripts'), each('layout'), each('all'),
    `${text(quantile(late, 0.5), 0)}, ${text(Math.max(...late), 0)}`, text(factor, 0)];
  return `| ${cells.join(' | ')} |`;
}

async function load(browser, form, address) {
  const times = [];
  for (let count = 0; count < LOADS; count += 1) {
    const { context, milliseconds } = await open(browser, address, WINDOWS[0]);
    times.push(milliseconds);
    await context.close();
  }
  return `| ${form} | ${text(quantile(times, 0.5), 0)} | ${text(Math.max(...times), 0)} |`;
}

const FORMS = { server: 'patchcord panel', folder: 'static folder' };
const named = process.argv.slice(2);
const unknown = named.find((form) => !(form in FORMS));
if (unknown) {
  console.error(`There is no form "${unknown}" of the panel. The forms are: ${Object.keys(FORMS).join(', ')}.`);
  process.exit(1);
}
const forms = named.length > 0 ? named : ['server', ...existsSync(join(SITE, 'index.html')) ? ['folder'] : []];
const busy = loadavg()[0];
const browser = await launch();
const [rows, loads] = [[], []];
try {
  for (const form of forms) {
    const host = await startHost(form, `patches/${PATCH}`);
    const address = form === 'server' ? host.address : `${host.address}?patch=${PATCH}`;
    loads.push(await load(browser, FORMS[form], address));
    for (const size of WINDOWS) rows.push(await measure(browser, FORMS[form], address, size));
    host.stop();
  }
  console.log(`Chromium ${browser.version()}, ${cpus().length} × ${cpus()[0].model.trim()}, load ${text(busy, 2)} at the start and ${text(loadavg()[0], 2)} at the end.\n`);
} finally {
  await browser.close();
}
const table = (heads, lines) => console.log([`| ${heads.join(' | ')} |`, `|${'---|'.repeat(heads.length)}`, ...lines, ''].join('\n'));
table(['form', 'window', 'cords', 'pictures per second', 'interval, median', '99 %', 'frames per picture', 'scripts', 'style and layout', 'all',
  'knob, median and longest', 'times real time'], rows);
table(['form', 'first trace, median', 'longest'], loads);
