/**
 * The way to a session or a comparison: a server behind a WebSocket or an engine in a Worker. Both answer requests in order.
 *
 * @typedef {{text: string, frame: ArrayBuffer | null}} Answer
 * @typedef {{kind: 'server' | 'worker', patch?: string | null, text?: string, request: (text: string) => Promise<Answer>,
 *   lost: Promise<string>, onpartial: (text: string) => void, close: () => void}} Link  `patch` is the name of the patch that
 *   the host opens first, and `text` its text if it is in host.json; `lost` resolves with a message when the host no longer
 *   answers. `onpartial` gets the partial responses to a request. `close` ends the host at once: open requests fail, and
 *   `lost` stays open.
 */

import { byId, stored } from './dom.js';
import { addressOf, isInside, read } from './resources.js';

/** Takes a value out of the fragment of the address. Returns undefined if it has none of this name. */
export function takeFromAddress(name) {
  const fragment = new URLSearchParams(location.hash.slice(1));
  const value = fragment.get(name);
  if (value === null) return undefined;
  fragment.delete(name);
  history.replaceState(null, '', location.pathname + location.search + (fragment.size ? `#${fragment}` : ''));
  return value;
}

/**
 * The token of the server as the query of an address. It moves from the address bar into the storage of its pages, so that
 * it is not shared by mistake, and links also open in other tabs.
 */
export const tokenQuery = () => `?token=${encodeURIComponent(stored('token', takeFromAddress('token')) ?? '')}`;

/** The kind of the host in host.json. */
let kind = '';

/** A link that gives answers to its requests in their order. `post` sends a request, and `end` ends the host. */
function linkOf(post, end) {
  const open = [];
  const { promise: lost, resolve: lose } = Promise.withResolvers();
  const fail = (message) => {
    for (const { reject } of open.splice(0)) reject(new Error(message));
  };
  return {
    /** @type {Link} */
    link: {
      kind,
      lost,
      request: (text) => new Promise((resolve, reject) => {
        open.push({ resolve, reject });
        post(text);
      }),
      onpartial() {},
      close() {
        end();
        fail('The connection was closed.');
      },
    },
    answer: (text, frame = null) => open.shift()?.resolve({ text, frame }),
    close(message) {
      // The page knows of the loss before its requests fail, so it sends no others.
      lose(message);
      fail(message);
    },
  };
}

/** @returns {Promise<Link>} */
function connectServer(path) {
  const address = new URL(path + tokenQuery(), document.baseURI);
  address.protocol = address.protocol.replace('http', 'ws');
  const socket = new WebSocket(address);
  socket.binaryType = 'arraybuffer';
  const { link, answer, close } = linkOf((request) => socket.send(request), () => {
    socket.onmessage = socket.onclose = null;
    socket.close();
  });
  let text = '';
  socket.onmessage = ({ data }) => {
    if (typeof data !== 'string') return answer(text, data);
    const { frame, partial } = JSON.parse(data);
    if (partial) link.onpartial(data);
    else if (frame) text = data;
    else answer(data);
  };
  return new Promise((resolve, reject) => {
    socket.onopen = () => resolve(link);
    socket.onclose = ({ reason }) => {
      const message = reason || byId('link').dataset.closed;
      close(message);
      reject(new Error(message));
    };
  });
}

/** @returns {Promise<Link>} */
async function connectWorker(module) {
  const inside = isInside(module);
  // A module that the document has is sent. Otherwise the Worker fetches the one that its address names.
  const query = inside ? '' : `?module=${module}`;
  const worker = new Worker(addressOf('worker/engine.js', 'text/javascript') + query, { type: 'module' });
  const { link, answer, close } = linkOf((text) => worker.postMessage({ text }), () => worker.terminate());
  const fail = (message) => {
    worker.terminate();
    close(message);
  };
  worker.onmessage = ({ data }) => {
    if (data.failed) fail(data.failed);
    else if (data.partial) link.onpartial(data.text);
    else answer(data.text, data.frame);
  };
  worker.onerror = (event) => fail(event.message || byId('link').dataset.engine);
  if (inside) worker.postMessage({ module: await (await read(module)).arrayBuffer() });
  return link;
}

/** Connects to a path of the server, or to a module in a Worker. */
const connectTo = (path, module) => (kind === 'server' ? connectServer(path) : connectWorker(module));

/** Connects to the host that host.json names. @returns {Promise<Link>} */
export async function connect() {
  const { host, patch, text } = await (await read('host.json')).json();
  kind = host;
  return Object.assign(await connectTo('session', 'engine.wasm'), { patch, text });
}

/** Begins a comparison with measured data at the same host. @returns {Promise<Link>} */
export const connectComparison = () => connectTo('compare', 'search.wasm');
