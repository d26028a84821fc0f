// @ts-check
/** Panels that can be enlarged to the whole page, and put back: by their button, or by Escape. */
import { create } from './dom.js';
import { t } from './text.js';

/** Where the button of each panel stands. */
const HOSTS = ['#map-corner', '#mode-row', '.plot-tools', '#console-section .toolbar', '#parameter-section .toolbar', '#event-section .toolbar'];

/** Gives every panel its button. */
export function makeEnlargeable() {
  const buttons = HOSTS.flatMap((host) => {
    const into = document.querySelector(host);
    const panel = into?.closest('section');
    return into && panel ? [makeButton(into, panel)] : [];
  });
  /** Enlarges one, and puts the others back. @param {Element | null} panel */
  function enlarge(panel) {
    document.querySelector('main')?.classList.toggle('enlarged', panel !== null);
    for (const { button, panel: own } of buttons) {
      const large = own === panel;
      own.classList.toggle('large', large);
      button.setAttribute('aria-pressed', String(large));
      button.title = large ? t('Put the panel back (Escape)') : t('Enlarge the panel');
      button.setAttribute('aria-label', button.title);
    }
    panel?.scrollIntoView({ block: 'nearest' });
  }
  for (const { button, panel } of buttons) button.addEventListener('click', () => enlarge(panel.classList.contains('large') ? null : panel));
  addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && !event.defaultPrevented && !document.querySelector('dialog[open]') && document.querySelector('main.enlarged')) enlarge(null);
  });
  enlarge(null);
}

/** @param {Element} into @param {HTMLElement} panel */
function makeButton(into, panel) {
  const button = create('button', { type: 'button', className: 'small enlarge', textContent: '⤢' });
  into.append(button);
  return { button, panel };
}
