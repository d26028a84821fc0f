// @ts-check
/**
 * The serial ports that the browser has for pages (Web Serial), for the page, which may ask for one, and for its worker,
 * which drives the robot at it. A port has no name in a browser: one that was granted is found again by what it says of
 * itself.
 *
 * @typedef {object} PortInfo What a port says of itself: the device of a USB port, the service of a Bluetooth port.
 * @property {number} [usbVendorId]
 * @property {number} [usbProductId]
 * @property {number | string} [bluetoothServiceClassId]
 *
 * @typedef {object} SerialPort A port, as browsers give it.
 * @property {() => PortInfo} getInfo
 * @property {(options: {baudRate: number, bufferSize: number}) => Promise<void>} open
 * @property {() => Promise<void>} close
 * @property {() => Promise<void>} forget
 * @property {(signals: {dataTerminalReady?: boolean, requestToSend?: boolean}) => Promise<void>} setSignals
 * @property {ReadableStream<Uint8Array> | null} readable
 * @property {WritableStream<Uint8Array> | null} writable
 *
 * @typedef {{getPorts: () => Promise<SerialPort[]>, requestPort: () => Promise<SerialPort>}} Serial
 */

/** Held by the page that drives a robot: one at a time in a browser, and browsers do not freeze a page that holds one. */
export const LOCK = 'rumbo-robot';

/** The browser's serial ports; undefined where it has none. @returns {Serial | undefined} */
export const serial = () => /** @type {any} */ (navigator).serial;

/** What a port is known by. @param {SerialPort} port */
export function kindOf(port) {
  const { usbVendorId, usbProductId, bluetoothServiceClassId } = port.getInfo();
  return JSON.stringify([usbVendorId ?? null, usbProductId ?? null, bluetoothServiceClassId ?? null]);
}

/** What a port is called in messages. @param {SerialPort} port */
export function nameOf(port) {
  const { usbVendorId, usbProductId, bluetoothServiceClassId } = port.getInfo();
  const hex = (/** @type {number | undefined} */ id) => (id ?? 0).toString(16).padStart(4, '0');
  if (usbVendorId !== undefined) return `USB ${hex(usbVendorId)}:${hex(usbProductId)}`;
  return bluetoothServiceClassId === undefined ? 'serial' : 'Bluetooth';
}

/** A port that a person chooses; others that cannot be distinguished from it are given back. @param {Serial} ports */
export async function choosePort(ports) {
  const port = await ports.requestPort();
  const granted = await ports.getPorts();
  await Promise.all(granted.filter((each) => each !== port && kindOf(each) === kindOf(port)).map((each) => each.forget()));
  return port;
}

/** Throws where another page uses a port: that would be given back, if the one chosen here is of its kind. */
export async function noOtherDrives() {
  const { held } = await navigator.locks.query();
  if (held?.some(({ name }) => name === LOCK)) throw new Error('another page of this browser drives a robot: go back to its lab first');
}
