// @ts-check
/** Which serial port is opened, and what is sent there. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { SerialLink, openPort } from '../lab/serial_link.js';
import { choosePort, kindOf, nameOf } from '../src/serial_ports.js';

const MEGA = { usbVendorId: 0x2341, usbProductId: 0x42 };
const OTHER = { usbVendorId: 0x1A86, usbProductId: 0x7523 };

/** A port as browsers give it, that notes what is done with it; its line takes nothing while `stuck`. @param {import('../src/serial_ports.js').PortInfo} info */
function port(info) {
  const made = {
    done: /** @type {string[]} */ ([]),
    written: /** @type {number[]} */ ([]),
    stuck: false,
    getInfo: () => info,
    readable: /** @type {ReadableStream<Uint8Array> | null} */ (null),
    writable: /** @type {WritableStream<Uint8Array> | null} */ (null),
    setSignals: async () => {},
    forget: async () => { made.done.push('forget'); },
    open: async () => {
      made.done.push('open');
      made.readable = new ReadableStream({ cancel: () => { made.readable = null; } });
      made.writable = new WritableStream({
        write: async (bytes) => {
          while (made.stuck) await new Promise((again) => setTimeout(again, 10));
          made.written.push(...bytes);
        },
      });
    },
    close: async () => { made.done.push('close'); },
  };
  return made;
}

/** The browser has these ports, and a person chooses the last one. @param {ReturnType<typeof port>[]} ports */
function browser(...ports) {
  const chosen = ports.at(-1);
  assert.ok(chosen);
  const serial = { getPorts: async () => ports, requestPort: async () => chosen };
  Object.defineProperty(globalThis, 'navigator', { value: { serial }, configurable: true });
  return serial;
}

test('ports have the names of their devices', () => {
  assert.deepEqual([MEGA, { bluetoothServiceClassId: '00001101' }, {}].map((info) => nameOf(port(info))), ['USB 2341:0042', 'Bluetooth', 'serial']);
  assert.notEqual(kindOf(port(MEGA)), kindOf(port(OTHER)));
});

test('of two ports of a kind the one that was chosen is kept, and those of other kinds are', async () => {
  const [before, other, chosen] = [port(MEGA), port(OTHER), port(MEGA)];
  assert.equal(await choosePort(browser(before, other, chosen)), chosen);
  assert.deepEqual([before.done, other.done, chosen.done], [['forget'], [], []]);
});

test('of two ports of a kind none is opened: the robot might be another one', async () => {
  const [first, second] = [port(MEGA), port(MEGA)];
  browser(first, second);
  await assert.rejects(openPort(kindOf(first), 9_600), /there are two of the kind/);
  assert.deepEqual([first.done, second.done], [[], []]);
  await assert.rejects(openPort(kindOf(port(OTHER)), 9_600), /does not offer it/);
});

test('what a line does not take in time is dropped, not sent late', async () => {
  const line = port(MEGA);
  browser(line);
  const link = new SerialLink(kindOf(line), 9_600, () => {}, () => {});
  await link.open();
  line.stuck = true;
  link.send(Uint8Array.of(1));
  await new Promise((done) => setTimeout(done, 200));
  link.send(Uint8Array.of(2));
  line.stuck = false;
  while (line.written.length < 1) await new Promise((again) => setTimeout(again, 10));
  await new Promise((done) => setTimeout(done, 50));
  link.send(Uint8Array.of(3));
  while (line.written.length < 2) await new Promise((again) => setTimeout(again, 10));
  assert.deepEqual(line.written, [1, 3]);
  await link.close();
  assert.equal(line.done.at(-1), 'close');
});
