/**
 * The problem check: every output and derivative in volts, compared with the equations of the patch. The table is shown in
 * the mode "Problem check".
 */

import { byId, fixed, partsOf, quantity, template } from './dom.js';
import { ask, highlight, on } from './state.js';

/** Units of an output and of its derivatives. Seconds are those of the machine. */
const UNITS = ['V', 'V/s', 'V/s2', 'V/s3', 'V/s4'];

const isWrong = ({ differs, overloaded }) => differs || overloaded;

/** The result of a row in a few words. */
function resultOf({ expected, differs, overloaded, not_compared: reason }) {
  if (differs) return '✗ fault';
  if (overloaded) return '✗ overload';
  return expected === null ? reason ?? 'no equation' : '✓ ok';
}

function rowNode(row) {
  const { element, order, quantity: name, expected, wired } = row;
  const volts = (value) => `${fixed(value, 3)}\u202f${UNITS[order]}`;
  const { node } = template('check-row', {
    seek: element + '′'.repeat(order), quantity: name, wired: volts(wired), result: resultOf(row),
    // Without the rounding errors of the arithmetic.
    ...expected !== null && { expected: volts(expected), difference: quantity(Number((wired - expected).toFixed(9)), UNITS[order], 3) },
  });
  node.classList.toggle('is-wrong', isWrong(row));
  node.onclick = () => highlight({ element });
  return node;
}

const root = byId('check');
const { status, start, random, rows } = partsOf(root);
let [mode, seed] = [null, null];

/** Compares the values, if the table is shown. */
async function check() {
  const found = !root.hidden && await ask('static-check', { seed });
  if (!found) return;
  rows.replaceChildren(...found.rows.sort((one, other) => isWrong(other) - isWrong(one)).map(rowNode));
  const wrong = found.rows.filter(isWrong).length;
  const words = found.compared ? root.dataset.equal : root.dataset.alone;
  status.textContent = `${seed ? `Test values ${seed}` : 'At the start'}: ${wrong ? `${wrong} of ${found.rows.length} values are wrong` : words}.`;
}

start.onclick = () => {
  seed = null;
  return check();
};
random.onclick = () => {
  seed += 1;
  check();
};
on('patch', check);
on('machine', async ({ mode: next }) => {
  if (next === mode) return;
  const isFirst = !mode;
  mode = next;
  root.hidden = mode !== 'problem-check';
  await start.onclick();
  // The page may be longer than the window. The mode with which a page begins does not move it.
  if (!isFirst) root.scrollIntoView({ block: 'nearest' });
});
