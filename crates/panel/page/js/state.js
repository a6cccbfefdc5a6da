/** The session as the page knows it. Views listen to events; commands go out one request at a time. */

import { decode } from './frame.js';
import { connect } from './link.js';

/** The latest data of each event. */
export const state = {
  hello: null, patch: null, findings: [], machine: null, scopes: [], equations: null, frame: null,
  /** The numbers of the outputs in frames, by their names. @type {Map<string, number>} */
  numbers: new Map(),
  /** @type {import('./link.js').Link | null} */
  host: null,
};

/** Events that are kept as their list. */
const LISTS = ['findings', 'scopes'];

/** @type {Map<string, ((data: any) => void)[]>} */
const listeners = new Map();

/**
 * Calls the listener with the data of each event of these names. The page adds `frame`, `link` (why there is no
 * connection, or an empty text), `highlight` (a place), `pointed` (the output or parameter at the pointer), `probing` (the listener that waits for an
 * output, or null), `data` (a file of measured data) and `saved`.
 * @param {string} names one or several, with blanks between them
 */
export function on(names, listener) {
  for (const name of names.split(' ')) listeners.set(name, [...listeners.get(name) ?? [], listener]);
}

/** Calls the listeners. A fault in one of them does not keep the others from running. */
export function emit(name, data) {
  for (const listener of listeners.get(name) ?? []) {
    try {
      listener(data);
    } catch (fault) {
      reportError(fault);
    }
  }
}

/** @typedef {{commands: any[], key: string | null, answer: Promise<any[]>, resolve: (events: any[]) => void}} Job */

/** @type {Job[]} */
const waiting = [];
let isOpen = false;
let requests = 0;

/** A name of what the command sets, if only its last value counts: a knob sends faster than the session answers. */
function replaceable(commands) {
  if (commands.length !== 1) return null;
  const { command, name, element, setting, scope } = commands[0];
  return ['parameter', 'setting', 'scrub', 'null-meter', 'meter', 'scope', 'time-scale'].includes(command)
    ? JSON.stringify([command, name, element, setting, scope]) : null;
}

const isAdvance = (/** @type {Job} */ job) => job.commands[0].command === 'advance';

/**
 * Sends commands in one request. Resolves with the events of the answer after the listeners were called; if the link is
 * lost, with no events.
 * @param {{command: string}[]} commands each with its name and its fields
 * @returns {Promise<any[]>}
 */
export function sendAll(commands) {
  if (!state.host) return Promise.resolve([]);
  const key = replaceable(commands);
  const before = waiting.findLast((job) => !isAdvance(job));
  if (key !== null && before?.key === key) {
    before.commands = commands;
    return before.answer;
  }
  const { promise: answer, resolve } = Promise.withResolvers();
  waiting.push({ commands, key, answer, resolve });
  pump();
  return answer;
}

/** Sends a command with its fields. @returns {Promise<any[]>} as for `sendAll` */
export const send = (command, fields) => sendAll([{ command, ...fields }]);

/** The event of this name in an answer, if there is one. */
export const eventOf = (events, name) => events.find(({ event }) => event === name);

/** Why the answer refuses its command, or nothing. */
export const refusalOf = (events) => eventOf(events, 'refused')?.message;

/** Sends a command that is answered by an event of the same name. Resolves with this event, if there is one. */
export const ask = async (command, fields) => eventOf(await send(command, fields), command);

async function pump() {
  if (isOpen || waiting.length === 0) return;
  isOpen = true;
  const { commands, resolve } = waiting.shift();
  requests += 1;
  let events = [];
  try {
    events = receive(await state.host.request(JSON.stringify({ id: requests, commands })));
  } catch (fault) {
    console.warn(fault);
  }
  isOpen = false;
  resolve(events);
  pump();
}

/** Takes an answer over into the state, then calls the listeners. */
function receive({ text, frame }) {
  const { events } = JSON.parse(text);
  for (const { event, ...data } of events) {
    if (event in state) state[event] = LISTS.includes(event) ? data[event] : data;
    if (event !== 'patch') continue;
    // Voltages belong to one patch: those of the last one would be shown at the wrong outputs.
    state.frame = null;
    state.numbers = new Map(data.outputs.map(({ name }, number) => [name, number]));
  }
  for (const { event, ...data } of events) emit(event, data);
  if (frame) {
    state.frame = decode(frame);
    emit('frame', state.frame);
  }
  return events;
}

/** The output with this name in the patch, if there is one. */
export const outputOf = (name) => state.patch?.outputs[state.numbers.get(name)];

/** The volts of an output in the latest frame, if they are known. */
export const voltsOf = (name) => state.frame?.volts[state.numbers.get(name)];

/** Connects to the host. Rejects if there is none. */
export async function open() {
  const host = await connect();
  state.host = host;
  emit('link', '');
  host.lost.then((message) => {
    state.host = null;
    for (const job of waiting.splice(0)) job.resolve([]);
    emit('link', message);
  });
  await send('hello');
}

/** Asks the views to show a place at the panel. */
export const highlight = (place) => emit('highlight', place);

/** @type {((output: string) => void) | null} */
let probe = null;

/**
 * Waits for a click on an output in any view. Only one listener waits at a time.
 * @param {((output: string) => void) | null} listener called once; null ends the waiting
 */
export function selectProbe(listener) {
  probe = listener;
  emit('probing', probe);
}

/** A view reports a click on an output. */
export function probed(output) {
  const listener = probe;
  selectProbe(null);
  listener?.(output);
}

export const isProbing = () => probe !== null;
