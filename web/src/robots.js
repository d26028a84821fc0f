// @ts-check
/** The robots in one world, each with a session of its own: which of them the page is of. */
import { create, element } from './dom.js';

const choice = element('robot', HTMLSelectElement);
choice.addEventListener('change', () => {
  location.hash = `robot=${choice.value}`;
});

/** @param {string[]} robots @param {number} own */
export function offerRobots(robots, own) {
  choice.hidden = robots.length === 0;
  choice.replaceChildren(...robots.map((name) => create('option', { textContent: name })));
  choice.selectedIndex = own;
}

// Another robot's session begins as a page that is loaded does.
addEventListener('hashchange', () => {
  if (location.hash.startsWith('#robot=')) location.reload();
});
