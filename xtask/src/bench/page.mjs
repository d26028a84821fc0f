// Opens the dashboard in an already running Chromium: "ready", then for each address read "live" when signals are plotted.
import { createInterface } from "node:readline";
import { chromium } from "playwright-core";

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
console.log("ready");
for await (const url of createInterface({ input: process.stdin })) {
  try {
    await page.goto(url);
    await page.waitForFunction(() => globalThis.rumbo?.series("left_pwm")?.t.length > 0, null, { polling: "raf", timeout: 20_000 });
    console.log("live");
  } catch (error) {
    console.log(String(error).split("\n")[0]);
  }
}
await browser.close();
