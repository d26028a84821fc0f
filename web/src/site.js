// @ts-check
/** What the lab has on the site only: links to the other pages. Beside a lesson it is without them, and without first steps. */
import { create, element } from './dom.js';
import { language, t } from './text.js';

/** Shown in another page of the site. */
export const isEmbedded = window.top !== window;

/** Links to the site's other pages, in the reader's language where they have it; within one of them, a layout without them. */
export function linkPages() {
  document.body.classList.toggle('embedded', isEmbedded);
  if (isEmbedded) return;
  const pages = [
    [t('Lessons'), `docs/lessons/${language}/`],
    [t('Guides'), language === 'es' ? 'README.es.html#para-seguir-leyendo' : 'README.html#where-to-read-on'],
    [t('Theory'), 'docs/theory/'],
  ];
  const links = pages.map(([textContent, href]) => create('a', { textContent, href }));
  element('brand', HTMLDivElement).append(create('nav', { id: 'pages', ariaLabel: t('Pages') }, ...links));
}
