// @ts-check
/** Dialogs over the page, and files to and from the reader's computer. */
import { clickable, create } from './dom.js';
import { said, t } from './text.js';

/**
 * A dialog with a title and a button that closes it; Escape closes it too. The page around it stays active: STOP is never
* covered or disabled.
 * @param {string} id
 * @param {string} title
 */
export function dialog(id, title) {
  const close = create('button', { type: 'button', className: 'small', textContent: t('Close') });
  const heading = create('h2', { textContent: title, id: `${id}-title` });
  const body = create('div', { className: 'dialog-body' });
  const made = create('dialog', { id }, create('div', { className: 'row toolbar' }, heading, create('span', { className: 'spacer' }), close), body);
  made.setAttribute('aria-labelledby', heading.id);
  close.addEventListener('click', () => made.close());
  addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !made.open || event.defaultPrevented) return;
    event.preventDefault();
    made.close();
  });
  /** What had the focus before. @type {Element | null} */
  let opener = null;
  made.addEventListener('close', () => {
    if (opener instanceof HTMLElement) opener.focus();
  });
  document.body.append(made);
  /** Opens it in front of all others. */
  const open = () => {
    opener = document.activeElement;
    document.body.append(made);
    if (!made.open) made.show();
  };
  return { dialog: made, body, heading, open };
}

/** A dialog's line for what went wrong. */
export function complaint() {
  const line = create('output', { className: 'complaint' });
  line.setAttribute('role', 'alert');
  return line;
}

/** A button that copies a text. @param {string} text */
export function copyButton(text) {
  const button = clickable({ className: 'small', textContent: t('Copy') }, () => navigator.clipboard.writeText(text).then(() => { button.textContent = t('copied'); }, () => {}));
  return button;
}

/** What went wrong, for such a line. @param {unknown} error */
export function wordsOf(error) {
  if (error instanceof DOMException && error.name === 'NotFoundError') return t('no port was chosen');
  return error instanceof Error ? said(error.message) : String(error);
}

/**
 * Offers a file for download.
 * @param {string} name
 * @param {Blob} content
 */
export function saveFile(name, content) {
  const url = URL.createObjectURL(content);
  create('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/**
 * A button that opens a file of the reader's, or several at once.
 * @param {string} text
 * @param {string} accept
 * @param {(file: File, all: File[]) => void} taken
 */
export function fileButton(text, accept, taken, multiple = false) {
  const input = create('input', { type: 'file', accept, multiple, hidden: true });
  const button = clickable({ textContent: text }, () => input.click());
  input.addEventListener('change', () => {
    const files = [...input.files ?? []];
    if (!files[0]) return;
    // The same file can be opened again.
    input.value = '';
    taken(files[0], files);
  });
  return create('span', {}, button, input);
}
