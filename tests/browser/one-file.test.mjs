/**
 * The panel as one file, from a file address: the page of the static folder, and one that the command exports. A file
 * address has no server, so a page that requests anything else than itself fails.
 */

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFile, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';

import { PATCHCORD, ROOT, SITE } from './hosts.mjs';
import { FORM, MASS_AND_SPRING, downloadOf, gallery, knobOf, openAddress, picturesOf, select, type, until } from './panel.mjs';

const options = { skip: FORM !== 'folder' && 'the page needs the static folder' };
const HOSTILE = '</script><script>alert(1)</script><!-- <script>';

/** A folder that is removed after the test. */
async function scratch(t) {
  const folder = await mkdtemp(join(tmpdir(), 'patchcord-'));
  t.after(() => rm(folder, { recursive: true }));
  return folder;
}

/** Opens a page from its file, and checks at the end that it has requested nothing else. */
async function openLocal(t, file, query = '') {
  const page = await openAddress(t, 'about:blank');
  const requests = [];
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(pathToFileURL(file).href + query);
  t.after(() => assert.deepEqual(requests.filter((url) => !/^(blob|data):/.test(url) && !url.startsWith(pathToFileURL(file).href)), []));
  return page;
}

const heading = (page, title) => page.getByRole('heading', { level: 1, name: title, exact: true }).waitFor();

/** Waits until the time and the trace of the first scope move. */
async function moves(page) {
  const [time, pictures] = [await page.getByRole('timer').textContent(), await picturesOf(page, 1)];
  await until('the time moves', async () => await page.getByRole('timer').textContent() !== time);
  await until('the trace moves', async () => await picturesOf(page, 1) !== pictures);
}

/** Writes a patch and exports it. Returns the text of the patch and the file of the page. */
async function exported(t, change) {
  const folder = await scratch(t);
  const [patch, file] = ['spring.json', 'page.html'].map((name) => join(folder, name));
  const document = JSON.parse(await readFile(join(ROOT, MASS_AND_SPRING), 'utf8'));
  const text = `${JSON.stringify({ ...document, ...change }, null, 2)}\n`;
  await writeFile(patch, text);
  execFileSync(PATCHCORD, ['panel', '--export', file, '--site', SITE, patch]);
  return { text, file };
}

test('an exported page opens with its patch and operates', options, async (t) => {
  const { text, file } = await exported(t, { title: 'A spring on a stick' });
  const page = await openLocal(t, file);
  await heading(page, 'A spring on a stick');
  await select(page, 'Operate');
  await moves(page);
  await type(page, 'm', 4);
  await until('the mass is turned', async () => await knobOf(page, 'm').getByRole('textbox').inputValue() === '4');
  await page.getByRole('button', { name: 'Undo' }).click();
  const { name, content } = await downloadOf(page, () => page.getByRole('button', { name: 'Save' }).click());
  assert.equal(name, 'spring.json');
  assert.equal(String(content), text);
});

test('no text of a patch is code of an exported page', options, async (t) => {
  const { file } = await exported(t, { title: HOSTILE, note: HOSTILE });
  const page = await openLocal(t, file);
  page.on('dialog', () => assert.fail('the title was executed'));
  await heading(page, HOSTILE);
  assert.equal(await page.title(), `${HOSTILE} – patchcord`);
});

test('patchcord.html begins with the gallery, and a click runs a patch', options, async (t) => {
  const page = await openLocal(t, join(SITE, 'patchcord.html'));
  await gallery(page).waitFor();
  const pictures = gallery(page).getByRole('img').or(gallery(page).locator('img'));
  await until('the pictures are there', () => pictures.evaluateAll((all) => all.length > 30 && all.slice(0, 5).every((image) => image.naturalWidth > 0)));
  await gallery(page).getByRole('link', { name: /Van der Pol/ }).first().click();
  await heading(page, /Van der Pol/);
  await moves(page);
  await page.getByRole('tab', { name: 'Patch panel' }).click();
  await page.locator('#board .faceplate').first().waitFor();
  // The address names the patch, and a reload continues with it.
  assert.match(page.url(), /patchcord\.html\?patch=lessons\/van-der-pol\.json$/);
  await page.reload();
  await heading(page, /Van der Pol/);
});

test('patchcord.html has the measured data of its examples', options, async (t) => {
  const page = await openLocal(t, join(SITE, 'patchcord.html'), '?patch=examples/05_missing_effect/spring.json');
  await heading(page, 'Mass on a spring');
  const view = page.getByRole('tabpanel', { name: 'Measured data' });
  await view.getByRole('figure').waitFor();
  await until('a search is possible', () => view.getByRole('button', { name: 'Search', exact: true }).isEnabled());
});

test('a copy of patchcord.html alone is enough, and its address can name a patch', options, async (t) => {
  const file = join(await scratch(t), 'ein Blatt ä.html');
  await copyFile(join(SITE, 'patchcord.html'), file);
  const page = await openLocal(t, file, '?patch=lessons/lorenz.json');
  await heading(page, /Lorenz/);
  await select(page, 'Operate');
  await moves(page);
});

test('index.html from a file says which file to open', options, async (t) => {
  const context = await openAddress(t, 'about:blank').then((page) => page.context());
  // Its errors are expected, so it is another page than that of openAddress.
  const page = await context.newPage();
  await page.goto(pathToFileURL(join(SITE, 'index.html')).href);
  await page.getByText('open the file patchcord.html').waitFor();
});
