/**
 * The engine in a Worker: a session in WebAssembly. A message `{id, text}` is a request, and its answer is
 * `{id, text, frame}` or `{id, failed}`. After a failure, every request fails. A first message `{module}` has the bytes of
 * the module; without it, the module is fetched.
 */

/** What a panic of the engine said. */
let panic = '';

/** Why there is no engine; empty while there is one. */
let failed = '';

/** The functions of the engine that JavaScript calls, and its memory; null before the first message. */
let engine = null;

async function fetchModule() {
  const file = new URL('../engine.wasm', import.meta.url);
  const response = await fetch(file);
  if (!response.ok) throw new Error(`The file engine.wasm is missing next to the page (${response.status}).`);
  // Some web servers do not know the type of WebAssembly, and browsers compile no other type as it arrives.
  const isKnown = response.headers.get('content-type') === 'application/wasm';
  return isKnown ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}

/** @param {ArrayBuffer | undefined} bytes */
async function load(bytes) {
  const module = await (bytes ? WebAssembly.compile(bytes) : fetchModule());
  const instance = await WebAssembly.instantiate(module, { host: { now: () => performance.now(), fail } });
  /** The engine calls this with the message of a panic. It then stops. */
  function fail(pointer, length) {
    panic = new TextDecoder().decode(new Uint8Array(instance.exports.memory.buffer, pointer, length));
  }
  return instance.exports;
}

/** Sends a request to the session. Memory may move while the session works, so it is looked up again. */
function request(exports, text) {
  const bytes = new TextEncoder().encode(text);
  const pointer = exports.allocate(bytes.length);
  new Uint8Array(exports.memory.buffer, pointer, bytes.length).set(bytes);
  exports.request(pointer, bytes.length);
  exports.release(pointer, bytes.length);
  const { buffer } = exports.memory;
  const frame = exports.frame_pointer();
  return {
    text: new TextDecoder().decode(new Uint8Array(buffer, exports.text_pointer(), exports.text_length())),
    frame: frame === 0 ? null : buffer.slice(frame, frame + exports.frame_length()),
  };
}

globalThis.onmessage = async ({ data: { id, text, module } }) => {
  engine ??= load(module);
  if (module) return;
  try {
    const exports = await engine;
    if (failed) throw new Error(failed);
    const answer = request(exports, text);
    postMessage({ id, ...answer }, answer.frame ? [answer.frame] : []);
  } catch (error) {
    failed ||= panic ? `The engine stopped because of a fault in patchcord: ${panic}` : String(error.message ?? error);
    postMessage({ id, failed });
  }
};
