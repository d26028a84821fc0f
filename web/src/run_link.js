// @ts-check
/**
 * A link to a run: scenario, world, sensor layout, robot, seed, parameters, and what was done by hand, after the `#` of the
 * site's address. Nothing of it is sent to the server.
 */

/**
 * What runs, as the lab takes it: `Start` of `crates/browser`.
 * @typedef {object} Start
 * @property {string} [scenario]
 * @property {string} [file] The file of that scenario, if it is not built in, packed by `pack` in a link.
 * @property {number} [robots] Copies of its robot.
 * @property {string | null} [world]
 * @property {string} [edited] The file of an edited world, packed by `pack` in a link.
 * @property {string | null} [rig]
 * @property {string} [robot]
 * @property {number} [seed]
 * @property {Record<string, number>} [parameters]
 * @property {string} [drive] Commands with their times.
 * @property {number} [until_s] The run was driven until then.
 * @property {string} [hash] Of the run until then.
 */

/** Some programs cut a longer address [characters]. */
export const LONGEST = 2_048;

const TEXTS = /** @type {const} */ (['scenario', 'file', 'world', 'edited', 'rig', 'robot', 'drive', 'hash']);
const NUMBERS = /** @type {const} */ (['robots', 'seed', 'until_s']);

/** What a link says, and the version of Rumbo that made it. @param {string} text @returns {{start: Start, version: string | null}} */
export function readLink(text) {
  const fields = new Map(new URLSearchParams(text.replace(/^[?#]/, '')));
  /** @param {string} name */
  const take = (name) => {
    const value = fields.get(name);
    fields.delete(name);
    return value;
  };
  const version = take('version') ?? null;
  /** @type {Start & {parameters: Record<string, number>}} */
  const start = { parameters: {} };
  for (const name of TEXTS) {
    const value = take(name);
    if (value) start[name] = value;
  }
  for (const name of NUMBERS) {
    const value = take(name);
    if (value) start[name] = Number(value);
  }
  for (const [name, value] of fields) start.parameters[name] = Number(value);
  return { start, version };
}

/** What is wrong with the numbers of a link, in words. @param {Start} start @returns {string | null} */
export function wrongNumber({ parameters, seed, robots, until_s }) {
  const numbers = Object.entries({ ...parameters, seed, robots, until_s });
  const none = numbers.find(([, value]) => value !== undefined && !Number.isFinite(value));
  if (none) return `${none[0]} is no number; write it with a decimal point`;
  const part = Object.entries({ seed, robots }).find(([, value]) => value !== undefined && !(Number.isSafeInteger(value) && value >= 0));
  return part ? `${part[0]} is no whole number from 0 on` : null;
}

/**
 * The link of a run.
 * @param {string} page its address
 * @param {{[name in keyof Start]?: Start[name] | null}} start
 * @param {string} version
 */
export function writeLink(page, start, version) {
  const { parameters, ...rest } = start;
  // The sensor layout is a parameter of the robot too; the choice sets it.
  const fields = { ...parameters, rig: null, ...rest, version };
  const given = Object.entries(fields).flatMap(([name, value]) => (value === null || value === undefined ? [] : [[name, String(value)]]));
  const url = new URL(page);
  url.hash = new URLSearchParams(given).toString();
  return url.href;
}

/** Longest text that a link unpacks to [bytes]: what the session takes. */
const MOST_UNPACKED = 100_000;

/** A text for a link, compressed: in base64 as addresses take it. @param {string} text */
export async function pack(text) {
  const packed = await bytesOf(new Blob([text]).stream().pipeThrough(new CompressionStream('deflate-raw')), Infinity);
  return btoa(String.fromCharCode(...(packed ?? []))).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

/** The text that was packed. @param {string} packed */
export async function unpack(packed) {
  const unpacked = async () => {
    const bytes = Uint8Array.from(atob(packed.replaceAll('-', '+').replaceAll('_', '/')), (each) => each.charCodeAt(0));
    return bytesOf(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw')), MOST_UNPACKED);
  };
  const bytes = await unpacked().catch(() => {
    throw new Error('a file in it is damaged; copy the whole link');
  });
  if (bytes === null) throw new Error('a file in it is too large');
  return new TextDecoder().decode(bytes);
}

/** What comes from a stream, `null` if it is more. @param {ReadableStream<Uint8Array>} stream @param {number} most */
async function bytesOf(stream, most) {
  /** @type {number[]} */
  const all = [];
  const reader = stream.getReader();
  for (let read = await reader.read(); !read.done; read = await reader.read()) {
    if (all.length + read.value.length > most) return null;
    for (const byte of read.value) all.push(byte);
  }
  return new Uint8Array(all);
}
