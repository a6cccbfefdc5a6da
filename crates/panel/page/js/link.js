/**
 * The way to the session: a server behind a WebSocket or an engine in a Worker. Both answer requests in order.
 *
 * @typedef {{text: string, frame: ArrayBuffer | null}} Answer
 * @typedef {{kind: 'server' | 'worker', patch?: string | null, text?: string, request: (text: string) => Promise<Answer>,
 *   lost: Promise<string>}} Link  `patch` is the name of the patch that the host opens first, and `text` its text if it is
 *   in host.json; `lost` resolves with a message when the host no longer answers.
 */

import { stored } from './dom.js';
import { addressOf, isInside, read } from './resources.js';

/**
 * The token of the server. It moves from the address bar into the storage of its pages, so that it is not shared by
 * mistake, and links also open in other tabs.
 */
export function token() {
  const fragment = new URLSearchParams(location.hash.slice(1));
  if (fragment.has('token')) {
    stored('token', fragment.get('token'));
    fragment.delete('token');
    history.replaceState(null, '', location.pathname + location.search + (fragment.size ? `#${fragment}` : ''));
  }
  return stored('token') ?? '';
}

/** A link that gives answers to its requests in their order. `post` sends a request. */
function linkOf(kind, post) {
  const open = [];
  const { promise: lost, resolve: lose } = Promise.withResolvers();
  const request = (text) => new Promise((resolve, reject) => {
    open.push({ resolve, reject });
    post(text);
  });
  return {
    /** @type {Link} */
    link: { kind, request, lost },
    answer: (text, frame = null) => open.shift()?.resolve({ text, frame }),
    close(message) {
      for (const { reject } of open.splice(0)) reject(new Error(message));
      lose(message);
    },
  };
}

/** @returns {Promise<Link>} */
function connectServer() {
  const address = new URL(`session?token=${encodeURIComponent(token())}`, document.baseURI);
  address.protocol = address.protocol.replace('http', 'ws');
  const socket = new WebSocket(address);
  socket.binaryType = 'arraybuffer';
  const { link, answer, close } = linkOf('server', (request) => socket.send(request));
  let text = '';
  socket.onmessage = ({ data }) => {
    if (typeof data !== 'string') answer(text, data);
    else if (JSON.parse(data).frame) text = data;
    else answer(data);
  };
  return new Promise((resolve, reject) => {
    socket.onopen = () => resolve(link);
    socket.onclose = ({ reason }) => {
      const message = reason
        || 'The connection to patchcord is closed. Check that the command still runs, and use the address that it printed.';
      close(message);
      reject(new Error(message));
    };
  });
}

/** @returns {Promise<Link>} */
async function connectWorker() {
  const worker = new Worker(addressOf('worker/engine.js', 'text/javascript'), { type: 'module' });
  let id = 0;
  const { link, answer, close } = linkOf('worker', (text) => {
    id += 1;
    worker.postMessage({ id, text });
  });
  const fail = (message) => {
    worker.terminate();
    close(message);
  };
  worker.onmessage = ({ data }) => {
    if (data.failed) fail(data.failed);
    else answer(data.text, data.frame);
  };
  worker.onerror = (event) => fail(event.message || 'The engine could not be loaded. Load the page again.');
  // Without this message, the Worker fetches its module.
  if (isInside('engine.wasm')) worker.postMessage({ module: await (await read('engine.wasm')).arrayBuffer() });
  return link;
}

/** Connects to the host that host.json names. @returns {Promise<Link>} */
export async function connect() {
  token();
  const answer = await read('host.json');
  if (!answer.ok) throw new Error('The file host.json is missing next to the page.');
  const { host, patch, text } = await answer.json();
  return { ...await (host === 'server' ? connectServer() : connectWorker()), patch, text };
}
