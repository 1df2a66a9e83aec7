// The moving picture of README.md: the demonstration organ in the viewer, pulled with the mouse and let
// go. From the folder web, after `make`:
//
//     LARIAT=../build/lariat node ../tools/render/moving.mjs FOLDER     numbered PNGs
//     convert -delay 8 -loop 0 FOLDER/*.png -layers optimize ../docs/images/pull.gif
//
// The engine runs at a fifth of its pace, so that a browser that draws in software keeps up.
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const here = (name) => import(pathToFileURL(join(process.cwd(), 'test', name)).href);
const { openBrowser, openPage } = await here('browser.mjs');
const { demo, view } = await here('engine.mjs');

const FOLDER = process.argv[2];
const START = [700, 205], WAY = [70, -105], SIZE = { width: 1400, height: 640 };
const CLIP = { x: 430, y: 20, width: 540, height: 480 };
const PULL = 14, HOLD = 3, LEAVE = 20; // pictures

mkdirSync(FOLDER, { recursive: true });
const engine = await view(demo().scene, '--port', '0', '--pace', '0.2');
const browser = await openBrowser({ viewport: SIZE, deviceScaleFactor: 1 });
const { page } = await openPage(browser, engine.url);
let number = 0;
const shot = async () => {
    await page.screenshot({ path: join(FOLDER, `${String(number++).padStart(3, '0')}.png`), clip: CLIP });
    await page.waitForTimeout(120);
};
await page.evaluate(() => ['hint', 'slow'].forEach((id) => document.getElementById(id).remove()));
await page.mouse.move(...START);
await page.mouse.down();
for (let i = 1; i <= PULL + HOLD; i++) {
    const share = Math.min(1, i / PULL);
    await page.mouse.move(START[0] + share * WAY[0], START[1] + share * WAY[1]);
    await shot();
}
await page.mouse.up();
for (let i = 0; i < LEAVE; i++) await shot();
await browser.close();
await engine.end();
