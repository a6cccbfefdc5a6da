/** Puts the page together. */

import { mountBoard } from './board.js';
import { mountCheck } from './check.js';
import { mountControls, press } from './controls.js';
import { byId, joined, named, root, stored } from './dom.js';
import { mountEquations } from './equations.js';
import { mountFiles, begin } from './files.js';
import { bind, startKeys } from './keys.js';
import { mountKnobs } from './knobs.js';
import { mountLamps } from './lamps.js';
import { startLoop } from './loop.js';
import { mountMeasured } from './measured.js';
import { mountMessages } from './messages.js';
import { mountMeters } from './meters.js';
import { mountSchematic } from './schematic.js';
import { mountScope } from './scope.js';
import { cancelProbe, emit, on, open, send, state } from './state.js';

/** How the scopes and the views share the page: "scopes", "both" or "view". */
function setLayout(name) {
  root.dataset.layout = name;
  stored('layout', name);
  press(byId('layout'), ({ value }) => value === name);
  sendViews();
}

/** The views below the scopes. Only the one that is shown gets its events. */
function mountTabs() {
  const tabs = [...document.querySelectorAll('[role=tab]')];
  const panelOf = (tab) => byId(tab.getAttribute('aria-controls'));
  const select = (chosen) => {
    for (const tab of tabs) {
      tab.ariaSelected = tab === chosen;
      tab.tabIndex = tab === chosen ? 0 : -1;
      panelOf(tab).hidden = tab !== chosen;
    }
    stored('tab', chosen.id);
    setLayout(root.dataset.layout === 'view' ? 'view' : 'both');
  };
  tabs.forEach((tab, index) => {
    tab.onclick = () => select(tab);
    tab.onkeydown = ({ key }) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[key];
      if (!by) return;
      const next = tabs.at((index + by) % tabs.length);
      next.focus();
      select(next);
    };
  });
  for (const each of byId('layout').children) each.onclick = () => setLayout(each.value);
  bind('V', 'Large scopes, large view, or both', () => setLayout({ both: 'scopes', scopes: 'view', view: 'both' }[root.dataset.layout]));
  const before = stored('layout') ?? 'both';
  select(byId(stored('tab')) ?? tabs[0]);
  setLayout(before);
  // A finding about an equation has no place at the panel. The schematic has all other places.
  on('highlight', ({ element, equation }) => {
    if (equation) select(tabs[2]);
    else if (element && (root.dataset.layout === 'scopes' || (byId('schematic').hidden && byId('board').hidden))) select(byId('board').hidden ? tabs[0] : tabs[1]);
  });
}

function sendViews() {
  const isShown = (id) => !byId(id).hidden && root.dataset.layout !== 'scopes';
  if (state.host) send('views', { schematic: isShown('schematic'), equations: isShown('equations') });
}

/** Theme and projector mode, which theme.js keeps. */
function mountAppearance() {
  const [theme, projector] = [byId('theme'), byId('projector')];
  theme.value = stored('theme') ?? 'system';
  projector.ariaPressed = stored('projector') === 'true';
  const set = (key, value) => {
    stored(key, value);
    root.dispatchEvent(new Event('themeset'));
  };
  theme.onchange = () => set('theme', theme.value);
  projector.onclick = () => {
    projector.ariaPressed = projector.ariaPressed !== 'true';
    set('projector', projector.ariaPressed);
  };
}

function mountTitle() {
  on('patch', ({ title, file, source, note, machine }) => {
    const name = title || file || 'New patch';
    byId('title').textContent = byId('title').title = name;
    const type = named(state.hello?.machines, machine)?.title || machine;
    byId('subtitle').textContent = joined([file !== name && file, type], ' · ');
    byId('about-text').textContent = joined([note, source], '\n\n');
    document.title = `${name} – patchcord`;
  });
}

/** A menu closes when the user goes elsewhere, and by the Escape key. */
function mountPopovers() {
  for (const kind of ['pointerdown', 'focusin', 'keydown']) {
    document.addEventListener(kind, ({ key, target }) => {
      for (const each of document.querySelectorAll('.popover[open]')) {
        if (key ? key === 'Escape' : !each.contains(target)) each.open = false;
      }
    });
  }
}

/** Connects and brings the first patch; also after the connection was lost. */
async function start() {
  const isOpen = await open().then(() => true, ({ message }) => emit('link', { connected: false, message }));
  if (!isOpen) return;
  sendViews();
  await begin();
}

byId('unstarted').remove();
mountControls();
mountTitle();
mountMessages(start);
mountFiles();
for (const index of [0, 1]) mountScope(byId(`scope-${index + 1}`), index);
mountMeters();
mountKnobs();
mountLamps();
mountSchematic(byId('schematic'));
mountBoard(byId('board'));
mountEquations(byId('equations'));
mountMeasured();
mountCheck(byId('check'));
mountTabs();
mountAppearance();
mountPopovers();
startKeys();
byId('cancel-probe').onclick = cancelProbe;
startLoop();
start();
