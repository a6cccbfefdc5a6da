/** Keys of the page. The table that carries them out is also the list that the page shows. */

import { byId, el, place, stored, template } from './dom.js';
import { selectProbe } from './state.js';

/** @type {{key: string, text: string | undefined, run: (event: KeyboardEvent) => void, button?: HTMLElement}[]} */
const table = [];

/**
 * Adds a key: "O", "?", "Space", "Ctrl+S", "Ctrl+Shift+Z".
 * @param {string | undefined} text what it does, for the list, unless another row says so
 * @param {(event: KeyboardEvent) => void} run
 */
export const bind = (key, text, run, button) => table.push({ key, text, run, button });

// The keys of buttons are in index.html.
for (const button of document.querySelectorAll('[aria-keyshortcuts]')) {
  for (const key of button.ariaKeyShortcuts.split(' ')) bind(key.replace('Control', 'Ctrl'), button.dataset.action, () => button.click(), button);
}

/** The name of a pressed key as `bind` has it. */
function nameOf({ key, ctrlKey, metaKey, shiftKey }) {
  if (ctrlKey || metaKey) return `Ctrl+${shiftKey ? 'Shift+' : ''}${key.toUpperCase()}`;
  return key === ' ' ? 'Space' : key.length === 1 ? key.toUpperCase() : key;
}

/** Whether the key belongs to the control that has the focus. */
function isTaken({ target, key, defaultPrevented, altKey, isComposing }, name) {
  if (defaultPrevented || altKey || isComposing || document.querySelector('dialog[open]')) return true;
  // A field undoes its own text, but it opens and saves no files.
  if (['Ctrl+S', 'Ctrl+O'].includes(name)) return false;
  return target.closest('input:not([type=range], [type=checkbox], [type=radio]), select')
    || (key === ' ' && target.closest('button, a, summary, input, [role], [tabindex]'));
}

const areLettersOff = () => stored('letters-off') === 'true';

function pressed(event) {
  if (event.key === 'Escape') selectProbe(null);
  const name = nameOf(event);
  // Two views can have the same key.
  const row = table.find(({ key, button }) => key === name && !button?.closest('[hidden]'));
  if (!row || isTaken(event, name) || (!name.startsWith('Ctrl+') && name !== '?' && areLettersOff())) return;
  event.preventDefault();
  row.run(event);
}

const [dialog, letters] = [byId('key-list'), byId('letters')];
byId('keys').onclick = () => {
  place(dialog.querySelector('dl'), table.filter(({ text }) => text).map(({ key, text }) => {
    const { node, keys } = template('key', { text });
    keys.append(...key.split(/\b\+/).map((part) => el('kbd', null, part)));
    return { node };
  }));
  dialog.showModal();
};
// Speech input can set off single letters by accident, so that they can be switched off.
letters.checked = !areLettersOff();
letters.onchange = () => stored('letters-off', !letters.checked);
document.onkeydown = pressed;
