// @ts-check
/** The page loads its modules at once, not one after another as they import each other. No browser is needed. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

const WEB = new URL('../', import.meta.url);
/** @param {URL | string} path */
const read = (path) => readFileSync(new URL(path, WEB), 'utf8');

test('what the page preloads is what its modules import', () => {
  const html = read('index.html');
  const preloaded = [...html.matchAll(/<link rel="modulepreload" href="([^"]+)">/g)].map(([, path = '']) => path);
  /** @type {Set<string>} */
  const imported = new Set();
  /** @param {URL} module */
  const follow = (module) => {
    for (const [, path = ''] of read(module).matchAll(/^(?:import|export) (?:[^'"();]* from )?'(\.[^']+)'/gm)) {
      const name = new URL(path, module).href.slice(WEB.href.length);
      if (imported.has(name)) continue;
      imported.add(name);
      follow(new URL(name, WEB));
    }
  };
  follow(new URL('src/main.js', WEB));
  assert.deepEqual([...preloaded].sort(), [...imported].sort());
});
