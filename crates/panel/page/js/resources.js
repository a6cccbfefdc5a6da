/**
 * The files of the page: engine, patches, faceplates and pictures. patchcord.html has all of them in its document, each as
 * the text of an element `script` with its path. Otherwise they are at their addresses.
 */

/** The element with a file. @returns {HTMLScriptElement | undefined} */
const elementOf = (path) => [...document.scripts].find(({ dataset }) => dataset.path === path);

/** Whether the document has a file. */
export const isInside = (path) => Boolean(elementOf(path));

/**
 * A file as the response to a request for it. `address` is where it is if the document does not have it. Rejects with a
 * message if it is not there.
 */
export async function read(path, address = path) {
  const element = elementOf(path);
  if (!element) {
    const answer = await fetch(address, { redirect: 'error' }).catch(() => null);
    if (answer?.ok) return answer;
    throw new Error(`There is no file at ${new URL(address, document.baseURI).pathname}. Check the address, and that its server runs.`);
  }
  if (element.dataset.encoding !== 'gzip-base64') return new Response(element.text);
  const bytes = Uint8Array.from(atob(element.text), (char) => char.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip')));
}

/** An address for an element or a Worker that loads a file. Browsers start no Worker from a blob of a page in a file. */
export function addressOf(path, type) {
  const element = elementOf(path);
  return element ? `data:${type},${encodeURIComponent(element.text)}` : path;
}
