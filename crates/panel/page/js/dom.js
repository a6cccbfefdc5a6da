/** Small helpers for elements and numbers. Text always becomes a text node, never markup. */

const SVG = 'http://www.w3.org/2000/svg';

/**
 * Sets attributes. A function for `onx` becomes a listener, `true` an empty attribute; false and null are left out.
 * @param {Element | Document} element
 * @param {Record<string, any> | null} attributes
 * @param {any[]} children elements, texts and numbers; null and false are left out
 */
export function fill(element, attributes, children = []) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if ((value ?? false) === false) continue;
    if (typeof value === 'function') element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.flat().filter((child) => (child ?? false) !== false));
  return element;
}

/** Makes an HTML element. @returns {any} */
export const el = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);

/** Makes an SVG element. @returns {any} */
export const svg = (tag, attributes, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);

/** The texts that are there, in one. */
export const joined = (texts, separator = ', ') => texts.filter(Boolean).join(separator);

/** The first of a list that has a name. */
export const named = (list, name) => list?.find((each) => each.name === name);

/** Makes a function that returns whether its argument differs from that of its last call, as JSON. */
export function changeDetector() {
  let last;
  return (value) => last !== (last = JSON.stringify(value));
}

/** Makes a function that returns whether this number of milliseconds has passed since it returned true. */
export function rateLimiter(period) {
  let due = 0;
  return (now = performance.now()) => {
    const isDue = now >= due;
    if (isDue) due = now + period;
    return isDue;
  };
}

/** Whether a key is pressed together with one that makes it a command of the browser. */
export const hasModifier = ({ ctrlKey, metaKey, altKey }) => ctrlKey || metaKey || altKey;

/** The power of 10 that is at most the value. */
export const decadeOf = (value) => 10 ** Math.floor(Math.log10(value));

/** The next 1, 2 or 5 times a power of 10. */
export function roundUp(value) {
  const decade = decadeOf(value);
  return Number((decade * [1, 2, 5, 10].find((step) => step * decade >= value * 0.999999)).toPrecision(12));
}

/** The value, or the end of the range that is nearest. */
export const within = (low, value, high) => Math.min(high, Math.max(low, value));

export const byId = (id) => document.getElementById(id);

/** The element `html`. Tests import this module without a page. */
export const root = globalThis.document?.documentElement;

/** What this browser keeps by a name. A value is kept first. */
export function stored(name, value) {
  if (value !== undefined) localStorage.setItem(`patchcord.${name}`, value);
  return localStorage.getItem(`patchcord.${name}`);
}

/** Copies a text. Pages without encryption have no clipboard, but can replace what is copied. Returns whether it is copied. */
export async function copyText(text) {
  if (await navigator.clipboard?.writeText(text).then(() => true, () => false)) return true;
  document.oncopy = (event) => {
    event.preventDefault();
    event.clipboardData.setData('text/plain', text);
  };
  const isCopied = document.execCommand('copy');
  document.oncopy = null;
  return isCopied;
}

/** Hides the nodes that do not have all words of a text. Returns how many are shown. */
export function filter(nodes, text) {
  const words = text.toLowerCase().split(/\s+/);
  for (const node of nodes) node.hidden = !words.every((word) => node.textContent.toLowerCase().includes(word));
  return [...nodes].filter(({ hidden }) => !hidden).length;
}

/** The parts of an element by the names in `data-part`. @returns {Record<string, any>} */
export const partsOf = (node) => Object.fromEntries(Array.from(node.querySelectorAll('[data-part]'), (part) => [part.dataset.part, part]));

/** A copy of a template of index.html, and its parts. Those in `texts` get these texts. @returns {Record<string, any>} */
export function template(id, texts = {}) {
  const node = byId(id).content.firstElementChild.cloneNode(true);
  const parts = partsOf(node);
  for (const [name, text] of Object.entries(texts)) parts[name].textContent = text;
  return { node, ...parts };
}

/** A copy of the drawing in a template, with more attributes and children. @returns {any} */
export const shape = (id, attributes, ...children) =>
  fill(byId(id).content.querySelector('svg > *').cloneNode(true), attributes, children);

/** The attributes of a place of the patch panel that can have the focus, if it has a key. */
export const keyed = (key) => key && { role: 'button', tabindex: -1, 'data-key': key };

/** Writes a text only if it is another one, because many are written for every frame. */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Puts a box that floats at a place of the window or of a smaller area, or as near as it fits. */
export function float(box, x, y, width = innerWidth, height = innerHeight) {
  box.style.left = `${within(8, x, width - box.offsetWidth - 8)}px`;
  box.style.top = `${within(8, y, height - box.offsetHeight - 8)}px`;
}

/** Shows parts that were made from a template. Returns them. */
export function place(parent, parts) {
  parent.replaceChildren(...parts.map(({ node }) => node));
  return parts;
}

/** A button with a text. */
export const button = (text, onclick, attributes) => el('button', { type: 'button', onclick, ...attributes }, text);

/** Connects the buttons of a group. Returns a function that presses the button with a value, and no other one. */
export function choice(id, run) {
  const buttons = [...byId(id).children];
  for (const each of buttons) each.onclick = () => run(each.value);
  return (value) => { for (const each of buttons) each.ariaPressed = each.value === value; };
}

/** A number with at most this number of significant digits, in a form that a field accepts: "0.25", "1.2e-7". */
export function format(number, digits = 4) {
  if (Number.isNaN(number ?? NaN)) return '';
  const size = Math.abs(number);
  if (size && (size < 1e-4 || size >= 1e7)) return number.toExponential(digits - 1).replace(/\.?0+e/, 'e').replace('e+', 'e');
  return String(Number(number.toPrecision(digits)));
}

/** A text of a number with a true minus sign. */
export const minus = (text) => text.replace(/^-/, '−');

/** A number with this number of decimals. Zero has no sign. */
export const fixed = (value, decimals) => minus((Number(value.toFixed(decimals)) || 0).toFixed(decimals));

/** A number for reading, with its unit: "−1.5 m", "1.2·10⁻⁷ kg", "20 µs". The unit "1" is left out. */
export function quantity(value, unit = '', digits = 4) {
  if (!Number.isFinite(value)) return '—';
  // Volts, seconds and hertz get prefixes; nobody reads kilovolts or kiloseconds here.
  const most = { V: 0, s: 0, Hz: 2 }[unit];
  const power = most === undefined || !value ? 0 : within(-4, Math.floor(Math.log10(Math.abs(value) * (1 + 1e-9)) / 3), most);
  const name = ['p', 'n', 'µ', 'm', '', 'k', 'M'][power + 4] + (unit === '1' ? '' : unit);
  const [mantissa, exponent] = format(value / 1000 ** power, digits).split('e');
  const raised = exponent ? `·10${exponent.replace(/./g, (sign) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[sign] ?? '⁻')}` : '';
  return `${minus(mantissa)}${raised}${name && '\u202f'}${name}`;
}

/** Whether an element or what is in it has the focus. */
export const hasFocus = (element) => element.contains(document.activeElement);

/** The number in a field, or null. A decimal comma and a true minus sign are accepted. */
export function parse(text) {
  const plain = text.trim().replace('−', '-').replace(',', '.');
  return plain === '' || !Number.isFinite(Number(plain)) ? null : Number(plain);
}
