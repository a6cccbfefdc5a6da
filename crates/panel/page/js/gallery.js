/** The gallery: the shipped patches, and those that this browser keeps. */

import { forget, recent } from './autosave.js';
import { button, byId, el, filter, quantity, template } from './dom.js';
import { addressOf, read } from './resources.js';
import { on } from './state.js';

/**
 * @typedef {{path: string, title: string, line: string, group: string, picture: string, machine: string,
 *   duration: number | null, note: string, source: string, data: string | null, experiment: object | null}} Piece
 */

/** @type {Promise<Piece[]> | null} */
let list = null;

/** The shipped patches. */
export function pieces() {
  list ??= read('gallery.json').then((answer) => answer.json()).catch(() => []);
  return list;
}

const [dialog, search, body, status] = ['dialog', 'search', 'body', 'status'].map((name) => byId(`gallery-${name}`));

/** A card that opens a patch. Returns its parts. */
function cardOf(id, picture, texts, run) {
  const parts = template(id, texts);
  const { image, link } = parts;
  image.src = addressOf(picture ?? 'icon.svg', 'image/svg+xml');
  link.onclick = (event) => {
    // The browser opens links in other tabs.
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    dialog.close();
    run();
  };
  return parts;
}

function pieceCard({ path, title, line, picture, machine, duration, note, source }, open) {
  const texts = { title, line, machine, run: duration && quantity(duration, 's'), note, source, path };
  const { node, link, inside } = cardOf('piece', picture, texts, () => open(path));
  link.href = `?patch=${path}`;
  inside.ariaLabel = `See inside ${title}`;
  return node;
}

const when = (time) => new Date(time).toLocaleString([], { dateStyle: 'medium', timeStyle: 'medium' });

function keptCard({ id, title, file, time, path, snapshots }, all, restore) {
  const texts = { title: title || file, line: when(time) };
  const { node, remove, earlier, states } = cardOf('kept-piece', all.find((piece) => piece.path === path)?.picture, texts, () => restore(id));
  earlier.ariaLabel = states.ariaLabel = `Earlier states of ${texts.title}`;
  states.append(...snapshots.slice(0, -1).reverse().map((each) => button(when(each.time), () => {
    dialog.close();
    restore(id, each.time);
  }, { class: 'small' })));
  remove.ariaLabel = `Delete ${texts.title} of ${texts.line}`;
  remove.onclick = async () => {
    if (!confirm(`${remove.ariaLabel} from this browser?`)) return;
    await forget(id);
    node.remove();
    search.focus();
  };
  return node;
}

/** Shows the cards that have all words. */
search.oninput = () => {
  const count = filter(body.querySelectorAll('li'), search.value);
  status.textContent = search.value.trim() && `${count} found`;
};

/** Opens the gallery. @param {{open: (path: string) => void, restore: (id: string, time?: number) => void}} actions */
export async function showGallery({ open, restore }) {
  const all = await pieces();
  const kept = await recent();
  if (dialog.open) return;
  const sections = { Recent: kept.map((row) => keptCard(row, all, restore)) };
  for (const piece of all) (sections[piece.group] ??= []).push(pieceCard(piece, open));
  body.replaceChildren(...Object.entries(sections).map(([name, cards]) =>
    el('section', { 'aria-label': name }, el('h3', null, name), el('ul', null, cards))));
  search.value = status.textContent = '';
  dialog.showModal();
}

// The message about a lost connection would be behind the gallery.
on('link', () => dialog.close());
