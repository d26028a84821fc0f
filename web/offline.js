// @ts-check
/**
 * Service worker of the site: keeps all its files, so that the lab opens without a network too. A newer site is fetched
 * beside the one in use, and taken when no page has that open any more: a page never mixes two of them.
 */

// Put in by `cargo xtask site`: the files, and a number that changes with their contents.
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

worker.addEventListener('fetch', (/** @type {any} */ event) => {
  if (event.request.method !== 'GET') return;
  const found = caches.open(CACHE).then((cache) => cache.match(event.request, { ignoreSearch: true }));
  event.respondWith(found.then((kept) => kept ?? fetch(event.request)));
});
