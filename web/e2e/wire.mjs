/**
 * The wire between a browser and the server: a relay that counts what crosses it. Whatever
 * asks, the page, its service worker or the browser itself, is counted, and nothing else.
 */
import { createServer, connect } from 'node:net';

/**
 * A relay before the server at `url`; `octets` are those that went to the browser. Nothing
 * crosses it from `cut` to `mend`.
 */
export async function wireTo(url) {
  const { hostname, port } = new URL(url);
  const wire = { octets: 0 };
  const open = new Set();
  let whole = true;
  const relay = createServer((browser) => {
    if (!whole) {
      browser.destroy();
      return;
    }
    const server = connect(Number(port), hostname);
    for (const end of [browser, server]) {
      open.add(end);
      end.on('error', () => end.destroy());
      end.on('close', () => {
        open.delete(end);
        browser.destroy();
        server.destroy();
      });
    }
    server.on('data', (data) => (wire.octets += data.length));
    server.pipe(browser);
    browser.pipe(server);
  });
  await new Promise((listening) => relay.listen(0, '127.0.0.1', listening));
  return Object.assign(wire, {
    url: `http://127.0.0.1:${relay.address().port}`,
    cut() {
      whole = false;
      for (const end of open) end.destroy();
    },
    mend() {
      whole = true;
    },
    close() {
      for (const end of open) end.destroy();
      relay.close();
    },
  });
}
