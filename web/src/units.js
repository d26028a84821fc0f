// @ts-check
/** Units that people read: cm, rpm and degrees. Everything on the way from the robot is SI. */

export const RPM_PER_RAD_S = 60 / (2 * Math.PI);
export const CM_PER_M = 100;
export const DEG_PER_RAD = 180 / Math.PI;

/**
 * A number with a fixed count of decimals and a real minus sign, or a dash where there is none.
 * @param {number | null | undefined} value
 * @param {number} [decimals]
 */
export function format(value, decimals = 1) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  return value.toFixed(decimals).replace(/^-(?=.*[1-9])/, '−').replace(/^-/, '');
}

/**
 * The shortest text for a value that crossed the link as a 32-bit float.
 * @param {number | null} value
 */
export function formatFloat(value) {
  return value === null ? '' : String(Number(value.toPrecision(6)));
}
