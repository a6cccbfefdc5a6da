/** A storage oscilloscope of the page: screen, controls, cursors, trigger level. */

import { byId, changeDetector, fill, joined, quantity, rateLimiter, root, template, within, write } from './dom.js';
import { nameOf, reading } from './probes.js';
import { mountControls, mountMark, placeMark, setPosition } from './scope-controls.js';
import { save } from './scope-export.js';
import { ACROSS, scales, UP } from './scope-grid.js';
import { Screen } from './scope-screen.js';
import { Trace } from './scope-trace.js';
import { on, outputOf, selectProbe, send, state, voltsOf } from './state.js';

/** Milliseconds between two text alternatives, and between two readings of the cursors. */
const [TEXT, READING] = [1000, 100];
/** Pixels of a wheel for one step. */
const NOTCH = 60;

/** Chooses scales so that the traces, or the present voltages without traces, fill the screen. */
function autoSet(controls, { outputs, trace }, step) {
  const isTime = controls.display === 'time';
  controls.channels.forEach((each, channel) => {
    let [low, high] = trace.extent(channel);
    if (low > high) low = high = voltsOf(outputs[channel]?.name);
    if (!outputs[channel] || !Number.isFinite(low)) return;
    const size = Math.max(Math.abs(low), Math.abs(high), 1e-3);
    // A trace on both sides of 0 V, or nearly constant, keeps 0 V in the middle.
    const isCentral = high - low > 1.2 * size || high - low < 0.05 * size;
    const [half, middle] = isCentral ? [size, 0] : [(high - low) / 2, (low + high) / 2];
    step(controls, channel, (half / ((isTime || channel ? UP : ACROSS) / 2 - 0.5)) * 0.999, 1);
    setPosition(each, Math.round(((each.inverted ? 2 : -2) * middle) / each.volts_per_division) / 2);
  });
  if (!isTime) return;
  controls.seconds_per_division = 0;
  const period = trace.periodOf(outputs[0] ? 0 : 1);
  if (period) step(controls, -1, (2.5 * period) / ACROSS, 1);
}

