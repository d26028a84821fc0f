/** What `crates/browser` exports; `cargo xtask site` writes the module. */
export default function init(): Promise<unknown>;

export class Lab {
  /** `start` is what runs, as JSON: `Start` of `crates/browser`. */
  constructor(start: string);
  /** Of Rumbo. */
  readonly version: string;
  /** When the run began [ms since 1970]. */
  readonly began_ms: number;
  /** The run so far as a log, which began at this time in UTC. */
  log(started: string): { name: string, bytes: Uint8Array<ArrayBuffer> };
  /** The run so far for a link, as JSON. */
  share(): string;
  /** Shows a recording in place of the lab, which waits. */
  show(recording: Recording): void;
  /** Shows the lab again. */
  resume(): void;
  /** Warns the page. */
  warn(text: string): void;
  /** Takes an order, as JSON. */
  order(json: string): void;
  /** One round, of 20 ms at most. */
  advance(): void;
  /** The messages that are new to the page, as JSON. */
  news(): string[];
}

/** A recording to be shown; it is read apart from the lab, which goes on when the memory does not suffice. */
export class Recording {
  constructor(file: string, bytes: Uint8Array);
}

/** The hash of a headless run, by the native program, or by an image if it is not empty. */
export function run_hash(scenario: string, seed: number, image: Uint8Array): string;

/** The names of the scenarios, in order. */
export function scenarios(): string[];
