/** The patch in a link: compressed in the part of the address that browsers do not send to servers. */

import { byId, copyText, partsOf } from './dom.js';
import { takeFromAddress } from './link.js';
import { ask, state } from './state.js';

/** The largest text of a patch in a link, in bytes. */
const LARGEST_IN_LINK = 1e6;
/** Some programs cut longer links. */
const LONG_LINK = 8000;

const dialog = byId('share-dialog');

/** The text of a stream, which is not read further than the limit. Rejects with a message if it is larger or no text. */
export async function textOf(stream, limit, name) {
  const parts = [];
  let size = 0;
  const reader = stream.getReader();
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    parts.push(part.value);
    size += part.value.length;
    if (size > limit) {
      reader.cancel();
      throw new Error(`${name} is larger than ${limit / 1e6} MB.`);
    }
  }
  try {
    return new TextDecoder('utf-8', { fatal: true }).decode(await new Blob(parts).arrayBuffer());
  } catch {
    throw new Error(`${name} is not UTF-8 text.`);
  }
}

const through = (data, stream) => new Blob([data]).stream().pipeThrough(stream);

/** Compresses a text. */
export const deflate = (text) => new Response(through(text, new CompressionStream('deflate-raw'))).bytes();

/** The text of compressed bytes. Rejects if they are wrong or the text is larger than the limit. */
export const inflate = (bytes, limit) => textOf(through(bytes, new DecompressionStream('deflate-raw')), limit, 'The patch');

/** The name of a file without folders. */
export const baseName = (path) => path.split(/[\\/]/).at(-1);

/**
 * Takes the patch out of the address: a reload then continues the session instead of beginning again.
 * @returns {Promise<{name: string, text: string} | null>} null if there is none; rejects with a message
 */
export async function takeLink() {
  const [coded, name = ''] = [takeFromAddress('p'), takeFromAddress('name')];
  if (coded === undefined) return null;
  try {
    const bytes = Uint8Array.fromBase64(coded, { alphabet: 'base64url' });
    return { name: baseName(name).slice(-80) || 'shared.json', text: await inflate(bytes, LARGEST_IN_LINK) };
  } catch (fault) {
    throw fault.name === 'Error' ? fault : new Error(dialog.dataset.wrong);
  }
}

const { link, status, server, long, system, again } = partsOf(dialog);
system.hidden = !navigator.share;
system.onclick = () => navigator.share({ url: link.value }).catch(() => {});
again.onclick = copy;

/** Copies the link. */
async function copy() {
  link.select();
  status.textContent = await copyText(link.value) ? 'The link is copied.' : 'Select the link and copy it.';
}

/** Copies the link of the present patch, and shows it. The address has no token, because only its path is used. */
export async function share() {
  const patch = await ask('text');
  if (!patch) return;
  const coded = (await deflate(patch.text)).toBase64({ alphabet: 'base64url', omitPadding: true });
  const url = `${location.href.split(/[?#]/)[0]}#p=${coded}&name=${encodeURIComponent(baseName(patch.name))}`;
  link.value = url;
  server.hidden = state.host?.kind !== 'server' && location.protocol !== 'file:';
  long.hidden = url.length <= LONG_LINK;
  dialog.showModal();
  copy();
}
