// @ts-check
/** What may be said of one's own robot besides its wires: fields of the station's list, each with what is taken where nobody says it. */
import { create } from './dom.js';
import { numberAs, t } from './text.js';

/** @typedef {import('./wiring.js').Asked} Asked */

/** Units as people write them. @type {Record<string, string>} */
const UNITS = { deg: '°', count: '', 1: '' };

export class SaidForm {
  element = create('fieldset', { id: 'wire-said' }, create('legend', { textContent: t('What you know of it; the rest is as the grey figures say') }));
  /** @type {Map<string, HTMLInputElement | HTMLSelectElement>} */
  #fields = new Map();
  #changed;

  /** @param {() => void} changed */
  constructor(changed) {
    this.#changed = changed;
    this.element.hidden = true;
  }

  /** @param {Asked[]} list */
  offer(list) {
    for (const asked of list) {
      const field = this.#field(asked);
      field.id = `wire-said-${asked.key}`;
      field.addEventListener('input', this.#changed);
      this.#fields.set(asked.key, field);
      const unit = asked.range ? UNITS[asked.range[2]] ?? asked.range[2] : '';
      this.element.append(create('label', { title: t(asked.about) }, `${t(asked.label)}${unit === '' ? '' : ` [${unit}]`} `, field));
    }
  }

  /** @param {Asked} asked */
  #field({ choices, range }) {
    if (range) return create('input', { type: 'number', min: String(range[0]), max: String(range[1]), step: 'any' });
    return create('select', {}, create('option', { value: '' }), ...choices.map(([value, title]) => create('option', { value, textContent: t(title) })));
  }

  /** Which of them matter for the robot as it is, each with its usual value. @param {Record<string, string>} usual */
  show(usual) {
    this.element.hidden = Object.keys(usual).length === 0;
    for (const [key, field] of this.#fields) {
      const value = usual[key];
      const label = field.parentElement;
      if (label) label.hidden = value === undefined;
      if (value === undefined) continue;
      if (field instanceof HTMLInputElement) {
        field.placeholder = numberAs(value);
        continue;
      }
      // The usual one is the first, said by nobody.
      const [first, ...others] = field.options;
      for (const option of others) option.hidden = option.value === value;
      if (first) first.textContent = others.find((option) => option.value === value)?.textContent ?? value;
    }
  }

  /** What was said, of what matters. */
  get said() {
    const said = [...this.#fields].filter(([, field]) => field.value !== '' && !field.parentElement?.hidden);
    return Object.fromEntries(said.map(([key, field]) => [key, field.value]));
  }
}
