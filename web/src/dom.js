// @ts-check
/** Small helpers for the page's elements. */

/**
 * The element with this id, which must be of this kind.
 * @template {Element} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
export function element(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`the page has no ${kind.name} #${id}`);
  return found;
}

/**
 * A new element with these properties and children.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Partial<Omit<HTMLElementTagNameMap[K], 'style'>>} [properties]
 * @param {(Node | string)[]} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function create(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  Object.assign(made, properties);
  made.append(...children);
  return made;
}

/**
 * A new button.
 * @param {Partial<Omit<HTMLButtonElement, 'style'>>} properties
 * @param {(event: MouseEvent) => unknown} act when it is pressed
 * @param {(Node | string)[]} children
 */
export function clickable(properties, act, ...children) {
  const made = create('button', { type: 'button', ...properties }, ...children);
  made.addEventListener('click', act);
  return made;
}

/** A text with what stands between backticks as code. @param {string} text */
export const withCode = (text) => text.split('`').map((part, index) => (index % 2 === 1 ? create('code', { textContent: part }) : part));

/**
 * Writes a text only when it differs, so that nothing is laid out again without need.
 * @param {Element} target
 * @param {string} text
 */
export function setText(target, text) {
  if (target.textContent !== text) target.textContent = text;
}

/**
 * Calls back once per frame at most, after `request()`, and not at all without.
 * @param {() => void} draw
 */
export function onFrame(draw) {
  let asked = false;
  return function request() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      draw();
    });
  };
}
