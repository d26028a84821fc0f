// @ts-check
/** A video, WebM, of the map while a replay goes through the time that the plots show, at the replay's speed. */
import { saveFile } from './dialog.js';
import { element, setText } from './dom.js';
import { t } from './text.js';
import { colours } from './theme.js';
import { format } from './units.js';

const FRAMES_PER_S = 30;
/** Enough for lines on a plain ground [bit/s]. */
const BITS_PER_S = 4_000_000;
/** After the last instant, for the frame that shows it [ms]. */
const TAIL_MS = 200;

export class Video {
  #button = element('replay-video', HTMLButtonElement);
  #map = element('map', HTMLCanvasElement);
  #replay;
  #range;
  /** `runs`: the replay goes through it. @type {{recorder: MediaRecorder, to_s: number, runs: boolean} | null} */
  #made = null;
  #t_s = 0;

  /** @param {import('./replay.js').ReplayBar} replay @param {() => [number, number]} range what the plots show [s] */
  constructor(replay, range) {
    this.#replay = replay;
    this.#range = range;
    this.#button.hidden = typeof MediaRecorder === 'undefined';
    this.#button.addEventListener('click', () => (this.#made ? this.#end() : this.#begin()));
  }

  /** @param {import('./types.js').State} state */
  show({ t_s, replay, speed }) {
    this.#t_s = t_s;
    if (!this.#made) return;
    this.#made.runs ||= speed > 0;
    // Closed, over, or paused by a hand.
    if (!replay || (this.#made.runs && (t_s >= this.#made.to_s || speed === 0))) this.#end();
  }

  #begin() {
    const [from_s, to_s] = this.#range();
    const canvas = document.createElement('canvas');
    const [width, height] = [canvas.width, canvas.height] = [this.#map.width & ~1, this.#map.height & ~1];
    const context = canvas.getContext('2d', { alpha: false });
    if (!context) return;
    const recorder = new MediaRecorder(canvas.captureStream(FRAMES_PER_S), { videoBitsPerSecond: BITS_PER_S });
    /** @type {Blob[]} */
    const parts = [];
    const name = `${element('replay-name', HTMLSpanElement).textContent?.replace(/\.mcap$/, '')}-${from_s.toFixed(1)}-${to_s.toFixed(1)}.webm`;
    recorder.addEventListener('dataavailable', ({ data }) => parts.push(data));
    recorder.addEventListener('stop', () => saveFile(name, new Blob(parts, { type: 'video/webm' })));
    const draw = () => {
      if (recorder.state === 'inactive') return;
      context.fillStyle = colours.panel;
      context.fillRect(0, 0, width, height);
      context.drawImage(this.#map, 0, 0);
      context.fillStyle = colours.text;
      context.font = `${13 * devicePixelRatio}px system-ui, sans-serif`;
      context.fillText(`${format(this.#t_s, 2)} s`, 8 * devicePixelRatio, 20 * devicePixelRatio);
      requestAnimationFrame(draw);
    };
    this.#made = { recorder, to_s, runs: false };
    setText(this.#button, t('Stop the video'));
    this.#replay.seek(from_s);
    this.#replay.play(true);
    recorder.start();
    draw();
  }

  #end() {
    const { recorder } = this.#made ?? {};
    this.#made = null;
    setText(this.#button, t('Video'));
    this.#replay.play(false);
    setTimeout(() => recorder?.stop(), TAIL_MS);
  }
}
