/** The two forms of the panel: the server of the command, and the static folder. */

import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import { delimiter, extname, join, normalize, sep } from 'node:path';
import { fileURLToPath } from 'node:url';

/** The folder of the project. */
export const ROOT = fileURLToPath(new URL('../../', import.meta.url));
const TARGET = process.env.CARGO_TARGET_DIR ?? join(ROOT, 'target');
/** The command, built by `cargo build`. */
export const PATCHCORD = process.env.PATCHCORD ?? join(TARGET, 'debug', 'patchcord');
/** The static folder, built by crates/web. */
export const SITE = process.env.PATCHCORD_SITE ?? join(TARGET, 'site');

export const TYPES = {
  '.css': 'text/css', '.csv': 'text/csv', '.html': 'text/html', '.js': 'text/javascript', '.json': 'application/json',
  '.png': 'image/png', '.svg': 'image/svg+xml', '.wasm': 'application/wasm',
};

/** The path of Chromium, or null. */
export function findChromium() {
  const names = ['chromium', 'chromium-browser'];
  const paths = process.env.PATH.split(delimiter).flatMap((folder) => names.map((name) => join(folder, name)));
  return process.env.CHROMIUM || paths.find((path) => existsSync(path)) || null;
}

/** Starts `patchcord panel` with a patch. The address has the token. */
async function startCommand(patch) {
  const command = spawn(PATCHCORD, ['panel', ...(patch ? [patch] : []), '--no-open', '--port', '0'], { cwd: ROOT });
  let printed = '';
  const address = await new Promise((resolve, reject) => {
    const read = (data) => {
      printed += data;
      const found = printed.match(/http:\S+/);
      if (found) resolve(found[0]);
    };
    command.stdout.on('data', read);
    command.stderr.on('data', read);
    command.on('error', reject);
    command.on('exit', () => reject(new Error(`patchcord panel ended: ${printed}`)));
  });
  return { address, stop: () => command.kill() };
}

/** Serves the static folder as any web server would. */
async function startFolder() {
  const server = createServer(async ({ url }, answer) => {
    const path = decodeURIComponent(new URL(url, 'http://localhost').pathname);
    const file = normalize(join(SITE, path.endsWith('/') ? `${path}index.html` : path));
    const content = file.startsWith(SITE + sep) ? await readFile(file).catch(() => null) : null;
    answer.writeHead(content ? 200 : 404, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream' });
    answer.end(content ?? 'not found');
  });
  await new Promise((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  return {
    address: `http://127.0.0.1:${server.address().port}/`,
    stop() {
      server.closeAllConnections();
      server.close();
    },
  };
}

/** @param {'server' | 'folder'} form @param {string | null} patch what the server opens; a folder has no patch of its own */
export function startHost(form, patch) {
  return form === 'server' ? startCommand(patch) : startFolder();
}
