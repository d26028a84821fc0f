// @ts-check
/** What a light or a buzzer at the robot's pins shows. */

/** The words for what a part shows. @param {import('./types.js').Part} part @param {(signal: string) => number | null} now @returns {[string, number]} */
export function shownOf({ name, kind }, now) {
  const level = now(`pin_${name}_${kind}`) ?? 0;
  if (kind !== 'buzzer') return [`${Math.round(100 * level)} %`, level];
  const hz = now(`${name}_hz`) ?? 0;
  return hz > 0 ? [`${Math.round(hz)} Hz`, 1] : [`${Math.round(100 * level)} %`, level];
}
