/** What `crates/report` exports; `cargo xtask site` writes the module. */
export default function init(): Promise<unknown>;

/** The experiments in the report's order, each with its `name` and its `title` in a language, as JSON. */
export function experiments(language: string): string;

/** The file of `rumbo experiments`; posts the part that is done, 0 to 1, after each run. No names: all experiments. */
export function report(only: string[], seed: number, language: string): Uint8Array<ArrayBuffer>;
