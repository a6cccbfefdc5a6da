// Tests of the folder that crates/web/build-site writes:
//
//     node --test crates/web/tests/*.mjs
//
// With the path of the command in PATCHCORD, the samples of every shipped patch are compared with those of the command.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import test from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

const root = fileURLToPath(new URL('../../../', import.meta.url));
const site = join(process.env.CARGO_TARGET_DIR ?? join(root, 'target'), 'site');

let workers = 0;

/**
 * Loads engine.js as a Worker does, from a web server with this response. Returns a function that sends a message and
 * gives its answer. `report` gets partial responses.
 */
async function start(respond, module = 'engine.wasm', report = assert.fail) {
  globalThis.fetch = async (url) => respond(readFileSync(fileURLToPath(url)));
  await import(`${pathToFileURL(join(site, 'worker/engine.js'))}?module=${module}&${workers += 1}`);
  const { onmessage } = globalThis;
  return (data) => new Promise((resolve) => {
    globalThis.postMessage = (answer, transfer) => (answer.partial ? report(answer) : resolve({ ...answer, transfer }));
    onmessage({ data });
  });
}

const typed = (type) => (bytes) => new Response(bytes, { headers: { 'content-type': type } });
const wasm = typed('application/wasm');

/** Sends commands, and returns the events of the answer and its frame. */
async function send(worker, ...commands) {
  const answer = await worker({ text: JSON.stringify({ id: 1, commands }) });
  assert.equal(answer.failed, undefined);
  return { events: JSON.parse(answer.text).events, ...answer };
}

for (const type of ['application/wasm', 'application/wasm; charset=utf-8', 'text/plain']) {
  test(`the engine is loaded as ${type}`, async () => {
    const { events, frame } = await send(await start(typed(type)), { command: 'hello' });
    assert.equal(events[0].event, 'hello');
    assert.equal(frame, null);
  });
}

test('a frame is transferred', async () => {
  const { frame, transfer } = await send(await start(wasm), { command: 'advance', seconds: 0.02 });
  assert.ok(frame instanceof ArrayBuffer && frame.byteLength > 0);
  assert.deepEqual(transfer, [frame]);
});

test('requests are answered in order, also those that come before the engine', async () => {
  const worker = await start(wasm);
  const ids = [1, 2, 3];
  const answers = [];
  const all = new Promise((resolve) => {
    for (const id of ids) worker({ text: JSON.stringify({ id, commands: [] }) });
    globalThis.postMessage = ({ text }) => {
      answers.push(JSON.parse(text).id);
      if (answers.length === ids.length) resolve();
    };
  });
  await all;
  assert.deepEqual(answers, ids);
});

test('a missing engine is reported', async () => {
  const worker = await start(() => new Response('', { status: 404 }));
  assert.match((await worker({ text: '' })).failed, /engine.wasm is missing/);
});

test('a panic is reported, and no request is answered after it', async () => {
  const encode = TextEncoder.prototype.encode;
  const worker = await start(wasm);
  await send(worker, { command: 'hello' });
  TextEncoder.prototype.encode = () => ({ length: 0xffff_ffff });
  const { failed } = await worker({ text: '' });
  TextEncoder.prototype.encode = encode;
  assert.match(failed, /fault in patchcord: panicked at .*capacity overflow/s);
  assert.equal((await worker({ text: '{"id": 7, "commands": []}' })).failed, failed);
});

test('without a name, the Worker loads the engine of the panel', async () => {
  const asked = [];
  globalThis.fetch = (url) => {
    asked.push(String(url));
    return new Promise(() => {});
  };
  await import(pathToFileURL(join(site, 'worker/engine.js')));
  globalThis.onmessage({ data: { text: '' } });
  assert.match(asked[0], /\/engine\.wasm$/);
});

for (const [module, imports] of [['engine.wasm', ['fail', 'now']], ['search.wasm', ['fail', 'partial']]]) {
  test(`${module} needs nothing but its host`, () => {
    const compiled = new WebAssembly.Module(readFileSync(join(site, module)));
    const found = WebAssembly.Module.imports(compiled).map((entry) => `${entry.module}.${entry.name}`);
    assert.deepEqual(found.sort(), imports.map((name) => `host.${name}`));
  });

  test(`messages of ${module} name no folder of the computer that compiled it`, () => {
    const text = readFileSync(join(site, module)).toString('latin1');
    assert.ok(text.includes('crates/core/src/'));
    assert.doesNotMatch(text, /\/(home|root|usr|Users)\//);
  });
}

test('a search reports its progress and finds the missing effect', async () => {
  const partial = [];
  const worker = await start(wasm, 'search.wasm', (answer) => partial.push(answer));
  const given = (name) => ({ name, text: readFileSync(join(root, 'examples/05_missing_effect', name), 'utf8') });
  const experiment = { outputs: { x: 'x' }, fit: ['k'] };
  await send(worker, { command: 'begin', patch: given('spring.json'), data: given('measured.csv') }, { command: 'compare', experiment });
  assert.deepEqual(partial, []);
  const { events } = await send(worker, { command: 'search', seed: 1 });
  assert.match(events.find(({ event }) => event === 'found').sentence, /viscous-friction/);
  assert.ok(partial.length > 0);
  for (const { text } of partial) {
    const { id, events: steps } = JSON.parse(text);
    assert.equal(id, 1);
    assert.ok(steps.every(({ event }) => event === 'progress'));
  }
});

test('the samples of shipped patches have the bits of the command', { skip: !process.env.PATCHCORD }, async (t) => {
  const worker = await start(wasm);
  const folder = mkdtempSync(join(tmpdir(), 'patchcord-'));
  t.after(() => rmSync(folder, { recursive: true }));
  const groups = ['lessons', 'others', 'problems', 'thesis', 'measured'].map((group) => `patches/${group}`);
  for (const group of [...groups, 'examples/05_missing_effect']) {
    for (const name of readdirSync(join(root, group)).filter((file) => /(?<!\.experiment)\.json$/.test(file))) {
      const file = join(root, group, name);
      const csv = join(folder, 'samples.csv');
      execFileSync(process.env.PATCHCORD, ['run', file, '--csv', csv], { stdio: ['ignore', 'ignore', 'inherit'] });
      const text = readFileSync(file, 'utf8');
      const { events } = await send(worker, { command: 'open', name, text }, { command: 'run' });
      const table = events.find(({ event }) => event === 'table');
      assert.ok(table, `${name}: ${JSON.stringify(events.find(({ event }) => event === 'refused'))}`);
      assert.ok(table.csv === readFileSync(csv, 'utf8'), `${group}/${name} has other samples than the command`);
    }
  }
});
