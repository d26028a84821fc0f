// @ts-check
/** The shapes of an edited world. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { pack, readLink, unpack, writeLink } from '../src/run_link.js';
import { ARENA, Draft, added, changed, lampsOf, met, moved, pulled, turned, without } from '../src/world_shapes.js';

/** @typedef {import('../src/world_shapes.js').World} World */
/** @typedef {import('../src/world_shapes.js').Item} Item */

const GRID = { step_m: 0.05, step_deg: 5 };
/** @type {Item} */
const BOX = { kind: 'box', index: 0 };
/** @type {World} */
const WORLD = { box: [{ centre_m: [1, 1], size_m: [0.4, 0.2], angle_deg: 90 }], wall: [{ from_m: [0, 2], to_m: [1, 2] }], start: { x_m: 0, y_m: 0 } };

test('a corner of a turned box is pulled, and the one across stays', () => {
  // Turned by 90°, its length runs along y: the corner of larger x and y of the page is (1, -1) of its own.
  const world = pulled(WORLD, BOX, [1, -1], [1.2, 1.4], { step_m: 0, step_deg: 0 });
  const [box] = world.box ?? [];
  assert.deepEqual(box, { centre_m: [1.05, 1.1], size_m: [0.6, 0.3], angle_deg: 90 });
  // Pulled through the corner across it keeps a size.
  assert.deepEqual(pulled(WORLD, BOX, [1, -1], [-5, -5], GRID).box?.[0]?.size_m, [0.01, 0.01]);
});

test('what the editor does not know of a world stays in it', () => {
  const mover = { path_m: [[0, 0], [1, 0]] };
  /** @type {any} */
  const world = { ...WORLD, mover: [mover], box: [{ ...WORLD.box?.[0], colour: 'red' }] };
  const [wide] = added(moved(turned(world, BOX, 5), BOX, [1.02, 0.98], GRID), 'wall', [0, 0], GRID);
  /** @type {any} */
  const after = without(changed(wide, ARENA, { walled: true }), { kind: 'wall', index: 0 });
  assert.deepEqual(after.mover, [mover]);
  assert.deepEqual(after.box, [{ centre_m: [1, 1], size_m: [0.4, 0.2], angle_deg: 95, colour: 'red' }]);
  assert.deepEqual(after.wall, [{ from_m: [0, 0], to_m: [0.5, 0] }]);
  assert.deepEqual(world.box[0].angle_deg, 90);
});

test('a pointer meets handles first, then what is drawn above, and nothing where nothing is', () => {
  assert.deepEqual(met(WORLD, BOX, [1.1, 1.2], 0.02)?.grip, [1, -1]);
  assert.deepEqual(met(WORLD, ARENA, [1.1, 1.2], 0.02), { item: BOX, grip: 'all' });
  assert.deepEqual(met(WORLD, BOX, [1, 1.32], 0.02), { item: BOX, grip: 'turn' });
  assert.deepEqual(met(WORLD, ARENA, [0.5, 2.01], 0.02)?.item.kind, 'wall');
  assert.deepEqual(met(WORLD, ARENA, [0.05, 0.05], 0.02)?.item.kind, 'start');
  assert.equal(met(WORLD, ARENA, [2, 2.5], 0.02), null);
});

test('a drag is one change, and a new change after undo ends what could be made again', () => {
  const draft = new Draft(WORLD);
  for (const x of [1.1, 1.2, 1.3]) draft.change(moved(draft.world, BOX, [x, 1], GRID), 'drag');
  draft.settle();
  draft.change(turned(draft.world, BOX, 5), 'key');
  draft.undo();
  assert.deepEqual(draft.world.box?.[0]?.centre_m, [1.3, 1]);
  draft.undo();
  assert.deepEqual([draft.world, draft.canUndo, draft.canRedo], [WORLD, false, true]);
  draft.redo();
  draft.change(without(draft.world, BOX));
  assert.deepEqual([draft.world.box, draft.canRedo], [[], false]);
});

test('a world of twenty boxes fits into a link, and comes out as it was', async () => {
  const boxes = Array.from({ length: 20 }, (_, index) => `[[box]]\nangle_deg = ${index * 7}\ncentre_m = [${index * 0.35}, ${(index % 5) * 0.45}]\nsize_m = [0.3, 0.${index + 10}]\n`);
  const text = `title = "Año"\n${boxes.join('\n')}`;
  const link = writeLink('http://localhost/', { scenario: 'mode1', edited: await pack(text), parameters: {} }, '0.2.0');
  assert.ok(link.length < 2_048, String(link.length));
  assert.equal(await unpack(readLink(new URL(link).hash).start.edited ?? ''), text);
  await assert.rejects(unpack(await pack('x'.repeat(200_000))), /too large/);
  await assert.rejects(unpack('no such thing'));
});

test('a lamp is added, met, moved and taken away like what stands, and gives what a bulb does', () => {
  const [world, lamp] = added(WORLD, 'lamp', [0.51, 0.52], GRID);
  assert.deepEqual(lampsOf(world), [{ at_m: [0.5, 0.5], height_m: 0.1, lumen: 806 }]);
  assert.deepEqual(met(world, ARENA, [0.5, 0.51], 0.02), { item: lamp, grip: 'all' });
  assert.deepEqual(moved(world, lamp, [-0.3, 0.2], GRID).lamp, [{ at_m: [-0.3, 0.2] }]);
  assert.deepEqual(without(world, lamp).lamp, []);
});
