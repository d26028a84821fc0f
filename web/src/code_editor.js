// @ts-check
/**
 * An editor of C++ in a pane: CodeMirror, loaded when it is first needed, with breakpoints in its gutter and the line at which a
 * debugger stands. In a shadow root, where its style sheets are allowed without the page's being any.
 */
import * as cm from '../vendor/codemirror/codemirror.js';
import { create } from './dom.js';
import { t } from './text.js';

/** @typedef {{line: number, column: number | null, text: string}} Problem Lines and columns from 1. */

/** Sets the breakpoints of a file, by line. */
const setBreakpoints = cm.StateEffect.define();
/** The line at which the program stands; null: none. */
const setStand = cm.StateEffect.define();

const breakpointMark = new class extends cm.GutterMarker {
  toDOM() {
    return create('span', { className: 'breakpoint', textContent: '●' });
  }
}();

const breakpoints = cm.StateField.define({
  create: () => cm.RangeSet.empty,
  update(/** @type {any} */ set, /** @type {any} */ change) {
    for (const effect of change.effects) {
      if (!effect.is(setBreakpoints)) continue;
      const { doc } = change.state;
      const lines = effect.value.filter((/** @type {number} */ line) => line <= doc.lines);
      return cm.RangeSet.of(lines.map((/** @type {number} */ line) => breakpointMark.range(doc.line(line).from)), true);
    }
    return set.map(change.changes);
  },
});

const stand = cm.StateField.define({
  create: () => cm.Decoration.none,
  update(/** @type {any} */ set, /** @type {any} */ change) {
    for (const effect of change.effects) {
      if (!effect.is(setStand)) continue;
      const { doc } = change.state;
      if (effect.value === null || effect.value > doc.lines) return cm.Decoration.none;
      return cm.Decoration.set([cm.Decoration.line({ class: 'stands' }).range(doc.line(effect.value).from)]);
    }
    return set.map(change.changes);
  },
  provide: (/** @type {any} */ field) => cm.EditorView.decorations.from(field),
});

const THEME = cm.EditorView.theme({
  '&': { height: '100%', color: 'var(--text)', backgroundColor: 'var(--field)', fontSize: '13px' },
  '&.cm-focused': { outline: '2px solid var(--left)', outlineOffset: '-2px' },
  '.cm-scroller': { fontFamily: 'ui-monospace, monospace', lineHeight: '1.45' },
  '.cm-content': { caretColor: 'var(--text)' },
  '.cm-gutters': { backgroundColor: 'var(--panel)', color: 'var(--dim)', borderRight: '1px solid var(--line)' },
  '.cm-activeLine': { backgroundColor: 'color-mix(in srgb, var(--grid) 55%, transparent)' },
  '.cm-activeLineGutter': { backgroundColor: 'var(--grid)' },
  '.cm-content ::selection': { backgroundColor: 'color-mix(in srgb, var(--left) 40%, transparent)' },
  '.cm-breakpoints .cm-gutterElement': { minWidth: '1.3em', textAlign: 'center', cursor: 'pointer' },
  '.cm-breakpoints': { minWidth: '1.3em' },
  '.breakpoint': { color: 'var(--bad)' },
  // Its own marks are images, which the page may not load.
  '.cm-lintRange-error': { backgroundImage: 'none', textDecoration: 'underline wavy var(--bad)' },
  '.cm-lint-marker-error': { content: 'normal' },
  '.cm-lint-marker-error::before': { content: '"▲"', color: 'var(--bad)', fontSize: '11px' },
  '.stands': { backgroundColor: 'color-mix(in srgb, var(--warning) 32%, transparent) !important' },
  '.cm-panels, .cm-tooltip': { backgroundColor: 'var(--panel)', color: 'var(--text)', border: '1px solid var(--line)' },
  '.cm-textfield, .cm-button': { backgroundColor: 'var(--field)', backgroundImage: 'none', color: 'inherit', border: '1px solid var(--edge)' },
  '.value': { padding: '3px 7px', fontFamily: 'ui-monospace, monospace', whiteSpace: 'pre-wrap', maxWidth: '46ch' },
  '.cm-searchMatch, .cm-selectionMatch': { backgroundColor: 'color-mix(in srgb, var(--right) 30%, transparent)' },
});

