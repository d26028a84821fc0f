// @ts-check
/**
 * Service worker of the site: keeps the lab and the lessons from the start, so that they open without a network too, and every
 * other page from when it is opened first. A newer site is fetched beside the one in use, and taken when no page has that open
 * any more: a page never mixes two of them.
 */

// Put in by `cargo xtask site`: the files kept from the start, and a number that changes with the contents of any file of the site.
/** @type {string[]} */
const FILES = [];
const VERSION = '';

const CACHE = `rumbo-${VERSION}`;
const worker = /** @type {any} */ (self);

worker.addEventListener('install', (/** @type {any} */ event) => {
  // Not what the browser kept of an earlier site.
  const requests = FILES.map((file) => new Request(file, { cache: 'reload' }));
  event.waitUntil(caches.open(CACHE).then((cache) => cache.addAll(requests)));
});

worker.addEventListener('activate', (/** @type {any} */ event) => {
  const clean = caches.keys().then((names) => {
    const old = names.filter((name) => name.startsWith('rumbo-') && name !== CACHE);
    return Promise.all(old.map((name) => caches.delete(name)));
  });
  event.waitUntil(clean);
});

/** @param {Request} request */
async function answer(request) {
  const cache = await caches.open(CACHE);
  const kept = await cache.match(request, { ignoreSearch: true });
  if (kept) return kept;
  const fetched = await fetch(request);
  if (fetched.ok && !fetched.redirected && fetched.type === 'basic') await cache.put(request, fetched.clone());
  return fetched;
}

worker.addEventListener('fetch', (/** @type {any} */ event) => {
  if (event.request.method === 'GET') event.respondWith(answer(event.request));
});
