// @ts-check
/** Fingers on a drawing: one drags, two zoom. A mouse has its wheel and its own drag. */

/** @typedef {{x: number, y: number}} Point In the element [px]. */

/**
 * @param {HTMLElement} target
 * @param {(dx_px: number, dy_px: number) => void} onDrag
 * @param {(factor: number, about: Point) => void} onPinch `factor`: ratio of the fingers' distances
 */
export function watchFingers(target, onDrag, onPinch) {
  /** @type {Map<number, Point>} */
  const fingers = new Map();
  const where = (/** @type {PointerEvent} */ { clientX, clientY }) => {
    const { left, top } = target.getBoundingClientRect();
    return { x: clientX - left, y: clientY - top };
  };
  target.addEventListener('pointerdown', (event) => {
    if (event.pointerType === 'touch') fingers.set(event.pointerId, where(event));
  });
  target.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = where(event);
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, now);
    if (!other) return onDrag(now.x - before.x, now.y - before.y);
    const apart = (/** @type {Point} */ { x, y }) => Math.max(Math.hypot(x - other.x, y - other.y), 1);
    return onPinch(apart(now) / apart(before), { x: (now.x + other.x) / 2, y: (now.y + other.y) / 2 });
  });
  for (const type of /** @type {const} */ (['pointerup', 'pointercancel', 'pointerleave'])) target.addEventListener(type, ({ pointerId }) => fingers.delete(pointerId));
}
