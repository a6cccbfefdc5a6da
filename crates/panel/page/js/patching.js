/** Patching by mouse, touch and keys. */

import { cordClass, keysOf, lay } from './cords.js';
import { fill, hasModifier, shape } from './dom.js';
import { PITCH } from './faceplate.js';
import { bind } from './keys.js';
import { choose as offerProbes } from './probes.js';
import { highlight, isProbing, send } from './state.js';
import { ahead, ARROWS, cheapest } from './zoom.js';

/** Distance in pixels within which a jack or plug is taken, by the type of the pointer. */
const REACH = { mouse: 13, pen: 18, touch: 24 };
/** The scale from which on a finger can choose between jacks, which are then at least 44 px apart. */
const TOUCHABLE = 44 / PITCH;
/** Pixels by which a pointer moves before it drags. */
const STILL = 5;
/** Milliseconds after which a finger that does not move opens the menu of probes. */
const LONG = 600;

const endOf = ({ type, element, jack, output }) => (type === 'out' ? { output } : { element, jack });
const isJack = ({ type }) => type === 'in' || type === 'out';
/** The output whose voltage is at a place, if it is only one. */
const outputAt = ({ output, cord, view }) => output ?? cord?.from ?? (view?.cords.length === 1 && view.cords[0]);

/** @param {any} board what board.js has */
export function mountPatching(board) {
  const { say, stop, parts: { canvas, over, lock } } = board;
  let press = null;
  /** The cord in the hand: the jack of its other end, the type of jack that it needs, and which cord it was. */
  let hand = null;
  let draft = null;

  function isLocked() {
    if (board.isLocked()) say(lock.dataset.locked);
    return board.isLocked();
  }
  /** The plug or jack at the pointer. Plugs come first, because they are on top of their jacks. */
  function nearest(event, test = () => true) {
    const point = board.zoom.units(event);
    return cheapest([...board.plugs, ...board.stops.filter(isJack)].filter(test), ({ x, y }) => Math.hypot(x - point.x, y - point.y),
      board.reach(REACH[event.pointerType] ?? REACH.mouse));
  }
  function take(fixed, cord, id, node) {
    release();
    hand = { fixed, cord, id, node, want: fixed.type === 'in' ? 'out' : 'in' };
    canvas.dataset.want = hand.want;
    fixed.node.classList.add('is-held');
    node?.classList.add('is-lifted');
    draft = shape('cord', { class: `${cordClass(board.colours.get(cord?.from ?? fixed.output))} is-draft` });
    lay(draft, fixed, fixed);
    over.append(draft);
    board.hover(null, null);
    say(`Cord from ${fixed.name}: choose an ${hand.want}put. Escape cancels.`);
  }
  /** Takes what is there: a plug out of its jack, a loose plug, or the first end of a new cord. */
  function begin(hit, isNew) {
    const { type, cord, moves, id, node } = hit;
    if (type === 'loose') take(hit.fixed, undefined, id, node);
    else if (type === 'plug' && !isNew) take(stop(keysOf(cord)[moves === 'in' ? 'out' : 'in']), cord, undefined, node);
    else take(hit.jack?.node ? hit.jack : hit);
  }
  function release() {
    if (!hand) return;
    hand.fixed.node.classList.remove('is-held');
    hand.node?.classList.remove('is-lifted');
    draft.remove();
    mark(null);
    hand = null;
    delete canvas.dataset.want;
    say('');
  }
  /** Marks the jack into which a plug would go. */
  function mark(goal) {
    canvas.querySelector('.is-aim')?.classList.remove('is-aim', 'is-wrong');
    goal?.node.classList.add('is-aim', goal.type === hand.want ? 'is-aim' : 'is-wrong');
  }
  /** Draws the cord in the hand to a jack or a point. */
  function aim(goal, point = goal) {
    mark(goal);
    lay(draft, hand.fixed, point);
  }
  function plugInto(goal) {
    const { fixed, want, cord, id } = hand;
    release();
    if (goal === fixed || (cord && Object.values(keysOf(cord)).includes(goal.key))) return;
    const [output, input] = want === 'in' ? [fixed, goal] : [goal, fixed];
    if (goal.type !== want) board.bubble(`Both are ${goal.type}puts. A cord goes from an output to an input.`, goal);
    else if (id !== undefined) send('plug-loose', { id, to: endOf(goal) });
    else if (cord) send('move-cord', { ...cord, to: endOf(goal) });
    else send('plug', { from: output.output, ...endOf(input) });
  }
  /** Leaves the cord where it is dropped. */
  function drop({ x, y }) {
    const { fixed, cord, id } = hand;
    release();
    const at = [Math.round(x), Math.round(y)];
    if (id === undefined) send('loose-cord', { end: endOf(fixed), at, ...cord && { replaces: cord } });
    else send('move-loose', { id, at });
  }
  /** Offers the probes for the output at a place, or places the one that waits. Returns whether there is an output. */
  function offer(one, event) {
    const output = outputAt(one ?? {});
    if (!output) return false;
    release();
    // The menu gets the end of the press.
    board.zoom.pointers.clear();
    board.focus(one.key ?? one.jack.key);
    offerProbes(output, one.node, event);
    return true;
  }
  /** A click or Enter: the first one begins a cord, the second one ends it. A full jack gives its cord. */
  function choose(hit) {
    const jack = isJack(hit) ? hit : hit.fixed ? null : hit.jack;
    if (isProbing()) offer(hit);
    else if (hand) {
      if (jack) plugInto(jack);
      else release();
    } else if (!isLocked()) {
      const isFull = jack?.node.classList.contains('is-full');
      begin(isFull ? board.plugs.find((plug) => plug.jack === jack && plug.moves) ?? jack : hit, !isFull);
    }
  }
  function click({ hit, key, knob, isSmall }, event) {
    if (isSmall) {
      board.zoom.by(1.05 * TOUCHABLE / board.zoom.scale, ...board.zoom.local(event));
      say('Now touch the jack.');
      return;
    }
    if (hit) {
      board.focus(hit.key ?? hit.jack.key);
      choose(hit);
      return;
    }
    const isBusy = hand !== null;
    release();
    board.focus(key);
    if (knob) highlight({ element: knob, setting: 'setting' });
    if (!isBusy) fillFree(stop(key));
  }
  function fillFree(one) {
    if (one?.type === 'free' && !isLocked()) board.add(one.section);
  }

  /** The nearest place in a direction. Cords follow each other in their order. */
  function next(from, [dx, dy]) {
    const all = board.stops.filter(({ type }) => (type === 'cord') === (from.type === 'cord'));
    if (from.type === 'cord') return all.at((all.indexOf(from) + dx + dy) % all.length);
    return ahead(from, all, [dx, dy]);
  }
  function remove(one) {
    const own = board.plugs.filter(({ jack, cord }) => jack === one && cord);
    if (!isJack(one)) board.remove(one);
    else if (own.length === 1 || (own.length && one.type === 'in')) board.remove(stop(keysOf(own.at(-1).cord).cord));
    else say(own.length ? canvas.dataset.several : canvas.dataset.none);
  }
  /** Returns whether the panel uses the key. */
  function key(name, one) {
    if (name === 'Escape' && hand) release();
    else if (ARROWS[name]) {
      const goal = next(one, ARROWS[name]);
      board.focus(goal.key);
      if (hand && isJack(goal)) aim(goal);
    } else if (name === 'Enter' || name === ' ') {
      if (isJack(one) || one.type === 'loose') choose(one);
      else fillFree(one);
    } else if (name === 'Delete' || name === 'Backspace') {
      if (one.type !== 'free' && !isLocked()) remove(one);
    } else return false;
    return true;
  }

  const keyAt = ({ target }) => target.closest('[data-key]')?.dataset.key;
  // The focus follows the choice of a place, not the press; and a page does not scroll under a finger that patches.
  const prevent = (event) => event.preventDefault();
  board.zoom.listen(() => !press || (press.isMoved && !press.isDragging));
  fill(canvas, {
    onpointerdown(event) {
      if (event.button) return;
      if (board.zoom.pointers.size > 1) {
        if (press?.isDragging) release();
        press = null;
        return;
      }
      const { pointerId, clientX, clientY, target } = event;
      canvas.setPointerCapture(pointerId);
      const hit = nearest(event);
      const isSmall = hit && event.pointerType === 'touch' && board.zoom.scale < TOUCHABLE;
      const own = { at: [clientX, clientY], hit, isSmall, key: keyAt(event), knob: target.closest('[data-knob]')?.dataset.knob };
      press = own;
      if (event.pointerType === 'touch')
        setTimeout(() => { if (press === own && !own.isMoved && !hand && offer(own.hit, event)) press = null; }, LONG);
    },
    // The right button, or the key for menus.
    oncontextmenu(event) {
      if (offer(event.button < 0 ? stop(event.target.dataset.key) : nearest(event), event)) event.preventDefault();
    },
    onpointermove(event) {
      const { clientX, clientY, pointerType } = event;
      if (board.zoom.pointers.size > 1) return;
      if (press && !press.isMoved && Math.hypot(clientX - press.at[0], clientY - press.at[1]) >= STILL) {
        press.isMoved = true;
        press.isDragging = press.hit !== null && !press.isSmall && !isLocked();
        if (press.isDragging) begin(press.hit, event.shiftKey || event.ctrlKey);
      }
      if (hand && (!press || press.isDragging)) {
        const goal = nearest(event, (one) => isJack(one) && one !== hand.fixed);
        aim(goal, goal ?? board.zoom.units(event));
      } else if (!press && pointerType === 'mouse') {
        const hit = nearest(event);
        // The lowest plug is the jack with all its cords, each one above it is its own cord.
        const seen = hit?.type !== 'plug' ? hit : hit.x === hit.jack.x ? hit.jack : stop(keysOf(hit.cord).cord);
        board.hover(seen ?? stop(keyAt(event)) ?? null);
      }
    },
    onpointerup(event) {
      const done = press;
      press = null;
      if (done?.isDragging && hand) {
        const goal = nearest(event, isJack);
        board.focus((goal ?? hand.fixed).key);
        if (goal) plugInto(goal);
        else drop(board.zoom.units(event));
      } else if (done && !done.isMoved) click(done, event);
    },
    onpointercancel() {
      if (press?.isDragging) release();
      press = null;
    },
    onpointerleave: () => { if (!press) board.hover(null); },
    onmousedown: prevent,
    ontouchstart: prevent,
    onkeydown(event) {
      const one = stop(event.target.dataset.key);
      if (one && !hasModifier(event) && key(event.key, one)) event.preventDefault();
    },
  });
  bind('M', 'Probes at the jack with the focus', ({ target }) => offer(stop(target.dataset.key)));
  board.release = release;
}
