/** Opening, saving, and what the page begins with. */

import { button, el, label } from './dom.js';
import { bind } from './keys.js';
import { token } from './link.js';
import { toast } from './messages.js';
import { on, send, state } from './state.js';

/** The session of this tab, so that a reload loses nothing. */
const STORED = 'patchcord.session';
/** Milliseconds without a change after which the session is stored. */
const QUIET = 800;

/** @type {any} */
let snapshot = null;
/** Revision of the patch that was opened or saved last. */
let saved = null;

const byId = (id) => document.getElementById(id);
/** Another server, or another patch in the address, is another session. */
const address = () => location.pathname + location.search + token();
const isChanged = () => state.patch !== null && state.patch.undo !== null && state.patch.revision !== saved;

async function openText(name, text) {
  const events = await send({ command: 'open', name, text });
  const isOpen = !events.some(({ event }) => event === 'refused');
  if (isOpen) {
    saved = state.patch?.revision ?? null;
    document.documentElement.dataset.first = '';
  }
  return isOpen;
}

/** Asks before changes are lost. @returns {Promise<boolean>} whether to continue */
function mayReplace() {
  if (!isChanged()) return Promise.resolve(true);
  return ask('Replace this patch?', el('p', null, `“${state.patch.title || state.patch.file}” has changes that are not saved.`),
    'Replace without saving');
}

/** A dialog with a question. @returns {Promise<boolean>} whether the user agrees */
function ask(title, content, yes) {
  return new Promise((resolve) => {
    const close = (answer) => () => dialog.close(answer);
    const dialog = el('dialog', {
      class: 'dialog', 'aria-labelledby': 'ask-title',
      onclose: () => { dialog.remove(); resolve(dialog.returnValue === 'yes'); },
    }, el('h2', { id: 'ask-title' }, title), content,
    el('div', { class: 'dialog-buttons' }, button('Cancel', close('no')), button(yes, close('yes'), { class: 'primary', autofocus: true })));
    document.body.append(dialog);
    dialog.showModal();
  });
}

async function openFile(file) {
  if (file && await mayReplace()) openText(file.name, await file.text());
}

async function create() {
  const machines = state.hello?.machines ?? [];
  const choice = el('select', null, machines.map(({ name, title }) =>
    el('option', { value: name, selected: name === state.patch?.machine }, title || name)));
  const lost = isChanged() && el('p', { class: 'warning' }, 'The present patch has changes that are not saved. They will be lost.');
  if (!await ask('New patch', el('div', null, label('Machine', choice), lost), 'Create')) return;
  await send({ command: 'new', machine: choice.value || null });
  saved = state.patch?.revision ?? null;
}

/** Gives the user a file. */
export function download(name, content, type) {
  const url = URL.createObjectURL(new Blob([content], { type }));
  el('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

async function save() {
  const events = await send({ command: 'text' });
  const text = events.find(({ event }) => event === 'text');
  if (!text) return;
  download(text.name.split(/[\\/]/).at(-1) || 'patch.json', text.text, 'application/json');
  saved = state.patch?.revision ?? null;
}

function mountDrop() {
  const hasFile = ({ dataTransfer }) => dataTransfer?.types.includes('Files');
  const show = (isOver) => document.documentElement.toggleAttribute('data-dropping', isOver);
  addEventListener('dragover', (event) => {
    if (!hasFile(event)) return;
    event.preventDefault();
    show(true);
  });
  addEventListener('dragleave', ({ relatedTarget }) => { if (relatedTarget === null) show(false); });
  addEventListener('drop', (event) => {
    show(false);
    // A view that takes files of its own has handled the event.
    if (!hasFile(event) || event.defaultPrevented) return;
    event.preventDefault();
    openFile(event.dataTransfer.files[0]);
  });
}

/** Keeps the latest session, for a reload and for a lost connection. */
function mountStore() {
  let timer = 0;
  const store = async () => {
    const events = await send({ command: 'snapshot' });
    const found = events.find(({ event }) => event === 'snapshot');
    if (!found) return;
    snapshot = found.snapshot;
    try {
      sessionStorage.setItem(STORED, JSON.stringify({ address: address(), saved, snapshot }));
    } catch {
      // The session is larger than the storage of the browser: a reload begins with the last one that fitted.
    }
  };
  const later = () => {
    clearTimeout(timer);
    timer = setTimeout(store, QUIET);
  };
  for (const name of ['patch', 'scopes', 'machine']) on(name, later);
}

function stored() {
  try {
    const found = JSON.parse(sessionStorage.getItem(STORED) ?? 'null');
    return found?.address === address() ? found : null;
  } catch {
    return null;
  }
}

/** Restores the session. @returns {Promise<boolean>} whether it worked */
async function restore(content) {
  const events = await send({ command: 'restore', snapshot: content });
  return events.some(({ event }) => event === 'patch');
}

/** Opens the text at an address of this site. @returns {Promise<boolean>} whether there is one that opens */
async function fetchPatch(url, isOptional, name = url.pathname.split('/').at(-1)) {
  const answer = await fetch(url).catch(() => null);
  if (!answer?.ok) {
    if (!isOptional) toast(`No patch at ${url.pathname}. Check the address.`);
    return false;
  }
  return openText(name, await answer.text());
}

async function openNamed() {
  const named = new URLSearchParams(location.search).get('patch');
  if (named === null) return false;
  const url = new URL(named, document.baseURI);
  if (url.origin === location.origin) return fetchPatch(url, false);
  toast('The page opens patches of its own site only. Save the file and drop it here.');
  return false;
}

/** Brings the first patch: that of the last session, of the address, of the server, or the first lesson. */
export async function begin() {
  if (snapshot !== null && await restore(snapshot)) return;
  const found = stored();
  if (found && await restore(found.snapshot)) {
    saved = found.saved;
    return;
  }
  if (await openNamed()) return;
  const own = new URL(`patch?token=${encodeURIComponent(token())}`, document.baseURI);
  if (state.host?.kind === 'server' && state.host.patch && await fetchPatch(own, false, state.host.patch)) return;
  if (await fetchPatch(new URL('patches/default.json', document.baseURI), true)) return;
  await send({ command: 'new', machine: null });
}

/** Connects the buttons and the page. */
export function mountFiles() {
  const input = byId('file');
  const choose = () => input.click();
  input.addEventListener('change', () => {
    openFile(input.files[0]);
    // The same file can be opened again after a change.
    input.value = '';
  });
  for (const [id, key, text, run] of [['new', null, 'New patch', create], ['open', 'Ctrl+O', 'Open a patch', choose],
    ['save', 'Ctrl+S', 'Save the patch', save]]) {
    byId(id).addEventListener('click', run);
    if (key) bind(key, text, run);
  }
  mountDrop();
  mountStore();
  addEventListener('beforeunload', (event) => { if (isChanged() && snapshot === null) event.preventDefault(); });
}
