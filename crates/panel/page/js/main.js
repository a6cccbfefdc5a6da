/** Puts the page together: the views connect themselves when they are loaded. */

import './board.js';
import './check.js';
import './controls.js';
import { byId, choice, fill, root, stored } from './dom.js';
import './equations.js';
import { begin } from './files.js';
import { bind } from './keys.js';
import './knobs.js';
import './lamps.js';
import './loop.js';
import './measured.js';
import './meters.js';
import './schematic.js';
import './scope.js';
import { emit, on, open, selectProbe, send, state } from './state.js';

const tabs = [...document.querySelectorAll('[role=tab]')];
const [schematic, board, link] = ['schematic', 'board', 'link'].map(byId);

/** Asks for the events of the view that is shown only. */
function sendViews() {
  const isShown = (id) => !byId(id).hidden && root.dataset.layout !== 'scopes';
  if (state.host) send('views', { schematic: isShown('schematic'), equations: isShown('equations') });
}

const pressLayout = choice('layout', setLayout);

/** How the scopes and the views share the page: "scopes", "both" or "view". */
function setLayout(name) {
  root.dataset.layout = name;
  stored('layout', name);
  pressLayout(name);
  sendViews();
}

/** Shows the view of a tab. */
function select(chosen) {
  for (const tab of tabs) {
    tab.ariaSelected = tab === chosen;
    tab.tabIndex = tab === chosen ? 0 : -1;
    byId(tab.getAttribute('aria-controls')).hidden = tab !== chosen;
  }
  stored('tab', chosen.id);
  setLayout(root.dataset.layout === 'view' ? 'view' : 'both');
}

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
bind('V', 'Large scopes, large view, or both', () => setLayout({ both: 'scopes', scopes: 'view', view: 'both' }[root.dataset.layout]));
const before = stored('layout') ?? 'both';
select(byId(stored('tab')) ?? tabs[0]);
setLayout(before);
on('highlight', ({ element, equation }) => {
  // A finding about an equation has no place at the panel. The schematic has all other places.
  if (equation) select(tabs[2]);
  else if (element && (root.dataset.layout === 'scopes' || (schematic.hidden && board.hidden))) select(tabs[board.hidden ? 0 : 1]);
});

// Theme and projector mode, which theme.js shows.
const [theme, projector] = [byId('theme'), byId('projector')];
theme.value = stored('theme') ?? 'system';
projector.ariaPressed = stored('projector') === 'true';
const set = (key, value) => {
  stored(key, value);
  dispatchEvent(new Event('storage'));
};
theme.onchange = () => set('theme', theme.value);
projector.onclick = () => {
  projector.ariaPressed = projector.ariaPressed !== 'true';
  set('projector', projector.ariaPressed);
};

/** A menu closes when the user goes elsewhere, and by the Escape key. */
const close = ({ key, target }) => {
  for (const each of document.querySelectorAll('.popover[open]')) {
    if (key ? key === 'Escape' : !each.contains(target)) each.open = false;
  }
};
fill(document, { onpointerdown: close, onfocusin: close, onkeydown: close });

/** Connects and brings the first patch; also after the connection was lost. */
async function start() {
  // There is one attempt at a time.
  emit('link', '');
  const isOpen = await open().then(() => true, ({ message }) => emit('link', message));
  if (!isOpen) return;
  sendViews();
  await begin();
}

byId('unstarted').remove();
byId('cancel-probe').onclick = () => selectProbe(null);
link.lastChild.onclick = start;
start();
