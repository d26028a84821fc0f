// @ts-check
/**
 * Finds words in the index of the site's pages. Accents and capitals make no difference, a word is found by its beginning
 * and in its other forms; what has all words of a query comes before what has some, and rare words count more.
 */

/** A heading's anchor, the heading, and the text below it. @typedef {[string, string, string]} Section */
/** Address from the site's root, title, language, whether the page is there in the other language too. @typedef {[string, string, string, boolean, Section[]]} Page */
/** @typedef {{address: string, title: string, heading: string, text: string, language: string, folded: {title: string, heading: string, text: string}, weight: number}} Entry */
/** @typedef {{address: string, title: string, heading: string, excerpt: string, language: string}} Found */

/** What a word counts in a heading, the more if it is all of a word there, in a page's title, and each time in a text, up to so often. */
const [IN_HEADING, WHOLE, IN_TITLE, MOST_IN_TEXT] = [8, 4, 2, 5];
/** What another form of the word counts instead of 1. */
const OTHER_FORM = 0.7;
/** Pages for who builds on Rumbo, after those for who uses it. */
const LATER = /^(?:CHANGELOG|CONTRIBUTING|ARCHITECTURE|docs\/adr\/|api\/)/;
const [LATER_WEIGHT, OTHER_LANGUAGE_WEIGHT] = [0.3, 0.6];
const [MOST, MOST_OF_A_PAGE] = [12, 3];
/** An excerpt begins so many characters before the first word found, and has so many. */
const [BEFORE, LONG] = [50, 170];

/** Small letters without accents; of the same length, so that places in it are places in the text. @param {string} text */
export function fold(text) {
  return text.replace(/[^\0-\x7f]/g, (sign) => {
    const plain = sign.normalize('NFD').replace(/\p{M}/gu, '').toLowerCase();
    return plain.length === 1 ? plain : sign;
  }).replace(/[A-Z]/g, (letter) => letter.toLowerCase());
}

/**
 * The searchable entries for a reader of this language: of pages in both languages, the reader's.
 * @param {Page[]} pages
 * @param {string} language
 * @returns {Entry[]}
 */
export function entriesOf(pages, language) {
  return pages.flatMap(([page, title, own, translated, sections]) => {
    if (own !== language && translated) return [];
    const weight = (LATER.test(page) ? LATER_WEIGHT : 1) * (own === language ? 1 : OTHER_LANGUAGE_WEIGHT);
    return sections.map(([anchor, heading, text], index) => ({
      // A page's first heading is at its top.
      address: index === 0 ? page : `${page}#${anchor}`, title, heading: heading || title, text, language: own, weight,
      folded: { title: fold(title), heading: fold(heading || title), text: fold(text) },
    }));
  });
}

/** A word as it was typed, folded, and what it has in common with its other forms. @typedef {{word: string, stem: string}} Term */
/** Where a word stands, its length, and whether it is the one typed or begins with it, or only another form. @typedef {{at: number, length: number, exact: boolean}} Place */

/** Endings of English and Spanish words; what is left of a word has so many letters at least. */
const ENDING = /(?:a?ciones|a?cion|iones|ions?|ings?|ed|e?s|[aei]r|[aeoy])$/;
const SHORTEST_STEM = 4;
const LETTER = /[\p{L}\p{N}]/u;

/** The words of a query. @param {string} query @returns {Term[]} */
export function termsOf(query) {
  const words = fold(query).split(/\s+/).map((word) => word.replace(/^[^\p{L}\p{N}]+|[^\p{L}\p{N}]+$/gu, '')).filter(Boolean);
  return [...new Set(words)].map((word) => {
    const stem = word.replace(ENDING, '');
    return { word, stem: stem.length < SHORTEST_STEM ? word : stem };
  });
}

/** Where a text has these words, in order. @param {string} folded @param {Term[]} terms */
export function placesOf(folded, terms) {
  /** @type {Place[]} */
  const places = [];
  for (const { word, stem } of terms) {
    for (let at = folded.indexOf(stem); at >= 0; at = folded.indexOf(stem, at + stem.length)) {
      if (at > 0 && LETTER.test(folded.charAt(at - 1))) continue;
      const exact = folded.startsWith(word, at);
      let end = at + (exact ? word : stem).length;
      while (end < folded.length && LETTER.test(folded.charAt(end))) end++;
      places.push({ at, length: end - at, exact });
    }
  }
  return places.sort((one, other) => one.at - other.at);
}

/** What a word counts in an entry; 0: it is not there. @param {Entry} entry @param {Term} term */
function worth({ folded }, term) {
  const count = (/** @type {Place} */ { exact }) => (exact ? 1 : OTHER_FORM);
  const best = (/** @type {Place[]} */ places) => Math.max(0, ...places.map(count));
  const heading = placesOf(folded.heading, [term]);
  const whole = heading.some(({ length, exact }) => exact && length === term.word.length);
  const text = placesOf(folded.text, [term]).slice(0, MOST_IN_TEXT).reduce((sum, place) => sum + count(place), 0);
  return IN_HEADING * best(heading) + (whole ? WHOLE : 0) + IN_TITLE * best(placesOf(folded.title, [term])) + text;
}

/**
 * The best entries for a query.
 * @param {Entry[]} entries
 * @param {string} query
 * @returns {Found[]}
 */
export function find(entries, query) {
  const terms = termsOf(query);
  const worths = terms.map((term) => entries.map((entry) => worth(entry, term)));
  // A word says the more, the fewer entries have it (inverse document frequency, as in BM25); one that is nowhere says nothing.
  const tells = worths.map((each) => {
    const count = each.filter((value) => value > 0).length;
    return count === 0 ? 0 : Math.log(1 + (entries.length - count + 0.5) / (count + 0.5));
  });
  const all = tells.reduce((sum, each) => sum + each, 0);
  const judged = entries.map((entry, index) => {
    let [has, score] = [0, 0];
    worths.forEach((each, term) => {
      const [value, told] = [each[index] ?? 0, tells[term] ?? 0];
      score += value * told;
      if (value > 0) has += told;
    });
    // All words of a query before some of them.
    return { entry, score: score === 0 ? 0 : entry.weight * score * (has / all) ** 2 };
  });
  const best = judged.filter(({ score }) => score > 0).sort((one, other) => other.score - one.score);
  /** @type {Map<string, number>} */
  const ofPage = new Map();
  const shown = best.filter(({ entry }) => {
    const page = entry.address.replace(/#.*/, '');
    const count = (ofPage.get(page) ?? 0) + 1;
    ofPage.set(page, count);
    return count <= MOST_OF_A_PAGE;
  });
  // What tells the most is in the excerpt.
  const rarest = terms.toSorted((one, other) => (tells[terms.indexOf(other)] ?? 0) - (tells[terms.indexOf(one)] ?? 0));
  return shown.slice(0, MOST).map(({ entry: { address, title, heading, text, language, folded } }) => {
    const first = rarest.flatMap((term) => placesOf(folded.text, [term]))[0];
    return { address, title, heading, language, excerpt: excerpt(text, first?.at ?? 0) };
  });
}

/** A piece of a text around this place. @param {string} text @param {number} at */
function excerpt(text, at) {
  const wanted = Math.max(0, at - BEFORE);
  // Whole words.
  const begin = wanted === 0 ? 0 : text.indexOf(' ', wanted) + 1;
  const end = text.length <= begin + LONG ? text.length : text.lastIndexOf(' ', begin + LONG);
  return (begin > 0 ? '… ' : '') + text.slice(begin, Math.max(end, begin + BEFORE)) + (end < text.length ? ' …' : '');
}
