/** The equations that the wiring solves, and those that the patch states. Every quantity in them is a button. */

import { byId, el, fill, quantity } from './dom.js';
import { toast } from './messages.js';
import { choose } from './probes.js';
import { emit, highlight, on, send, state } from './state.js';

const GREEK = Object.fromEntries('alphaα betaβ gammaγ deltaδ epsilonε zetaζ etaη thetaθ kappaκ lambdaλ muμ nuν xiξ rhoρ sigmaσ tauτ phiφ chiχ psiψ omegaω'
  .split(' ').map((word) => [word.slice(0, -1), word.at(-1)]));
/** A number, a name with its primes or with the parenthesis of a function, or a sign. */
const TOKEN = /\d+(?:\.\d+)?(?:e[+-]?\d+)?|[\p{L}_][\p{L}\d_.]*(?:'+|\()?|\S/gu;
const PRIMES = ['', '′', '″', '‴'];

/** What a name in an equation is: an output, a parameter, or neither. */
function meaning(name) {
  const { patch } = state;
  if (patch?.parameters.some((each) => each.name === name)) return { parameter: name };
  const output = patch?.signals.find((each) => each.name === name)?.at
    ?? patch?.outputs.find((each) => each.name === name || each.name === `${name}.out`)?.name;
  return output ? { output } : null;
}

/** A name as mathematics prints it: "v_rate" has a subscript, "rho" is a letter. */
function printed(name) {
  const [base, ...rest] = name.split('_');
  return [el('i', null, GREEK[base] ?? base), rest.length > 0 && base && el('sub', null, rest.join(' '))];
}

function nameNode(name) {
  const at = meaning(name);
  if (!at) return el('span', null, printed(name));
  const key = at.output ?? at.parameter;
  const node = el('button', {
    type: 'button', class: `eq-name eq-${at.output ? 'output' : 'parameter'}`, 'data-key': key, 'aria-label': at.output ? `${name}, place a probe` : `${name}, show its knob`,
    onclick: (event) => (at.output ? choose(at.output, node, event) : highlight(at)),
  }, printed(name).flat());
  return node;
}

/** What is hidden is read out, so that a fraction is one in words too. */
const spoken = (text) => el('span', { class: 'spoken' }, text);
const operator = (sign) => [el('span', { class: 'eq-op' }, ` ${sign}`), '\u00a0'];

/**
 * Sets a formula in plain text: fractions, powers, primes, functions. Throws if the text is something else, such as a
 * condition.
 */
function formula(text) {
  const tokens = text.match(TOKEN) ?? [];
  /** Takes the next token if it is this one. */
  const take = (sign) => tokens[0] === sign && tokens.shift();
  const expect = (sign) => { if (!take(sign)) throw new Error(`expected ${sign}`); };
  const list = () => {
    const items = sum();
    while (take(',')) items.push(el('span', { class: 'eq-op' }, ', '), ...sum());
    expect(')');
    return items;
  };
  /** An atom. `inner` is what is in parentheses that a fraction or a bar makes needless. */
  const atom = () => {
    const token = tokens.shift() ?? '';
    const name = token.replace(/'+$|\($/u, '');
    if (token === '(') {
      const inner = list();
      return { nodes: ['(', ...inner, ')'], inner };
    }
    if (/^\d/u.test(token)) return { nodes: [quantity(Number(token), '', 12)], isNumber: true };
    if (!/^[\p{L}_]/u.test(token)) throw new Error('expected a value');
    if (token.endsWith('(')) return { nodes: name === 'abs' ? ['|', ...list(), '|'] : [el('span', { class: 'eq-function' }, name), '(', ...list(), ')'] };
    const primes = token.length - name.length;
    return { nodes: [nameNode(name), PRIMES[primes] ?? `(${primes})`], name: primes ? null : name };
  };
  const power = () => {
    const base = atom();
    if (!take('^')) return base;
    const minus = take('-');
    const { inner, nodes } = atom();
    return { nodes: [...base.nodes, el('sup', null, spoken('to the power '), minus ? ['−', ...nodes] : inner ?? nodes)] };
  };
  // A fraction alone needs no parentheses in a product.
  const bare = ({ inner, nodes }) => (inner?.length === 1 && inner[0].classList?.contains('eq-fraction') ? inner : nodes);
  const product = () => {
    let left = power();
    for (;;) {
      if (take('/')) {
        const right = power();
        left = { nodes: [el('span', { class: 'eq-fraction' }, el('span', null, left.inner ?? left.nodes), spoken(' over '), el('span', null, right.inner ?? right.nodes))] };
        continue;
      }
      const sign = take('*') ? operator('·') : ['\u2009'];
      if (sign.length === 1 && !/^[\p{L}_\d(]/u.test(tokens[0] ?? '')) return left;
      const right = power();
      // After a number, a name without meaning is a unit.
      const isUnit = left.isNumber && right.name && right.name !== 't' && !meaning(right.name);
      left = { nodes: [...bare(left), ...sign, ...(isUnit ? [right.name] : bare(right))] };
    }
  };
  const sum = () => {
    const nodes = take('-') ? ['−'] : [];
    nodes.push(...product().nodes);
    for (let sign; (sign = take('+') || take('-'));) nodes.push(...operator(sign.replace('-', '−')), ...product().nodes);
    return nodes;
  };
  const nodes = sum();
  if (tokens.length) throw new Error('more follows');
  return nodes;
}

/** Sets a text of which only the names are known. */
function words(text) {
  return (text.match(/[\p{L}_][\p{L}\d_.]*|[^\p{L}_]+/gu) ?? []).map((word) => (meaning(word) ? nameNode(word) : word.replaceAll('-', '−')));
}

function set(text) {
  try {
    return formula(text);
  } catch {
    return words(text);
  }
}

/** An equation. One with cases has a line for each, with its condition after two blanks or more. */
function equation(text) {
  const [, left, right] = text.match(/^(.*?)\s=\s(.*)$/su) ?? [];
  if (left === undefined) return words(text);
  const lines = right.split('\n').map((line) => line.trim().split(/\s{2,}/u));
  const value = lines.length === 1 && lines[0].length === 1 ? set(right)
    : el('span', { class: 'eq-cases' }, lines.flatMap(([one, condition]) => [el('span', null, set(one)), el('span', { class: 'eq-condition' }, words(condition ?? ''))]));
  return [...set(left), ...operator('='), ...[value].flat()];
}

/** Shows the equations. @param {HTMLElement} root */
export function mountEquations(root) {
  const [message, more, body] = ['.eq-message', '.eq-more', '.eq-body'].map((name) => root.querySelector(name));
  const copies = [['text', () => state.equations.equations.map(({ text }) => text).join('\n')], ['LaTeX', () => state.equations.latex]];
  body.querySelectorAll('button').forEach((each, at) => {
    const [name, text] = copies[at];
    each.onclick = () => navigator.clipboard.writeText(text()).then(() => toast(`The equations are copied as ${name}.`, 'note'),
      () => toast('The browser does not permit copying.'));
  });
  const fault = ({ message: text, hint }) => el('p', { class: 'eq-fault' }, el('strong', null, 'Error'), ` ${text}. `, el('span', null, hint));
  const row = (text, faults = []) => el('li', { class: faults.length && 'eq-wrong' }, el('div', { class: 'eq-row' }, equation(text)), faults.map(fault));
  const show = async () => {
    const { equations: view, findings } = state;
    if (!view) return;
    message.textContent = view.message ?? '';
    message.hidden = !view.message;
    root.classList.toggle('is-stale', Boolean(view.message));
    if (view.message) return;
    const faults = findings.filter(({ code }) => code === 'equation-not-solved');
    const lines = faults.length ? (await send({ command: 'text' })).find(({ event }) => event === 'text')?.text.split('\n') : null;
    // A finding says where its equation is in the text of the patch.
    const isOf = (text) => ({ line, column }) => lines?.[line - 1]?.slice(column - 1).startsWith(JSON.stringify(text));
    byId('eq-solved').replaceChildren(...view.equations.map(({ text }) => row(text)));
    more.textContent = view.more.trim();
    byId('eq-faults').replaceChildren(...faults.filter((each) => !view.stated.some((text) => isOf(text)(each))).map(fault));
    byId('eq-stated').replaceChildren(...view.stated.map((text) => row(text, faults.filter(isOf(text)))));
    byId('eq-stated').parentElement.hidden = !view.stated.length;
  };
  // A knob that is turned changes no name, so that the buttons stay and keep the focus.
  let drawn = '';
  const refresh = () => {
    const { patch, equations, findings } = state;
    const names = patch && [patch.parameters, patch.signals, patch.outputs].map((list) => list.map(({ name, at }) => [name, at]));
    const text = JSON.stringify([equations, names, findings]);
    if (text !== drawn) show();
    drawn = text;
  };
  for (const name of ['equations', 'findings', 'patch']) on(name, refresh);
  const point = ({ target }) => {
    const name = target.closest('.eq-name');
    const kind = name?.matches('.eq-output') ? 'output' : 'parameter';
    emit('pointed', name ? { [kind]: name.dataset.key } : {});
  };
  const leave = () => emit('pointed', {});
  fill(body, { onpointerover: point, onfocusin: point, onpointerleave: leave, onfocusout: leave });
  on('pointed', ({ output, parameter }) => {
    const key = output ?? parameter;
    for (const node of body.querySelectorAll('[data-key]')) node.classList.toggle('lit', node.dataset.key === key);
  });
}
