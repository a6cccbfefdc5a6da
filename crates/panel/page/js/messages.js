/** Findings of the checker, refusals, and the state of the connection. */

import { byId, fill, float, joined, root, template, write } from './dom.js';
import { highlight, on, send, state } from './state.js';

/** Milliseconds for which a refusal is shown, for a text of no length and for each letter. */
const SHOWN = 4000;
const SHOWN_PER_LETTER = 40;

/** The name of a place: "A3 x10", "parameter M". */
export const placeName = ({ element, jack, setting, parameter }) =>
  (parameter ? `parameter ${parameter}` : joined([element, jack ?? setting], ' '));

function findingItem({ code, severity, message, hint, place }) {
  const { node, seek, equations } = template('finding', { severity, message, hint, seek: place && `Show ${placeName(place)}` });
  node.classList.add(severity);
  seek.onclick = () => highlight(place);
  equations.hidden = code !== 'equation-not-solved';
  equations.onclick = () => highlight({ equation: true });
  return node;
}

/** A number of things, or nothing if there are none. */
const count = (number, word) => number && `${number} ${word}${number === 1 ? '' : 's'}`;

const [findings, correct, checks] = ['findings', 'correct', 'checks'].map(byId);

function showFindings() {
  const errors = state.findings.filter(({ severity }) => severity === 'error').length;
  const summary = joined([count(errors, 'error'), count(state.findings.length - errors, 'warning')]);
  findings.replaceChildren(...state.findings.map(findingItem));
  correct.hidden = !state.findings.some(({ code }) => code.startsWith('equation-'));
  write(checks, summary || 'The patch has no faults');
}

/** Searches for corrections, which takes seconds. They are in the hints of the findings. */
async function findCorrections() {
  if (correct.ariaBusy === 'true') return;
  correct.ariaBusy = true;
  write(checks, 'Searching for corrections…');
  const hints = () => state.findings.map(({ hint }) => hint).join();
  const before = hints();
  const answer = await send('advise');
  correct.ariaBusy = false;
  showFindings();
  if (answer.length === 0) return;
  if (hints() === before) toast(correct.dataset.none, 'note');
  correct.hidden = true;
  findings.focus();
}

/** Where the user looks: the pointer, or the control with the focus if a key was the last input. */
let pointer = null;

function place(box) {
  const focus = document.activeElement?.getBoundingClientRect();
  const { x, y } = pointer ?? { x: focus?.left ?? innerWidth / 2, y: focus?.bottom ?? innerHeight / 3 };
  float(box, x + 12, y + 16);
}

/** Shows a message near the pointer and reads it out. A message stays while the pointer is on it. */
export function toast(message, kind = 'error') {
  const { node: box, close } = template('toast', { message });
  box.classList.add(kind);
  close.onclick = () => box.remove();
  byId('toasts').replaceChildren(box);
  place(box);
  const time = SHOWN + SHOWN_PER_LETTER * message.length;
  let timer = setTimeout(close.onclick, time);
  box.onpointerenter = () => clearTimeout(timer);
  box.onpointerleave = () => { timer = setTimeout(close.onclick, time / 2); };
}

const move = ({ clientX, clientY }) => { pointer = { x: clientX, y: clientY }; };
fill(document, { onpointermove: move, onpointerdown: move, onkeydown: () => { pointer = null; } });
correct.onclick = findCorrections;
on('findings', showFindings);
on('refused', ({ message, place: where }) => {
  if (where) highlight(where);
  // The patch panel shows it at the jack.
  if (!where?.element || !byId('board').offsetParent) toast(message);
});
on('link', (message) => write(byId('link').firstChild, message));
on('probing', (listener) => root.toggleAttribute('data-probing', Boolean(listener)));
