/** A storage oscilloscope of the page: screen, controls, cursors, trigger level. */

import { el } from './dom.js';
import { makeControls, stepOf, stepVolts, TIME_BASES } from './scope-controls.js';
import { save } from './scope-export.js';
import { ACROSS, nameOf, perDivision, scales, Screen, si, UP } from './scope-screen.js';
import { Trace } from './scope-trace.js';
import { on, selectProbe, send, state } from './state.js';

/** Milliseconds for which answers that do not repeat the last change are ignored: they are older. */
const ANSWER = 600;
/** Milliseconds between two text alternatives, and between two readings of the cursors. */
const [TEXT, READING] = [1000, 100];
/** Pixels of a wheel for one step. */
const NOTCH = 60;

const isRound = (value) => Math.abs(stepOf(stepOf(value, 1), -1) / value - 1) < 1e-4;
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

/** Volts of a position in pixels of the screen, and the position of 0 V in divisions. */
const positionOf = ({ centre, volts_per_division: volts, inverted }) => ((inverted ? centre : -centre) / volts) || 0;

/** Puts a scope into an element. @param {HTMLElement} root @param {number} index 0 or 1 */
export function mountScope(root, index) {
  const trace = new Trace();
  const model = { controls: null, outputs: [null, null], lit: [false, false], span: 1, trace, title: '' };
  const cursors = { shown: false, at: [[0.25, 0.6], [0.75, 0.4]] };
  let places = [-1, -1];
  let active = 0;
  let [isScheduled, isDirty, isMoving] = [false, false, false];
  let [sent, sentAt, textAt, readAt, frameAt, wheel] = ['', -ANSWER, 0, 0, 0, 0];

  const canvases = [0, 1, 2].map((layer) => el('canvas', layer < 2 ? { 'aria-hidden': 'true' } : { role: 'img' }));
  const spots = [0, 1].map((channel) => el('div', { class: `scope-spot scope-channel-${channel + 1}` }));
  const handles = [0, 1].map((at) => handle(`scope-cursor`, `Cursor ${at + 1}`, (x, y) => moveCursor(at, x, y), () => cursors.at[at]));
  const level = handle('scope-level', 'Trigger level', (x, y) => moveLevel(y), () => [1, levelShare()]);
  const box = el('div', { class: 'scope-screen' }, canvases, spots, handles, level);
  const cells = [0, 1, 2].map(() => [0, 1, 2, 3].map((column) => el(column ? 'td' : 'th', column ? {} : { scope: 'row' })));
  const readout = el('table', { class: 'scope-readout', hidden: true },
    el('thead', {}, el('tr', {}, ['', 'Cursor 1', 'Cursor 2', 'Difference'].map((text) => el('th', { scope: 'col' }, text)))),
    el('tbody', {}, cells.map((row) => el('tr', {}, row))));
  const screen = new Screen(box, canvases);

  const act = {
    change, positionOf, autoSet,
    activate: (channel) => { active = channel; },
    place: (channel) => selectProbe((output) => output && change((controls) => { controls.channels[channel].output = output; })),
    setVolts: (channel, volts) => change((controls) => setVolts(controls.channels[channel], volts)),
    stepVolts: (channel, direction) => change((controls) => {
      const each = controls.channels[channel];
      const perVolt = isRound(each.volts_per_division) ? 1 : Math.abs(model.outputs[channel]?.per_volt ?? 1);
      setVolts(each, stepVolts(each.volts_per_division, direction, perVolt));
    }),
    setPosition: (channel, position) => change(({ channels }) => setPosition(channels[channel], position)),
    setBase: (seconds) => change((controls) => { controls.seconds_per_division = seconds; }),
    stepBase: (direction) => act.setBase(clamp(stepOf(model.span / ACROSS, direction), TIME_BASES[0], TIME_BASES.at(-1))),
    setCursors: (shown) => { cursors.shown = shown; readAt = 0; refresh(); },
    erase: () => { trace.erase(); send({ command: 'erase', scope: index }); schedule(); },
    save: (kind) => save(kind, model, `${(state.patch?.file ?? 'patch').replace(/^.*[\\/]|\.json$/g, '')}-scope-${index + 1}`),
  };
  const controlPanel = makeControls(model, act);
  root.classList.add('scope');
  root.append(box, readout, controlPanel.element);

  /** Changes the controls and sends them once before the next picture. */
  function change(edit) {
    if (!model.controls) return;
    const before = model.controls;
    const controls = structuredClone(before);
    edit(controls);
    take(controls);
    isDirty = true;
    schedule();
  }

  function setVolts(each, volts) {
    const position = positionOf(each);
    each.volts_per_division = volts;
    setPosition(each, position);
  }

  function setPosition(each, position) {
    each.centre = (each.inverted ? position : -position) * each.volts_per_division || 0;
  }

  /** Takes over new controls. The screen is erased if its traces no longer belong to them. */
  function take(controls) {
    const kind = (each) => each && JSON.stringify([each.display, each.seconds_per_division, each.channels.map(({ output }) => output)]);
    if (model.controls && kind(controls) !== kind(model.controls)) trace.erase();
    model.controls = controls;
    refresh();
  }

  function refresh() {
    const { controls } = model;
    if (!controls) return;
    const outputs = state.patch?.outputs ?? [];
    places = controls.channels.map(({ output }) => outputs.findIndex(({ name }) => name === output));
    model.outputs = places.map((place) => outputs[place] ?? null);
    model.title = `${state.patch?.title || state.patch?.file || 'patch'} · scope ${index + 1}`;
    model.span = ACROSS * controls.seconds_per_division || state.machine?.sweep || 1;
    readout.hidden = !cursors.shown;
    screen.stale = true;
    controlPanel.update(controls);
    schedule();
  }

  function schedule() {
    if (isScheduled) return;
    isScheduled = true;
    requestAnimationFrame(paint);
  }

  function paint(now) {
    isScheduled = false;
    const { controls } = model;
    if (isDirty) {
      isDirty = false;
      [sent, sentAt] = [JSON.stringify(controls), now];
      send({ command: 'scope', scope: index, controls }).then(() => { sentAt = -ANSWER; });
    }
    if (!controls || screen.view.width < 20) return;
    if (screen.stale) placeHandles();
    screen.draw(model);
    spots.forEach((spot, channel) => {
      const at = isMoving ? screen.spot(model, channel) : null;
      spot.hidden = !at;
      if (at) spot.style.transform = `translate(${at[0]}px, ${at[1]}px)`;
    });
    if (cursors.shown && now - readAt > READING) { readAt = now; read(); }
    if (now - textAt > TEXT) { textAt = now; describe(); }
  }

  /** A mark on the screen that pointer and keys move. Shares run from the lower left corner. */
  function handle(kind, name, move, where) {
    const element = el('div', { class: kind, role: 'slider', tabindex: 0, 'aria-label': name, 'aria-valuemin': 0, 'aria-valuemax': 100, hidden: true });
    element.addEventListener('pointerdown', (event) => {
      element.setPointerCapture(event.pointerId);
      element.focus();
      event.preventDefault();
    });
    element.addEventListener('pointermove', (event) => {
      if (!element.hasPointerCapture(event.pointerId)) return;
      const { x, y, across, up, ratio } = screen.view;
      const edge = box.getBoundingClientRect();
      move(clamp(((event.clientX - edge.left) * ratio - x) / across, 0, 1), clamp(1 - ((event.clientY - edge.top) * ratio - y) / up, 0, 1));
    });
    element.addEventListener('keydown', (event) => {
      const step = event.shiftKey ? 0.05 : 0.002;
      const [dx, dy] = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[event.key] ?? [0, 0];
      if (dx === 0 && dy === 0) return;
      event.preventDefault();
      const [x, y] = where();
      move(clamp(x + dx, 0, 1), clamp(y + dy, 0, 1));
    });
    return element;
  }

  function moveCursor(at, x, y) {
    cursors.at[at] = [x, y];
    placeHandles();
    read();
  }

  /** The volts at a share of the screen. */
  function voltsAt(channel, share) {
    const { gain, zero } = scales(screen.view, model.controls)[channel];
    const { x, y, across, up } = screen.view;
    const isAcross = model.controls.display === 'plane' && channel === 0;
    return ((isAcross ? x + share * across : y + (1 - share) * up) - zero) / gain;
  }

  function levelShare() {
    const { trigger } = model.controls;
    const { gain, zero } = scales(screen.view, model.controls)[trigger.channel];
    return 1 - (zero + gain * trigger.level - screen.view.y) / screen.view.up;
  }

  function moveLevel(share) {
    const volts = voltsAt(model.controls.trigger.channel, share);
    change(({ trigger }) => { trigger.level = Number(volts.toPrecision(4)); });
  }

  function placeHandles() {
    const { controls } = model;
    const { x, y, across, up, ratio } = screen.view;
    const plane = controls.display === 'plane';
    handles.forEach((element, at) => {
      const [right, top] = cursors.at[at];
      element.hidden = !cursors.shown;
      element.classList.toggle('scope-cross', plane);
      element.style.left = `${(x + right * across) / ratio}px`;
      element.style.top = `${(plane ? y + (1 - top) * up : y) / ratio}px`;
      element.style.height = plane ? '' : `${up / ratio}px`;
      element.setAttribute('aria-valuenow', (100 * right).toFixed(1));
    });
    level.hidden = plane || controls.trigger.mode === 'run';
    const share = clamp(levelShare(), 0, 1);
    level.style.left = `${(x + across) / ratio}px`;
    level.style.top = `${(y + (1 - share) * up) / ratio}px`;
    level.dataset.channel = String(controls.trigger.channel + 1);
    level.setAttribute('aria-valuenow', (100 * share).toFixed(1));
    level.setAttribute('aria-valuetext', si(controls.trigger.level, 'V'));
  }

  const inUnits = (volts, output) => si(volts, 'V', 4) + (output?.signal && volts === volts ? ` = ${si(volts * output.per_volt, output.unit, 4)}` : '');

  /** Writes the readings of the cursors. */
  function read() {
    const plane = model.controls.display === 'plane';
    const times = cursors.at.map(([share]) => trace.left + share * model.span);
    const apart = times[1] - times[0];
    const rows = [['t', ...times.map((time) => si(time, 's', 5)), `${si(apart, 's', 4)}, 1/Δt = ${si(1 / apart, 'Hz', 4)}`]];
    model.outputs.forEach((output, channel) => {
      const volts = cursors.at.map((at) => (plane ? voltsAt(channel, at[channel]) : trace.valueAt(channel, at[0])));
      rows.push([output ? nameOf(output) : '', ...[...volts, volts[1] - volts[0]].map((value) => inUnits(value, output))]);
    });
    rows.forEach((texts, row) => {
      cells[row][0].parentElement.hidden = row === 0 ? plane : !model.outputs[row - 1];
      texts.forEach((text, column) => { if (cells[row][column].textContent !== text) cells[row][column].textContent = text; });
    });
    handles.forEach((element, at) => element.setAttribute('aria-valuetext', rows.filter((_, row) => row > 0 || !plane).map((row) => `${row[0]} ${row[at + 1]}`).join(', ')));
  }

  /** The text alternative of the screen. */
  function describe() {
    const { controls, outputs, lit, span } = model;
    const parts = outputs.flatMap((output, channel) => {
      if (!output) return [];
      const volts = state.frame?.volts[places[channel]];
      return [`${nameOf(output)}: ${inUnits(volts ?? NaN, output)}, ${perDivision(controls.channels[channel], output)}${lit[channel] ? ', overloaded' : ''}`];
    });
    const kind = controls.display === 'plane' ? 'Y against X' : `against time, ${si(span / ACROSS, 's')}/div`;
    canvases[2].setAttribute('aria-label', `Scope ${index + 1}, ${kind}. ${parts.join('. ') || 'No probe'}`);
  }

  /** Chooses scales so that the traces fill the screen. */
  function autoSet() {
    change((controls) => {
      controls.channels.forEach((each, channel) => {
        const output = model.outputs[channel];
        const volts = state.frame?.volts[places[channel]];
        const [low, high] = trace.extent(channel) ?? [volts, volts];
        if (!output || !Number.isFinite(low)) return;
        // A trace that is nearly symmetrical keeps 0 V in the middle.
        const size = Math.max(Math.abs(low), Math.abs(high), 1e-3);
        const isCentral = high - low > 1.2 * size || high - low < 0.05 * size;
        const half = isCentral ? size : (high - low) / 2;
        const across = controls.display === 'plane' && channel === 0 ? ACROSS : UP;
        const perVolt = output.signal ? Math.abs(output.per_volt) : 1;
        each.volts_per_division = stepVolts((half / (across / 2 - 0.5)) * 0.999, 1, perVolt);
        const middle = isCentral ? 0 : (low + high) / 2;
        setPosition(each, Math.round((each.inverted ? 2 : -2) * (middle / each.volts_per_division)) / 2);
      });
      const used = model.outputs[0] ? 0 : 1;
      const period = controls.display === 'time' ? trace.periodOf(used) : 0;
      if (period > 0) controls.seconds_per_division = clamp(stepOf((2.5 * period) / ACROSS, 1), TIME_BASES[0], TIME_BASES.at(-1));
      else if (controls.display === 'time') controls.seconds_per_division = 0;
    });
  }

  box.addEventListener('wheel', (event) => {
    if (!model.controls || event.ctrlKey) return;
    event.preventDefault();
    wheel += (event.deltaY || event.deltaX) * (event.deltaMode ? NOTCH : 1);
    const steps = Math.trunc(wheel / NOTCH);
    if (steps === 0) return;
    wheel = 0;
    const direction = Math.sign(steps);
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
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', resize);

  on('theme', resize);
  on('patch', (patch) => {
    controlPanel.refill(patch);
    refresh();
  });
  on('machine', refresh);
  on('scopes', () => {
    const controls = state.scopes[index];
    const text = JSON.stringify(controls);
    const isOlder = performance.now() - sentAt < ANSWER && text !== sent;
    if (controls && !isDirty && !isOlder && text !== JSON.stringify(model.controls)) take(controls);
  });
  on('frame', (frame) => {
    if (!model.controls) return;
    const now = performance.now();
    isMoving = frame.moves && !frame.paused;
    if (isMoving) trace.clock += Math.min(0.1, (now - frameAt) / 1000);
    frameAt = now;
    for (let channel = 0; channel < 2; channel += 1) {
      const isLit = Boolean(frame.lamps[places[channel]]);
      if (isLit !== model.lit[channel]) { model.lit[channel] = isLit; trace.version += 1; }
    }
    trace.take(frame.scopes[index], model.span, model.controls.store, now);
    schedule();
  });
  if (state.patch) controlPanel.refill(state.patch);
  if (state.scopes[index]) take(structuredClone(state.scopes[index]));
}
