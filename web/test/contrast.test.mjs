// @ts-check
/** Text is readable: contrast of the colours in both themes by WCAG 2.2 (1.4.3: 4.5 to 1). No browser is needed. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

const css = readFileSync(new URL('../style.css', import.meta.url), 'utf8');
const LEAST = 4.5;

/** The colours of a theme, by name. @param {string} block @returns {Record<string, string>} */
const colours = (block) => Object.fromEntries([...block.matchAll(/--([\w-]+): (#[0-9a-f]{6})/g)].map((found) => [found[1] ?? '', found[2] ?? '']));
const dark = colours(css.slice(0, css.indexOf('@media')));
const light = colours(css.slice(css.indexOf('@media'), css.indexOf('* {')));

/** @param {string} colour @returns {[number, number, number]} 0 to 255 */
const channels = (colour) => /** @type {[number, number, number]} */ ([1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16)));

/** Relative luminance. @param {number[]} rgb */
function luminance(rgb) {
  const [red = 0, green = 0, blue = 0] = rgb.map((each) => each / 255).map((each) => (each <= 0.04045 ? each / 12.92 : ((each + 0.055) / 1.055) ** 2.4));
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

/** @param {number[]} a @param {number[]} b */
function contrast(a, b) {
  const [high = 0, low = 0] = [luminance(a), luminance(b)].sort((x, y) => y - x);
  return (high + 0.05) / (low + 0.05);
}

/** A colour laid over another. @param {number[]} over @param {number[]} under @param {number} share */
const mixed = (over, under, share) => over.map((each, index) => each * share + (under[index] ?? 0) * (1 - share));

for (const [theme, of] of /** @type {[string, Record<string, string>][]} */ ([['dark', dark], ['light', light]])) {
  const colour = (/** @type {string} */ name) => channels(of[name] ?? assert.fail(`${theme} has no --${name}`));

  test(`${theme}: texts and curves on panel and background`, () => {
    for (const name of ['text', 'dim', 'left', 'right', 'front', 'reference', 'robot', 'goal', 'good', 'warning', 'bad']) {
      for (const under of ['panel', 'back']) {
        const ratio = contrast(colour(name), colour(under));
        assert.ok(ratio >= LEAST, `--${name} on --${under}: ${ratio.toFixed(2)}`);
      }
    }
  });

  test(`${theme}: names of states on the colours of the band and of the lit box`, () => {
    for (let state = 0; state < 6; state++) {
      for (const [under, share] of /** @type {[string, number][]} */ ([['panel', 0.55], ['back', 0.4]])) {
        const ratio = contrast(colour('text'), mixed(colour(`state-${state}`), colour(under), share));
        assert.ok(ratio >= LEAST, `state ${state} on ${under}: ${ratio.toFixed(2)}`);
      }
    }
    assert.ok(contrast(colour('text'), mixed(colour('bad'), colour('panel'), 0.55)) >= LEAST, 'fault');
  });

  test(`${theme}: the edges of fields, 3 to 1 (1.4.11)`, () => {
    const ratio = contrast(colour('edge'), colour('panel'));
    assert.ok(ratio >= 3, ratio.toFixed(2));
  });

  test(`${theme}: STOP, and what is pressed`, () => {
    assert.ok(contrast([255, 255, 255], colour('stop')) >= LEAST);
    assert.ok(contrast(colour('text'), mixed(colour('left'), colour('back'), 0.25)) >= LEAST);
    for (const name of ['text', 'bad']) assert.ok(contrast(colour(name), mixed(colour('bad'), colour('panel'), 0.16)) >= LEAST, `${name} in the banner of a fault`);
  });
}

test('nothing moves by itself, whatever the reader prefers', () => {
  assert.doesNotMatch(css, /transition|animation|@keyframes/);
});
