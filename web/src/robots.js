// @ts-check
/** The robots in one world, each with a session of its own: which of them the page is of. */
import { create, element } from './dom.js';
import { t } from './text.js';

/** @param {string[]} robots @param {number} own */
export function offerRobots(robots, own) {
  const list = element('robots', HTMLDivElement);
  list.hidden = robots.length === 0;
  list.replaceChildren(...robots.map((name, index) => {
    const button = create('button', { type: 'button', className: 'small', textContent: name, title: t('Drive this robot; STOP stops all of them') });
    button.setAttribute('aria-pressed', String(index === own));
    button.addEventListener('click', () => {
      location.hash = `robot=${name}`;
    });
    return button;
  }));
}

// Another robot's session begins as a page that is loaded does.
addEventListener('hashchange', () => {
  if (location.hash.startsWith('#robot=')) location.reload();
});
