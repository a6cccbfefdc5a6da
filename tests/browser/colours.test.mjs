/** The colours of cords, as the style sheets have them: colour-blind people can distinguish them in both themes. */

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { test } from 'node:test';

import { ROOT } from './hosts.mjs';
import { contrast, difference, lab, seen, SIGHTS } from './sight.mjs';

/** The least difference of two cords by CIEDE2000, and the least contrast of a cord with a plate by WCAG 2. */
const [DIFFERENCE, CONTRAST] = [15, 3];
const CORDS = 8;

const css = async (name) => readFile(join(ROOT, 'crates/panel/page/css', name), 'utf8');
/** The values of a property in the rules whose selectors fit. */
const values = (text, selector, property) => [...text.matchAll(/^([^\n{}]*)\{([^{}]*)\}/gm)]
  .filter(([, name]) => selector.test(name.trim()))
  .flatMap(([, , rule]) => [...rule.matchAll(new RegExp(`${property}: (#[0-9a-f]{6})`, 'g'))].map(([, value]) => value));

/** The cords and the plates of a theme. */
async function coloursOf(theme) {
  const [rules, plates] = theme === 'dark' ? [/^:root\[data-theme="dark"\]$/, /^\[data-theme="dark"\] \.faceplate/] : [/^:root$/, /^\.faceplate/];
  const [panel, board] = [await css('panel.css'), await css('board.css')];
  return { cords: values(panel, rules, '--cord-\\d'), plates: values(board, plates, '--plate') };
}

test('differences and contrasts are those of published examples', () => {
  // Sharma, Wu and Dalal, "The CIEDE2000 color-difference formula" (2005), table 1.
  const examples = [
    [[50, 2.6772, -79.7751], [50, 0, -82.7485], 2.0425],
    [[50, 0, 0], [50, -1, 2], 2.3669],
    [[50, -0.001, 2.49], [50, 0.0011, -2.49], 4.7461],
    [[50, 2.5, 0], [73, 25, -18], 27.1492],
    [[60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644],
  ];
  for (const [one, other, wanted] of examples) assert.ok(Math.abs(difference(one, other) - wanted) < 1e-4, `${difference(one, other)}, not ${wanted}`);
  const [black, white, red] = ['#000000', '#ffffff', '#ff0000'].map((hex) => seen(hex, 'normal'));
  assert.ok(Math.abs(contrast(black, white) - 21) < 1e-4);
  [53.2408, 80.0925, 67.2032].forEach((wanted, at) => assert.ok(Math.abs(lab(red)[at] - wanted) < 1e-3, `${lab(red)}`));
});

test('the test recognises colours that look alike', () => {
  // Two cords of an earlier version, for people without the receptors of red.
  const [ochre, olive] = ['#a87600', '#857c00'].map((hex) => lab(seen(hex, 'protan')));
  assert.ok(difference(ochre, olive) < 1, `${difference(ochre, olive)}`);
});

for (const theme of ['light', 'dark']) {
  for (const sight of Object.keys(SIGHTS)) {
    test(`cords in the ${theme} theme differ for ${sight} sight, from each other and from every plate`, async () => {
      const { cords, plates } = await coloursOf(theme);
      assert.deepEqual([cords.length, plates.length], [CORDS, 3]);
      const faults = [];
      cords.forEach((cord, index) => {
        const colour = seen(cord, sight);
        cords.slice(0, index).forEach((other, before) => {
          const apart = difference(lab(colour), lab(seen(other, sight)));
          if (apart < DIFFERENCE) faults.push(`cords ${before + 1} and ${index + 1} differ by ${apart.toFixed(1)}`);
        });
        for (const plate of plates) {
          const ratio = contrast(colour, seen(plate, sight));
          if (ratio < CONTRAST) faults.push(`cord ${index + 1} on ${plate}: ${ratio.toFixed(2)}`);
        }
      });
      assert.deepEqual(faults, []);
    });
  }
}
