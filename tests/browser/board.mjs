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

/** The middle of a jack on the page. */
export async function middleOf(jack) {
  const hole = jack.locator('.hole');
  await hole.scrollIntoViewIfNeeded();
  const { x, y, width, height } = await hole.boundingBox();
  return [x + width / 2, y + height / 2];
}

/** Drags from a jack to a place. A page that scrolls in between would move the place. */
export async function drag(page, from, to) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps: 8 });
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
