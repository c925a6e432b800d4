/*
 * Keeps the dashboard's own files, so that a page opens again without a connection.
 *
 * What always holds: nothing of the API is ever kept or answered here; a file whose name
 * has a hash is right for ever, and the page itself is asked for first each time.
 */

const kept = 'binnacle-page-1';
/** On a bad connection the kept page is better than a white screen, ms. */
const patienceMs = 6_000;

self.addEventListener('install', (event) => {
  event.waitUntil(
    caches
      .open(kept)
      .then((cache) => cache.add('/'))
      .then(() => self.skipWaiting()),
  );
});

self.addEventListener('activate', (event) => {
  event.waitUntil(
    caches
      .keys()
      .then((names) => Promise.all(names.filter((n) => n !== kept).map((n) => caches.delete(n))))
      .then(() => self.clients.claim()),
  );
});

// What a page had loaded before there was anybody here to keep it.
self.addEventListener('message', (event) => {
  const files = Array.isArray(event.data?.keep) ? event.data.keep : [];
  const ours = files.filter((file) => isAsset(new URL(file)));
  event.waitUntil(caches.open(kept).then((cache) => Promise.all(ours.map((f) => keep(cache, f)))));
});

self.addEventListener('fetch', (event) => {
  const { request } = event;
  const url = new URL(request.url);
  if (request.method !== 'GET' || url.origin !== location.origin) return;
  if (request.mode === 'navigate' && !url.pathname.startsWith('/api/')) {
    event.respondWith(page(request.url));
  } else if (isAsset(url)) {
    event.respondWith(asset(request));
  }
});

const isAsset = (url) => url.origin === location.origin && url.pathname.startsWith('/assets/');

async function keep(cache, file) {
  if (!(await cache.match(file))) await cache.add(file).catch(() => undefined);
}

/** Every address of the dashboard is the same page, under headers of its own. */
async function page(address) {
  const cache = await caches.open(kept);
  try {
    const signal = AbortSignal.timeout(patienceMs);
    const answer = await fetch(address, { redirect: 'manual', signal });
    if (!isPage(answer)) return answer;
    const before = await cache.match('/');
    const [was, is] = await Promise.all([before?.text(), answer.clone().text()]);
    if (was !== is) await forgetAssets(cache);
    await cache.put('/', new Response(is, { headers: ofAnyAddress(answer.headers) }));
    return answer;
  } catch (error) {
    const found = await cache.match('/');
    if (found) return found;
    throw error;
  }
}

/** What else the server has, such as whether it is well, is no page; nor is another's address. */
const isPage = (answer) => answer.ok && answer.headers.get('Content-Type')?.startsWith('text/html');

/** What is asked for along with a page is so for one address only. */
function ofAnyAddress(headers) {
  const kept = new Headers(headers);
  kept.delete('Link');
  return kept;
}

/** Those of an older version of the page are asked for no more. */
async function forgetAssets(cache) {
  for (const request of await cache.keys()) {
    if (isAsset(new URL(request.url))) await cache.delete(request);
  }
}

async function asset(request) {
  const cache = await caches.open(kept);
  const found = await cache.match(request);
  if (found) return found;
  const answer = await fetch(request);
  if (answer.ok) await cache.put(request, answer.clone());
  return answer;
}
