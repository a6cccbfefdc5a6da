/** Tools of the patch panel: the line for cords, the palette of elements, and how the panel looks. */

import { el } from './dom.js';
import { faceplate } from './faceplate.js';
import { bind } from './keys.js';
import { toast } from './messages.js';
import { state } from './state.js';

const byId = (id) => document.getElementById(id);

/** @param {any} board what board.js has */
export function mountTools(board) {
  const { root, find, canvas, send, say, keep } = board;
  const field = find('.board-line input');
  const palette = find('.board-palette');
  const search = palette.querySelector('input');
  const list = palette.querySelector('ul');
  const [slider, choice] = [find('.board-look input'), find('select')];
  const lock = find('[data-do=lock]');

  // The line: "B1 P1.in", "P1.in <- B1", "remove P1.in B1", "add integrator".
  /** What a name can be: an output, an input, or an element with one input. */
  function named(text) {
    const inputs = board.stops.filter(({ type }) => type === 'in');
    const own = inputs.filter(({ element, jack, view }) => [`${element}.${jack}`, `${element}.${view.label}`].includes(text));
    const only = inputs.filter(({ element }) => element === text);
    const cut = text.lastIndexOf('.');
    const isElement = cut > 0 && state.patch.elements.some(({ name }) => name === text.slice(0, cut));
    const input = own[0] ?? (only.length === 1 ? only[0] : isElement && { element: text.slice(0, cut), jack: text.slice(cut + 1) });
    return { output: state.patch.outputs.some(({ name }) => name === text) && text, input: input && { element: input.element, jack: input.jack }, isInput: Boolean(own[0]) };
  }
  async function carryOut() {
    const words = field.value.replace(/<-|->|→|←/g, ' ').trim().split(/\s+/);
    const verb = ['remove', 'add'].includes(words[0]) ? words.shift() : 'plug';
    if (verb === 'add') return insert(words[0] ?? '', words[1]);
    const [one, other] = [named(words[0] ?? ''), named(words[1] ?? '')];
    const pair = one.output && other.input && !one.isInput ? [one, other] : [other, one];
    const [{ output: from }, { input }] = pair;
    if (words.length !== 2 || !from || !input) return say('Type an output and an input, such as B1 P1.in. The names are at the jacks.');
    const events = await send({ command: verb === 'remove' ? 'unplug' : 'plug', ...input, from });
    const refused = events.find(({ event }) => event === 'refused');
    say(refused?.message ?? `${verb === 'remove' ? 'Removed' : 'Plugged'}: ${from} ${verb === 'remove' ? 'from' : 'into'} ${input.element}.${input.jack}.`);
    if (!refused) field.value = '';
  }
  /** Names that can follow. */
  function complete() {
    const words = field.value.split(/\s+/);
    const before = words.slice(0, -1).filter((word) => word !== 'remove' && !/^<?->?$/.test(word));
    const first = before.length && named(before[0]);
    const fits = board.stops.filter(({ type }) => ['in', 'out'].includes(type) && (!first || type === (first.isInput ? 'out' : 'in')));
    const start = words.slice(0, -1).join(' ');
    byId('board-names').replaceChildren(...before.length > 1 ? [] : fits.map((stop) => el('option', { value: `${start} ${board.nameOf(stop)}`.trim() })));
  }
  field.addEventListener('input', complete);
  field.addEventListener('focus', complete);
  find('.board-line').addEventListener('submit', (event) => { event.preventDefault(); carryOut(); });

  // The palette.
  let kinds = [];
  let at = 0;
  function offer() {
    const words = search.value.trim().toLowerCase();
    const rows = kinds.filter(({ name, summary, law }) => `${name} ${summary} ${law}`.toLowerCase().includes(words))
      .sort((one, other) => other.name.startsWith(words) - one.name.startsWith(words));
    at = Math.max(0, Math.min(at, rows.length - 1));
    const left = (parts) => parts.map((key) => state.patch.parts.find((part) => part.key === key)).filter((part) => part && part.available !== null)
      .map(({ key, used, available }) => `${Math.max(available - used, 0)} of ${available} ${key.replaceAll('_', ' ')} left`).join(', ');
    list.replaceChildren(...rows.map(({ name, summary, parts }, index) => el('li', {
      role: 'option', id: `kind-${name}`, 'aria-selected': String(index === at), class: /\b0 of/.test(left(parts)) ? 'is-none' : '', onclick: () => insert(name),
    }, el('b', null, name), el('span', { class: 'kind-left' }, left(parts)), el('span', null, summary))));
    search.setAttribute('aria-activedescendant', rows.length ? `kind-${rows[at].name}` : '');
    list.children[at]?.scrollIntoView({ block: 'nearest' });
  }
  function open(section) {
    const all = state.hello?.kinds ?? [];
    kinds = section ? all.filter(({ name, parts }) => section.kinds?.includes(name) || parts.includes(section.part) || section.family === 'drive' && !parts.length) : all;
    if (!kinds.length) kinds = all;
    search.value = '';
    at = 0;
    palette.showModal();
    offer();
  }
  async function insert(kind, name = null) {
    palette.close();
    const before = new Set(state.patch.elements.map((element) => element.name));
    const events = await send({ command: 'add-element', kind, name });
    await board.render();
    const made = state.patch.elements.find((element) => !before.has(element.name));
    const refused = events.find(({ event }) => event === 'refused');
    say(refused?.message ?? `Added ${made?.name}, ${kind}.`);
    if (made && !refused) {
      field.value = '';
      board.focus(board.stop(`module:${made.name}`)?.key);
    }
  }
  board.add = (section) => (section?.add ? insert(section.add) : open(section));
  search.addEventListener('input', () => { at = 0; offer(); });
  search.addEventListener('keydown', (event) => {
    const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (by) at += by;
    else if (event.key !== 'Enter') return;
    event.preventDefault();
    if (by) offer();
    else list.children[at]?.click();
  });
  palette.addEventListener('click', ({ target }) => { if (target === palette) palette.close(); });

  // Buttons and looks.
  const isLocked = () => canvas.dataset.lock === 'true';
  function setLock(value) {
    canvas.dataset.lock = String(value);
    keep('lock', value);
    lock.setAttribute('aria-pressed', String(value));
    lock.textContent = value ? 'Unlock' : 'Lock';
    for (const control of root.querySelectorAll('[data-do=add], [data-do=clear], .board-line > *')) control.disabled = value;
  }
  const run = {
    add: () => open(),
    lock: () => setLock(!isLocked()),
    async clear() {
      await send({ command: 'clear-cords' });
      toast('All cords are removed, and the elements stay. Undo brings the cords back.', 'note');
    },
  };
  root.addEventListener('click', ({ target }) => {
    run[target.dataset.do]?.();
    if (target.dataset.zoom) board.zoom(Number(target.dataset.zoom));
  });
  const look = () => {
    const share = Number(slider.value);
    canvas.style.setProperty('--cord', 2.5 + 5 * share);
    canvas.style.setProperty('--cord-opacity', 0.3 + 0.7 * Math.min(share * 1.6, 1));
    keep('look', share);
  };
  slider.value = keep('look') ?? 0.65;
  slider.addEventListener('input', look);
  look();
  setLock(keep('lock') === 'true');
  faceplate('index').then((plates) => {
    board.plates = plates;
    choice.replaceChildren(...Object.entries(plates).map(([value, title]) => el('option', { value }, title)));
    choice.addEventListener('change', () => {
      keep(`plate.${state.patch.machine}`, choice.value);
      board.render();
    });
    board.render();
  });
  board.patched = (name) => { choice.value = name; };

  const visit = (action) => () => {
    if (!root.offsetParent) byId('tab-board').click();
    if (!isLocked()) action();
  };
  bind('a', 'Add an element to the patch panel', visit(open));
  bind('/', 'Type a cord, such as B1 P1.in', visit(() => field.focus()));
  root.addEventListener('keydown', (event) => {
    if (event.target === field) {
      if (event.key === 'Escape') board.focus(board.current?.key);
    } else if (event.key === 'c' && !palette.open && !event.ctrlKey && !event.metaKey && !event.target.closest('input, select')) {
      event.preventDefault();
      visit(() => field.focus())();
    }
  });
}
