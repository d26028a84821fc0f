// @ts-check
/** Writes a program to the board at a serial port: the port and the waiting around `Flasher` of `crates/browser`. */
import { openPort, pause, wordsOf } from './serial_link.js';

/** @typedef {import('./rumbo.js').Flasher} Flasher */

/** Speed of the Mega's boot loader [baud]. */
const BAUD = 115_200;
/** The flasher gets its turn at least this often [ms]. */
const TURN_MS = 20;

/**
 * Writes the flasher's program; throws the reason why it was not written, or not completely.
 * @param {string} kind of the port
 * @param {Flasher} flasher
 * @param {() => void} turn called now and then
 */
export async function flash(kind, flasher, turn) {
  const port = await openPort(kind, BAUD);
  const reader = port.readable?.getReader();
  const writer = port.writable?.getWriter();
  /** @type {string | null} */
  let lost = null;
  let wake = () => {};
  const read = async () => {
    for (let next = await reader?.read(); next && !next.done; next = await reader?.read()) {
      flasher.receive(next.value);
      wake();
    }
    throw new Error('it gives no bytes');
  };
  const reading = read().catch((error) => {
    lost = wordsOf(error);
    wake();
  });
  try {
    for (;;) {
      if (lost !== null) throw new Error(`the port is gone (${lost}): plug it in and write again`);
      turn();
      const { lines, send, done } = flasher.poll();
      if (done) return;
      // A port without these lines leaves the reset to the board's button.
      if (lines !== undefined) await port.setSignals({ dataTerminalReady: lines, requestToSend: lines }).catch(() => {});
      else if (send) await writer?.write(send).catch((error) => { lost = wordsOf(error); });
      else await Promise.race([pause(TURN_MS), new Promise((done) => { wake = () => done(null); })]);
    }
  } finally {
    await reader?.cancel().catch(() => {});
    await reading;
    await writer?.abort().catch(() => {});
    await port.close().catch(() => {});
  }
}
