/** What a finger finds on the page: the sizes of controls, the distances of jacks, and a touch. */

import { until } from './panel.mjs';

/** Size in pixels that a finger needs. */
export const FINGER = 44;
/** Pixels that rounding may cost. */
const ROUNDING = 0.5;

/**
 * The controls in sight that are smaller than a finger. Jacks and names in equations are smaller and have tests of their
 * own. An output of the schematic takes each touch within 22 px.
 */
function smallOnes(page) {
  return page.evaluate((least) => [...document.querySelectorAll('button, select, input, summary, a[href], [role=slider], [role=tab], [role=option]')]
    .filter((node) => node.checkVisibility() && !node.closest('svg, .skip, .eq-name'))
    .map((node) => ({ node, box: (node.matches('input') ? node.closest('label') ?? node : node).getBoundingClientRect() }))
    .filter(({ box }) => box.width > 0 && (box.height < least || box.width < least))
    .map(({ node, box }) => `${node.tagName} ${node.id} ${node.getAttribute('aria-label') ?? node.textContent.slice(0, 20)} ${box.width.toFixed(0)}x${box.height.toFixed(0)}`), FINGER - ROUNDING);
}

/** The controls of the page that are smaller than a finger, also in what is closed. */
export async function smallTargets(page) {
  const small = await smallOnes(page);
  for (const details of await page.locator('details:visible').all()) {
    const wasOpen = await details.evaluate((node) => {
      const before = node.open;
      node.open = true;
      return before;
    });
    small.push(...await smallOnes(page));
    await details.evaluate((node, open) => { node.open = open; }, wasOpen);
  }
  return [...new Set(small)];
}

/** The same for a dialog that an action opens. */
export async function smallInDialog(page, action) {
  await action();
  await page.getByRole('dialog').waitFor();
  const small = await smallTargets(page);
  await page.keyboard.press('Escape');
  await until('the dialog is closed', async () => (await page.getByRole('dialog').count()) === 0);
  return small;
}

/** The least distance of two jacks of the patch panel on the page, in pixels. */
export function jackDistance(page) {
  return page.locator('#board .jack[data-key] .hole').evaluateAll((holes) => {
    const places = holes.map((hole) => hole.getBoundingClientRect());
    let least = Infinity;
    places.forEach((one, index) => {
      for (const other of places.slice(index + 1)) least = Math.min(least, Math.hypot(one.x - other.x, one.y - other.y));
    });
    return least;
  });
}

/** Touches a point of the page. */
export const touch = (page, [x, y]) => page.touchscreen.tap(x, y);

/** Waits until the page has two frames, so that all that follows from a new size has been drawn. */
export const painted = (page) => page.evaluate(() => new Promise((resolve) => {
  requestAnimationFrame(() => requestAnimationFrame(resolve));
}));
