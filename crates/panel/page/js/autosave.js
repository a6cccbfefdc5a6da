/**
 * Snapshots of the patches of this browser. Each opened patch has a random id of its own, so none overwrites another.
 * A page that continues a patch writes its own name into it. If another page has done so since, a page writes to a new id.
 *
 * @typedef {{id: string, title: string, file: string, path: string | null, time: number, edited: boolean, isSaved: boolean,
 *   writer: string, snapshots: {time: number, data: Uint8Array}[]}} Row  a kept patch, with the oldest snapshot first
 * @typedef {{id: string, path: string | null, edited: boolean, isEarlier: boolean, opened: number, saved: number | null}}
 *   Entry  the patch on the panel: `path` is that in the gallery, `isEarlier` says that it continues an earlier snapshot than
 *   the newest one and is not kept since, `opened` and `saved` are revisions
 */

import { toast } from './messages.js';
import { deflate, inflate } from './share.js';
import { ask, emit, eventOf, on, send, state } from './state.js';

/** Milliseconds after a change at which a snapshot is made, also while further changes follow. */
const DELAY = 2000;
/** How many patches and how many snapshots of each there are at most. */
const PATCHES = 50;
const SNAPSHOTS = 10;
/** Snapshots are this many milliseconds apart, except for the newest one, so that they reach back further. */
const APART = 60_000;
/** The patch that this tab continues after a reload, and its address. */
const TAB = 'patchcord.open';

const random = () => crypto.getRandomValues(new Uint32Array(4)).join('-');
const writer = random();

/** @type {Entry | null} */
let present = null;
/** The number of changes, how many of them are kept, the timer of the next snapshot, whether one failed, and the last one. */
let [changes, kept, timer, hasFailed, queue] = [0, 0, 0, false, Promise.resolve()];

/** @type {Promise<IDBDatabase> | null} */
let database = null;

/** The result of a request, or the end of a transaction. */
const result = (work) => new Promise((resolve, reject) => {
  work.onsuccess = work.oncomplete = () => resolve(work.result);
  work.onerror = work.onabort = ({ target }) => reject(target.error);
});

function connect() {
  const request = indexedDB.open('patchcord', 1);
  request.onupgradeneeded = () => request.result.createObjectStore('patches', { keyPath: 'id' });
  return result(request);
}

/** Does all work or none of it. @param {(rows: IDBObjectStore) => any} work */
async function transact(work) {
  database ??= connect();
  const transaction = (await database).transaction('patches', 'readwrite');
  const [, answer] = await Promise.all([result(transaction), work(transaction.objectStore('patches'))]);
  return answer;
}

/** The kept patches: those that were changed first, then the latest first. */
async function sorted(rows) {
  return (await result(rows.getAll())).sort((one, other) => other.edited - one.edited || other.time - one.time);
}

/** Adds a snapshot. If the one before the newest is recent, it replaces the newest one, unless it continues an earlier one. */
async function add(rows, entry, about, data) {
  const known = await result(rows.get(entry.id));
  if (known && known.writer !== writer) entry.id = random();
  const snapshots = known?.snapshots ?? [];
  const time = Date.now();
  if (!entry.isEarlier && time - snapshots.at(-2)?.time < APART) snapshots.pop();
  snapshots.push({ time, data });
  rows.put({ ...about, id: entry.id, path: entry.path, time, writer, snapshots: snapshots.slice(-SNAPSHOTS) });
  const others = (await sorted(rows)).filter(({ id }) => id !== entry.id);
  for (const { id } of others.slice(PATCHES - 1)) rows.delete(id);
}

async function write() {
  clearTimeout(timer);
  timer = 0;
  const entry = present;
  if (entry === null || isKept() || !state.host) return;
  const until = changes;
  const found = await ask('snapshot');
  if (!found) return;
  const { title, file, revision } = state.patch;
  const about = { title, file, edited: entry.edited || revision !== entry.opened, isSaved: revision === entry.saved };
  try {
    const data = await deflate(JSON.stringify(found.snapshot));
    await transact((rows) => add(rows, entry, about, data));
    entry.isEarlier = false;
    if (entry !== present) return;
    kept = until;
    sessionStorage.setItem(TAB, `${entry.id} ${location.pathname}${location.search}`);
  } catch (fault) {
    console.warn(fault);
    database = null;
    if (!hasFailed) toast('This browser does not keep patches. Save this one as a file.');
    hasFailed = true;
  }
}

/** Keeps the present state now. @returns {Promise<boolean>} whether everything is kept */
export async function keep() {
  queue = queue.then(write);
  await queue;
  return isKept();
}

const isKept = () => kept === changes;

/** Whether the patch on the panel differs from its file. */
export const isChanged = () => present !== null && state.patch.revision !== present.saved;

function changed() {
  if (present === null) return;
  changes += 1;
  timer ||= setTimeout(keep, DELAY);
}

/** The patch was saved as a file. */
export function markSaved() {
  if (present !== null) present.saved = state.patch.revision;
  emit('saved', null);
  changed();
}

/**
 * Sends a command that puts another patch on the panel. Until its answer nothing is kept, because the session could
 * have either patch.
 * @returns {Promise<boolean>} whether the session has done it
 */
export async function replace(command, fields, { id = random(), path = null, edited, isSaved = true, isEarlier } = {}) {
  const before = present;
  present = null;
  if (!eventOf(await send(command, fields), 'patch')) {
    present = before;
    return false;
  }
  const { revision } = state.patch;
  present = { id, path, edited, isEarlier, opened: revision, saved: isSaved ? revision : null };
  emit('saved', null);
  changes += 1;
  keep();
  return true;
}

/**
 * Continues a kept patch with its newest snapshot that the session can read, or with the snapshot of a time. The newest
 * one then stays a snapshot.
 * @returns {Promise<boolean>}
 */
export async function restore(id, time) {
  const row = await transact(async (rows) => {
    const found = await result(rows.get(id));
    if (found) rows.put({ ...found, writer });
    return found;
  });
  for (const { data } of row?.snapshots.reverse().filter((each) => !time || each.time === time) ?? []) {
    const snapshot = JSON.parse(await inflate(data, Infinity));
    if (await replace('restore', { snapshot }, time ? { ...row, isSaved: false, isEarlier: true } : row)) return true;
  }
  return false;
}

/** Continues the patch that this tab had at this address before it was loaded again. */
export async function resume() {
  const [id, address] = (sessionStorage.getItem(TAB) ?? '').split(' ');
  return address === location.pathname + location.search && restore(id);
}

/** The patches that were changed in this browser, the latest first. @returns {Promise<Row[]>} */
export async function recent() {
  const rows = await transact(sorted).catch(() => []);
  return rows.filter(({ edited }) => edited);
}

/** Deletes a kept patch. If it is on the panel, it is kept again after its next change. */
export const forget = (id) => transact((rows) => { rows.delete(id); });

on('patch parameter scopes machine', changed);
on('link', () => { present = null; });
document.onvisibilitychange = keep;
window.onbeforeunload = (event) => {
  if (isKept() || !isChanged()) return;
  keep();
  event.preventDefault();
};
