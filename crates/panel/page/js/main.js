/** Puts the page together. */

import { mountBoard } from './board.js';
import { mountControls } from './controls.js';
import { mountEquations } from './equations.js';
import { mountFiles, begin } from './files.js';
import { bind, startKeys } from './keys.js';
import { mountKnobs } from './knobs.js';
import { mountLamps } from './lamps.js';
import { startLoop } from './loop.js';
import { mountMessages } from './messages.js';
import { mountMeters } from './meters.js';
import { mountSchematic } from './schematic.js';
import { mountScope } from './scope.js';
import { cancelProbe, emit, on, open, send, state } from './state.js';

const TAB = 'patchcord.tab';

const byId = (id) => document.getElementById(id);

/** The views below the scopes. Only the one that is shown gets its events. */
function mountTabs() {
  const tabs = [...document.querySelectorAll('[role=tab]')];
  const panelOf = (tab) => byId(tab.getAttribute('aria-controls'));
  const select = (chosen) => {
    for (const tab of tabs) {
      tab.setAttribute('aria-selected', String(tab === chosen));
      tab.tabIndex = tab === chosen ? 0 : -1;
      panelOf(tab).hidden = tab !== chosen;
    }
    localStorage.setItem(TAB, chosen.id);
    sendViews();
  };
  tabs.forEach((tab, index) => {
    tab.addEventListener('click', () => select(tab));
    tab.addEventListener('keydown', ({ key }) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[key];
      if (!by) return;
      const next = tabs[(index + by + tabs.length) % tabs.length];
      next.focus();
      select(next);
    });
    bind(String(index + 1), tab.textContent.trim(), () => select(tab));
  });
  // The place of a finding is in the views, so one of those that can show it must be open.
  on('highlight', ({ element }) => { if (element && !byId('equations').hidden) select(tabs[0]); });
  select(byId(localStorage.getItem(TAB) ?? '') ?? tabs[0]);
}

function sendViews() {
  if (state.host) send({ command: 'views', schematic: !byId('schematic').hidden, equations: !byId('equations').hidden });
}

/** Theme and projector mode, which theme.js keeps. */
function mountAppearance() {
  const root = document.documentElement;
  const theme = byId('theme');
  theme.value = localStorage.getItem('patchcord.theme') ?? 'system';
  const projector = byId('projector');
  const set = (key, value) => {
    localStorage.setItem(key, value);
    root.dispatchEvent(new Event('themeset'));
  };
  theme.addEventListener('change', () => set('patchcord.theme', theme.value));
  const toggle = () => set('patchcord.projector', String(!root.hasAttribute('data-projector')));
  projector.addEventListener('click', toggle);
  bind('l', 'Large type for a projector', toggle);
  const show = () => {
    projector.setAttribute('aria-pressed', String(root.hasAttribute('data-projector')));
    emit('theme', root.dataset.theme);
  };
  root.addEventListener('themechange', show);
  show();
}

function mountTitle() {
  on('patch', ({ title, file, source, note, machine }) => {
    const name = title || file || 'New patch';
    byId('title').textContent = name;
    byId('title').title = name;
    const type = state.hello?.machines.find((each) => each.name === machine)?.title || machine;
    byId('subtitle').textContent = [file, type].filter((text) => text && text !== name).join(' · ');
    byId('about').hidden = !(note || source);
    byId('about-text').textContent = [note, source].filter(Boolean).join('\n\n');
    document.title = `${name} – patchcord`;
  });
}

/** Connects and brings the first patch; also after the connection was lost. */
async function start() {
  try {
    await open();
  } catch (fault) {
    emit('link', { connected: false, message: fault.message });
    return;
  }
  sendViews();
  await begin();
}

mountControls();
mountTitle();
mountMessages(start);
mountFiles();
for (const index of [0, 1]) mountScope(byId(`scope-${index + 1}`), index);
mountMeters(byId('meters'));
mountKnobs(byId('knobs'));
mountLamps(byId('lamps'));
mountSchematic(byId('schematic'));
mountBoard(byId('board'));
mountEquations(byId('equations'));
mountTabs();
mountAppearance();
startKeys();
byId('cancel-probe').addEventListener('click', cancelProbe);
startLoop();
start();
