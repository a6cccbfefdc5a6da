/** Patching by mouse, touch and keys. */

import { curve, drawCord } from './cords.js';
import { highlight, isProbing, probed } from './state.js';

/** Distance in pixels within which a jack or plug is taken, by the type of the pointer. */
const REACH = { mouse: 13, pen: 18, touch: 24 };
/** Pixels by which a pointer moves before it drags. */
const STILL = 5;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

const endOf = ({ type, element, jack, output }) => (type === 'out' ? { output } : { element, jack });
const isJack = ({ type }) => type === 'in' || type === 'out';

/** @param {any} board what board.js has */
export function mountPatching(board) {
  const { canvas, over, send, say } = board;
  const pointers = new Map();
  let press = null;
  let pinch = 0;
  /** The cord in the hand: the jack of its other end, the type of jack that it needs, and which cord it was. */
  let hand = null;
  let draft = null;
  let aimed = null;
  const isLocked = () => canvas.dataset.lock === 'true' && (say('The panel is locked. Press Unlock to patch.'), true);

  function nearest(event, test = () => true) {
    const point = board.units(event);
    let least = (REACH[event.pointerType] ?? 13) / Math.min(board.scale, 1.4);
    let found = null;
    // Plugs come first, because they are on top of their jacks.
    for (const one of [...board.plugs, ...board.stops.filter(isJack)]) {
      const distance = Math.hypot(one.x - point.x, one.y - point.y);
      if (distance < least && test(one)) [least, found] = [distance, one];
    }
    return found;
  }

  function take(fixed, more = {}) {
    release();
    hand = { fixed, want: fixed.type === 'in' ? 'out' : 'in', ...more };
    canvas.dataset.want = hand.want;
    fixed.node.classList.add('is-held');
    more.node?.classList.add('is-lifted');
    draft = drawCord(fixed, fixed, { colour: board.colours.get(hand.cord?.from ?? fixed.output) });
    draft.classList.add('is-draft');
    over.append(draft);
    board.hover(null);
    say(`Cord from ${board.nameOf(fixed)}: choose an ${hand.want}put. Escape cancels.`);
  }
  /** Takes what is there: a plug out of its jack, a loose plug, or the first end of a new cord. */
  function begin(hit, isNew) {
    const { cord, moves, fixed, id, node, jack } = hit;
    if (hit.type === 'loose') take(fixed, { id, node });
    else if (hit.type === 'plug' && !isNew) take(board.stop(moves === 'in' ? `out:${cord.from}` : `in:${cord.element}.${cord.jack}`), { cord, node: hit.of });
    else take(isJack(hit) ? hit : jack);
  }
  function release() {
    if (!hand) return;
    hand.fixed.node.classList.remove('is-held');
    hand.node?.classList.remove('is-lifted');
    draft.remove();
    aim(null);
    hand = null;
    delete canvas.dataset.want;
    say('');
  }
  function aim(one) {
    aimed?.remove();
    aimed = one && board.ring(one, one.type === hand.want ? 'aim' : 'aim is-wrong');
  }
  function drawTo(point) {
    for (const path of draft.querySelectorAll('path')) path.setAttribute('d', curve(hand.fixed, point));
    draft.lastChild.setAttribute('transform', `translate(${point.x} ${point.y})`);
  }
  function plugInto(goal) {
    const { fixed, want, cord, id } = hand;
    release();
    if (goal.key === fixed.key) return;
    if (goal.type !== want) {
      board.bubble(want === 'in' ? 'Both are outputs. A cord goes from an output to an input.' : 'Both are inputs. A cord goes from an output to an input.', goal);
      return;
    }
    const to = endOf(goal);
    const isSame = cord && (to.output ? to.output === cord.from : to.element === cord.element && to.jack === cord.jack);
    if (isSame) return;
    if (id !== undefined) send({ command: 'plug-loose', id, to });
    else if (cord) send({ command: 'move-cord', ...cord, to });
    else send({ command: 'plug', from: (want === 'in' ? fixed : goal).output, ...endOf(want === 'in' ? goal : fixed) });
  }
  /** Leaves the cord where it is dropped. */
  function drop(point) {
    const { fixed, cord, id } = hand;
    release();
    const loose = { command: 'loose-cord', end: endOf(fixed), at: [Math.round(point.x), Math.round(point.y)], ...cord && { replaces: cord } };
    send(...id === undefined ? [] : [{ command: 'remove-loose', id }], loose);
  }
  /** A click or Enter: the first one begins a cord, the second one ends it. A full jack gives its cord. */
  function choose(hit) {
    const jack = isJack(hit) ? hit : hit.jack;
    if (isProbing()) {
      if (jack?.type === 'out') probed(jack.output);
    } else if (hand && jack) plugInto(jack);
    else if (hand || isLocked()) release();
    else if (jack?.node.classList.contains('is-full')) begin(board.plugs.find((plug) => plug.jack === jack && plug.moves === 'in'));
    else begin(hit, true);
  }

  canvas.addEventListener('pointerdown', (event) => {
    if (event.button) return;
    const { pointerId, clientX, clientY, target } = event;
    pointers.set(pointerId, [clientX, clientY]);
    if (pointers.size > 1) {
      if (press?.isDragging) release();
      press = null;
      return;
    }
    canvas.setPointerCapture(pointerId);
    press = { at: [clientX, clientY], hit: nearest(event), node: target.closest('[data-key]'), knob: target.closest('[data-knob]') };
  });
  canvas.addEventListener('pointermove', (event) => {
    const { clientX, clientY, pointerId, target } = event;
    const before = pointers.get(pointerId);
    if (before) pointers.set(pointerId, [clientX, clientY]);
    if (pointers.size > 1) {
      const [[ax, ay], [bx, by]] = pointers.values();
      const distance = Math.hypot(ax - bx, ay - by);
      const box = canvas.getBoundingClientRect();
      if (pinch) board.zoom(distance / pinch, (ax + bx) / 2 - box.x, (ay + by) / 2 - box.y);
      pinch = distance;
      return;
    }
    if (press && !press.isMoved) {
      if (Math.hypot(clientX - press.at[0], clientY - press.at[1]) < STILL) return;
      press.isMoved = true;
      if (press.hit && !isLocked()) {
        press.isDragging = true;
        begin(press.hit, event.shiftKey || event.ctrlKey);
      }
    }
    if (hand && (press?.isDragging || !press)) {
      const goal = nearest(event, (one) => isJack(one) && one !== hand.fixed);
      if (goal !== hand.goal) aim(goal);
      hand.goal = goal;
      drawTo(goal ?? board.units(event));
    } else if (press?.isMoved && before) {
      board.pan(clientX - before[0], clientY - before[1]);
    } else if (!press && event.pointerType === 'mouse') {
      const hit = nearest(event);
      board.hover(hit?.jack ?? hit ?? board.stop(target.closest('[data-key]')?.dataset.key) ?? null);
    }
  });
  // The focus follows the choice of a place, not the press.
  canvas.addEventListener('mousedown', (event) => event.preventDefault());
  const end = (event) => {
    pointers.delete(event.pointerId);
    pinch = 0;
    const { hit, node, knob, isMoved, isDragging } = press ?? {};
    const isPress = Boolean(press);
    press = null;
    if (!isPress || event.type === 'pointercancel') {
      if (isDragging) release();
    } else if (isDragging) {
      const goal = nearest(event, isJack);
      board.focus((goal ?? hand.fixed).key);
      if (goal) plugInto(goal);
      else drop(board.units(event));
    } else if (!isMoved && hit) {
      board.focus(hit.key ?? hit.jack.key);
      choose(hit);
    } else if (!isMoved) {
      const isBusy = hand;
      release();
      const one = board.stop(node?.dataset.key);
      if (knob) highlight({ element: knob.dataset.knob, setting: 'setting' });
      if (one) board.focus(one.key);
      if (one?.type === 'free' && !isBusy && !isLocked()) board.add(one.section);
    }
  };
  canvas.addEventListener('pointerup', end);
  canvas.addEventListener('pointercancel', end);
  canvas.addEventListener('pointerleave', () => { if (!press) board.hover(null); });
  // A page that does not scroll under a finger that patches.
  canvas.addEventListener('touchstart', (event) => event.preventDefault(), { passive: false });
  canvas.addEventListener('wheel', (event) => {
    if (!event.ctrlKey && !canvas.contains(document.activeElement)) return;
    event.preventDefault();
    const box = canvas.getBoundingClientRect();
    board.zoom(Math.exp(-event.deltaY / 400), event.clientX - box.x, event.clientY - box.y);
  }, { passive: false });

  /** The nearest place in a direction. Cords follow each other in their order. */
  function next(from, [dx, dy]) {
    const all = board.stops.filter(({ type }) => (type === 'cord') === (from.type === 'cord'));
    if (from.type === 'cord') return all[(all.indexOf(from) + dx + dy + all.length) % all.length];
    const cost = (one) => {
      const along = (one.x - from.x) * dx + (one.y - from.y) * dy;
      const across = Math.abs((one.x - from.x) * dy) + Math.abs((one.y - from.y) * dx);
      return along > 4 ? along + 2.5 * across : Infinity;
    };
    const best = all.reduce((one, other) => (cost(other) < cost(one) ? other : one), from);
    return best;
  }
  function press1(one, key) {
    if (key === 'Escape') return hand ? release() ?? true : false;
    if (ARROWS[key]) {
      const goal = next(one, ARROWS[key]);
      board.focus(goal.key);
      if (hand && isJack(goal)) {
        aim(goal);
        drawTo(goal);
      }
    } else if (key === 'Enter' || key === ' ') {
      if (isJack(one) || one.type === 'loose') choose(one);
      else if (one.type === 'free' && !isLocked()) board.add(one.section);
    } else if (key === 'Delete' || key === 'Backspace') {
      if (isLocked()) return true;
      const own = board.plugs.filter(({ jack }) => jack === one);
      if (!isJack(one)) { if (one.type !== 'free') board.remove(one); }
      else if (own.length === 1 || (own.length && one.type === 'in')) board.remove({ type: 'cord', cord: own.at(-1).cord, name: 'the cord' });
      else say(own.length ? 'There are several cords. Choose one: Tab leads to the cords.' : 'There is no cord in this jack.');
    } else return false;
    return true;
  }
  canvas.addEventListener('keydown', (event) => {
    const one = board.stop(event.target.dataset.key);
    if (!one || event.ctrlKey || event.metaKey || event.altKey || press1(one, event.key) === false) return;
    event.preventDefault();
  });
  board.release = release;
}
