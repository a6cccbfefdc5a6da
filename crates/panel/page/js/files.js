/** Opening, saving, and what the page begins with. */

import { isChanged, keep, markSaved, replace, restore, resume } from './autosave.js';
import { byId, el, fill, joined, named, root } from './dom.js';
import { pieces, showGallery } from './gallery.js';
import { tokenQuery } from './link.js';
import { toast } from './messages.js';
import { read } from './resources.js';
import { baseName, share, takeLink, textOf } from './share.js';
import { ask, emit, on, send, state } from './state.js';

/** The largest file in bytes, as for the command. */
const LARGEST_FILE = 16e6;


/** Opens something. A fault becomes a message. @returns {Promise<boolean>} whether it is open */
const attempt = (open) => open().catch((fault) => {
  toast(fault.message);
  return false;
});

async function openBy(command, fields, path) {
  const isOpen = await replace(command, fields, { path });
  if (isOpen) root.dataset.first = '';
  return isOpen;
}

const openText = (name, text, path) => openBy('open', { name, text }, path);

/** Keeps the present patch, or asks before its changes are lost. @returns {Promise<boolean>} whether to continue */
async function mayReplace() {
  return !isChanged() || await keep()
    || confirm(`“${state.patch.title || state.patch.file}” has changes that are not saved. Replace it?`);
}

/**
 * Opens another patch in the place of the present one, and puts its path in the gallery, if any, into the address.
 * @returns {Promise<boolean>} whether it is open
 */
const change = (open, path = '') => attempt(async () => {
  const isOpen = await mayReplace() && await open();
  if (isOpen) history.replaceState(null, '', location.pathname + (path && `?patch=${path}`));
  return isOpen;
});

const isData = ({ name }) => /\.(csv|tsv|txt)$/i.test(name);

const openFile = (file) => attempt(async () => {
  const { name } = file;
  const text = await textOf(file.stream(), LARGEST_FILE, `The file ${name}`);
  if (isData(file)) emit('data', { name, text });
  else await change(() => openText(name, text));
});

/** Opens files: the patch first, because measured data are compared with it. */
async function openFiles(files) {
  for (const file of [...files].sort((a, b) => isData(a) - isData(b))) await openFile(file);
}

function chooseMachine() {
  machine.replaceChildren(...(state.hello?.machines ?? []).map(({ name, title }) => new Option(title || name, name)));
  machine.value = state.patch?.machine;
  byId('new-dialog').showModal();
}

/** Gives the user a file. */
export function download(name, content, type) {
  const url = URL.createObjectURL(new Blob([content], { type }));
  el('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

async function save() {
  const text = await ask('text');
  if (!text) return;
  download(baseName(text.name) || 'patch.json', text.text, 'application/json');
  markSaved();
}

const hasFile = ({ dataTransfer }) => dataTransfer?.types.includes('Files');
const show = (isOver) => root.toggleAttribute('data-dropping', isOver);
fill(document, {
  ondragover(event) {
    if (!hasFile(event)) return;
    event.preventDefault();
    show(true);
  },
  ondragleave: ({ relatedTarget }) => { if (relatedTarget === null) show(false); },
  ondrop(event) {
    show(false);
    if (!hasFile(event)) return;
    event.preventDefault();
    openFiles(event.dataTransfer.files);
  },
});

const textAt = async (path, url) => textOf((await read(path, url)).body, LARGEST_FILE, 'The file');

/** Opens a file in the folder of the page or below it. */
async function openBelow(path, piece) {
  const folder = new URL('.', document.baseURI);
  const url = new URL(path, folder);
  if (!url.href.startsWith(folder.href)) {
    throw new Error(byId('open').dataset.outside);
  }
  return openText(baseName(decodeURIComponent(url.pathname)), await textAt(path, url), piece);
}

/** Opens a patch of the gallery with its measured data, or a file in the folder of the panel or below it. */
async function openAt(name) {
  const piece = (await pieces()).find(({ path }) => path === name);
  if (!piece) return state.host?.kind === 'server' ? openBy('open-file', { name }) : openBelow(name);
  const { data, experiment } = piece;
  const text = data && await textAt(`patches/${data}`);
  const isOpen = await openBelow(`patches/${name}`, name);
  if (isOpen && data) emit('data', { name: baseName(data), text, experiment, patch: state.patch.file });
  return isOpen;
}

async function openNamed() {
  const name = new URLSearchParams(location.search).get('patch');
  return name !== null && openAt(name);
}

async function openLink() {
  const link = await takeLink();
  return link !== null && await mayReplace() && openText(link.name, link.text);
}

/** Opens the patch with which the server was started, or that of an exported page. */
async function openGiven() {
  const { patch, text } = state.host ?? {};
  if (!patch) return false;
  return openText(patch, text ?? await textAt('patch', new URL(`patch${tokenQuery()}`, document.baseURI)));
}

const GALLERY = {
  /** One click opens a patch and runs it. */
  async open(path) {
    if (await change(() => openAt(path), path)) send('mode', { mode: 'operate' });
  },
  restore: (id, time) => change(() => restore(id, time)),
};

/** Brings the first patch. If nothing names one, the gallery opens. */
export async function begin() {
  const isNamed = state.host?.patch || /[?&#](patch|p)=/.test(location.href);
  for (const open of [openLink, resume, openNamed, openGiven]) {
    if (await attempt(open)) return;
  }
  await replace('new');
  if (!isNamed) showGallery(GALLERY);
}

/** Shows the title of the patch, with a mark while the patch differs from its file. */
function showTitle() {
  const { title, file, source, note, machine: type } = state.patch;
  const name = title || file || 'New patch';
  byId('title').textContent = byId('title').title = name;
  byId('subtitle').textContent = joined([file !== name && file, named(state.hello?.machines, type)?.title || type], ' · ');
  byId('about-text').textContent = joined([note, source], '\n\n');
  root.toggleAttribute('data-changed', isChanged());
  document.title = `${isChanged() ? '• ' : ''}${name} – patchcord`;
}

const [input, machine] = [byId('file'), byId('machine')];
input.onchange = () => {
  openFiles(input.files);
  // The same file can be opened again after a change.
  input.value = '';
};
const actions = {
  save, share, new: chooseMachine, create: () => change(() => replace('new', { machine: machine.value || null })),
  open: () => input.click(), gallery: () => showGallery(GALLERY),
};
for (const [id, run] of Object.entries(actions)) byId(id).onclick = run;
on('patch saved', showTitle);
window.onhashchange = () => {
  // A token in the address is kept.
  tokenQuery();
  attempt(openLink);
};
