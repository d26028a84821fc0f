// @ts-check
/**
 * The first check of a robot, step by step, its wheels in the air: the link, each motor with its encoder, each sonar, the servo. A step is
 * judged by what is measured, and by what a person sees where nothing can measure it.
 */
import { STANDING_RPM, TURNS, counted, judgeLink, judgeMotor, judgeServo, judgeSonar, judgeTurns, sonarInVain, turned } from './checkup.js';
import { dialog } from './dialog.js';
import { clickable, create } from './dom.js';
import { keep, recall } from './stored.js';
import { t } from './text.js';
import { CM_PER_M, format } from './units.js';

/** @typedef {import('./checkup.js').Verdict} Verdict */
/** @typedef {import('./checkup.js').Side} Side */
/** @typedef {import('./panel.js').Send} Send */
/** @typedef {{title: string, run: () => void}} Step */

/** A wheel is driven for this long, with the command repeated [ms]. */
const DRIVE_MS = 1_600;
/** From then on it is measured [ms]. */
const SPEED_UP_MS = 600;
/** Time for a wheel to come to rest before [ms]. */
const STAND_MS = 4_000;
const REPEAT_MS = 200;
/** Share of full PWM: beyond every dead zone. */
const DUTY = 0.4;
/** The movements that turn one wheel forward. @type {Record<Side, number>} */
const ONE_WHEEL = { left: 7, right: 5 };
/** Time to wait for a hand [ms]. */
const HAND_MS = 15_000;
const LOOK_MS = 100;

export class CheckupDialog {
  #send;
  #store;
  #state;
  #made = dialog('checkup-dialog', t('Check the robot'));
  #list = create('ol', { className: 'steps' });
  #ask = create('div', { className: 'stack', id: 'checkup-step' });
  /** @type {Step[]} */
  #steps = [];
  #at = 0;
  /** @type {(Verdict | null)[]} */
  #verdicts = [];
  /** What runs while a step does; ends with the step. @type {ReturnType<typeof setInterval> | null} */
  #timer = null;

  /**
   * @param {Send} send
   * @param {import('./store.js').Store} store
   * @param {() => import('./types.js').State | null} state
   */
  constructor(send, store, state) {
    this.#send = send;
    this.#store = store;
    this.#state = state;
    this.#made.body.append(this.#list, this.#ask);
    this.#made.dialog.addEventListener('close', () => this.#leave());
  }

  /** Opens by itself the first time that this browser shows a real robot. @param {number[]} sonars @param {boolean} servo */
  meet(sonars, servo) {
    const state = this.#state();
    if (!state || state.simulated || state.replay || state.robot.foreign || state.robot.text || !state.link.connected || recall('checkup') !== null) return;
    this.open(sonars, servo);
  }

