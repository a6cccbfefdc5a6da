/** The search for a missing effect: its progress, its candidates, and what it found. */

import { byId, el, quantity, write } from './dom.js';
import { download } from './files.js';
import { view } from './measured-plot.js';
import { highlight, refusalOf, send } from './state.js';

/** Milliseconds after which the patch panel has drawn new elements. */
const DRAWN = 400;

let found = null;

const times = (rms) => (rms === null ? 'no fit' : `${quantity(rms, '', 3)} × noise`);

/** Shows a list of texts. */
export const list = (parent, texts) => parent.replaceChildren(...texts.map((text) => el('li', null, text)));

/** Shows a step of the search, and adds the candidates that were tried since the last one. */
export function showProgress({ phase, done, total, added, best, rejected }) {
  write(view.phase, phase + (total ? `: ${done} of ${total}` : ''));
  view.bar.max = total || 1;
  view.bar.value = done;
  write(view.best, [...added, best ?? '…'].join(' and '));
  for (const { effect, rms } of rejected) view.candidates.prepend(el('li', null, el('s', null, effect), times(rms)));
}

/** Shows the result of a search, or removes the last one. */
export function showFound(result) {
  found = result;
  view.sentence.textContent = result?.sentence;
  if (!result) return list(view.candidates, []);
  const { before, after, doubts, parameters, patch } = result;
  list(view.facts, [`Residual: ${times(before)} before, ${times(after)} after`, ...parameters.map(({ name, value, low, high, unit, of }) =>
    `${name} = ${quantity(value, unit)} (95 %: ${quantity(low)} … ${quantity(high)}), of ${of}`)]);
  list(view.doubts, doubts);
  view.plug.hidden = !patch;
}

/** What the buttons of the result do. */
export const actions = {
  keep: () => download('report.html', found.report, 'text/html'),
  /** Opens the report in a tab. The policy of the page also holds there: it permits no styles but those that scripts set. */
  report() {
    const tab = window.open();
    if (!tab) return actions.keep();
    const [, head, styles, body] = found.report.match(/(.*)<style>(.*)<\/style>(.*)/s);
    const { document: page } = tab;
    page.write('<!doctype html><p>');
    page.close();
    page.documentElement.replaceWith(new DOMParser().parseFromString(head + body.replaceAll(' style=', ' data-style='), 'text/html').documentElement);
    const sheet = new tab.CSSStyleSheet();
    sheet.replaceSync(styles);
    page.adoptedStyleSheets = [sheet];
    for (const { style, dataset } of page.querySelectorAll('[data-style]')) style.cssText = dataset.style;
  },
  /** Puts the effect into the patch, and shows where. */
  async plug() {
    const { text, elements } = found.patch;
    byId('tab-board').click();
    if (refusalOf(await send('replace', { text }))) return;
    setTimeout(() => elements.forEach((element) => highlight({ element })), DRAWN);
  },
};