const COLOURS = cm.syntaxHighlighting(cm.HighlightStyle.define([
  { tag: [cm.tags.keyword, cm.tags.controlKeyword, cm.tags.modifier], color: 'var(--left)' },
  { tag: [cm.tags.typeName, cm.tags.standard(cm.tags.name)], color: 'var(--front)' },
  { tag: [cm.tags.number, cm.tags.bool, cm.tags.character], color: 'var(--right)' },
  { tag: cm.tags.string, color: 'var(--warning)' },
  { tag: [cm.tags.processingInstruction, cm.tags.macroName, cm.tags.special(cm.tags.name)], color: 'var(--goal)' },
  { tag: cm.tags.comment, color: 'var(--dim)', fontStyle: 'italic' },
  { tag: cm.tags.function(cm.tags.definition(cm.tags.variableName)), fontWeight: '600' },
]));

/** CodeMirror's own words. */
const phrases = () => Object.fromEntries([
  ['Find', t('Find')], ['Replace', t('Replace')], ['next', t('next|search')], ['previous', t('previous|search')], ['all', t('all|search')],
  ['match case', t('match case')], ['by word', t('whole words')], ['regexp', t('regular expression')], ['replace', t('replace|search')],
  ['replace all', t('replace all')], ['close', t('Close')], ['Go to line', t('Go to line')], ['go', t('go|line')],
]);

export class CodeEditor {
  #view;
  /** Every file's state, by its name. @type {Map<string, any>} */
  #states = new Map();
  #name = '';
  #extensions;

