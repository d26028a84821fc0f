// @ts-check
/** A reporter of `node --test`: the files with a test that failed, a line each, again for each test. */

/** @param {AsyncIterable<{type: string, data: any}>} events */
export default async function* failed(events) {
  for await (const { type, data } of events) if (type === 'test:fail' && data.file) yield `${data.file}\n`;
}
