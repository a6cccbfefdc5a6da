/** The gallery: examples with measured data, and earlier states of a patch. `?patch=` opens shipped patches and files. */

import assert from 'node:assert/strict';
import { mkdir, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';

import { ROOT, startHost } from './hosts.mjs';
import {
  downloadOf, FORM, gallery, kept, MASS_AND_SPRING, openAddress, openFile, openPanel, parameterIs, ready, stateOf, tab, type, undoButton, until, VAN_DER_POL,
} from './panel.mjs';

const EXAMPLES = 'examples/05_missing_effect';
const LORENZ = 'patches/lessons/lorenz.json';

const jsonOf = async (path) => JSON.parse(await readFile(join(ROOT, path), 'utf8'));
const titleOf = async (path) => (await jsonOf(path)).title;
const view = (page) => page.getByRole('tabpanel', { name: 'Measured data' });
const viewButton = (page, name) => view(page).getByRole('button', { name, exact: true });
const heading = (page, title) => page.getByRole('heading', { level: 1, name: title, exact: true }).waitFor();

async function openGallery(page) {
  await page.getByRole('button', { name: 'Gallery', exact: true }).click();
  await gallery(page).waitFor();
}

/** Opens a patch of the gallery by its card. */
async function openCard(page, path) {
  await openGallery(page);
  await gallery(page).locator(`a[href="?patch=${path}"]`).click();
}

/** The columns of an experiment by the names of signals or drives. */
const columnsOf = (uses) => Object.entries(uses ?? {}).map(([name, use]) => [name, use.column ?? use, use.sigma]);

for (const stem of ['spring', 'slide']) {
  test(`the example ${stem} opens with its measured data, ready to search`, async (t) => {
    const page = await openPanel(t, { patch: null });
    await openCard(page, `${EXAMPLES}/${stem}.json`);
    await ready(page, await titleOf(`${EXAMPLES}/${stem}.json`));
    assert.equal(await tab(page, 'Measured data').getAttribute('aria-selected'), 'true');
    await view(page).getByRole('figure').first().waitFor();
    await until('a search is possible', () => viewButton(page, 'Search').isEnabled());
    // The experiment is that of the repository, with all that no control shows.
    const shipped = await jsonOf(`${EXAMPLES}/${stem}.experiment.json`);
    const { name, content } = await downloadOf(page, () => viewButton(page, 'Save experiment').click());
    const saved = JSON.parse(content);
    assert.equal(name, `${shipped.data.replace('.csv', '')}.experiment.json`);
    for (const key of ['title', 'patch', 'data', 'fit', 'train', 'test']) assert.deepEqual(saved[key], shipped[key], key);
    for (const key of ['outputs', 'drives']) assert.deepEqual(columnsOf(saved[key]), columnsOf(shipped[key]), key);
    await viewButton(page, 'Search').click();
    await view(page).getByRole('progressbar').waitFor();
    await viewButton(page, 'Cancel').click();
  });
}

test('another patch does not get the experiment of an example', async (t) => {
  const page = await openPanel(t, { patch: null });
  await openCard(page, `${EXAMPLES}/spring.json`);
  await until('a search is possible', () => viewButton(page, 'Search').isEnabled());
  await openFile(page, MASS_AND_SPRING);
  await view(page).getByRole('checkbox', { name: 'x0', exact: true }).waitFor();
  await until('a search with the other patch is possible', () => viewButton(page, 'Search').isEnabled());
  const { title, patch } = JSON.parse((await downloadOf(page, () => viewButton(page, 'Save experiment').click())).content);
  assert.match(title, /^Mass and spring: /);
  assert.equal(patch, 'mass-and-spring.json');
});

test('a patch that needs public data says which, and opens without them', async (t) => {
  const page = await openPanel(t, { patch: null });
  await openGallery(page);
  const card = gallery(page).locator('a[href="?patch=measured/emps.json"]');
  assert.match(await card.textContent(), /it needs the public data DATA_EMPS\.mat \(docs\/measured\.md\)/);
  await card.click();
  await ready(page, await titleOf('patches/measured/emps.json'));
  await until('a run', async () => (await stateOf(page)).frame?.time > 0);
});

const summary = (page, title) => gallery(page).getByText('Earlier states').and(gallery(page).getByLabel(`Earlier states of ${title}`));
const states = (page, title) => gallery(page).getByRole('group', { name: `Earlier states of ${title}` }).getByRole('button');

/** Opens the list of the earlier states of a patch by keys. Returns its buttons. */
async function showStates(page, title) {
  await openGallery(page);
  await summary(page, title).focus();
  await page.keyboard.press('Enter');
  await states(page, title).first().waitFor();
  return states(page, title);
}

test('each earlier state of a recent patch opens by keys, and none is lost', async (t) => {
  const page = await openPanel(t);
  const title = await titleOf(MASS_AND_SPRING);
  await kept(page);
  await type(page, 'k', 20);
  await parameterIs(page, 'k', 20);
  await kept(page);
  await openFile(page, VAN_DER_POL);
  await ready(page, await titleOf(VAN_DER_POL));
  // The newest state is that of the card, so one is left.
  assert.equal(await (await showStates(page, title)).count(), 1);
  assert.match(await states(page, title).first().textContent(), /\d:\d\d:\d\d/);
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await ready(page, title);
  await parameterIs(page, 'k', 40);
  // It continues. The state that was the newest one becomes an earlier one.
  await type(page, 'k', 30);
  await parameterIs(page, 'k', 30);
  await kept(page);
  const list = await showStates(page, title);
  await until('two earlier states', async () => (await list.count()) === 2);
  await list.first().click();
  await ready(page, title);
  await parameterIs(page, 'k', 20);
  await undoButton(page).click();
  await parameterIs(page, 'k', 40);
});

/** Writes patches into a folder, which is removed after the test. Returns the folder. */
async function folderOf(t, texts) {
  const folder = await mkdtemp(join(tmpdir(), 'patchcord-'));
  t.after(() => rm(folder, { recursive: true }));
  for (const [name, title] of Object.entries(texts)) {
    await mkdir(join(folder, name, '..'), { recursive: true });
    await writeFile(join(folder, name), JSON.stringify({ ...await jsonOf(MASS_AND_SPRING), title }));
  }
  return folder;
}

const message = (page, text) => page.getByRole('complementary', { name: 'Messages' }).getByText(text).waitFor();

test('?patch= opens patches below the folder of the panel, and shipped ones first', { skip: FORM !== 'server' && 'a static folder has no own files' }, async (t) => {
  const folder = await folderOf(t, { 'start/first.json': 'First', 'start/tasks/spring.json': 'Task', 'start/lessons/lorenz.json': 'Own flow', 'secret.json': 'Secret' });
  const host = await startHost('server', join(folder, 'start/first.json'));
  t.after(host.stop);
  const page = await openAddress(t, host.address);
  await heading(page, 'First');
  const open = (name) => page.goto(new URL(`?patch=${name}`, host.address).href);
  await open('tasks/spring.json');
  await heading(page, 'Task');
  await type(page, 'k', 20);
  await parameterIs(page, 'k', 20);
  await kept(page);
  await page.reload();
  // The change is not saved.
  await heading(page, '• Task');
  await parameterIs(page, 'k', 20);
  await open('lessons/lorenz.json');
  await heading(page, await titleOf(LORENZ));
  await open('./lessons/lorenz.json');
  await heading(page, 'Own flow');
  // What is not there, or not below the folder, is refused in words. The page begins as without a name.
  await open('tasks/missing.json');
  await message(page, /there is no file tasks\/missing\.json in the folder of the panel/);
  await heading(page, 'First');
  await open('../secret.json');
  await message(page, /is not below the folder of the panel/);
  await heading(page, 'First');
});

test('?patch= opens patches below a static folder, and shipped ones first', { skip: FORM !== 'folder' && 'the server has other files' }, async (t) => {
  const page = await openPanel(t, { patch: null });
  const open = (name) => page.goto(new URL(`?patch=${name}`, page.url()).href);
  for (const name of ['lessons/lorenz.json', 'patches/lessons/lorenz.json', './patches/lessons/lorenz.json']) {
    await open(name);
    await heading(page, await titleOf(LORENZ));
  }
  await open('tasks/missing.json');
  await message(page, /There is no file at \/tasks\/missing\.json/);
  await open('//localhost/secret.json');
  await message(page, /opens patches in its own folder only/);
});
