/** Marks on the screen of a scope that pointer and keys move: cursors and the trigger level. */

import { fill, within } from './dom.js';

/**
 * Lets a mark be moved. `move` gets shares of the graticule, from its lower left corner.
 * @param {() => [number, number]} where its present place
 */
export function mountMark(mark, screen, move, where) {
  const to = (x, y) => move(within(0, x, 1), within(0, y, 1));
  fill(mark, {
    onpointerdown(event) {
      event.preventDefault();
      mark.setPointerCapture(event.pointerId);
      mark.focus();
    },
    onpointermove({ pointerId, clientX, clientY }) {
      if (!mark.hasPointerCapture(pointerId)) return;
      const { x, y, across, up, ratio } = screen.view;
      const { left, top } = screen.box.getBoundingClientRect();
      to(((clientX - left) * ratio - x) / across, 1 - ((clientY - top) * ratio - y) / up);
    },
    onkeydown(event) {
      const step = event.shiftKey ? 0.05 : 0.002;
      const way = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[event.key];
      if (!way) return;
      event.preventDefault();
      const [x, y] = where();
      to(x + way[0], y + way[1]);
    },
  });
}

/** Puts a mark to its place. `text` is its value for a screen reader. */
export function placeMark(mark, { x, y, across, up, ratio }, [right, top], share, text) {
  mark.style.left = `${(x + right * across) / ratio}px`;
  mark.style.top = `${(y + (1 - top) * up) / ratio}px`;
  fill(mark, { 'aria-valuenow': (100 * share).toFixed(1), 'aria-valuetext': text });
}
