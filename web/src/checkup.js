// @ts-check
/**
 * Evaluation of a robot's first check, from measurements and a person's answers: plain functions, tested one by one.
 *
 * The encoders have one channel each: they count, but do not measure the direction. So the page measures which of them
 * count while one wheel is driven, and a person answers which wheel turned, and in which direction.
 */
import { t } from './text.js';

/** @typedef {'left' | 'right'} Side */
/** @typedef {'forward' | 'backward' | 'other' | 'none'} Seen What a person saw of the wheel that was driven. */
/** @typedef {{good: boolean, text: string}} Verdict */

/** A wheel that turns slower than this stands [rpm]. */
export const STANDING_RPM = 6;
/** A hand before a sonar [cm]. */
export const HAND_CM = /** @type {[number, number]} */ ([3, 40]);

/** @param {string} text @returns {Verdict} */
const good = (text) => ({ good: true, text });
/** @param {string} text @returns {Verdict} */
const bad = (text) => ({ good: false, text });

/**
 * Which encoders counted while one wheel was driven.
 * @param {Side} side
 * @param {number} left_rpm the largest speed of the left encoder, without sign
 * @param {number} right_rpm
 * @returns {'own' | 'other' | 'both' | 'none'}
 */
export function counted(side, left_rpm, right_rpm) {
  const [own, other] = side === 'left' ? [left_rpm, right_rpm] : [right_rpm, left_rpm];
  if (own >= STANDING_RPM && other >= STANDING_RPM) return 'both';
  return own >= STANDING_RPM ? 'own' : other >= STANDING_RPM ? 'other' : 'none';
}

/**
 * What is wrong with a motor and its encoder, and what to swap.
 * @param {Side} side
 * @param {'own' | 'other' | 'both' | 'none'} count
 * @param {Seen} seen
 * @returns {Verdict}
 */
export function judgeMotor(side, count, seen) {
  const wheel = side === 'left' ? t('left|wheel') : t('right|wheel');
  if (seen === 'none') {
    return count === 'none'
      ? bad(t('The {} wheel does not turn. See that the battery is on, that the driver has its supply and its enable wire, and that the motor\'s two wires are tight.', wheel))
      : bad(t('An encoder counts, although no wheel turns: its signal picks up noise. See its ground wire and keep it away from the motors\' wires.'));
  }
  if (seen === 'other') {
    return count === 'own'
      ? bad(t('Motors and encoders are both exchanged. Swap the two motors at the driver, and the two encoders\' signal wires.'))
      : bad(t('The two motors are exchanged. Swap them at the driver\'s outputs.'));
  }
  if (count === 'other') return bad(t('The two encoders are exchanged. Swap their signal wires at the Mega.'));
  if (count === 'none') return bad(t('The {} encoder is silent. See its supply, its signal wire, and the gap between its sensor and its disc.', wheel));
  if (count === 'both') return bad(t('Both encoders count, although one wheel is driven. See that the other wheel hangs free, and the encoders\' ground wires.'));
  if (seen === 'backward') return bad(t('The {} wheel turns backward. Swap the two wires of its motor at the driver.', wheel));
  return good(t('The {} wheel turns forward, and its encoder counts.', wheel));
}

/** Turns of a wheel by hand, and what the program counts in one. */
export const TURNS = 10;
export const EDGES_PER_TURN = 384;
/** Part of the turns by which a person is wrong at most. */
const MISCOUNTED = 0.06;

/**
 * How far a wheel turned by what its program shows.
 * @param {ArrayLike<number>} t \[s\]
 * @param {ArrayLike<number | null | undefined>} rpm
 * @param {number} from index
 */
export function turned(t, rpm, from) {
  let turns = 0;
  for (let at = Math.max(from, 1); at < t.length; at++) turns += Math.abs(rpm[at] ?? 0) / 60 * ((t[at] ?? 0) - (t[at - 1] ?? 0));
  return turns;
}

/** What ten turns by hand say of gears and encoder. @param {Side} side @param {number} turns as they were counted @returns {Verdict} */
export function judgeTurns(side, turns) {
  const wheel = side === 'left' ? t('left|wheel') : t('right|wheel');
  if (turns < 0.1) return bad(t('The {} encoder is silent. See its supply, its signal wire, and the gap between its sensor and its disc.', wheel));
  const edges = Math.round(EDGES_PER_TURN * turns / TURNS);
  if (Math.abs(turns / TURNS - 1) <= MISCOUNTED) return good(t('Gears and encoder of the {} wheel are as the program counts them, {} edges in a turn.', wheel, EDGES_PER_TURN));
  return bad(t('A turn of the {} wheel gives some {} edges, and the program counts with {}: distances and speeds are wrong by that. See the gear ratio of its motor and the poles of its disc, and whether both edges of a pulse are counted.', wheel, edges, EDGES_PER_TURN));
}

/**
 * Result of a hand in front of a sonar; null: keep waiting.
 * @param {number} sonar 0 left, 1 right, 2 front
 * @param {(number | 'clear' | null)[]} ranges_cm of all, as they are now
 * @param {(number | 'clear' | null)[]} before_cm as they were before the hand
 * @returns {Verdict | null}
 */
export function judgeSonar(sonar, ranges_cm, before_cm) {
  const near = (/** @type {number | 'clear' | null | undefined} */ range) => typeof range === 'number' && range >= HAND_CM[0] && range <= HAND_CM[1];
  const names = [t('left|sonar'), t('right|sonar'), t('front|sonar')];
  if (near(ranges_cm[sonar])) return good(t('The {} sonar sees the hand.', names[sonar] ?? ''));
  const other = ranges_cm.findIndex((range, index) => index !== sonar && near(range) && !near(before_cm[index]));
  if (other >= 0) return bad(t('The {} sonar sees the hand instead of the {} one. Swap their trigger and echo wires.', names[other] ?? '', names[sonar] ?? ''));
  return null;
}

/** Verdict on a sonar that does not detect the hand. @param {number} sonar @param {number | 'clear' | null} range_cm @returns {Verdict} */
export function sonarInVain(sonar, range_cm) {
  const name = [t('left|sonar'), t('right|sonar'), t('front|sonar')][sonar] ?? '';
  return range_cm === null
    ? bad(t('The {} sonar gives no reading. See its 5 V supply, its trigger wire and its echo wire.', name))
    : bad(t('The {} sonar does not see the hand. Check that it points where it should, and that nothing is in its beam.', name));
}

/** What is to be done about the servo. @param {'ahead' | 'left' | 'right'} seen @returns {Verdict} */
export function judgeServo(seen) {
  if (seen === 'ahead') return good(t('The servo looks straight ahead.'));
  return bad(t(seen === 'left' ? 'The servo looks to the left. Take its horn off and put it back a tooth further to the right.' : 'The servo looks to the right. Take its horn off and put it back a tooth further to the left.'));
}

/** @param {{connected: boolean, telemetry_hz: number, crc_errors_down: number, crc_errors_up: number}} link @returns {Verdict} */
export function judgeLink(link) {
  if (!link.connected) return bad(t('The robot does not answer. See its power, the cable, and that the speed of the line is the same at both ends.'));
  if (link.telemetry_hz < 15) return bad(t('Telemetry comes {} times a second, 25 are expected. The line is too slow, or bytes are lost.', link.telemetry_hz));
  if (link.crc_errors_down + link.crc_errors_up > 20) return bad(t('{} frames were damaged. See the ground wire between robot and adapter, and the distance of a Bluetooth module.', link.crc_errors_down + link.crc_errors_up));
  return good(t('The link works: telemetry {} times a second.', link.telemetry_hz));
}
