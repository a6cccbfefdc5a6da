// Starts the modules of the page from its own text. A module comes after those that it imports.
(() => {
  const addresses = {};
  for (const { dataset: { path }, text } of document.querySelectorAll('script[data-path^="js/"]')) {
    const code = text.replace(/\b(from|import) ?'\.\/([^']+)'/g, (_, word, name) => `${word}'${addresses[`js/${name}`]}'`);
    addresses[path] = URL.createObjectURL(new Blob([code], { type: 'text/javascript' }));
  }
  import(addresses['js/main.js']);
})();
