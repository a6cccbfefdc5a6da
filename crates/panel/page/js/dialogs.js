/** Dialogs of the page. */

import { el } from './dom.js';

/**
 * Shows a dialog until it is closed.
 * @param {string} title
 * @param {any[]} content
 * @param {Record<string, any>} [attributes]
 * @returns {HTMLDialogElement}
 */
export function openDialog(title, content, attributes) {
  const dialog = el('dialog', {
    class: 'dialog', 'aria-label': title, onclose: () => dialog.remove(), ...attributes,
  }, el('h2', null, title), content);
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}
