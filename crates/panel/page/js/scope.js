/** A storage oscilloscope of the page: screen, controls, cursors, trigger level. */

import { el } from './dom.js';
import { makeControls, stepOf, stepVolts, TIME_BASES } from './scope-controls.js';
import { save } from './scope-export.js';
import { ACROSS, nameOf, reading, scales, si, UP } from './scope-grid.js';
import { makeMark, placeMark } from './scope-marks.js';
import { Screen } from './scope-screen.js';
import { Trace } from './scope-trace.js';
import { on, selectProbe, send, state } from './state.js';

/** Milliseconds between two text alternatives, and between two readings of the cursors. */
const [TEXT, READING] = [1000, 100];
/** Pixels of a wheel for one step. */
const NOTCH = 60;

const isRound = (value) => Math.abs(stepOf(stepOf(value, 1), -1) / value - 1) < 1e-4;
const base = (seconds) => Math.min(TIME_BASES.at(-1), Math.max(TIME_BASES[0], seconds));

/** Divisions from the middle of the screen up to 0 V. */
const positionOf = ({ centre, volts_per_division: volts, inverted }) => (inverted ? centre : -centre) / volts || 0;

function setPosition(each, position) {
  each.centre = (each.inverted ? position : -position) * each.volts_per_division || 0;
}

/** Changes the scale. 0 V stays at its place. */
function setVolts(each, volts) {
  const position = positionOf(each);
  each.volts_per_division = volts;
  setPosition(each, position);
}

/** Chooses scales so that the traces fill the screen. */
function autoSet(controls, { outputs, trace }, present) {
  const isTime = controls.display === 'time';
  controls.channels.forEach((each, channel) => {
    const output = outputs[channel];
    let [low, high] = trace.extent(channel);
    if (low > high) low = high = present[channel];
    if (!output || !Number.isFinite(low)) return;
    const size = Math.max(Math.abs(low), Math.abs(high), 1e-3);
    // A trace on both sides of 0 V, or nearly constant, keeps 0 V in the middle.
    const isCentral = high - low > 1.2 * size || high - low < 0.05 * size;
    const divisions = (isTime || channel === 1 ? UP : ACROSS) / 2 - 0.5;
    const half = isCentral ? size : (high - low) / 2;
    each.volts_per_division = stepVolts((half / divisions) * 0.999, 1, output.signal ? Math.abs(output.per_volt) : 1);
    const middle = isCentral ? 0 : (low + high) / 2 / each.volts_per_division;
    setPosition(each, Math.round((each.inverted ? 2 : -2) * middle) / 2);
  });
  const period = isTime ? trace.periodOf(outputs[0] ? 0 : 1) : 0;
  if (isTime) controls.seconds_per_division = period > 0 ? base(stepOf((2.5 * period) / ACROSS, 1)) : 0;
}

