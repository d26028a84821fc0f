import { chromium } from 'playwright-core';
import { open, folder } from '/tmp/w/d/web/test/dashboard.mjs';
const fake = process.env.FAKE;
const sizes = [['wide', { viewport: { width: 1280, height: 720 }, colorScheme: 'light' }], ['dark', { viewport: { width: 1280, height: 720 }, colorScheme: 'dark' }], ['phone', { viewport: { width: 390, height: 844 }, colorScheme: 'light', hasTouch: true, isMobile: true, locale: 'es-ES' }]];
for (const [name, options] of sizes) {
  const { page, close, complaints } = await open(['lab', '--scenario', 'mode8-random', '--seed', '7', '--out', folder()], options);
  await page.waitForSelector('#connection.good');
  if (fake) await page.evaluate(() => {
    const send = WebSocket.prototype.send;
    WebSocket.prototype.send = function (text) {
      const order = JSON.parse(text);
      if (order.type !== 'world') return send.call(this, text);
      const model = { title: 'Boxes at random and a goal', arena: { from_m: [-1, -2.1], to_m: [4.4, 2.1], walled: true }, box: [{ centre_m: [1, 0.5], size_m: [0.4, 0.3], angle_deg: 20 }, { centre_m: [2.2, -0.8], size_m: [0.5, 0.5] }], wall: [{ from_m: [3, -2], to_m: [3, 0.3], thickness_m: 0.05 }], start: { x_m: 0, y_m: 0, heading_deg: 0 }, goal_m: [3.6, 1] };
      this.dispatchEvent(new MessageEvent('message', { data: JSON.stringify({ type: 'world', ticket: order.ticket, model, toml: '', problem: order.act === 'check' ? 'world edited:9: box[1].size_m = 0: must be within 0.01..50 m' : null, driven: false }) }));
    };
  });
  await page.screenshot({ path: `/tmp/w/d/.${name}-0.png` });
  await page.click('#edit-world');
  await page.waitForSelector('#editor:not([hidden])');
  await page.waitForTimeout(400);
  await page.screenshot({ path: `/tmp/w/d/.${name}-1.png` });
  await page.selectOption('#editor-item', 'box 0');
  await page.locator('#editor button', { hasText: /^\+ (Box|Caja)$/ }).click();
  await page.waitForTimeout(700);
  await page.locator('#map').scrollIntoViewIfNeeded();
  await page.screenshot({ path: `/tmp/w/d/.${name}-2.png` });
  console.log(name, complaints);
  await close();
}
