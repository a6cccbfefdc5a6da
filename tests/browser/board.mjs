/** The patch panel view: its jacks and cords, and how a user patches. */

import { stateOf, tab, until } from './panel.mjs';

/** Shows the patch panel and waits for its faceplate. */
export async function showBoard(page) {
  await tab(page, 'Patch panel').click();
  await until('the faceplate', async () => (await page.locator('#board .jack').count()) > 0);
}

const board = (page) => page.getByRole('tabpanel', { name: 'Patch panel' });
const escaped = (text) => text.replace(/[.+*]/g, '\\$&');

/** An input jack such as "P1.in". */
export const inputJack = (page, name) => board(page).getByRole('button', { name: new RegExp(`^${escaped(name)}, input`) });
export const outputJack = (page, name) => board(page).getByRole('button', { name: new RegExp(`^${escaped(name)}, output`) });
export const cordNode = (page, from, to) => board(page).getByRole('button', { name: new RegExp(`^${escaped(from)} → ${escaped(to)}`) });
export const looseCords = (page) => board(page).getByRole('button', { name: /^Loose cord/ });
export const boardStatus = (page) => board(page).getByRole('status');
export const cordLine = (page) => board(page).getByLabel(/^Cord: output and input/);

/** The middle of a jack on the page, as it is now. */
export async function middleOf(jack) {
  const { x, y, width, height } = await jack.locator('.hole').boundingBox();
  return [x + width / 2, y + height / 2];
}

/** Clicks the jacks in turn. */
export async function clickJacks(page, ...jacks) {
  for (const jack of jacks) {
    await jack.scrollIntoViewIfNeeded();
    await page.mouse.click(...await middleOf(jack));
  }
}

/** Drags from a jack to another one, or by so many pixels. Both must be in the window, because scrolling moves them. */
export async function drag(page, from, to) {
  await from.scrollIntoViewIfNeeded();
  const [x, y] = await middleOf(from);
  const end = Array.isArray(to) ? [x + to[0], y + to[1]] : await middleOf(to);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(...end, { steps: 8 });
  await page.mouse.up();
}

/** Whether the patch has this cord. */
export async function hasCord(page, from, to) {
  const [name, jackName] = to.split('.');
  const { patch } = await stateOf(page);
  const element = patch.elements.find((each) => each.name === name);
  return element.jacks.find((each) => each.name === jackName)?.cords.includes(from) ?? false;
}

/** Waits until the patch has this cord, or has it no more. */
export function cordIs(page, from, to, isPlugged) {
  return until(`cord ${from} to ${to}: ${isPlugged}`, async () => (await hasCord(page, from, to)) === isPlugged);
}

/** Pulls a cord with the Delete key. */
export async function pull(page, from, to) {
  await cordNode(page, from, to).focus();
  await page.keyboard.press('Delete');
  await cordIs(page, from, to, false);
}
