// @ts-check
/**
 * The test files of a folder in one process and one browser, two files at once: `node test/run.mjs test/browser`. A file alone:
 * `node --test test/browser/lab.test.mjs`.
 */
import { readdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { describe } from 'node:test';
import './dashboard.mjs';

const AT_ONCE = 2;

const files = process.argv.slice(2).flatMap((folder) => readdirSync(folder).filter((name) => name.endsWith('.test.mjs')).sort().map((name) => resolve(join(folder, name))));
if (files.length === 0) throw new Error('name a folder with *.test.mjs');

describe('browser', { concurrency: AT_ONCE }, () => {
  for (const file of files) {
    describe(file.replace(/.*\/(.*)\.test\.mjs$/, '$1'), { concurrency: 1 }, async () => {
      await import(file);
    });
  }
});
