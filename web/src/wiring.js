// @ts-check
/** What a robot's wiring is, without a page: its rows, what the station is asked of them, and what is on which pin. */

/** @typedef {{name: string, title: string, pins: {name: string, pwm: boolean}[]}} Board */
/** @typedef {{name: string, title: string, jumpers: boolean, needed: string[], standby: boolean}} Driver */
/** A robot to begin with. @typedef {{name: string, title: string, board: string, driver: string, pins: Record<string, string>}} Known */
/** @typedef {{boards: Board[], drivers: Driver[], known: Known[], parts: string[]}} Choices */
/** Something that has a pin: a signal, or a part of a kind. @typedef {{signal: string, kind?: string, pin: string}} Row */
/** What the station says of a plan. @typedef {{problem?: string, toml?: string, remarks?: string[], alike?: {robot: string, same: number, of: number, others: [string, string][]} | null, on?: Record<string, string>}} Answer */

/** Signals that a robot need not have. */
export const OPTIONAL = ['left_encoder', 'left_encoder_b', 'right_encoder', 'right_encoder_b', 'servo', 'front_trigger', 'front_echo', 'left_trigger', 'left_echo', 'right_trigger', 'right_echo', 'rear_trigger', 'rear_echo', 'left_fault', 'right_fault', 'link_rx', 'link_tx'];
/** Sensors of which there may be several, from left to right. */
export const SENSORS = ['line', 'obstacle', 'sharp', 'light', 'maxsonar'];
/** Where a device on the two-wire bus usually is. @type {Record<string, string>} */
const ADDRESSES = { mpu6050: '0x68', ssd1306: '0x3c', hd44780: '0x27' };

/** The rows of a driver: what it needs, and of those before what still suits. @param {Driver} driver @param {Row[]} before @returns {Row[]} */
export function rowsOf(driver, before) {
  const pinOf = (/** @type {string} */ signal) => before.find((row) => row.signal === signal)?.pin ?? '';
  const own = [...driver.needed, ...(driver.standby ? ['standby'] : [])];
  const isDrivers = (/** @type {string} */ signal) => signal === 'standby' || /^(left|right)_(?!encoder|fault)(?!.*(trigger|echo)$)/.test(signal);
  return [...own.map((signal) => ({ signal, pin: pinOf(signal) })), ...before.filter(({ signal, kind }) => kind || !isDrivers(signal))];
}

/** What can be added. @param {Row[]} rows @param {Choices} choices */
export const addable = (rows, { parts }) => [...OPTIONAL.filter((signal) => !rows.some((row) => row.signal === signal)), ...SENSORS, ...parts];

/** A new row of what can be added: sensors and parts are numbered. @param {string} what @param {Row[]} rows @returns {Row} */
export function added(what, rows) {
  if (OPTIONAL.includes(what)) return { signal: what, pin: '' };
  let number = 1;
  while (rows.some(({ signal }) => signal === `${what}_${number}`)) number++;
  const signal = `${what}_${number}`;
  return SENSORS.includes(what) ? { signal, pin: '' } : { signal, kind: what, pin: ADDRESSES[what] ?? '' };
}

/**
 * What the station is asked.
 * @param {{name: string, like: string | null, board: string, driver: string, four_wheels: boolean, battery_v: number | null}} about
 * @param {Row[]} rows
 */
export function request(about, rows) {
  const given = rows.map((row) => ({ ...row, pin: row.pin.trim() })).filter(({ pin }) => pin !== '');
  return {
    plan: {
      ...about,
      pins: given.filter(({ kind }) => !kind).map(({ signal, pin }) => [signal, pin]),
      parts: given.flatMap(({ signal, kind, pin }) => (kind ? [[signal, kind, pin]] : [])),
    },
  };
}

/** A pin's name as the board writes it; null where it is none of its pins. @param {Board} board @param {string} text */
export function pinOf({ pins }, text) {
  const name = text.trim().toUpperCase().replace(/^D(?=\d)/, '').replace(/^0+(?=\d)/, '');
  const first = pins.findIndex((pin) => pin.name.startsWith('A'));
  return (pins.find((pin) => pin.name === name) ?? (/^\d+$/.test(name) && Number(name) >= first ? pins[Number(name)] : undefined))?.name ?? null;
}

/** What is on each pin: by the rows, and what else the robot's file has there. @param {Board} board @param {Row[]} rows @param {Record<string, string>} [on] @returns {Map<string, string[]>} */
export function byPin(board, rows, on = {}) {
  /** @type {Map<string, string[]>} */
  const all = new Map();
  for (const { signal, pin } of rows) {
    const name = pinOf(board, pin);
    if (name !== null) all.set(name, [...all.get(name) ?? [], signal]);
  }
  for (const [pin, owner] of Object.entries(on)) if (!all.has(pin)) all.set(pin, [owner]);
  return all;
}

/** The ending of what a sketch is made of. */
const SOURCE = /^platformio\.ini$|\.(ino|pde|c|cc|cpp|h|hh|hpp|s)$/i;

/** Whether a sketch is made of such a file. @param {string} path */
export const isSource = (path) => SOURCE.test(path);
