/** Tools of the patch panel: the line for cords, the palette of elements, and how the panel looks. */

import { byId, fill, stored, template, within } from './dom.js';
import { faceplate } from './faceplate.js';
import { bind } from './keys.js';
import { toast } from './messages.js';
import { refusalOf, send, state } from './state.js';

/** @param {any} board what board.js has */
export function mountTools(board) {
  const { root, say } = board;
  const { canvas, changes, line, field, names, slider, choice, lock, palette, search, list } = board.parts;

  /** What a name can be: an output, an input by its name or its label, or an element with one input. */
  function named(text) {
    const [, element, jack] = /^(.+)\.([^.]+)$/.exec(text) ?? [];
    const inputs = board.stops.filter((one) => one.type === 'in' && (one.element === text || one.element === element));
    const exact = inputs.find((one) => element && [one.jack, one.view.label].includes(jack));
    const other = element ? { element, jack } : inputs.length === 1 && inputs[0];
    return { from: board.stop(`out:${text}`) && text, exact, into: exact ?? (inputs.length > 0 && other) };
  }
  /** Carries out the line: "B1 P1.in", "P1.in <- B1" or "remove P1.in B1". */
  async function enter(event) {
    event.preventDefault();
    const words = field.value.replace(/<-|->|→/g, ' ').trim().split(/\s+/);
    const isRemoval = words[0] === 'remove' && Boolean(words.shift());
    const [one, other] = [named(words[0] ?? ''), named(words[1] ?? '')];
    const [{ from }, { into }] = one.from && other.into && !one.exact ? [one, other] : [other, one];
    if (words.length !== 2 || !from || !into) {
      say(line.dataset.help);
      return;
    }
    const { element, jack } = into;
    const refused = refusalOf(await send(isRemoval ? 'unplug' : 'plug', { element, jack, from }));
    say(refused ?? `${isRemoval ? 'Removed the cord' : 'Plugged a cord'} from ${from} to ${element}.${jack}.`);
    if (!refused) field.value = '';
  }
  /** Offers the names that can follow. */
  function complete() {
    const words = field.value.split(/\s+/).slice(0, -1);
    const first = words.filter((word) => word !== 'remove' && !/<-|->/.test(word)).map(named);
    const types = [['in', 'out'], [first[0]?.exact ? 'out' : 'in']][first.length] ?? [];
    const fits = board.stops.filter(({ type }) => types.includes(type));
    names.replaceChildren(...fits.map(({ name }) => new Option('', [...words, name].join(' '))));
  }

  // The palette.
  let kinds = [];
  let at = 0;
  const left = (parts) => state.patch.parts.filter(({ key, available }) => parts.includes(key) && available !== null)
    .map(({ key, used, available }) => `${Math.max(available - used, 0)} of ${available} ${key.replaceAll('_', ' ')} left`).join(', ');
  function offer() {
    const words = search.value.trim().toLowerCase();
    const rows = kinds.filter(({ name, summary }) => `${name} ${summary}`.toLowerCase().includes(words))
      .sort((one, other) => other.name.startsWith(words) - one.name.startsWith(words));
    at = within(0, at, rows.length - 1);
    list.replaceChildren(...rows.map(({ name, summary, parts }, index) => {
      const rest = left(parts);
      return fill(template('kind', { name, rest, summary }).node, {
        id: `kind-${name}`, 'aria-selected': `${index === at}`, class: rest.startsWith('0') && 'is-none', onclick: () => add(name),
      });
    }));
    search.setAttribute('aria-activedescendant', rows.length ? `kind-${rows[at].name}` : '');
    list.children[at]?.scrollIntoView({ block: 'nearest' });
  }
  function open(section) {
    const all = state.hello?.kinds ?? [];
    const fits = section ?
      all.filter(({ name, parts, prefix }) => section.kinds?.includes(name)
        || parts.includes(section.part) || (section.family && prefix === 'E')) : [];
    kinds = fits.length ? fits : all;
    [search.value, at] = ['', 0];
    palette.showModal();
    offer();
  }
  async function add(kind) {
    palette.close();
    const before = new Set(state.patch.elements.map(({ name }) => name));
    const refused = refusalOf(await send('add-element', { kind }));
    await board.render();
    const made = state.patch.elements.find(({ name }) => !before.has(name))?.name;
    say(refused ?? `Added ${made}, ${kind}.`);
    board.focus(`module:${made}`);
  }
  board.add = (section) => (section.add ? add(section.add) : open(section));

  function setLock(isOn) {
    say('');
    canvas.dataset.lock = stored('board.lock', isOn);
    changes.disabled = lock.ariaPressed = isOn;
  }
  async function clear() {
    if (!refusalOf(await send('clear-cords')))
      toast(root.dataset.cleared, 'note');
  }
  const run = { add: open, lock: () => setLock(!board.isLocked()), clear };
  line.onsubmit = enter;
  field.oninput = field.onfocus = complete;
  field.onkeydown = ({ key }) => { if (key === 'Escape') board.back(); };
  search.oninput = () => { at = 0; offer(); };
  search.onkeydown = (event) => {
    const by = { ArrowDown: 1, ArrowUp: -1, Enter: 0 }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    at += by;
    if (by) offer();
    else list.children[at]?.click();
  };

  root.onclick = ({ target }) => run[target.dataset.do]?.();
  slider.value = stored('board.look') ?? 0.65;
  slider.oninput = () => canvas.style.setProperty('--look', stored('board.look', slider.value));
  slider.oninput();
  choice.onchange = () => { stored(`board.plate.${state.patch.machine}`, choice.value); board.render(); };
  setLock(stored('board.lock') === 'true');
  board.patched = (name) => { choice.value = name; };
  faceplate('index').then((plates) => {
    board.plates = plates;
    choice.replaceChildren(...Object.entries(plates).map(([value, title]) => new Option(title, value)));
    board.render();
  });

  // Keys also work in other views.
  const visit = (action) => () => {
    if (!root.offsetParent) byId('tab-board').click();
    if (!board.isLocked()) action();
  };
  bind('A', 'Add an element to the patch panel', visit(open));
  bind('/', 'Type a cord, such as B1 P1.in', visit(() => field.focus()));
}
