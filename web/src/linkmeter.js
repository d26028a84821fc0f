// @ts-check
/** The link: its load, its losses, and the bytes themselves, frame by frame. */
import { create, element, setText } from './dom.js';
import { t } from './text.js';
import { format } from './units.js';

/** @typedef {import('./types.js').State} State */
/** @typedef {import('./types.js').LinkBytes} LinkBytes */

/** Clock error beyond that of a ceramic resonator [ppm]. */
const WRONG_CLOCK_PPM = 10_000;
/** Lines kept of the bytes. */
const KEPT = 400;
/** Bytes of a frame that are shown. */
const SHOWN = 24;
/** Names of the frames, by their kind (docs/protocol.md). @type {Record<number, string>} */
const KINDS = { 1: 'HELLO', 2: 'telemetry', 3: 'status', 4: 'event', 5: 'acknowledgement', 6: 'heading', 8: 'HELLO', 9: 'heartbeat', 10: 'command', 11: 'velocity' };

export class LinkMeter {
  #figures = element('link-figures', HTMLDListElement);
  #bytes = element('link-bytes', HTMLPreElement);
  #hold = element('link-hold', HTMLInputElement);
  /** @type {Map<string, HTMLElement>} */
  #values = new Map();
  /** @type {string[]} */
  #lines = [];
  /** The incomplete frame in each direction. @type {[number[], number[]]} */
  #open = [[], []];
  #seen = false;
  /** What stands there while there are no bytes. */
  #nothing = '';

  /** It is visible. @param {boolean} seen */
  show(seen) {
    this.#seen = seen;
    if (seen) this.#write();
  }

  /** @param {State} state */
  update({ link, robot, replay }) {
    const nothing = replay ? t('The bytes stand in the log; a replay does not show them.') : '';
    if (nothing !== this.#nothing) {
      this.#nothing = nothing;
      this.#write();
    }
    /** @type {[string, string, boolean][]} */
    const figures = [
      [t('telemetry'), `${format(link.telemetry_hz)} Hz`, false],
      [t('round trip'), link.round_trip_ms === null ? '–' : `${link.round_trip_ms} ms`, false],
      [t('load from the robot'), `${format(link.down_load * 100, 0)} % · ${format(link.down_load * link.baud / 10, 0)} B/s`, link.down_load > 0.98],
      [t('load to the robot'), `${format(link.up_load * 100, 0)} % · ${format(link.up_load * link.baud / 10, 0)} B/s`, link.up_load > 0.9],
      [t('speed of the line'), `${link.baud} baud`, false],
      [t('CRC errors from, to the robot'), `${link.crc_errors_down} | ${link.crc_errors_up}`, link.crc_errors_down + link.crc_errors_up > 0],
      [t('frames missing'), String(link.frames_lost), link.frames_lost > 0],
      [t('dropped: link full'), String(link.dropped), link.dropped > 0],
      [t('commands unconfirmed'), String(link.unacknowledged), link.unacknowledged > 0],
      [t('control ticks late'), String(robot.overruns), robot.overruns > 0],
      [t('robot started at'), link.clock_offset_ms === undefined ? t('as the station') : `${format(link.clock_offset_ms / 1e3, 2)} s`, false],
      [t('robot\'s clock'), link.clock_fast_ppm === undefined ? '–' : t(link.clock_fast_ppm < 0 ? '{} ppm slow' : '{} ppm fast', Math.abs(link.clock_fast_ppm)), Math.abs(link.clock_fast_ppm ?? 0) > WRONG_CLOCK_PPM],
    ];
    for (const [name, text, wrong] of figures) {
      const value = this.#values.get(name) ?? this.#figure(name);
      setText(value, text);
      value.classList.toggle('wrong', wrong);
    }
  }

  /** @param {string} name */
  #figure(name) {
    const value = create('dd');
    this.#figures.append(create('div', {}, create('dt', { textContent: name }), value));
    this.#values.set(name, value);
    return value;
  }

  clear() {
    this.#lines = [];
    this.#open = [[], []];
    this.#write();
  }

  /** @param {LinkBytes[]} said */
  add(said) {
    for (const { t_s, to_robot, hex } of said) {
      const open = this.#open[to_robot ? 1 : 0];
      for (let at = 0; at < hex.length; at += 2) {
        const byte = parseInt(hex.slice(at, at + 2), 16);
        open.push(byte);
        if (byte === 0 || (byte === 10 && open.every(isText))) {
          if (open.length > 1) this.#lines.push(line(t_s, to_robot, open));
          open.length = 0;
        }
      }
      if (open.length > 200) open.length = 0;
    }
    this.#lines.splice(0, this.#lines.length - KEPT);
    this.#write();
  }

  #write() {
    if (!this.#seen || this.#hold.checked) return;
    const atEnd = this.#bytes.scrollHeight - this.#bytes.scrollTop - this.#bytes.clientHeight < 30;
    this.#bytes.textContent = this.#lines.join('\n') || this.#nothing;
    if (atEnd) this.#bytes.scrollTop = this.#bytes.scrollHeight;
  }
}

/** @param {number} byte */
function isText(byte) {
  return (byte >= 32 && byte < 127) || byte === 10 || byte === 13 || byte === 9;
}

/** @param {number} t_s @param {boolean} toRobot @param {number[]} bytes */
function line(t_s, toRobot, bytes) {
  const where = `${format(t_s, 3).padStart(9)} ${toRobot ? '→' : '←'}`;
  if (bytes.every(isText)) return `${where} ${String.fromCharCode(...bytes).trimEnd()}`;
  const hex = bytes.slice(0, SHOWN).map((byte) => byte.toString(16).padStart(2, '0')).join(' ');
  return `${where} ${kind(bytes).padEnd(10)} ${hex}${bytes.length > SHOWN ? ' …' : ''}`;
}

/** What kind of frame it is: the high half of the first byte after COBS's own. @param {number[]} bytes */
function kind(bytes) {
  const header = bytes[0] === 1 ? 0 : bytes[1] ?? 0;
  return t(KINDS[header >> 4] ?? 'unknown');
}
