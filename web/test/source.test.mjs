// @ts-check
/** What the code pane and the debugger do without a page. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Requests, placeOf, plainName, sameFiles } from '../src/source.js';

test('a place in a file has its line, and perhaps a column; what is none leads nowhere', () => {
  assert.deepEqual(placeOf('src/my wall.ino:12:7'), { file: 'src/my wall.ino', line: 12, column: 7 });
  assert.deepEqual(placeOf('wall.ino:12'), { file: 'wall.ino', line: 12, column: null });
  assert.deepEqual([placeOf('wall.ino'), placeOf(null)], [null, null]);
});

test('a name is one that the lab takes', () => {
  assert.deepEqual(['example:wall', 'mine.ino', 'año 2'].map(plainName), ['wall', 'mine', 'a_o 2']);
});

test('files are the same in any order, and differ by a character or a name', () => {
  const [a, b] = [{ name: 'a.ino', text: 'x' }, { name: 'b.h', text: 'y' }];
  assert.equal(sameFiles([a, b], [b, a]), true);
  assert.equal(sameFiles([a, b], [a, { ...b, text: 'y ' }]), false);
  assert.equal(sameFiles([a], [{ ...a, name: 'c.ino' }]), false);
});

test('a response belongs to its request, one to another page\'s to none, and a refusal has its reason', async () => {
  /** @type {any[]} */
  const sent = [];
  const requests = new Requests((request) => sent.push(request));
  const [first, second] = [requests.ask('scopes', { frameId: 0 }), requests.ask('next')];
  requests.receive({ type: 'response', request_seq: sent[0].seq - 1, success: true, body: { of: 'another page' } });
  requests.receive({ type: 'response', request_seq: sent[1].seq, success: false, message: 'the program runs; pause it first' });
  requests.receive({ type: 'response', request_seq: sent[0].seq, success: true, body: { scopes: [] } });
  assert.deepEqual(await first, { scopes: [] });
  await assert.rejects(second, /pause it first/);
  assert.deepEqual(sent[0], { seq: sent[0].seq, type: 'request', command: 'scopes', arguments: { frameId: 0 } });
});
