/** The gallery: the shipped patches, and those that this browser keeps. */

import { forget, recent } from './autosave.js';
import { openDialog } from './dialogs.js';
import { button, el, quantity } from './dom.js';
import { on } from './state.js';

/** @typedef {{path: string, title: string, line: string, group: string, picture: string, machine: string, duration: number | null, note: string, source: string}} Piece */

/** @type {HTMLDialogElement | null} */
let dialog = null;
/** @type {Promise<Piece[]> | null} */
let list = null;

/** The shipped patches. */
export function pieces() {
  list ??= fetch('gallery.json').then((answer) => (answer.ok ? answer.json() : [])).catch(() => []);
  return list;
}

/** A card that opens a patch: a link, or a button without one. `text` is what the search looks at. */
function cardOf({ href, picture, title, line, run }, more, text) {
  const onclick = (event) => {
    // The browser opens links in other tabs.
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    dialog.close();
    run();
  };
  const card = el('li', null, el(href ? 'a' : 'button', { class: 'piece', href, onclick },
    el('img', { src: picture, alt: '', width: 160, height: 96 }), el('strong', null, title), el('span', null, line)), more);
  card.text = text.join(' ').toLowerCase();
  return card;
}

function pieceCard({ path, title, line, picture, machine, duration, note, source }, open) {
  const facts = Object.entries({ Machine: machine, Run: duration && quantity(duration, 's'), Note: note, Source: source });
  return cardOf({ href: `?patch=${path}`, picture, title, line, run: () => open(path) },
    el('details', null, el('summary', { 'aria-label': `See inside ${title}` }, 'See inside'),
      el('dl', null, facts.filter(([, value]) => value).map(([name, value]) => el('div', null, el('dt', null, name), el('dd', null, value))))),
    [title, line, note, source, path]);
}

function recentCard({ id, title, file, time, path }, all, open) {
  const name = title || file;
  const date = new Date(time).toLocaleString([], { dateStyle: 'medium', timeStyle: 'short' });
  const remove = async () => {
    if (!confirm(`Delete “${name}” of ${date} from this browser?`)) return;
    await forget(id);
    card.remove();
    dialog?.querySelector('input').focus();
  };
  const card = cardOf({ picture: all.find((piece) => piece.path === path)?.picture ?? 'icon.svg', title: name, line: date, run: () => open(id) },
    button('Delete', remove, { class: 'small', 'aria-label': `Delete ${name} of ${date}` }), [name, file]);
  return card;
}

/** Shows the cards that have all words. */
function filter(body, status, text) {
  const words = text.toLowerCase().split(/\s+/);
  let count = 0;
  for (const section of body.children) {
    const cards = [...section.querySelectorAll('li')];
    for (const card of cards) card.hidden = !words.every((word) => card.text.includes(word));
    const shown = cards.filter((card) => !card.hidden).length;
    section.hidden = shown === 0;
    count += shown;
  }
  status.textContent = text.trim() && `${count} found`;
}

/** Opens the gallery. @param {{open: (path: string) => void, restore: (id: string) => void}} actions */
export async function showGallery({ open, restore }) {
  const all = await pieces();
  const kept = await recent();
  if (dialog) return;
  const sections = [['Recent', kept.map((row) => recentCard(row, all, restore))], ...[...new Set(all.map(({ group }) => group))].map((name) =>
    [name, all.filter(({ group }) => group === name).map((piece) => pieceCard(piece, open))])];
  const body = el('div', { class: 'gallery-body' }, sections.map(([name, cards]) =>
    cards.length > 0 && el('section', { 'aria-label': name }, el('h3', null, name), el('ul', null, cards))));
  const status = el('p', { role: 'status' });
  const search = el('input', {
    type: 'search', placeholder: 'Search', 'aria-label': 'Search the gallery', autofocus: matchMedia('(pointer: fine)').matches,
    oninput: () => filter(body, status, search.value),
  });
  dialog = openDialog('Gallery', [
    el('div', { class: 'gallery-bar' }, search, status, button('×', () => dialog.close(), { class: 'close', 'aria-label': 'Close the gallery' })),
    body], { class: 'dialog gallery' });
  dialog.addEventListener('close', () => { dialog = null; });
}

// The message about a lost connection would be behind the gallery.
on('link', () => dialog?.close());