/** Puts a scope into an element. @param {HTMLElement} root @param {number} index 0 or 1 */
export function mountScope(root, index) {
  const trace = new Trace();
  const model = { controls: null, outputs: [null, null], lit: [false, false], span: 1, trace, title: '' };
  const cursors = [[0.25, 0.6], [0.75, 0.4]];
  let [places, active, wheel, isPending, isScheduled, isMoving, hasCursors] = [[-1, -1], 0, 0, false, false, false, false];
  let [unanswered, textAt, readAt, frameAt, shown] = [0, 0, 0, 0, ''];

  const canvases = [{ 'aria-hidden': 'true' }, { 'aria-hidden': 'true' }, { role: 'img' }].map((attributes) => el('canvas', attributes));
  const spots = [1, 2].map((channel) => el('div', { class: `scope-spot scope-channel-${channel}`, hidden: true }));
  const box = el('div', { class: 'scope-screen' }, canvases, spots);
  const screen = new Screen(box, canvases);
  const marks = cursors.map((place, at) => makeMark('scope-cursor', `Cursor ${at + 1}`, screen, (x, y) => {
    place.splice(0, 2, x, y);
    read();
  }, () => place));
  const level = makeMark('scope-level', 'Trigger level', screen, (_, y) => change(({ trigger }) => {
    trigger.level = Number(voltsAt(trigger.channel, y).toPrecision(4));
  }), () => [1, levelShare()]);
  box.append(...marks, level);
  const cells = [0, 1, 2].map(() => ['th', 'td', 'td', 'td'].map((tag) => el(tag, tag === 'th' ? { scope: 'row' } : {})));
  const readout = el('table', { class: 'scope-readout' },
    el('thead', {}, el('tr', {}, el('td', {}), ['Cursor 1', 'Cursor 2', 'Difference'].map((text) => el('th', { scope: 'col' }, text)))),
    el('tbody', {}, cells.map((row) => el('tr', {}, row))));

  const act = {
    change, positionOf,
    activate: (channel) => { active = channel; },
    place: (channel) => selectProbe((output) => change((controls) => { controls.channels[channel].output = output; })),
    setVolts: (channel, volts) => change(({ channels }) => setVolts(channels[channel], volts)),
    stepVolts: (channel, direction) => change(({ channels }) => {
      const { volts_per_division: volts } = channels[channel];
      const perVolt = Math.abs(model.outputs[channel]?.per_volt ?? 1);
      setVolts(channels[channel], stepVolts(volts, direction, isRound(volts * perVolt) ? perVolt : 1));
    }),
    setPosition: (channel, position) => change(({ channels }) => setPosition(channels[channel], position)),
    setBase: (seconds) => change((controls) => { controls.seconds_per_division = seconds; }),
    stepBase: (direction) => act.setBase(base(stepOf(model.span / ACROSS, direction))),
    setCursors: (shown) => { hasCursors = shown; refresh(); },
    autoSet: () => change((controls) => autoSet(controls, model, places.map((place) => state.frame?.volts[place]))),
    erase: () => { trace.erase(performance.now()); send({ command: 'erase', scope: index }); schedule(); },
    save: (kind) => save(kind, model, `${(state.patch?.file ?? 'patch').replace(/^.*[\\/]|\.json$/g, '')}-scope-${index + 1}`),
  };
  const panel = makeControls(model, act);
  root.classList.add('scope');
  root.append(box, readout, panel.element);

  /** Changes the controls. They are sent once before the next picture. */
  function change(edit) {
    if (!model.controls) return;
    const controls = structuredClone(model.controls);
    edit(controls);
    isPending = true;
    take(controls);
  }

  /** Takes over controls. The screen is erased if its traces do not belong to them. */
  function take(controls) {
    const kind = ({ display, seconds_per_division: seconds, channels }) => [display, seconds, ...channels.map(({ output }) => output)].join();
    if (model.controls && kind(controls) !== kind(model.controls)) trace.erase(performance.now());
    model.controls = controls;
    refresh();
  }

  function refresh() {
    const { controls } = model;
    if (!controls) return;
    const outputs = state.patch?.outputs ?? [];
    const others = shown !== (shown = outputsText());
    places = controls.channels.map(({ output }) => outputs.findIndex(({ name }) => name === output));
    model.outputs = places.map((place) => outputs[place] ?? null);
    model.title = `${state.patch?.title || state.patch?.file || 'patch'}, scope ${index + 1}`;
    model.span = spanOf(controls);
    screen.isStale = true;
    panel.update(controls, others ? state.patch : null);
    schedule();
  }

  const outputsText = () => JSON.stringify([state.patch?.outputs, state.patch?.title]);
  const spanOf = (controls) => ACROSS * controls.seconds_per_division || state.machine?.sweep || 1;

  function schedule() {
    if (!isScheduled) requestAnimationFrame(paint);
    isScheduled = true;
  }

  function paint(now) {
    isScheduled = false;
    const { controls } = model;
    if (isPending) {
      isPending = false;
      unanswered += 1;
      send({ command: 'scope', scope: index, controls }).then(() => {
        unanswered -= 1;
        synchronise();
      });
    }
    if (!controls || screen.view.width < 20) return;
    if (screen.isStale || (hasCursors && now - readAt > READING)) read(now);
    screen.draw(model);
    spots.forEach((spot, channel) => {
      const at = isMoving ? screen.spot(model, channel) : null;
      spot.hidden = !at;
      if (at) spot.style.transform = `translate(${at[0]}px, ${at[1]}px)`;
    });
    if (now - textAt > TEXT) describe(now);
  }

  /** The volts at a share of the screen. */
  function voltsAt(channel, share) {
    const { x, y, across, up } = screen.view;
    const { isX, gain, zero } = scales(screen.view, model.controls)[channel];
    return ((isX ? x + share * across : y + (1 - share) * up) - zero) / gain;
  }

  function levelShare() {
    const { trigger } = model.controls;
    const { gain, zero } = scales(screen.view, model.controls)[trigger.channel];
    return Math.min(1, Math.max(0, 1 - (zero + gain * trigger.level - screen.view.y) / screen.view.up));
  }

  /** Writes the readings of the cursors and puts the marks to their places. */
  function read(now = readAt) {
    readAt = now;
    const { controls: { display, trigger }, outputs, span } = model;
    const { view } = screen;
    const isPlane = display === 'plane';
    level.hidden = isPlane || trigger.mode === 'run';
    level.dataset.channel = String(trigger.channel + 1);
    placeMark(level, view, [1, levelShare()], levelShare(), si(trigger.level, 'V'));
    readout.hidden = !hasCursors;
    for (const mark of marks) mark.hidden = !hasCursors;
    if (!hasCursors) return;
    const times = cursors.map(([share]) => trace.left + share * span);
    const apart = times[1] - times[0];
    const rows = [['t', ...times.map((time) => si(time, 's', 5)), `${si(apart, 's')}, 1/Δt = ${si(1 / apart, 'Hz')}`]];
    outputs.forEach((output, channel) => {
      const volts = cursors.map((place) => (isPlane ? voltsAt(channel, place[channel]) : trace.valueAt(channel, place[0])));
      rows.push(output ? [nameOf(output), ...[...volts, volts[1] - volts[0]].map((value) => reading(value, output))] : null);
    });
    if (isPlane) rows[0] = null;
    rows.forEach((texts, row) => {
      cells[row][0].parentElement.hidden = !texts;
      texts?.forEach((text, column) => { if (cells[row][column].textContent !== text) cells[row][column].textContent = text; });
    });
    marks.forEach((mark, at) => {
      const [right, top] = cursors[at];
      mark.classList.toggle('scope-cross', isPlane);
      mark.style.height = isPlane ? '' : `${view.up / view.ratio}px`;
      placeMark(mark, view, [right, isPlane ? top : 1], right, rows.filter(Boolean).map((texts) => `${texts[0]} ${texts[at + 1]}`).join(', '));
    });
  }

  /** Writes the text alternative of the screen. */
  function describe(now) {
    textAt = now;
    const { controls, outputs, lit, span } = model;
    const parts = outputs.flatMap((output, channel) => {
      if (!output) return [];
      const value = reading(state.frame?.volts[places[channel]] ?? NaN, output);
      const scale = reading(controls.channels[channel].volts_per_division, output, '/div');
      return [`${nameOf(output)}: ${value}, ${scale}${lit[channel] ? ', overloaded' : ''}`];
    });
    const kind = controls.display === 'plane' ? 'Y against X' : `against time, ${si(span / ACROSS, 's')}/div`;
    canvases[2].setAttribute('aria-label', `Scope ${index + 1}, ${kind}. ${parts.join('. ') || 'No probe'}`);
  }

  box.addEventListener('wheel', (event) => {
    if (!model.controls || event.ctrlKey) return;
    event.preventDefault();
    wheel += (event.deltaY || event.deltaX) * (event.deltaMode ? NOTCH : 1);
    if (Math.abs(wheel) < NOTCH) return;
    const direction = Math.sign(wheel);
    wheel = 0;
    if (event.shiftKey) act.stepVolts(active, direction);
    else if (model.controls.display === 'time') act.stepBase(direction);
    else for (const channel of [0, 1]) act.stepVolts(channel, direction);
  }, { passive: false });

  const resize = () => {
    screen.resize();
    schedule();
  };
  new ResizeObserver(resize).observe(box);
  new MutationObserver(resize).observe(document.documentElement, { attributes: true });

  /** Takes over the session's controls. An answer to an earlier change would undo a later one. */
  function synchronise() {
    const controls = state.scopes[index];
    if (controls && !isPending && unanswered === 0 && JSON.stringify(controls) !== JSON.stringify(model.controls)) take(controls);
  }

  // A knob changes the patch sixty times a second. Only other outputs concern the scope.
  on('patch', () => { if (outputsText() !== shown) refresh(); });
  on('machine', () => { if (model.controls && spanOf(model.controls) !== model.span) refresh(); });
  on('scopes', synchronise);
  on('frame', (frame) => {
    if (!model.controls) return;
    const now = performance.now();
    isMoving = frame.moves && !frame.paused;
    if (isMoving) trace.clock += Math.min(0.1, (now - frameAt) / 1000);
    frameAt = now;
    places.forEach((place, channel) => {
      const isLit = Boolean(frame.lamps[place]);
      if (isLit !== model.lit[channel]) trace.version += 1;
      model.lit[channel] = isLit;
    });
    const data = frame.scopes[index];
    if (data.display === model.controls.display) trace.take(data, model.span, model.controls.store, now);
    schedule();
  });
  synchronise();
}
