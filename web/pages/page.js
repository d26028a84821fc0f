// @ts-check
/**
 * Links of a page that open the lab set to an experiment: beside the text where there is room, else in place of the page.
 * The lab is loaded when one of them is used, again for each.
 */

import { create } from '../src/dom.js';

/** Text and lab side by side, both readable. */
const wide = matchMedia('(min-width: 1080px)');
const spanish = document.documentElement.lang === 'es';
const words = spanish ? { lab: 'Laboratorio', whole: 'En toda la ventana', close: 'Cerrar' } : { lab: 'Lab', whole: 'In the whole window', close: 'Close' };

/** Lessons in Spanish have a lab in Spanish. */
function speak() {
  if (!location.pathname.includes('/lessons/')) return;
  try {
    localStorage.setItem('rumbo.language', document.documentElement.lang);
  } catch {
    // Storage is forbidden to the page: the lab speaks the browser's language.
  }
}

/** Shows the lab of a link beside the text. @param {HTMLAnchorElement} link */
function show(link) {
  document.getElementById('lab')?.remove();
  for (const each of document.querySelectorAll('a.run[aria-current]')) each.removeAttribute('aria-current');
  link.setAttribute('aria-current', 'true');
  const close = create('button', { type: 'button', textContent: words.close });
  const panel = create('aside', { id: 'lab', ariaLabel: words.lab },
    create('p', {}, create('a', { href: link.href, textContent: words.whole }), close),
    create('iframe', { title: words.lab, src: link.href }));
  close.addEventListener('click', () => {
    panel.remove();
    link.removeAttribute('aria-current');
    document.body.classList.remove('with-lab');
    link.focus();
  });
  const top = link.getBoundingClientRect().top;
  document.body.classList.add('with-lab');
  document.getElementById('desk')?.append(panel);
  // The text gets narrower: what was clicked stays where it was.
  scrollBy({ top: link.getBoundingClientRect().top - top, behavior: 'instant' });
}

for (const link of document.querySelectorAll('a.run')) {
  link.addEventListener('click', (event) => {
    speak();
    if (!(link instanceof HTMLAnchorElement) || !(event instanceof MouseEvent)) return;
    if (!wide.matches || event.ctrlKey || event.metaKey || event.shiftKey || event.button !== 0) return;
    event.preventDefault();
    show(link);
  });
}