  /** @param {number[]} sonars that the robot carries, by number @param {boolean} servo it carries one, with a sonar on it */
  open(sonars, servo) {
    keep('checkup', 'offered');
    const names = [t('left|sonar'), t('right|sonar'), t('front|sonar')];
    this.#steps = [
      { title: t('Wheels in the air'), run: () => this.#begin() },
      { title: t('Link'), run: () => this.#verdict(judgeLink(/** @type {import('./types.js').State} */ (this.#state()).link)) },
      { title: t('Left motor and encoder'), run: () => this.#motor('left') },
      { title: t('Right motor and encoder'), run: () => this.#motor('right') },
      { title: t('Turns of the left wheel'), run: () => this.#turns('left') },
      { title: t('Turns of the right wheel'), run: () => this.#turns('right') },
      ...sonars.map((sonar) => ({ title: t('Sonar: {}', names[sonar] ?? ''), run: () => this.#sonar(sonar) })),
      ...(servo ? [{ title: t('Servo'), run: () => this.#servo() }] : []),
    ];
    this.#verdicts = this.#steps.map(() => null);
    this.#at = 0;
    this.#made.open();
    this.#run();
  }

  #run() {
    this.#stopTimer();
    this.#list.replaceChildren(...this.#steps.map(({ title }, index) => {
      const verdict = this.#verdicts[index];
      const mark = verdict ? (verdict.good ? '✓ ' : '✕ ') : '';
      const line = create('li', { className: `${index === this.#at ? 'now' : ''} ${verdict ? (verdict.good ? 'passed' : 'failed') : ''}`, textContent: mark + title });
      if (index === this.#at) line.setAttribute('aria-current', 'step');
      return line;
    }));
    const step = this.#steps[this.#at];
    if (step) step.run();
    else this.#summary();
  }

  /** @param {string} text @param {...HTMLElement} more */
  #say(text, ...more) {
    this.#ask.replaceChildren(create('p', { textContent: text }), ...more);
  }

  /** @param {[string, () => void][]} answers */
  #buttons(...answers) {
    return create('div', { className: 'row' }, ...answers.map(([text, act], index) => clickable({ textContent: text, className: index === 0 ? 'go' : '' }, act)));
  }

  /** Shows what a step found, and what can be done then. @param {Verdict} verdict */
  #verdict(verdict) {
    this.#stopTimer();
    this.#verdicts[this.#at] = verdict;
    const on = () => {
      this.#at += 1;
      this.#run();
    };
    const again = () => this.#run();
    this.#say(verdict.text, verdict.good ? this.#buttons([t('Next'), on]) : this.#buttons([t('Again'), again], [t('Next'), on]));
    this.#ask.firstElementChild?.classList.add(verdict.good ? 'passed' : 'failed');
  }

  #begin() {
    this.#say(t('Put the robot on a block so that both wheels hang free. The page arms the robot and turns one wheel at a time; STOP works at any moment.'),
      this.#buttons([t('The wheels hang free'), () => {
        this.#verdicts[this.#at] = { good: true, text: '' };
        this.#at += 1;
        this.#run();
      }]));
  }

