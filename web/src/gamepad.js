// @ts-check
/**
 * A gamepad, polled: the left stick or the cross gives a direction while a shoulder button is held (dead-man), and the right one of the
 * four buttons (B, circle) is STOP.
 *
 * Buttons and axes are those of the browsers' standard mapping (W3C Gamepad, section 7).
 */

const POLL_MS = 50;
/** Dead band of a stick. */
const SLACK = 0.35;
const STOP_BUTTON = 1;
const DEAD_MAN = [4, 5, 6, 7];
const CROSS = { up: 12, down: 13, left: 14, right: 15 };

/**
 * @typedef {object} Stick
 * @property {number} forward -1, 0 or 1.
 * @property {number} left -1, 0 or 1.
 * @property {number} depth How far in that direction, in quarters: 0.25 to 1.
 * @property {number} ahead How far forward: -1 to 1.
 * @property {number} aside How far to the left: -1 to 1.
 */

/** @param {Gamepad} pad @returns {Stick | null} Null: nobody holds the dead-man's button, or the stick is in the middle. */
function read(pad) {
  const down = (/** @type {number} */ button) => pad.buttons[button]?.pressed ?? false;
  if (!DEAD_MAN.some(down)) return null;
  const cross = { forward: Number(down(CROSS.up)) - Number(down(CROSS.down)), left: Number(down(CROSS.left)) - Number(down(CROSS.right)) };
  if (cross.forward !== 0 || cross.left !== 0) return { ...cross, depth: 1, ahead: cross.forward, aside: cross.left };
  const [right = 0, back = 0] = pad.axes;
  const side = (/** @type {number} */ value) => (Math.abs(value) < SLACK ? 0 : -Math.sign(value));
  const stick = { forward: side(back), left: side(right) };
  const share = (/** @type {number} */ value) => side(value) * Math.min(1, (Math.abs(value) - SLACK) / (1 - SLACK));
  if (stick.forward === 0 && stick.left === 0) return null;
  return { ...stick, ahead: share(back), aside: share(right), depth: Math.min(1, Math.ceil(Math.max(Math.abs(right), Math.abs(back)) * 4) / 4) };
}

/**
 * Polls the gamepads as long as the page lives.
 * @param {(stick: Stick | null) => void} onStick called at every poll
 * @param {() => void} onStop
 */
export function watchGamepads(onStick, onStop) {
  let stopping = false;
  setInterval(() => {
    const pads = [...navigator.getGamepads()].filter((pad) => pad !== null && pad.connected);
    const stop = pads.some((pad) => pad?.buttons[STOP_BUTTON]?.pressed);
    if (stop && !stopping) onStop();
    stopping = stop;
    // A hidden page does not drive.
    const looked = document.visibilityState === 'visible' && document.hasFocus();
    onStick(looked && !stop ? pads.map((pad) => pad && read(pad)).find((stick) => stick !== null) ?? null : null);
  }, POLL_MS);
}
