/** What the page uses of CodeMirror; its own types are in its packages, which the page does not need. */
export const EditorState: any, RangeSet: any, StateEffect: any, StateField: any;
export const Decoration: any, EditorView: any, GutterMarker: any;
export const gutter: any, highlightActiveLine: any, highlightActiveLineGutter: any, hoverTooltip: any, keymap: any, lineNumbers: any;
export const defaultKeymap: any, history: any, historyKeymap: any, indentWithTab: any;
export const HighlightStyle: any, bracketMatching: any, indentOnInput: any, indentUnit: any, syntaxHighlighting: any;
export const cpp: any, lintGutter: any, setDiagnostics: any, highlightSelectionMatches: any, search: any, searchKeymap: any, tags: any;
