// @ts-check
/** Every text has both languages: the page's own, and what the station and the robot say. No browser is needed. */
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { test } from 'node:test';
import { CODE } from '../src/spanish/code.js';
import { FILES } from '../src/spanish/files.js';
import { GUIDE } from '../src/spanish/guide.js';
import { PAGE } from '../src/spanish/page.js';
import { PARAMETERS } from '../src/spanish/parameters.js';
import { PROGRAM } from '../src/spanish/program.js';
import { ROBOT } from '../src/spanish/robot.js';
import { SCENARIOS } from '../src/spanish/scenarios.js';
import { WIRING } from '../src/spanish/wiring.js';

const TABLES = [PAGE, ROBOT, PROGRAM, PARAMETERS, SCENARIOS, GUIDE, FILES, CODE, WIRING];
/** @type {Record<string, string>} */
const SPANISH = Object.assign({}, ...TABLES);

/** A source, with each text that goes on in the next line as one. @param {string} path */
const read = (path) => readFileSync(new URL(path, import.meta.url), 'utf8').replace(/\\\n\s*/g, '');
/** @param {string} literal */
const unescaped = (literal) => literal.replace(/\\(.)/g, '$1');
/** @param {string} text */
const hasWords = (text) => /\p{Letter}{2}/u.test(text);

/** @param {Iterable<string>} texts */
function allSpanish(texts) {
  const missing = [...new Set(texts)].filter((text) => SPANISH[text] === undefined);
  assert.deepEqual(missing, [], 'without Spanish');
}

