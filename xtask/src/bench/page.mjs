// Measures in an already running Chromium: prints "ready", then answers each line read, a word and an address.
import { createInterface } from "node:readline";
import { chromium } from "playwright-core";

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
const percentile = (values, share) => [...values].sort((a, b) => a - b)[Math.ceil(share * values.length) - 1];

/** Opens the dashboard: "live" when signals are plotted. */
async function open(url) {
  await page.goto(url);
  await page.waitForFunction(() => globalThis.rumbo?.series("left_pwm")?.t.length > 0, null, { polling: "raf", timeout: 20_000 });
  return "live";
}

/** From the last byte of a frame, received by the station, to the frame after the one that drew it: 95 of 100 [ms]. */
async function age() {
  await page.evaluate(() => { rumbo.ages.measured = []; });
  await page.waitForFunction(() => rumbo.ages.measured.length >= 200, null, { timeout: 60_000 });
  return percentile(await page.evaluate(() => rumbo.ages.measured), 0.95).toFixed(0);
}

/** From a press of STOP in the page to PWM zero, 3 ms after the tick that disarmed: 95 of 100 [ms]. */
async function stop() {
  const took = [];
  for (let run = 0; run < 20; run++) {
    await page.locator("#on").click();
    await page.waitForFunction(() => rumbo.state().robot.armed);
    await page.waitForTimeout(300 + 37 * run % 100);
    took.push(await page.evaluate(async () => {
      const { received_ms, session_ms } = rumbo.ages;
      const pressed_ms = performance.timeOrigin + performance.now() - (received_ms - session_ms);
      const disarmed = () => [...document.querySelectorAll("#events li")].filter((each) => each.textContent.endsWith("disarmed"));
      const before = disarmed().length;
      document.querySelector("#stop").click();
      for (let waited_ms = 0; waited_ms < 10_000; waited_ms += 20) {
        await new Promise((done) => setTimeout(done, 20));
        const lines = disarmed();
        if (lines.length > before) return Number(lines[0].dataset.t) * 1e3 + 3 - pressed_ms;
      }
      throw new Error("STOP was not answered");
    }));
  }
  return percentile(took, 0.95).toFixed(0);
}

/** Frames per second of all that moves, with the ranges and ghosts of twenty seeds, eight plots of four signals each and ten minutes in sight. */
async function frames(url) {
  await page.goto(url);
  await page.waitForFunction(() => globalThis.rumbo?.state() !== null);
  const four = [["true_left_rpm", "true_right_rpm", "left_rpm", "right_rpm"], ["heading_deg", "true_heading_deg", "servo_deg", "heading_ref_deg"],
    ["x_m", "y_m", "true_x_m", "true_y_m"], ["range_left_cm", "range_right_cm", "range_front_cm", "true_range_front_cm"]];
  const plots = [...four, ...four].map((signals, index) => ({ title: `plot ${index}`, signals, min: null, max: null, weight: 4 }));
  await page.evaluate((plots) => {
    const layout = { window_s: 600, plots };
    const modes = Object.fromEntries(Array.from({ length: 11 }, (_none, mode) => [mode, layout]));
    localStorage.setItem("rumbo.layouts", JSON.stringify({ version: 1, modes, named: {} }));
  }, plots);
  await page.reload();
  await page.locator("#runs").click();
  await page.locator("#seeds-start").click();
  await page.locator("#seeds button").nth(20).waitFor({ timeout: 120_000 });
  await page.locator("#on").click();
  await page.waitForFunction(() => {
    const { t } = globalThis.rumbo?.series("left_pwm") ?? { t: [] };
    return t.length > 10 && t.at(-1) - t[0] > 590;
  }, null, { polling: 200, timeout: 120_000 });
  await page.locator("#speed").selectOption("1");
  return page.evaluate(() => new Promise((done) => {
    const begin = performance.now();
    let count = 0;
    const frame = () => {
      rumbo.draw();
      count += 1;
      const passed_ms = performance.now() - begin;
      if (passed_ms < 5_000) requestAnimationFrame(frame);
      else done(`${(count * 1e3 / passed_ms).toFixed(0)} with ${document.querySelectorAll(".plot-head").length} plots, ${1 + rumbo.others().length} robots, ${rumbo.series("left_pwm").t.length} lines`);
    };
    requestAnimationFrame(frame);
  }));
}

console.log("ready");
for await (const line of createInterface({ input: process.stdin })) {
  const [word, url] = line.split(" ");
  try {
    console.log(await { open, age, stop, frames }[word](url));
  } catch (error) {
    console.log(`failed: ${String(error).split("\n")[0]}`);
  }
}
await browser.close();