  /**
   * @param {HTMLElement} host
   * @param {{changed: () => void, breakpoints: () => void, valueOf: (expression: string) => Promise<string | null>}} on
   */
  constructor(host, on) {
    // What is typed here is no command of the page's.
    host.addEventListener('keydown', (event) => event.stopPropagation());
    const toggle = (/** @type {any} */ view, /** @type {{from: number}} */ { from }) => {
      const line = view.state.doc.lineAt(from).number;
      const lines = linesOf(view.state);
      view.dispatch({ effects: setBreakpoints.of(lines.includes(line) ? lines.filter((each) => each !== line) : [...lines, line]) });
      on.breakpoints();
      return true;
    };
    this.#extensions = [
      breakpoints, stand, cm.gutter({
        class: 'cm-breakpoints', markers: (/** @type {any} */ view) => view.state.field(breakpoints),
        initialSpacer: () => breakpointMark, domEventHandlers: { mousedown: toggle },
      }),
      cm.lineNumbers({ domEventHandlers: { mousedown: toggle } }), cm.lintGutter(), cm.highlightActiveLine(), cm.highlightActiveLineGutter(), cm.history(),
      cm.bracketMatching(), cm.indentOnInput(), cm.indentUnit.of('  '), cm.cpp(), cm.search({ top: true }), cm.highlightSelectionMatches(), THEME, COLOURS,
      cm.EditorState.phrases.of(phrases()), cm.EditorView.contentAttributes.of({ 'aria-label': t('Source; Escape, then Tab leaves it'), tabindex: '0' }),
      cm.keymap.of([
        { key: 'F9', run: (/** @type {any} */ view) => toggle(view, view.state.selection.main) },
        ...cm.searchKeymap, ...cm.historyKeymap, ...cm.defaultKeymap, cm.indentWithTab,
      ]),
      cm.hoverTooltip(async (/** @type {any} */ view, /** @type {number} */ at) => {
        const word = view.state.wordAt(at);
        const value = word && await on.valueOf(view.state.sliceDoc(word.from, word.to));
        return value ? { pos: word.from, end: word.to, above: true, create: () => ({ dom: create('div', { className: 'value', textContent: value }) }) } : null;
      }),
      cm.EditorView.updateListener.of((/** @type {any} */ update) => {
        if (update.docChanged) on.changed();
      }),
    ];
    const root = host.attachShadow({ mode: 'open' });
    this.#view = new cm.EditorView({ parent: root, root });
  }

  /** Other files, of which the first is shown. @param {{name: string, text: string}[]} files */
  setFiles(files) {
    this.#states = new Map(files.map(({ name, text }) => [name, cm.EditorState.create({ doc: text, extensions: this.#extensions })]));
    this.#name = files[0]?.name ?? '';
    this.#view.setState(this.#states.get(this.#name) ?? cm.EditorState.create());
  }

  /** All files as they are now. @returns {{name: string, text: string}[]} */
  get files() {
    this.#keep();
    return [...this.#states].map(([name, state]) => ({ name, text: state.doc.toString() }));
  }

  /** The file that is shown. */
  get name() {
    return this.#name;
  }

  #keep() {
    if (this.#states.has(this.#name)) this.#states.set(this.#name, this.#view.state);
  }

  /** @param {string} name */
  show(name) {
    if (name === this.#name || !this.#states.has(name)) return;
    this.#keep();
    this.#name = name;
    this.#view.setState(this.#states.get(name));
  }

  /** Goes to a line of the file that is shown. @param {number} line @param {number} [column] */
  goTo(line, column = 1) {
    const { doc } = this.#view.state;
    const { from, to } = doc.line(Math.min(Math.max(line, 1), doc.lines));
    const at = Math.min(from + column - 1, to);
    this.#view.dispatch({ selection: { anchor: at }, effects: cm.EditorView.scrollIntoView(at, { y: 'center' }) });
    this.#view.focus();
  }

  /** Acts on every file. @param {(name: string, state: any) => object} change */
  #all(change) {
    this.#keep();
    for (const [name, state] of this.#states) {
      const spec = change(name, state);
      if (name === this.#name) this.#view.dispatch(spec);
      else this.#states.set(name, state.update(spec).state);
    }
  }

  /** @param {Map<string, Problem[]>} problems by file */
  setProblems(problems) {
    this.#all((name, state) => cm.setDiagnostics(state, (problems.get(name) ?? []).map(({ line, column, text }) => {
      const { from, to } = state.doc.line(Math.min(Math.max(line, 1), state.doc.lines));
      const at = Math.min(from + (column ?? 1) - 1, to);
      return { from: at, to: Math.max(to, at), severity: 'error', message: text };
    })));
  }

  /** The lines with breakpoints, by file. @returns {Record<string, number[]>} */
  get breakpoints() {
    this.#keep();
    return Object.fromEntries([...this.#states].map(([name, state]) => [name, linesOf(state)]));
  }

  /** @param {Record<string, number[]>} lines */
  set breakpoints(lines) {
    this.#all((name) => ({ effects: setBreakpoints.of(lines[name] ?? []) }));
  }

  /** Shows where the program stands. @param {string | null} file @param {number} line */
  standAt(file, line) {
    if (file !== null) this.show(file);
    this.#all((name) => ({ effects: setStand.of(name === file ? line : null) }));
    if (file !== this.#name) return;
    const { doc } = this.#view.state;
    this.#view.dispatch({ effects: cm.EditorView.scrollIntoView(doc.line(Math.min(line, doc.lines)).from, { y: 'nearest', yMargin: 40 }) });
  }
}

/** @param {any} state @returns {number[]} */
function linesOf(state) {
  const lines = [];
  for (let each = state.field(breakpoints).iter(); each.value; each.next()) lines.push(state.doc.lineAt(each.from).number);
  return [...new Set(lines)];
}
