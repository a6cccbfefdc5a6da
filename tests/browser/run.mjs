/**
 * Runs the browser tests: `node run.mjs [server] [folder] [-- FILE.test.mjs...]`. Without a form, the server is tested, and
 * the static folder if it is there. If both are tested, tests that depend on the page only run with the first.
 */

import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { findChromium, PATCHCORD, SITE } from './hosts.mjs';

const HERE = fileURLToPath(new URL('.', import.meta.url));
const NEEDS = {
  server: [PATCHCORD, 'Build it with: cargo build'],
  folder: [join(SITE, 'index.html'), 'Build it with: crates/web/build-site'],
};

/** Tests of layout, colours and accessibility, for which both forms have the same page. */
const ONCE = ['colours.test.mjs', 'looks.test.mjs'];

function fail(message) {
  console.error(message);
  process.exit(1);
}

const words = process.argv.slice(2);
const end = words.includes('--') ? words.indexOf('--') : words.length;
const named = words.slice(0, end);
const unknown = named.find((form) => !(form in NEEDS));
if (unknown) fail(`There is no form "${unknown}" of the panel. The forms are: ${Object.keys(NEEDS).join(', ')}.`);
if (!existsSync(join(HERE, 'node_modules'))) fail('The packages of the tests are missing. Install them with: npm ci --prefix tests/browser');
if (!findChromium()) fail('Chromium is missing. Install the package chromium, or set CHROMIUM to its path.');

let forms = named;
if (forms.length === 0) {
  forms = existsSync(NEEDS.folder[0]) ? ['server', 'folder'] : ['server'];
  if (forms.length === 1) console.log(`The static folder is not tested, because it is not there. ${NEEDS.folder[1]}`);
}
// The tests of the folder compare it with the command, so both forms need the command.
for (const form of new Set(['server', ...forms])) {
  const [path, remedy] = NEEDS[form];
  if (!existsSync(path)) fail(`${path} is missing. ${remedy}`);
}
const files = end < words.length ? words.slice(end + 1) : readdirSync(HERE).filter((name) => name.endsWith('.test.mjs')).sort();
let isGood = true;
for (const [index, form] of forms.entries()) {
  const tests = index > 0 && end === words.length ? files.filter((name) => !ONCE.includes(name)) : files;
  console.log(`Browser tests of the panel, form "${form}"`);
  const { status } = spawnSync(process.execPath, ['--test', '--test-concurrency=1', '--test-reporter=spec', ...tests],
    { cwd: HERE, stdio: 'inherit', env: { ...process.env, PANEL_FORM: form } });
  isGood &&= status === 0;
}
process.exit(isGood ? 0 : 1);
