// @ts-check
/** A real robot at a serial port of the browser, on the site: the dialog that begins it, and the line that ends it. */
import { complaint, dialog, wordsOf } from './dialog.js';
import { create, element, setText } from './dom.js';
import { FlashForm } from './flash_form.js';
import { choosePort, kindOf, nameOf, noOtherDrives, serial } from './serial_ports.js';
import { said, t } from './text.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./serial_ports.js').SerialPort} SerialPort */
/** @typedef {import('./worker_link.js').PortNews} PortNews */

/**
 * The port of a robot to be driven.
 * @typedef {object} Wanted
 * @property {string} kind By which the worker finds it.
 * @property {string} name For messages.
 * @property {number} baud
 * @property {boolean} text The robot runs the original program.
 */

/** The speed of the robot's Bluetooth module, then those of others [baud]. */
const SPEEDS = [9_600, 19_200, 38_400, 57_600, 115_200];

export class RobotPort {
  #ask;
  #dialog = dialog('robot-dialog', t('A real robot'));
  #speed = create('select', { id: 'port-speed' });
  #text = create('input', { type: 'checkbox', id: 'port-text' });
  #connect = create('button', { type: 'button', id: 'port-connect', className: 'go', textContent: t('Choose a port…') });
  #complaint = complaint();
  #bar = element('robot-port', HTMLDivElement);
  #name = element('port-name', HTMLElement);
  #choose = element('port-choose', HTMLButtonElement);

  /** @type {FlashForm | null} */
  #flash = null;

  /** @param {(what: {connect: Wanted} | {choose: string} | {flash: import('./flash_form.js').Program} | 'leave') => void} ask asks the worker */
  constructor(ask) {
    this.#ask = ask;
    const begins = element('real-robot', HTMLButtonElement);
    begins.hidden = !isSite;
    if (!isSite) return;
    begins.addEventListener('click', () => this.#open());
    this.#speed.append(...SPEEDS.map((baud) => create('option', { value: String(baud), textContent: String(baud) })));
    this.#connect.addEventListener('click', () => this.#try(this.#begin));
    this.#choose.addEventListener('click', () => this.#try(this.#chooseAnother));
    element('port-end', HTMLButtonElement).addEventListener('click', () => this.#ask('leave'));
    const hints = [
      t('Drives a robot at a serial port of this computer: its Bluetooth module, once the computer is paired with it, or a cable. The simulated robot waits meanwhile.'),
      t('Connecting does not switch the robot on: ON does. Rumbo\'s program stops it within half a second when the port is gone or this page is closed.'),
    ];
    this.#dialog.body.append(...hints.map((textContent) => create('p', { textContent })));
    const why = whyNot();
    if (why !== null) {
      this.#dialog.body.append(create('p', { className: 'complaint', id: 'port-missing', textContent: why }));
      return;
    }
    this.#dialog.body.append(
      create('div', { className: 'row' }, create('label', {}, `${t('speed of the line')} `, this.#speed, ' baud'), create('label', {}, this.#text, ` ${t('it runs the original program, which is silent until ON, and drives on when the port is gone')}`)),
      create('div', { className: 'row' }, this.#connect), this.#complaint);
    this.#flash = new FlashForm((program) => ask({ flash: program }));
    this.#dialog.body.append(this.#flash.body);
  }

  #open() {
    setText(this.#complaint, '');
    this.#dialog.open();
    this.#connect.focus();
  }

  /** Says what went wrong. @param {(ports: import('./serial_ports.js').Serial) => Promise<void>} work */
  async #try(work) {
    const ports = serial();
    if (!ports) return;
    setText(this.#complaint, '');
    this.#connect.disabled = true;
    try {
      await work.call(this, ports);
    } catch (error) {
      setText(this.#complaint, wordsOf(error));
      this.#connect.disabled = false;
    }
  }

  /** @param {import('./serial_ports.js').Serial} ports */
  async #begin(ports) {
    await noOtherDrives();
    const port = await choosePort(ports);
    this.#ask({ connect: { kind: kindOf(port), name: nameOf(port), baud: Number(this.#speed.value), text: this.#text.checked } });
  }

  /** @param {import('./serial_ports.js').Serial} ports */
  async #chooseAnother(ports) {
    this.#ask({ choose: kindOf(await choosePort(ports)) });
  }

  /** @param {PortNews} news */
  show(news) {
    if ('flashed' in news) return this.#flash?.show(news.flashed);
    this.#connect.disabled = false;
    if ('refused' in news) return setText(this.#complaint, said(news.refused));
    if ('back' in news) {
      this.#choose.hidden = news.back !== null;
      this.#name.classList.toggle('bad', news.back === null);
      if (news.back !== null) setText(this.#name, t('port {}', news.back));
      return undefined;
    }
    document.body.classList.toggle('at-port', news.port !== null);
    this.#bar.hidden = news.port === null;
    this.#choose.hidden = true;
    this.#name.classList.remove('bad');
    setText(this.#name, t('port {}', news.port ?? ''));
    if (news.port !== null) this.#dialog.dialog.close();
    return undefined;
  }
}

/** Why this browser has no serial ports for the page, or null. */
function whyNot() {
  if (serial()) return null;
  if (!isSecureContext) return t('Browsers have serial ports only for pages that come over HTTPS or from this computer.');
  return t('This browser has no serial ports for pages (Web Serial). Chrome, Edge and Opera on a computer have them; elsewhere `rumbo connect` drives the robot.');
}
