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
  /** What explains this time, as JSON. */
  explain(from_s: number, to_s: number): string;
  /** Shows a recording in place of the lab, which waits. */
  show(recording: Recording): void;
  /** Shows the lab again. */
  resume(): void;
  /** Makes the page that of another robot in the world. */
  select(robot: number): void;
  /** Warns the page. */
  warn(text: string): void;
  /** Takes an order, as JSON. */
  order(json: string): void;
  /** One round, of 20 ms at most. */
  advance(): void;
  /** The messages that are new to the page, as JSON. */
  news(): string[];
  /** Gives its memory back. */
  free(): void;
}

export class Robot {
  /** A session with a real robot at the port of this name; with `text` it runs the original program. */
  constructor(port: string, baud: number, text: boolean);
  /** These bytes arrived. */
  arrived(bytes: Uint8Array): void;
  /** The bytes to send since the last call. */
  take_outgoing(): Uint8Array<ArrayBuffer>;
  /** The port is gone, and why. */
  lost(why: string): void;
  /** It is open again, or another one of this name is in its place. */
  back(name: string): void;
  /** Warns the page. */
  warn(text: string): void;
  /** Takes an order, as JSON. */
  order(json: string): void;
  /** One round. */
  advance(): void;
  /** The messages that are new to the page, as JSON. */
  news(): string[];
  /** When the session began [ms since 1970]. */
  readonly began_ms: number;
  /** Begins to write the session so far as a log, which began at this time in UTC. */
  save(started: string): void;
  /** Goes on writing for a few milliseconds; the log, once it is complete. */
  saved(): { name: string, bytes: Uint8Array<ArrayBuffer> } | undefined;
  /** Gives its memory back. */
  free(): void;
}

/** Writes a program to an Arduino Mega at a serial port. */
export class Flasher {
  /** The program in a file of this name. */
  constructor(file: string, content: Uint8Array);
  /** These bytes arrived. */
  receive(bytes: Uint8Array): void;
  /** What to do with the port now; nothing of it: to wait for bytes, or some milliseconds. */
  poll(): { lines?: boolean, send?: Uint8Array<ArrayBuffer>, done: boolean };
  /** What is going on, in a word or two. */
  readonly phase: string;
  /** Which part of all is done, 0 to 1. */
  readonly part: number;
  /** What an end now leaves behind. */
  readonly aftermath: string;
  /** Gives its memory back. */
  free(): void;
}

/** A recording to be shown; it is read apart from the lab, which goes on when the memory does not suffice. */
export class Recording {
  constructor(file: string, bytes: Uint8Array);
}

/** The hash of a headless run of a `Start` as JSON, by the native program, or by an image if it is not empty. */
export function run_hash(start: string, image: Uint8Array): string;

/** The names of the scenarios, in order. */
export function scenarios(): string[];
