/** How the page is laid out: what is too wide, what covers something else, and which texts are cut. */

/** Pixels that borders share and rounding costs. */
const ROUNDING = 1.5;
/** The least width of the title in pixels. */
const TITLE = 60;
const CONTROLS = 'button, select, input, summary, .bar-title';
/** Texts that name or report something. They may be wider than their boxes. */
const TEXTS = '.field-name, .scrub-name, .readout p, .mode-name';
/** What holds controls. */
const CARDS = '.bar, .machine, .readout, .run, .timing, .lamps, .checks, .scopes > .card, .views-bar, .board-tools, .board-foot, .meter, .schematic-tools';

/** The width of the page in pixels. It is that of the window if nothing scrolls sideways. */
export const pageWidth = (page) => page.evaluate(() => document.scrollingElement.scrollWidth);

/** Controls and texts that cover each other or leave their card, and a title without room. Closed menus do not count. */
export function misplaced(page) {
  return page.evaluate(([controls, texts, cards, rounding, least]) => {
    const isOver = (one, other) => Math.min(one.right, other.right) - Math.max(one.left, other.left) > rounding
      && Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top) > rounding;
    const isOut = (one, card) => one.left < card.left - rounding || one.right > card.right + rounding
      || one.top < card.top - rounding || one.bottom > card.bottom + rounding;
    const name = (node) => `${node.tagName.toLowerCase()} ${node.ariaLabel ?? node.textContent.trim().slice(0, 24)}`;
    const boxOf = (node) => {
      const text = document.createRange();
      text.selectNodeContents(node);
      return (node.matches(texts) ? text : node).getBoundingClientRect();
    };
    const { width } = document.querySelector('.bar-title').getBoundingClientRect();
    const faults = width < least ? [`the title has ${width} px`] : [];
    for (const card of document.querySelectorAll(cards)) {
      // Without a box of its own, its children have theirs, at other places of the page.
      if (!card.checkVisibility() || getComputedStyle(card).display === 'contents') continue;
      const seen = [...card.querySelectorAll(`${controls}, ${texts}`)].filter((node) => node.checkVisibility() && !node.matches('.scope-check input')
        && getComputedStyle(node.closest('.modes') ?? node).position !== 'fixed');
      const boxes = seen.map(boxOf);
      const edge = card.getBoundingClientRect();
      seen.forEach((node, index) => {
        // Tabs scroll if they have no room.
        if (!node.closest('.tabs') && isOut(boxes[index], edge)) faults.push(`${name(node)} leaves ${card.className}`);
        seen.slice(0, index).forEach((other, before) => {
          const isTab = node.closest('.tabs') || other.closest('.tabs');
          if (!isTab && !node.contains(other) && !other.contains(node) && isOver(boxes[index], boxes[before])) faults.push(`${name(node)} covers ${name(other)}`);
        });
      });
    }
    return faults;
  }, [CONTROLS, TEXTS, CARDS, ROUNDING, TITLE]);
}

/** Lists of scopes whose selected text does not fit, and modes whose name touches the border. */
export function cutTexts(page) {
  return page.evaluate((rounding) => {
    const faults = [];
    for (const list of document.querySelectorAll('.scope select[data-set$="division"]')) {
      if (!list.checkVisibility()) continue;
      const copy = list.cloneNode(false);
      copy.append(list.selectedOptions[0].cloneNode(true));
      copy.style.cssText = 'position: absolute; max-width: none; width: max-content';
      list.after(copy);
      const missing = copy.getBoundingClientRect().width - list.getBoundingClientRect().width;
      copy.remove();
      if (missing > rounding) faults.push(`${list.selectedOptions[0].textContent} is cut by ${missing.toFixed(1)} px`);
    }
    for (const node of document.querySelectorAll('.mode-name')) {
      const text = document.createRange();
      text.selectNodeContents(node);
      const [inner, outer] = [text, node.closest('.mode')].map((part) => part.getBoundingClientRect());
      const least = Math.min(inner.left - outer.left, outer.right - inner.right);
      if (least < 4) faults.push(`${node.textContent} is ${least.toFixed(1)} px from the border`);
    }
    return faults;
  }, ROUNDING);
}

/** The middle size of the texts of a drawing on the page, in pixels. */
export function typeSize(page, drawing) {
  return page.locator(`${drawing} text`).evaluateAll((texts) => {
    const sizes = texts.filter((text) => text.textContent).map((text) => parseFloat(getComputedStyle(text).fontSize) * text.getScreenCTM().a).sort((a, b) => a - b);
    return sizes[Math.floor(sizes.length / 2)];
  });
}