  /** @param {Side} side */
  #motor(side) {
    const wheel = side === 'left' ? t('left|wheel') : t('right|wheel');
    this.#say(t('The {} wheel will turn forward for a moment. Watch it.', wheel), this.#buttons([t('Turn it'), () => this.#drive(side)]));
  }

  /** @param {Side} side */
  #drive(side) {
    this.#say(t('turning…'));
    if (this.#state()?.robot.mode !== 0) {
      if (this.#state()?.robot.armed) this.#send({ type: 'disarm' });
      this.#send({ type: 'mode', mode: 0 });
    }
    if (this.#state()?.robot.fault) this.#send({ type: 'clear_fault' });
    if (!this.#state()?.robot.armed) this.#send({ type: 'arm' });
    let [waited_ms, driven_ms, from_s] = [0, 0, 0];
    this.#timer = setInterval(() => {
      // A wheel still turning from before must not be counted.
      waited_ms += REPEAT_MS;
      const standing = Math.max(this.#most('left_rpm', this.#now_s() - 0.2), this.#most('right_rpm', this.#now_s() - 0.2)) < STANDING_RPM;
      if (driven_ms === 0 && !standing && waited_ms < STAND_MS) return;
      driven_ms += REPEAT_MS;
      if (driven_ms === SPEED_UP_MS) from_s = this.#now_s();
      if (driven_ms <= DRIVE_MS) return this.#send({ type: 'move_duty', movement: ONE_WHEEL[side], duty: DUTY, held: true });
      this.#send({ type: 'move_duty', movement: 0, duty: 0 });
      return this.#seen(side, from_s);
    }, REPEAT_MS);
  }

  #now_s() {
    return this.#store.slow.t.at(-1) ?? 0;
  }

  /** The most of a signal since then, without sign. @param {string} name @param {number} from_s */
  #most(name, from_s) {
    const table = this.#store.tableOf(name);
    const values = (table.columns.get(name) ?? []).slice(table.indexAt(from_s));
    return values.reduce((/** @type {number} */ most, value) => Math.max(most, Math.abs(value ?? 0)), 0);
  }

  /** @param {Side} side @param {number} from_s */
  #seen(side, from_s) {
    this.#stopTimer();
    const [left_rpm, right_rpm] = [this.#most('left_rpm', from_s), this.#most('right_rpm', from_s)];
    const count = counted(side, left_rpm, right_rpm);
    const judge = (/** @type {import('./checkup.js').Seen} */ seen) => this.#verdict(judgeMotor(side, count, seen));
    const wheel = side === 'left' ? t('left|wheel') : t('right|wheel');
    this.#say(t('The encoders counted: left up to {} rpm, right up to {} rpm. What did you see?', format(left_rpm, 0), format(right_rpm, 0)),
      this.#buttons([t('the {} wheel turned forward', wheel), () => judge('forward')], [t('the {} wheel turned backward', wheel), () => judge('backward')],
        [t('the other wheel turned'), () => judge('other')], [t('no wheel turned'), () => judge('none')], [t('Again'), () => this.#drive(side)]));
  }

  /** Ten turns by hand tell edges and gears. @param {Side} side */
  #turns(side) {
    if (this.#state()?.robot.armed) this.#send({ type: 'disarm' });
    const wheel = side === 'left' ? t('left|wheel') : t('right|wheel');
    const count = () => {
      const from_s = this.#now_s();
      this.#say(t('Turn the {} wheel by hand, {} whole turns one way in about ten seconds.', wheel, TURNS), this.#buttons([t('It has turned'), () => {
        const table = this.#store.tableOf(`${side}_rpm`);
        this.#verdict(judgeTurns(side, turned(table.t, table.columns.get(`${side}_rpm`) ?? [], table.indexAt(from_s))));
      }]));
    };
    const on = () => {
      this.#at += 1;
      this.#run();
    };
    this.#say(t('Mark a place of the {} tyre: its turns are counted.', wheel), this.#buttons([t('Count'), count], [t('Skip'), on]));
  }

  #ranges() {
    return (this.#store.latest?.ranges_m ?? [null, null, null]).map((range) => (typeof range === 'number' ? range * CM_PER_M : range));
  }

  /** @param {number} sonar */
  #sonar(sonar) {
    const name = [t('left|sonar'), t('right|sonar'), t('front|sonar')][sonar] ?? '';
    const before = this.#ranges();
    const reading = create('output');
    this.#say(t('Hold a hand 10 to 30 cm before the {} sonar.', name), reading, this.#buttons([t('Skip'), () => {
      this.#at += 1;
      this.#run();
    }]));
    let passed_ms = 0;
    let agreed = 0;
    this.#timer = setInterval(() => {
      passed_ms += LOOK_MS;
      const now = this.#ranges();
      reading.textContent = now.map((range, each) => `${[t('left'), t('right'), t('front')][each]} ${range === 'clear' ? t('clear|sonar') : typeof range === 'number' ? `${format(range, 0)} cm` : '–'}`).join('   ');
      const verdict = judgeSonar(sonar, now, before);
      agreed = verdict ? agreed + 1 : 0;
      // Half a second, so that a passing hand is not mistaken for one that is held.
      if (verdict && agreed >= 5) this.#verdict(verdict);
      else if (passed_ms >= HAND_MS) this.#verdict(sonarInVain(sonar, now[sonar] ?? null));
    }, LOOK_MS);
  }

  #servo() {
    this.#say(t('The servo is commanded straight ahead, {}°. Where does the front sonar look?', format((this.#store.latest?.servo_rad ?? 0) * 180 / Math.PI, 0)),
      this.#buttons([t('straight ahead'), () => this.#verdict(judgeServo('ahead'))], [t('to the left'), () => this.#verdict(judgeServo('left'))], [t('to the right'), () => this.#verdict(judgeServo('right'))]));
  }

  #summary() {
    const wrong = this.#verdicts.filter((verdict) => verdict && !verdict.good);
    const lines = create('ul', {}, ...wrong.map((verdict) => create('li', { className: 'failed', textContent: verdict?.text ?? '' })));
    const again = this.#buttons([t('Close'), () => this.#made.dialog.close()], [t('Begin again'), () => {
      this.#verdicts = this.#steps.map(() => null);
      this.#at = 0;
      this.#run();
    }]);
    this.#send({ type: 'disarm' });
    if (wrong.length > 0) this.#say(t('There is something to put right:'), lines, again);
    else this.#say(t('All that was checked works. Put the robot on the floor, and calibrate it.'), again);
  }

  #stopTimer() {
    if (this.#timer !== null) clearInterval(this.#timer);
    this.#timer = null;
  }

  /** Nothing keeps turning when the page is left. */
  #leave() {
    this.#stopTimer();
    if (this.#state()?.robot.armed) this.#send({ type: 'disarm' });
  }
}
