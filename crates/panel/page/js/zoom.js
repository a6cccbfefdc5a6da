/** Zoom and pan of a drawing: buttons, wheel, pointers. */

import { fill, hasFocus, root, within } from './dom.js';

/** The largest scale at which a drawing opens, and the largest that the user can choose. */
const [OPENED, LARGEST] = [2, 5];
/** Pixels that a pointer moves before it pans. */
const SLACK = 5;
/** Pixels from the edge within which a place is not in sight. */
const EDGE = 40;
/** Pixels from a finger to what it means. */
const FINGER = 22;
/** The size of type in pixels at which the least scale of a drawing applies. Larger type makes drawings larger. */
const TYPE = 15;

/** Steps to the right and downwards of the arrow keys. */
export const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** The one that has the least cost below a limit, or null. */
export function cheapest(all, cost, limit = Infinity) {
  let [found, least] = [null, limit];
  for (const one of all) {
    const its = cost(one);
    if (its < least) [found, least] = [one, its];
  }
  return found;
}

/** The one that is nearest in a direction, or the same one. Those straight ahead come before those at the side. */
export function ahead(from, all, [dx, dy]) {
  return cheapest(all, ({ x, y }) => {
    const along = (x - from.x) * dx + (y - from.y) * dy;
    return along > 1 ? along + 2.5 * Math.abs((x - from.x) * dy + (y - from.y) * dx) : Infinity;
  }) ?? from;
}

/** The node that is nearest to a finger, or null. Other pointers are precise. */
export const nodeAt = ({ pointerType, clientX, clientY }, nodes) => cheapest(nodes, (node) => {
  const { left, right, top, bottom } = node.getBoundingClientRect();
  return Math.hypot(clientX - within(left, clientX, right), clientY - within(top, clientY, bottom));
}, pointerType === 'touch' ? FINGER : 0);

export class Zoom {
  /** The corner and the scale of the part in sight, its size in pixels, and the size of the drawing. */
  x = 0;
  y = 0;
  scale = 1;
  width = 0;
  height = 0;
  size = { width: 1000, height: 600 };
  /** Whether the user has not moved the drawing. */
  isFitted = true;
  /** Pixels that the pointers have moved since the first one was pressed. */
  travel = 0;
  /** Places of the pointers that are pressed. */
  pointers = new Map();

  /**
   * @param {SVGSVGElement[]} pictures they show the same part
   * @param {number} margin space around the drawing
   * @param {number} least the scale at which texts can be read in type of normal size; a larger drawing is cut when it opens
   */
  constructor(view, pictures, margin, least, moved = () => {}) {
    Object.assign(this, { pictures, margin, moved, least });
    new ResizeObserver(() => this.resize()).observe(pictures[0]);
    // The type of the page can have another size now.
    addEventListener('storage', () => this.resize());
    fill(view, {
      onclick: ({ target: { dataset: { zoom } } }) => {
        if (zoom) Number(zoom) ? this.by(zoom) : this.fit(0);
      },
    });
  }

  /** The scale at which the whole drawing is in sight. */
  get whole() {
    return Math.min(this.width / (this.size.width + 2 * this.margin), this.height / (this.size.height + 2 * this.margin), OPENED);
  }

  to(x, y, scale = this.scale, isFitted = false) {
    const { width, height, margin, size, pictures } = this;
    const edge = (at, seen, all) => (seen > all + 2 * margin ? (all - seen) / 2 : within(-margin, at, all + margin - seen));
    const box = [width / scale, height / scale];
    Object.assign(this, { x: edge(x, box[0], size.width), y: edge(y, box[1], size.height), scale, isFitted });
    for (const picture of pictures) picture.setAttribute('viewBox', [this.x, this.y, ...box].join(' '));
    pictures[0].toggleAttribute('data-free', scale > this.whole);
    this.moved();
  }

  /** Shows the whole drawing, or as much of it as the least scale permits. */
  fit(least = this.least) {
    this.least = least;
    this.isFitted = true;
    const type = parseFloat(getComputedStyle(root).fontSize);
    if (this.width) this.to(-this.margin, -this.margin, Math.max(this.whole, least * type / TYPE), true);
  }

  /** The picture has another size, or the drawing has. */
  resize() {
    const { clientWidth, clientHeight } = this.pictures[0];
    [this.width, this.height] = [clientWidth, clientHeight];
    if (this.isFitted) this.fit();
    else if (this.width) this.to(this.x, this.y);
  }

  /** Changes the scale about a point in pixels. */
  by(factor, x = this.width / 2, y = this.height / 2) {
    const next = within(0.9 * Math.min(this.whole, 1), this.scale * factor, LARGEST);
    const share = 1 / this.scale - 1 / next;
    this.to(this.x + x * share, this.y + y * share, next);
  }

  pan(dx, dy) {
    this.to(this.x - dx / this.scale, this.y - dy / this.scale);
  }

  /** Whether the pointers have not moved the drawing. */
  get isStill() {
    return this.travel < SLACK;
  }

  /** Pixels of a point of the drawing, and the point at a pointer. */
  pixels({ x, y }) {
    return [(x - this.x) * this.scale, (y - this.y) * this.scale];
  }

  units(event) {
    const [x, y] = this.local(event);
    return { x: this.x + x / this.scale, y: this.y + y / this.scale };
  }

  local({ clientX, clientY }) {
    const { left, top } = this.pictures[0].getBoundingClientRect();
    return [clientX - left, clientY - top];
  }

  /** Pans as far as is necessary to show a point of the drawing. */
  reveal(point) {
    const sizes = [this.width, this.height];
    const by = this.pixels(point).map((at, axis) => (at < EDGE || at > sizes[axis] - EDGE ? sizes[axis] / 2 - at : 0));
    if (by.some(Boolean)) this.pan(...by);
  }

  /**
   * Lets pointers pan and zoom. The wheel scrolls the page, unless the user has gone into the drawing.
   * @param {() => boolean} may whether the pointers that are pressed may do so
   */
  listen(may = () => true) {
    const { pointers, pictures: [picture] } = this;
    const spread = () => {
      const [a, b = a] = pointers.values();
      return [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, Math.hypot(a[0] - b[0], a[1] - b[1])];
    };
    const away = ({ pointerId }) => pointers.delete(pointerId);
    fill(picture, {
      onpointerdown: (event) => {
        if (pointers.size === 0) this.travel = 0;
        pointers.set(event.pointerId, this.local(event));
      },
      onpointermove: (event) => {
        if (!pointers.has(event.pointerId)) return;
        const [x, y, before] = spread();
        pointers.set(event.pointerId, this.local(event));
        const [u, v, after] = spread();
        this.travel += Math.hypot(u - x, v - y, after - before);
        if (this.isStill || !may()) return;
        picture.setPointerCapture(event.pointerId);
        this.pan(u - x, v - y);
        if (before && after) this.by(after / before, u, v);
      },
      onpointerup: away,
      onpointercancel: away,
      onpointerleave: away,
      onwheel: (event) => {
        if (!event.ctrlKey && !event.metaKey && !hasFocus(picture)) return;
        event.preventDefault();
        this.by(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.002)), ...this.local(event));
      },
    });
  }
}
