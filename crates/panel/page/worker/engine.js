/**
 * The engine in a Worker: a session or a comparison in WebAssembly. A message `{text}` is a request. Requests are answered
 * in order by `{text, frame}` or `{failed}`. Before an answer, there may be partial responses `{text, partial: true}`. After
 * a failure, every request fails. A first message `{module}` has the bytes of the module; without it, the module is fetched.
 */

/** The file of the module, which the address of the Worker names unless a message has the module. */
const name = new URL(import.meta.url).searchParams.get('module') ?? 'engine.wasm';

/** What a panic of the engine said. */
let panic = '';


/** Why there is no engine; empty while there is one. */
let failed = '';

/** The functions of the engine that JavaScript calls, and its memory; null before the first message. */
let engine = null;

async function fetchModule() {
  const file = new URL(`../${name}`, import.meta.url);
  const response = await fetch(file);
  if (!response.ok) throw new Error(`The file ${name} is missing next to the page (${response.status}).`);
  // Some web servers do not know the type of WebAssembly, and browsers compile no other type as it arrives.
  const isKnown = response.headers.get('content-type') === 'application/wasm';
  return isKnown ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}

/** @param {ArrayBuffer | undefined} bytes */
async function load(bytes) {
  const module = await (bytes ? WebAssembly.compile(bytes) : fetchModule());
  const instance = await WebAssembly.instantiate(module, { host: { now: () => performance.now(), fail, partial } });
  /** The engine calls this with the message of a panic. It then stops. */
  function fail(pointer, length) {
    panic = textAt(instance.exports, pointer, length);
  }
  /** The engine calls this with a partial response to the present request. */
  function partial(pointer, length) {
    postMessage({ text: textAt(instance.exports, pointer, length), partial: true });
  }
  return instance.exports;
}

/** A text in the memory of the engine. Memory may move while the engine works, so it is looked up again. */
function textAt({ memory }, pointer, length) {
  return new TextDecoder().decode(new Uint8Array(memory.buffer, pointer, length));
}

/** Sends a request to the engine. */
function request(exports, text) {
  const bytes = new TextEncoder().encode(text);
  const pointer = exports.allocate(bytes.length);
  new Uint8Array(exports.memory.buffer, pointer, bytes.length).set(bytes);
  (exports.compare_request ?? exports.request)(pointer, bytes.length);
  exports.release(pointer, bytes.length);
  const frame = exports.frame_pointer();
  return {
    text: textAt(exports, exports.text_pointer(), exports.text_length()),
    frame: frame === 0 ? null : exports.memory.buffer.slice(frame, frame + exports.frame_length()),
  };
}

globalThis.onmessage = async ({ data: { text, module } }) => {
  engine ??= load(module);
  if (module) return;
  try {
    const exports = await engine;
    if (failed) throw new Error(failed);
    const answer = request(exports, text);
    postMessage(answer, answer.frame ? [answer.frame] : []);
  } catch (error) {
    failed ||= panic ? `The engine stopped because of a fault in patchcord: ${panic}` : String(error.message ?? error);
    postMessage({ failed });
  }
};
