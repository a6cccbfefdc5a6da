// Runs before the page is drawn, so that it never appears in the wrong colours.
(() => {
  const root = document.documentElement;
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const stored = (name) => localStorage.getItem(`patchcord.${name}`);
  const show = () => {
    const chosen = stored('theme') ?? 'system';
    root.dataset.theme = chosen === 'system' ? (dark.matches ? 'dark' : 'light') : chosen;
    root.toggleAttribute('data-projector', stored('projector') === 'true');
  };
  dark.onchange = show;
  // main.js sends this event; so does the browser if another page has kept a theme.
  window.onstorage = show;
  show();
})();
