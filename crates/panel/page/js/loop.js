/** The clock of the panel: one `advance` for each picture, and never two on their way. */

import { within } from './dom.js';
import { on, send, state } from './state.js';

/** The longest time that one advance covers, in seconds. After a pause of the page the machine does not jump. */
const LONGEST = 0.1;
/** Milliseconds between frames while nothing moves. */
const RESTING = 100;
/** Milliseconds after a command during which frames follow quickly, so that a knob acts at once on a resting machine. */
const LIVELY = 400;

let last = performance.now();
let lively = 0;
let isWaiting = false;

function tick(now) {
  requestAnimationFrame(tick);
  if (isWaiting || document.hidden || !state.host || !state.patch) return;
  const rests = state.frame && (!state.frame.moves || state.frame.paused);
  if (rests && now > lively && now - last < RESTING) return;
  const seconds = within(0, (now - last) / 1000, LONGEST);
  last = now;
  isWaiting = true;
  send('advance', { seconds }).then(() => { isWaiting = false; });
}

on('patch machine scopes', () => { lively = performance.now() + LIVELY; });
requestAnimationFrame(tick);
