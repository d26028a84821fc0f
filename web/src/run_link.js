// @ts-check
/**
 * A link to a run: scenario, world, sensor layout, robot, seed, parameters, and what was done by hand, after the `#` of the
 * site's address. Nothing of it is sent to the server.
 */

/**
 * What runs, as the lab takes it: `Start` of `crates/browser`.
 * @typedef {object} Start
 * @property {string} [scenario]
 * @property {string} [world]
 * @property {string} [rig]
 * @property {string} [robot]
 * @property {number} [seed]
 * @property {Record<string, number>} parameters
 * @property {string} [drive] Commands with their times.
 * @property {number} [until_s] The run was driven until then.
 * @property {string} [hash] Of the run until then.
 */

/** Some programs cut a longer address [characters]. */
export const LONGEST = 2_048;

const TEXTS = /** @type {const} */ (['scenario', 'world', 'rig', 'robot', 'drive', 'hash']);
const NUMBERS = /** @type {const} */ (['seed', 'until_s']);

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
  /** @type {Start} */
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
