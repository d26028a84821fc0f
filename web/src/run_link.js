// @ts-check
/**
 * A link to a run: scenario, world, sensor layout, robot, seed and parameters, after the `#` of the site's address. Nothing
 * of it is sent to the server.
 */

/**
 * What runs, as the lab takes it.
 * @typedef {object} Start
 * @property {string} [scenario]
 * @property {string} [world]
 * @property {string} [rig]
 * @property {string} [robot]
 * @property {number} [seed]
 * @property {Record<string, number>} parameters
 */

const NAMES = /** @type {const} */ (['scenario', 'world', 'rig', 'robot']);

/** What a link says, and the version of Rumbo that made it. @param {string} text @returns {{start: Start, version: string | null}} */
export function readLink(text) {
  const fields = new Map(new URLSearchParams(text.replace(/^[?#]/, '')));
  const version = fields.get('version') ?? null;
  fields.delete('version');
  /** @type {Start} */
  const start = { parameters: {} };
  for (const name of NAMES) {
    const value = fields.get(name);
    if (value) start[name] = value;
    fields.delete(name);
  }
  const seed = fields.get('seed');
  if (seed) start.seed = Number(seed);
  fields.delete('seed');
  for (const [name, value] of fields) start.parameters[name] = Number(value);
  return { start, version };
}

/**
 * The link of a run.
 * @param {string} page its address
 * @param {{scenario: string, world: string | null, rig: string | null, seed: number}} choice
 * @param {string | undefined} robot if it is another one than the scenario's
 * @param {Record<string, number>} parameters that are not at their defaults
 * @param {string} version
 */
export function writeLink(page, choice, robot, parameters, version) {
  // The sensor layout is a parameter of the robot too; the choice sets it.
  const fields = { ...parameters, ...choice, robot, version };
  const given = Object.entries(fields).flatMap(([name, value]) => (value === null || value === undefined ? [] : [[name, String(value)]]));
  const url = new URL(page);
  url.hash = new URLSearchParams(given).toString();
  return url.href;
}