/** Puts a scope into its card. @param {number} index 0 or 1 */
function mountScope(index) {
  const trace = new Trace();
  const model = { controls: null, outputs: [], lit: [false, false], span: 1, trace };
  const cursors = [[0.25, 0.6], [0.75, 0.4]];
  const [hasOtherAxes, hasOtherOutputs, hasOtherLamps] = [changeDetector(), changeDetector(), changeDetector()];
  const [isTextDue, isReadingDue] = [rateLimiter(TEXT), rateLimiter(READING)];
  let [active, wheel, unanswered, frameAt] = [0, 0, 0, 0];
  /** Whether a picture is requested, the machine moves, and the lists have the outputs of another patch. */
  let [isScheduled, isMoving, isOtherPatch] = [false, false, false];

  const parts = template('scope');
  const { node, box, picture, level, readout, hasCursors } = parts;
  const screen = new Screen(box, model);
  const spots = box.querySelectorAll('.scope-spot');
  const marks = box.querySelectorAll('.scope-cursor');
  marks.forEach((mark, at) => mountMark(mark, screen, (...place) => {
    cursors[at] = place;
    read();
  }, () => cursors[at]));
  mountMark(level, screen, (_, y) => change(({ trigger }) => {
    trigger.level = Number(voltsAt(trigger.channel, y).toPrecision(4));
  }), () => [1, levelShare()]);

  const { step, update } = mountControls(parts, model, change, {
    place: (channel) => selectProbe((output) => change(({ channels }) => { channels[channel].output = output; })),
    cursors: refresh,
    auto: () => change((controls) => autoSet(controls, model, step)),
    erase: () => {
      trace.erase();
      send('erase', { scope: index });
      schedule();
    },
    save: (kind) => save(kind, model, `${(state.patch?.file ?? 'patch').replace(/^.*[\\/]|\.json$/g, '')}-scope-${index + 1}`),
  });
  byId(`scope-${index + 1}`).append(node);

  /** Changes the controls. */
  async function change(edit) {
    if (!model.controls) return;
    const controls = structuredClone(model.controls);
    edit(controls);
    take(controls);
    unanswered += 1;
    await send('scope', { scope: index, controls });
    unanswered -= 1;
    synchronise();
  }

  /** Takes over controls. The screen is erased if its traces do not belong to them. */
  function take(controls) {
    const { display, seconds_per_division: seconds, channels } = controls;
    model.controls = controls;
    if (hasOtherAxes([display, seconds, channels.map(({ output }) => output)])) {
      trace.erase();
      screen.resize();
    }
    refresh();
  }

  function refresh() {
    const { controls } = model;
    if (!controls) return;
    const { patch } = state;
    model.outputs = controls.channels.map(({ output }) => outputOf(output));
    model.title = `${patch?.title || patch?.file || 'patch'}, scope ${index + 1}`;
    model.span = spanOf(controls);
    screen.isStale = true;
    update(controls, isOtherPatch && patch);
    isOtherPatch = false;
    // A screen that is out of sight is not painted, and has a text nevertheless.
    describe();
    schedule();
  }

  const spanOf = (controls) => ACROSS * controls.seconds_per_division || state.machine?.sweep || 1;

  function schedule() {
    if (!isScheduled) requestAnimationFrame(paint);
    isScheduled = true;
  }

  function paint(now) {
    isScheduled = false;
    const { controls } = model;
    if (!controls || screen.view.width < 20) return;
    if (screen.isStale || (hasCursors.checked && isReadingDue(now))) read();
    screen.draw();
    const back = state.machine?.latest
      && { time: state.frame?.time, volts: model.outputs.map((output) => voltsOf(output?.name)) };
    spots.forEach((spot, channel) => {
      const at = (isMoving || back) && screen.spot(channel, back);
      spot.hidden = !at;
      if (at) spot.style.translate = `${at[0]}px ${at[1]}px`;
    });
    if (isTextDue(now)) describe();
  }

  /** The volts at a share of the screen. */
  function voltsAt(channel, share) {
    const { x, y, across, up } = screen.view;
    const { isX, gain, zero } = scales(screen.view, model.controls)[channel];
    return ((isX ? x + share * across : y + (1 - share) * up) - zero) / gain;
  }

  function levelShare() {
    const { view, model: { controls } } = screen;
    const { trigger } = controls;
    const { gain, zero } = scales(view, controls)[trigger.channel];
    return within(0, 1 - (zero + gain * trigger.level - view.y) / view.up, 1);
  }

  /** Writes the readings of the cursors and puts the marks to their places. */
  function read() {
    const { controls: { display, trigger }, outputs, span } = model;
    const { view } = screen;
    const isPlane = display === 'plane';
    placeMark(level, view, [1, levelShare()], levelShare(), quantity(trigger.level, 'V'));
    if (!hasCursors.checked) return;
    const differences = (name, from, to, text) => [name, text(from), text(to), text(to - from)];
    const rows = outputs.map((output, channel) => {
      const values = cursors.map((place) => (isPlane ? voltsAt(channel, place[channel]) : trace.valueAt(channel, place[0])));
      return output && differences(nameOf(output), ...values, (volts) => reading(volts, output));
    });
    const times = cursors.map(([share]) => trace.left + share * span);
    rows.unshift(!isPlane && differences('t', ...times, (time) => quantity(time, 's', 5)));
    if (!isPlane) rows[0][3] += `, 1/Δt = ${quantity(1 / (times[1] - times[0]), 'Hz')}`;
    rows.forEach((texts, at) => {
      const row = readout.tBodies[0].rows[at];
      row.hidden = !texts;
      if (texts) texts.forEach((text, column) => write(row.cells[column], text));
    });
    marks.forEach((mark, at) => {
      const [right, top] = cursors[at];
      mark.style.height = `${view.up}px`;
      const values = rows.filter(Boolean).map((texts) => `${texts[0]} ${texts[at + 1]}`);
      placeMark(mark, view, [right, isPlane ? top : 1], right, values.join(', '));
    });
  }

  /** Writes the text alternative of the screen. */
  function describe() {
    const { controls, outputs, lit, span } = model;
    const texts = outputs.map((output, channel) => output && joined([`${nameOf(output)}: ${reading(voltsOf(output.name), output)}`,
      reading(controls.channels[channel].volts_per_division, output, '/div'), lit[channel] && 'overloaded']));
    const kind = controls.display === 'plane' ? 'Y against X' : `against time, ${quantity(span / ACROSS, 's', 3)}/div`;
    picture.ariaLabel = `Scope ${index + 1}, ${kind}. ${joined(texts, '. ') || 'No probe'}`;
  }

  fill(node, { onfocusin: ({ target }) => { active = target.parentElement.dataset.channel ?? active; } });
  box.onwheel = (event) => {
    if (!model.controls || event.ctrlKey) return;
    event.preventDefault();
    wheel += (event.deltaY || event.deltaX) * (event.deltaMode ? NOTCH : 1);
    if (Math.abs(wheel) < NOTCH) return;
    const direction = Math.sign(wheel);
    wheel = 0;
    const isTime = model.controls.display === 'time';
    change((controls) => {
      if (isTime && !event.shiftKey) step(controls, -1, model.span / ACROSS, direction);
      for (const channel of event.shiftKey ? [active] : isTime ? [] : [0, 1]) step(controls, channel, null, direction);
    });
  };

  const resize = () => {
    screen.resize();
    schedule();
  };
  new ResizeObserver(resize).observe(box);
  new MutationObserver(resize).observe(root, { attributes: true });

  /** Takes over the session's controls. An answer to an earlier change would undo a later one. */
  function synchronise() {
    const controls = state.scopes[index];
    if (controls && !unanswered && JSON.stringify(controls) !== JSON.stringify(model.controls)) take(controls);
  }

  // A knob changes the patch sixty times a second. Only other outputs concern the scope.
  on('patch', ({ outputs, title }) => {
    isOtherPatch ||= hasOtherOutputs([outputs, title]);
    if (isOtherPatch) refresh();
  });
  on('machine', () => { if (model.controls && spanOf(model.controls) !== model.span) refresh(); });
  on('scopes', synchronise);
  on('frame', (frame) => {
    if (!model.controls) return;
    const now = performance.now();
    isMoving = frame.moves && !frame.paused;
    if (isMoving) trace.clock += Math.min(0.1, (now - frameAt) / 1000);
    frameAt = now;
    model.lit = model.outputs.map((output) => frame.lamps[state.numbers.get(output?.name)] === 1);
    if (hasOtherLamps(model.lit)) trace.version += 1;
    const data = frame.scopes[index];
    if (data.display === model.controls.display) trace.take(data, model.span, model.controls.store, now);
    schedule();
  });
  synchronise();
}

for (const index of [0, 1]) mountScope(index);