test('the texts of the page that scripts put there', () => {
  const files = readdirSync(new URL('../src', import.meta.url)).filter((name) => name.endsWith('.js'));
  const sources = files.map((name) => read(`../src/${name}`)).join('\n');
  // What stands in a call, and what is put into one later.
  const calls = [...sources.matchAll(/\b(?:t|said|named|BadExpression)\((?:[^()'`]|'(?:[^'\\]|\\.)*')*/g)].map(([call]) => call);
  const later = [...sources.matchAll(/\b(?:title|label|unit|name): '(?:[^'\\]|\\.)*'/g)].map(([property]) => property).filter((each) => !/'\w+_\w+'/.test(each));
  const frames = sources.match(/const KINDS = {.*/)?.[0] ?? '';
  const texts = [...calls, ...later, frames].flatMap((part) => [...part.matchAll(/'((?:[^'\\]|\\.)*)'/g)].map((found) => unescaped(found[1] ?? ''))).filter(hasWords);
  assert.ok(texts.length > 120, String(texts.length));
  allSpanish(texts);
});

test('the texts of the page as it is served', () => {
  const html = read('../index.html').replace(/^[^]*<body/, '<body').replaceAll('&amp;', '&');
  const texts = [...html.matchAll(/>([^<]+)</g)].map((found) => (found[1] ?? '').trim());
  const attributes = [...html.matchAll(/(?:title|aria-label|placeholder)="([^"]+)"/g)].map((found) => found[1] ?? '');
  allSpanish([...texts, ...attributes].filter(hasWords));
});

test('messages of the robot: faults, refusals, why it started, events, modes, states, parameters', () => {
  /** The literals of a function, or from a line on. @param {string} path @param {RegExp} where */
  const literals = (path, where) => [...read(path).matchAll(where)].flatMap(([part]) => [...part.matchAll(/"([^"]+)"/g)].map((found) => found[1] ?? ''));
  const explained = /fn (?:explanation|title|detail)\([^]*?\n {4}}/g;
  const modes = ['manual', 'front_distance', 'front_align', 'wall_hold', 'wall_follow', 'wheel_speed', 'straight_line', 'waypoints', 'twist', 'mission/mod', 'description']
    .map((mode) => `../../crates/control/src/mode/${mode}.rs`);
  const states = modes.flatMap((mode) => literals(mode, /^states! {[^]*?^}/gm));
  const names = modes.flatMap((mode) => literals(mode, /^ {4}(?:name|about): "[^"]+"/gm));
  const groups = modes.flatMap((mode) => literals(mode, /Group::new\(\s*"[^"]+"/g));
  const values = [...literals('../../crates/control/src/params.rs', /ParamKind::Choice\(&\[[^\]]*\]/g), ...literals('../../crates/control/src/params/kind.rs', /ParamKind::Switch => &\[[^\]]*\]/g)]
    .map((name) => name.replaceAll('_', ' '));
  assert.deepEqual(values, ['straight', 'pure pursuit', 'no', 'yes']);
  const parameters = [...(read('../../crates/control/src/params.rs').split('\ntable! {')[1] ?? '').split('\n}')[0]?.matchAll(/\/\/\/ (.+)/g) ?? []].map((found) => found[1] ?? '');
  assert.ok(states.length > 110 && groups.length > 12 && names.length === 20 && parameters.length > 60, `${states.length} ${groups.length} ${names.length} ${parameters.length}`);
  allSpanish([
    ...literals('../../crates/control/src/types.rs', explained), ...literals('../../crates/wire/src/names.rs', explained), ...states, ...groups, ...names, ...values, ...parameters,
  ]);
});

/** Literals of the station's sources that no page shows as they are: parts of sentences, and what goes elsewhere. */
const NO_SENTENCE = ['rig', 'in world', 'with rig', 'this program has none', '{}: {}', '{}-{}-{}T{}:{}:{}Z', 'reset: {}{}{}, seed {}', 'a new route, {}', 'allowed is {}', 'parameter {}', 'once', 'again and again'];

test('messages of session and station', () => {
  const texts = ['wire/src/words', 'session/src/words', 'session/src/anomaly', 'session/src/error', 'session/src/observer', 'session/src/session', 'session/src/session/calibrating', 'session/src/session/commanding', 'session/src/observer/describe', 'station/src/session', 'station/src/tuning', 'station/src/web/tuning', 'cli/src/tune/dashboard', 'station/src/recordings', 'station/src/web/recordings', 'session/src/replay', 'log/src/bound', 'browser/src/lab', 'browser/src/following'].flatMap((name) => {
    const source = (read(`../../crates/${name}.rs`).split('#[cfg(test)]')[0] ?? '').replace(/^\s*\/\/.*$/gm, '');
    return [...source.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map((found) => (found[1] ?? '').replace(/\{[^}]*\}/g, '{}'));
  }).map((text) => text.replace('allowed is {} to {} {}', 'allowed is {} to {}').replace(/^allowed is \{\} to \{\} (?:cm|rpm)$/, 'allowed is {} to {}'));
  allSpanish(texts.filter((text) => /[ :]/.test(text) && hasWords(text) && !NO_SENTENCE.includes(text)));
});

test('messages about a file that is no recording, after its name', () => {
  const source = ['log/src/error', 'browser/src/showing'].map((name) => read(`../../crates/${name}.rs`).replace(/^\s*\/\/.*$/gm, '')).join('\n');
  const texts = [...source.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map((found) => (found[1] ?? '').replace(/\{[^}]*\}/g, '{}')).filter((text) => / /.test(text) && hasWords(text));
  assert.ok(texts.length > 5, String(texts.length));
  allSpanish(texts.map((text) => (text.startsWith('{}: ') ? text : `{}: ${text}`)));
});

test('why nothing is tuned', () => {
  const displays = ['tune/error', 'tune/objective'].flatMap((name) => [...read(`../../crates/experiment/src/${name}.rs`).matchAll(/#\[error\([^]*?\)\]$/gm)].map(([part]) => part));
  const texts = [...displays, read('../../crates/experiment/src/tune/over.rs').match(/"[^"]+ sets it itself[^"]*"/)?.[0] ?? ''].flatMap((part) => [...part.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map((found) => unescaped(found[1] ?? '').replace(/\{[^}]*\}/g, '{}')));
  assert.ok(texts.length > 9, String(texts.length));
  allSpanish(texts);
});

/** Names that are the same in Spanish, and a sentence that goes with a place or without. */
const SAME = ['Serial (USB)', 'compiler: {}{}'];

test('what is said of a program at the pins, its end, the debugger and the speed of the link', () => {
  const texts = ['emulator/src/verdict', 'sim/src/mega/notes', 'sim/src/mega/wheels', 'sim/src/debugging', 'sim/src/drivers', 'session/src/watch', 'lab/src/robot/programs'].flatMap((name) => {
    const source = (read(`../../crates/${name}.rs`).split('#[cfg(test)]')[0] ?? '').replace(/^\s*\/\/.*$/gm, '').replace(/(?:unreachable!|unwrap_or_else\(\|\| panic!)\([^)]*\)/g, '');
    return [...source.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map((found) => unescaped((found[1] ?? '').replace(/\{[^}]*\}/g, '{}')));
  });
  assert.ok(texts.length > 80, String(texts.length));
  allSpanish(texts.filter((text) => / /.test(text) && hasWords(text) && !SAME.includes(text)));
});

/** Parts of such messages, which have their Spanish with the rest of the sentence, or need none. */
const WITHIN = ['not valid TOML: {}{}', '; write decimals with a point', 'must be a number{}, without quotes', ' in {}', ' or ', 'turn rate', ', or '];

/** The same of robots: the end of a sentence that has its Spanish as a whole, with and without it. */
const PART_OF_ROBOT = [', or "high" or "low" where a jumper holds it', 'must be a pin of the {}, 0 to {}, such as 5 or "A0"{}'];

test('what is wrong with a scenario, a world or an image', () => {
  const files = ['read', 'value', 'word', 'near', 'scenario/mod', 'scenario/read', 'scenario/fleet', 'commands', 'mover', 'route', 'world', 'fit', 'start'].map((name) => `experiment/src/files/${name}`);
  const texts = [...files, 'sim/src/fleet', 'lab/src/robots', 'emulator/src/image/error', 'emulator/src/image/hex'].flatMap((name) => {
    const source = (read(`../../crates/${name}.rs`).split('#[cfg(test)]')[0] ?? '').replace(/^\s*\/\/.*$/gm, '');
    return [...source.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map((found) => unescaped((found[1] ?? '').replaceAll('{{', '').replace(/\{[^}]*\}+/g, '{}')));
  });
  assert.ok(texts.length > 150, String(texts.length));
  allSpanish(texts.filter((text) => / /.test(text) && hasWords(text) && !text.includes('[[fleet]]') && !WITHIN.includes(text)));
});

test('what is asked of one\'s own robot, and what is odd or wrong about it', () => {
  const sources = ['new_asked', 'new_robot', 'robot', 'sonars', 'pin', 'parts', 'line', 'obstacle'].map((name) => (read(`../../crates/experiment/src/files/${name}.rs`).split('#[cfg(test)]')[0] ?? '').replace(/^\s*\/\/.*$/gm, ''));
  const [asked = '', made = '', ...files] = sources;
  const fields = [...asked.matchAll(/(?:label|about):\s*"((?:[^"\\]|\\.)*)"|\("\w+", "([^"]+)"\)/g)].map((found) => found[1] ?? found[2] ?? '');
  assert.ok(fields.length > 40, String(fields.length));
  const remarks = made.match(/\npub fn remarks[^]*?\n}/)?.[0] ?? '';
  const texts = [...[remarks, ...files].join('\n').matchAll(/"((?:[^"\\]|\\.)*)"/g)].map((found) => unescaped((found[1] ?? '').replaceAll('{{', '').replace(/\{[^}]*\}+/g, '{}')));
  assert.ok(texts.length > 100, String(texts.length));
  allSpanish([...fields.filter(hasWords), ...texts.filter((text) => / /.test(text) && hasWords(text) && !WITHIN.includes(text) && !PART_OF_ROBOT.includes(text))]);
});

test('titles and groups of the built-in scenarios', () => {
  const folder = new URL('../../scenarios/', import.meta.url);
  const files = readdirSync(folder).map((name) => readFileSync(new URL(name, folder), 'utf8'));
  const texts = files.flatMap((file) => ['title', 'group'].map((key) => file.match(new RegExp(`^${key} = "(.*)"$`, 'm'))?.[1] ?? `no ${key}: ${file.slice(0, 80)}`));
  assert.ok(texts.length > 100, String(texts.length));
  allSpanish(texts);
});

test('titles of the built-in worlds', () => {
  const folder = new URL('../../worlds/', import.meta.url);
  allSpanish(readdirSync(folder).map((name) => readFileSync(new URL(name, folder), 'utf8').match(/^title = "(.*)"$/m)?.[1] ?? `no title: ${name}`));
});

test('a text keeps its values in the other language, and stands in one table only', () => {
  for (const [english, spanish] of Object.entries(SPANISH)) {
    assert.ok(spanish.trim() !== '' || english.trim() === '', english);
    const places = (/** @type {string} */ text) => text.match(/\{\d?\}/g)?.length ?? 0;
    assert.equal(places(spanish), places(english), english);
  }
  const keys = TABLES.flatMap((table) => Object.keys(table));
  assert.deepEqual(keys.filter((key, index) => keys.indexOf(key) !== index), []);
});

test('Spanish has one word for one thing, lazo for a control loop, referencia, PWM a she, and says tú', () => {
  const report = ['messages', 'words'].flatMap((name) => read(`../../crates/report/content/es/${name}.md`).split('\n- '));
  const exercises = ['wall', 'speed', 'box'].flatMap((name) => read(`../../examples/assignments/${name}/assignment.toml`).split('\n'));
  const wrong = [...Object.values(SPANISH), ...report, ...exercises].filter((spanish) => /\bbucles?\b|consigna|\bordenad[ao]s?\b|\b(?:el|del|los) PWM\b|\busted\b|\b(?:compruebe|pruebe|elija|pulse|ponga|conéctelo|cárguela)\b/i.test(spanish));
  assert.deepEqual(wrong, []);
});
