/** Marks on the screen of a scope that pointer and keys move: cursors and the trigger level. */

import { el } from './dom.js';

const clamp = (share) => Math.min(1, Math.max(0, share));

/**
 * Makes a mark. `move` gets shares of the graticule, from its lower left corner.
 * @param {() => [number, number]} where its present place
 */
export function makeMark(kind, name, screen, move, where) {
  const mark = el('div', { class: kind, role: 'slider', tabindex: 0, 'aria-label': name, 'aria-valuemin': 0, 'aria-valuemax': 100, hidden: true });
  const to = (x, y) => move(clamp(x), clamp(y));
  mark.addEventListener('pointerdown', (event) => {
    event.preventDefault();
    mark.setPointerCapture(event.pointerId);
    mark.focus();
  });
  mark.addEventListener('pointermove', (event) => {
    if (!mark.hasPointerCapture(event.pointerId)) return;
    const { x, y, across, up, ratio } = screen.view;
    const { left, top } = screen.box.getBoundingClientRect();
    to(((event.clientX - left) * ratio - x) / across, 1 - ((event.clientY - top) * ratio - y) / up);
  });
  mark.addEventListener('keydown', (event) => {
    const step = event.shiftKey ? 0.05 : 0.002;
    const way = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[event.key];
    if (!way) return;
    event.preventDefault();
    const [x, y] = where();
    to(x + way[0], y + way[1]);
  });
  return mark;
}

/** Puts a mark to its place. `text` is its value for a screen reader. */
export function placeMark(mark, { x, y, across, up, ratio }, [right, top], share, text) {
  mark.style.left = `${(x + right * across) / ratio}px`;
  mark.style.top = `${(y + (1 - top) * up) / ratio}px`;
  mark.setAttribute('aria-valuenow', (100 * share).toFixed(1));
  mark.setAttribute('aria-valuetext', text);
}
