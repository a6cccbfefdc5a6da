/** The equations that the wiring solves, and those that the patch states. Every quantity in them is a button. */

import { button, byId, changeDetector, copyText, el, fill, named, partsOf, quantity } from './dom.js';
import { toast } from './messages.js';
import { choose } from './probes.js';
import { ask, emit, highlight, on, state } from './state.js';
import { nodeAt } from './zoom.js';

const root = byId('equations');
/** The Greek letters by their names, from index.html. */
const letters = new Map(Object.entries(JSON.parse(root.dataset.letters)));
/** A number, a name with its primes or with the parenthesis of a function, or a sign. */
const TOKEN = /\d+(?:\.\d+)?(?:e[+-]?\d+)?|[\p{L}_][\p{L}\d_.]*(?:'+|\()?|\S/gu;
const PRIMES = ['', '′', '″', '‴'];

/** What a name in an equation is: `{output}`, `{parameter}`, or nothing. */
function meaning(name) {
  const { parameters = [], signals, outputs } = state.patch ?? {};
  if (named(parameters, name)) return { parameter: name };
  const output = named(signals, name)?.at ?? (named(outputs, name) ?? named(outputs, `${name}.out`))?.name;
  return output && { output };
}

const span = (look, ...children) => el('span', { class: look && `eq-${look}` }, children.flat());

/** A name as mathematics prints it, with a subscript or as a Greek letter: "v_rate", "rho". A name that means something is a button. */
function nameNode(name) {
  const [base, ...rest] = name.split('_');
  const printed = [el('i', null, letters.get(base) ?? base), rest.length > 0 && base && el('sub', null, rest.join(' '))];
  const at = meaning(name);
  if (!at) return span(null, printed);
  const { output, parameter } = at;
  const node = button(null, (event) => (output ? choose(output, node, event) : highlight(at)), {
    class: 'eq-name', 'data-output': output, 'data-parameter': parameter,
    'aria-label': name + (output ? ', place a probe' : ', show its knob'),
  });
  return fill(node, null, printed);
}

/** What is hidden is read out, so that a fraction is one in words too. */
const spoken = (text) => el('span', { class: 'spoken' }, text);
const operator = (sign) => [span('op', ` ${sign}`), '\u00a0'];

/**
 * Sets a formula in plain text: fractions, powers, primes, functions. Throws if the text is something else, such as a
 * condition.
 */
function formula(text) {
  const tokens = text.match(TOKEN) ?? [];
  const fail = () => { throw new Error(`This is no formula: ${text}`); };
  /** Takes the next token if it is this one. */
  const take = (sign) => tokens[0] === sign && tokens.shift();
  const list = () => {
    const items = sum();
    while (take(',')) items.push(span('op', ', '), ...sum());
    if (!take(')')) fail();
    return items;
  };
  /** An atom. `inner` is what is in parentheses that a fraction or a bar makes needless. */
  const atom = () => {
    const token = tokens.shift() ?? '';
    if (token === '(') {
      const inner = list();
      return { nodes: ['(', ...inner, ')'], inner };
    }
    if (/^\d/u.test(token)) return { nodes: [quantity(Number(token), '', 12)], isNumber: true };
    if (!/^[\p{L}_]/u.test(token)) fail();
    const name = token.replace(/'+$|\($/u, '');
    const primes = token.length - name.length;
    if (token === 'abs(') return { nodes: ['|', ...list(), '|'] };
    if (token.endsWith('(')) return { nodes: [span('function', name), '(', ...list(), ')'] };
    return { nodes: [nameNode(name), PRIMES[primes] ?? `(${primes})`], name: primes ? null : name };
  };
  const power = () => {
    const base = atom();
    if (!take('^')) return base;
    const minus = take('-') ? '−' : null;
    const { inner, nodes } = atom();
    return { nodes: [...base.nodes, el('sup', null, spoken('to the power '), minus, minus ? nodes : inner ?? nodes)] };
  };
  // A fraction alone needs no parentheses in a product.
  const bare = ({ inner, nodes }) => (inner?.length === 1 && inner[0].classList?.contains('eq-fraction') ? inner : nodes);
  const product = () => {
    let left = power();
    for (;;) {
      if (take('/')) {
        const right = power();
        const [over, under] = [left, right].map(({ inner, nodes }) => span(null, inner ?? nodes));
        left = { nodes: [span('fraction', over, spoken(' over '), under)] };
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
  if (tokens.length) fail();
  return nodes;
}

/** Sets a text of which only the names are known. */
const words = (text) => (text?.match(/[\p{L}_][\p{L}\d_.]*|[^\p{L}_]+/gu) ?? [])
  .map((word) => (meaning(word) ? nameNode(word) : word.replaceAll('-', '−')));

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
  if (!left) return words(text);
  const lines = right.split('\n').map((line) => line.trim().split(/\s{2,}/u));
  const value = lines.flat().length === 1 ? set(right)
    : [span('cases', lines.flatMap(([one, condition]) => [span(null, set(one)), span('condition', words(condition))]))];
  return [...set(left), ...operator('='), ...value];
}

const { message, body, plain, latex, solved, more, unplaced, stated } = partsOf(root);

async function copy(text) {
  if (await copyText(text)) toast(plain.dataset.done, 'note');
  else toast(plain.dataset.fault);
}

plain.onclick = () => copy(state.equations.equations.map(({ text }) => text).join('\n'));
latex.onclick = () => copy(state.equations.latex);

const fault = ({ message: text, hint }) => el('p', { class: 'eq-fault' }, el('strong', null, 'Error'), ` ${text}. `, span(null, hint));
const row = (text, faults = []) => el('li', { class: faults.length && 'eq-wrong' },
  el('div', { class: 'eq-row' }, equation(text)), faults.map(fault));

async function show() {
  const { equations: view, findings } = state;
  if (!view) return;
  message.textContent = view.message;
  if (view.message) return;
  const faults = findings.filter(({ code }) => code === 'equation-not-solved');
  const lines = faults.length ? (await ask('text'))?.text.split('\n') : null;
  // Other findings have come meanwhile, and are shown.
  if (findings !== state.findings) return;
  // A finding says where its equation is in the text of the patch.
  const isOf = (text) => ({ line, column }) => lines?.[line - 1]?.slice(column - 1).startsWith(JSON.stringify(text));
  solved.replaceChildren(...view.equations.map(({ text }) => row(text)));
  more.textContent = view.more.trim();
  unplaced.replaceChildren(...faults.filter((each) => !view.stated.some((text) => isOf(text)(each))).map(fault));
  stated.replaceChildren(...view.stated.map((text) => row(text, faults.filter(isOf(text)))));
}

// A knob that is turned changes no name, so that the buttons stay and keep the focus.
const hasOtherContent = changeDetector();
on('equations findings patch', () => {
  const { patch, equations, findings } = state;
  const names = ['parameters', 'signals', 'outputs'].map((list) => patch?.[list].map(({ name, at }) => [name, at]));
  if (hasOtherContent([equations, names, findings])) show();
});
const point = ({ target }) => emit('pointed', { ...target.closest('.eq-name')?.dataset });
const leave = () => emit('pointed', {});
const touch = (event) => { if (!event.target.closest('button')) nodeAt(event, body.querySelectorAll('.eq-name'))?.click(); };
fill(body, { onclick: touch, onpointerover: point, onfocusin: point, onpointerleave: leave, onfocusout: leave });
on('pointed', ({ output, parameter }) => {
  for (const node of body.querySelectorAll('.eq-name')) {
    node.classList.toggle('lit', output ? node.dataset.output === output : parameter && node.dataset.parameter === parameter);
  }
});
