/** The connection to the server is lost and made again. */

import { connect, createServer } from 'node:net';
import { test } from 'node:test';

import { startHost } from './hosts.mjs';
import { FORM, MASS_AND_SPRING, openAddress, ready, select } from './panel.mjs';

const options = { skip: FORM !== 'server' && 'the engine is in the page' };

/**
 * A proxy between the page and the server on this port. `hold` keeps what the server sends, and `cut` ends all connections.
 * The server permits only its own address, so the proxy replaces its own in the heads of requests.
 */
async function startProxy(port) {
  const sockets = new Set();
  let isHeld = false;
  const proxy = createServer((page) => {
    const server = connect(port, '127.0.0.1');
    page.on('data', (data) => {
      const text = data.toString('latin1');
      const isHead = text.includes('HTTP/1.1\r\n');
      server.write(isHead ? Buffer.from(text.replaceAll(`:${proxy.address().port}`, `:${port}`), 'latin1') : data);
    });
    server.on('data', (data) => { if (!isHeld) page.write(data); });
    for (const [socket, other] of [[page, server], [server, page]]) {
      sockets.add(socket);
      socket.on('error', () => {});
      socket.on('close', () => other.destroy());
    }
  });
  await new Promise((resolve) => { proxy.listen(0, '127.0.0.1', resolve); });
  return {
    port: proxy.address().port,
    hold() { isHeld = true; },
    cut() {
      for (const socket of sockets) socket.destroy();
      sockets.clear();
      isHeld = false;
    },
    stop() {
      proxy.close();
      for (const socket of sockets) socket.destroy();
    },
  };
}

/** Sends commands of which the server answers none, and resolves when they wait. */
function sendUnanswered(page) {
  return page.evaluate(async () => {
    const { send } = await import(new URL('js/state.js', document.baseURI).href);
    for (let count = 0; count < 3; count += 1) send('text');
  });
}

test('a connection that is lost with open requests is made again', options, async (t) => {
  const host = await startHost('server', MASS_AND_SPRING);
  const address = new URL(host.address);
  const proxy = await startProxy(address.port);
  t.after(() => {
    proxy.stop();
    host.stop();
  });
  address.port = proxy.port;
  const page = await openAddress(t, address.href);
  await ready(page);
  proxy.hold();
  await sendUnanswered(page);
  proxy.cut();
  await page.getByRole('alert').getByText(/connection to patchcord is closed/).waitFor();
  await page.getByRole('button', { name: 'Connect again' }).click();
  await page.getByRole('button', { name: 'Connect again' }).waitFor({ state: 'hidden' });
  // The new session answers.
  await select(page, 'Hold');
});
