/** Small helpers for elements and numbers. Text always becomes a text node, never markup. */

const SVG = 'http://www.w3.org/2000/svg';

/**
 * Sets attributes. A function for `onx` becomes a listener, `true` an empty attribute; false and null are left out.
 * @param {Element} element
 * @param {Record<string, any> | null} attributes
 * @param {any[]} children elements, texts and numbers; null and false are left out
 */
function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function') element.addEventListener(name.slice(2), value);
    else if (name === 'value') element.value = value;
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** Makes an HTML element. @returns {any} */
export function el(tag, attributes, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** Makes an SVG element. @returns {any} */
export function svg(tag, attributes, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

/** A field with its label: `label('Length', input, 's')`. */
export function label(text, control, unit) {
  return el('label', { class: 'field' },
    el('span', { class: 'field-name' }, text),
    el('span', { class: 'field-box' }, control, unit && el('span', { class: 'unit' }, unit)));
}

/** A button with a text. */
export function button(text, onclick, attributes) {
  return el('button', { type: 'button', onclick, ...attributes }, text);
}

/** One of the icons of index.html. */
export function icon(name) {
  return svg('svg', { class: 'icon', 'aria-hidden': 'true' }, svg('use', { href: `#icon-${name}` }));
}

/** A number with so many significant digits, in a form that a field accepts: "0.25", "1.2e-7". */
export function format(number, digits = 4) {
  if (number === null || number === undefined || Number.isNaN(number)) return '';
  const size = Math.abs(number);
  if (size !== 0 && (size < 1e-4 || size >= 1e7)) {
    return number.toExponential(digits - 1).replace(/\.?0+e/, 'e').replace('e+', 'e');
  }
  return String(Number(number.toPrecision(digits)));
}

const RAISED = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };

/** A number for reading, with its unit: "−1.5 m", "1.2·10⁻⁷ s". The unit "1" is left out. */
export function quantity(value, unit, digits = 4) {
  const [mantissa, exponent] = format(value, digits).split('e');
  const power = exponent ? `·10${[...exponent].map((sign) => RAISED[sign]).join('')}` : '';
  return `${mantissa.replace('-', '−')}${power}${unit && unit !== '1' ? `\u202f${unit}` : ''}`;
}

/** The number in a field, or null. A decimal comma and a true minus sign are accepted. */
export function parse(text) {
  const plain = text.trim().replace('−', '-').replace(',', '.');
  return plain === '' || !Number.isFinite(Number(plain)) ? null : Number(plain);
}
