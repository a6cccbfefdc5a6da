/** Puts the page together. */

import { mountBoard } from './board.js';
import { mountControls, press } from './controls.js';
import { byId, fill } from './dom.js';
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

const [TAB, LAYOUT] = ['patchcord.tab', 'patchcord.layout'];

const root = document.documentElement;

/** How the scopes and the views share the page: "scopes", "both" or "view". */
function setLayout(name) {
  root.dataset.layout = name;
  localStorage.setItem(LAYOUT, name);
  press(byId('layout'), ({ value }) => value === name);
  sendViews();
}

/** The views below the scopes. Only the one that is shown gets its events. */
function mountTabs() {
  const tabs = [...document.querySelectorAll('[role=tab]')];
  const panelOf = (tab) => byId(tab.getAttribute('aria-controls'));
  const select = (chosen) => {
    for (const tab of tabs) {
      tab.setAttribute('aria-selected', tab === chosen);
      tab.tabIndex = tab === chosen ? 0 : -1;
      panelOf(tab).hidden = tab !== chosen;
    }
    localStorage.setItem(TAB, chosen.id);
    setLayout(root.dataset.layout === 'view' ? 'view' : 'both');
  };
  tabs.forEach((tab, index) => {
    fill(tab, {
      onclick: () => select(tab),
      onkeydown({ key }) {
        const by = { ArrowRight: 1, ArrowLeft: -1 }[key];
        if (!by) return;
        const next = tabs.at((index + by) % tabs.length);
        next.focus();
        select(next);
      },
    });
    bind(String(index + 1), tab.textContent.trim(), () => select(tab));
  });
  fill(byId('layout'), { onclick: ({ target }) => setLayout(target.closest('button').value) });
  bind('v', 'Large scopes, large view, or both', () => setLayout({ both: 'scopes', scopes: 'view', view: 'both' }[root.dataset.layout]));
  const before = localStorage.getItem(LAYOUT) ?? 'both';
  select(byId(localStorage.getItem(TAB)) ?? tabs[0]);
  setLayout(before);
  // A finding about an equation has no place at the panel. The schematic has all other places.
  on('highlight', ({ element, equation }) => {
    if (equation) select(tabs[2]);
    else if (element && (root.dataset.layout === 'scopes' || !byId('equations').hidden)) select(byId('board').hidden ? tabs[0] : tabs[1]);
  });
}

function sendViews() {
  const isShown = (id) => !byId(id).hidden && root.dataset.layout !== 'scopes';
  if (state.host) send({ command: 'views', schematic: isShown('schematic'), equations: isShown('equations') });
}

/** Theme and projector mode, which theme.js keeps. */
function mountAppearance() {
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

/** A menu closes when the user goes elsewhere, and by the Escape key. */
function mountPopovers() {
  for (const kind of ['pointerdown', 'focusin', 'keydown']) {
    document.addEventListener(kind, ({ key, target }) => {
      for (const each of document.querySelectorAll('.popover[open]')) if (key ? key === 'Escape' : !each.contains(target)) each.open = false;
    });
  }
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
mountMeters();
mountKnobs();
mountLamps(byId('lamps'));
mountSchematic(byId('schematic'));
mountBoard(byId('board'));
mountEquations(byId('equations'));
mountTabs();
mountAppearance();
mountPopovers();
startKeys();
byId('cancel-probe').addEventListener('click', cancelProbe);
startLoop();
start();
