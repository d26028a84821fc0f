// @ts-check
/**
 * avr8js, the AVR in JavaScript of Wokwi's simulators, with the clock and the PWM of an Arduino Mega: to compare the speed of
 * ours with.
 */
import { readFile } from 'node:fs/promises';
import { extname } from 'node:path';

/** Where a page finds it, below the site. */
const BELOW = 'avr8js/';

/** Gives a page of the site the package's files; its modules name each other without an ending. @param {import('playwright-core').Page} page */
export function serveAvr8js(page) {
  return page.route(`**/${BELOW}**`, async (route) => {
    const [, path = ''] = new URL(route.request().url()).pathname.split(BELOW);
    const file = new URL(`../node_modules/avr8js/dist/esm/${path}${extname(path) ? '' : '.js'}`, import.meta.url);
    await route.fulfill({ body: await readFile(file), contentType: 'text/javascript' });
  });
}

/**
 * Runs a program for an ATmega2560 at 16 MHz, in a page. Gives how often it has written to port B, which shows that it runs.
 * @param {import('playwright-core').Page} page
 * @param {Buffer} program the flash from its beginning
 * @param {number} seconds of the chip
 * @returns {Promise<number>}
 */
export function runAvr8js(page, program, seconds) {
  return page.evaluate(async ({ below, data, seconds }) => {
    const { CPU, AVRTimer, avrInstruction, timer1Config } = await import(new URL(`${below}index.js`, location.href).href);
    const FLASH_WORDS = 0x2_0000;
    const RAM_END = 0x2200;
    /** Its registers and RAM, less what avr8js adds. */
    const ram = RAM_END - 0x100;
    const flash = new Uint16Array(FLASH_WORDS);
    new Uint8Array(flash.buffer).set(Uint8Array.from(atob(data), (each) => each.charCodeAt(0)));
    const cpu = new CPU(flash, ram);
    // A 16-bit timer of the ATmega2560: its registers from here on, its flags, its mask, its first vector in words.
    const timer = (/** @type {number} */ at, /** @type {number} */ TIFR, /** @type {number} */ TIMSK, /** @type {number} */ vector) => new AVRTimer(cpu, {
      ...timer1Config, TCCRA: at, TCCRB: at + 1, TCCRC: at + 2, TCNT: at + 4, ICR: at + 6, OCRA: at + 8, OCRB: at + 10, OCRC: at + 12, TIFR, TIMSK,
      captureInterrupt: vector, compAInterrupt: vector + 2, compBInterrupt: vector + 4, compCInterrupt: vector + 6, ovfInterrupt: vector + 8, OCFC: 8, OCIEC: 8,
    });
    timer(0x80, 0x36, 0x6F, 0x20);
    timer(0x90, 0x38, 0x71, 0x3E);
    timer(0xA0, 0x39, 0x72, 0x52);
    const PORTB = 0x25;
    let writes = 0;
    cpu.writeHooks[PORTB] = () => {
      writes += 1;
      return false;
    };
    const end = seconds * 16e6;
    while (cpu.cycles < end) {
      avrInstruction(cpu);
      cpu.tick();
    }
    return writes;
  }, { below: BELOW, data: program.toString('base64'), seconds });
}
