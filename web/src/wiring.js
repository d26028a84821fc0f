// @ts-check
/** What a robot's wiring is, without a page: its rows, what the station is asked of them, and what is on which pin. */

/** @typedef {{name: string, title: string, pins: {name: string, pwm: boolean}[]}} Board */
/** @typedef {{name: string, title: string, jumpers: boolean, needed: string[], standby: boolean}} Driver */
/** A robot to begin with. @typedef {{name: string, title: string, board: string, driver: string, pins: Record<string, string>}} Known */
/** What may be said of a robot: a choice, or a number within a range, of a unit. @typedef {{key: string, label: string, about: string, choices: [string, string][], range: [number, number, string] | null}} Asked */
/** @typedef {{boards: Board[], drivers: Driver[], known: Known[], parts: string[], asked: Asked[]}} Choices */
/** Something that has a pin: a signal, or a part of a kind; of a sensor also where it is, `x:y:angle`, in m and degrees. @typedef {{signal: string, kind?: string, pin: string, place?: string}} Row */
/** What the station says of a plan. @typedef {{problem?: string, toml?: string, remarks?: string[], alike?: {robot: string, same: number, of: number, others: [string, string][]} | null, on?: Record<string, string>, asked?: Record<string, string>, places?: Record<string, string>}} Answer */

/** @param {string} name @returns {[string, string[]]} */
const sonar = (name) => [`${name}_sonar`, [`${name}_trigger`, `${name}_echo`]];
/** What a robot need not have, and the signals of its wires. @type {Map<string, string[]>} */
export const OPTIONAL = new Map([
  ['servo', ['servo']],
  ...['front', 'left', 'right', 'rear'].map(sonar),
  ['link', ['link_rx', 'link_tx']],
  ['encoders', ['left_encoder', 'right_encoder']],
  ['encoders_b', ['left_encoder_b', 'right_encoder_b']],
  ['battery', ['battery']],
  ['faults', ['left_fault', 'right_fault']],
]);
/** A sonar of another name is ahead until somebody says where. */
const SONAR = 'other_sonar';
const AHEAD = '0.11:0:0';
/** Sensors of which there may be several, from left to right. */
export const SENSORS = ['line', 'obstacle', 'sharp', 'light', 'maxsonar'];
/** Where a device on the two-wire bus usually is. @type {Record<string, string>} */
const ADDRESSES = { mpu6050: '0x68', vl53l0x: '0x29', qmc5883l: '0x0d', hmc5883l: '0x1e', ssd1306: '0x3c', hd44780: '0x27' };

/** The rows of a driver: what it needs, and of those before what still suits. @param {Driver} driver @param {Row[]} before @returns {Row[]} */
export function rowsOf(driver, before) {
  const pinOf = (/** @type {string} */ signal) => before.find((row) => row.signal === signal)?.pin ?? '';
  const own = [...driver.needed, ...(driver.standby ? ['standby'] : [])];
  const isDrivers = (/** @type {string} */ signal) => signal === 'standby' || /^(left|right)_(?!encoder|fault)(?!.*(trigger|echo)$)/.test(signal);
  return [...own.map((signal) => ({ signal, pin: pinOf(signal) })), ...before.filter(({ signal, kind }) => kind || !isDrivers(signal))];
}

/** What can be added. @param {Row[]} rows @param {Choices} choices */
export const addable = (rows, { parts }) => [...[...OPTIONAL].filter(([, signals]) => signals.some((own) => !rows.some(({ signal }) => signal === own))).map(([what]) => what), SONAR, ...SENSORS, ...parts];

/** New rows of what can be added: sensors and parts are numbered. @param {string} what @param {Row[]} rows @returns {Row[]} */
export function added(what, rows) {
  const has = (/** @type {string} */ own) => rows.some(({ signal }) => signal === own);
  const signals = OPTIONAL.get(what);
  if (signals) return signals.filter((signal) => !has(signal)).map((signal) => ({ signal, pin: '' }));
  let number = 1;
  const name = what === SONAR ? 'sonar' : what;
  while (has(`${name}_${number}`) || has(`${name}_${number}_trigger`)) number++;
  const signal = `${name}_${number}`;
  if (what === SONAR) return [{ signal: `${signal}_trigger`, pin: '', place: AHEAD }, { signal: `${signal}_echo`, pin: '' }];
  return [SENSORS.includes(what) ? { signal, pin: '' } : { signal, kind: what, pin: ADDRESSES[what] ?? '' }];
}

/** The sensor that a row's place is of, null where it has none. @param {Row} row */
export function sensorOf({ signal, kind }) {
  if (kind) return null;
  return /^(?:line|obstacle|sharp)_/.test(signal) ? signal : signal.match(/^(.+)_trigger$/)?.[1] ?? null;
}

/**
 * What the station is asked.
 * @param {{name: string, like: string | null, board: string, driver: string, said: Record<string, string>}} about
 * @param {Row[]} rows
 */
export function request(about, rows) {
  const given = rows.map((row) => ({ ...row, pin: row.pin.trim() })).filter(({ pin }) => pin !== '');
  return {
    plan: {
      ...about,
      pins: given.filter(({ kind }) => !kind).map(({ signal, pin }) => [signal, pin]),
      places: given.flatMap((row) => (row.place?.trim() ? [`${sensorOf(row)}=${row.place.replace(/,/g, '.')}`] : [])),
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
