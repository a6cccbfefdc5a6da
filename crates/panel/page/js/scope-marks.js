/** Marks on the screen of a scope that pointer and keys move: cursors and the trigger level. */

import { fill, within } from './dom.js';
import { ARROWS } from './zoom.js';

/**
 * Lets a mark be moved. `move` gets shares of the graticule, from its lower left corner.
 * @param {() => [number, number]} where its present place
 */
export function mountMark(mark, screen, move, where) {
  const to = (...shares) => move(...shares.map((share) => within(0, share, 1)));
  fill(mark, {
    onpointerdown(event) {
      event.preventDefault();
      mark.setPointerCapture(event.pointerId);
      mark.focus();
    },
    onpointermove({ pointerId, clientX, clientY }) {
      if (!mark.hasPointerCapture(pointerId)) return;
      const { x, y, across, up } = screen.view;
      const { left, top } = screen.box.getBoundingClientRect();
      to((clientX - left - x) / across, 1 - (clientY - top - y) / up);
    },
    onkeydown(event) {
      const step = event.shiftKey ? 0.05 : 0.002;
      const way = ARROWS[event.key];
      if (!way) return;
      event.preventDefault();
      const [x, y] = where();
      to(x + way[0] * step, y - way[1] * step);
    },
  });
}

/** Puts a mark to its place. `text` is its value for a screen reader. */
export function placeMark(mark, { x, y, across, up }, [right, top], share, text) {
  mark.style.left = `${x + right * across}px`;
  mark.style.top = `${y + (1 - top) * up}px`;
  mark.ariaValueNow = (100 * share).toFixed(1);
  mark.ariaValueText = text;
}
