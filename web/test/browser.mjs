// What browser tests share: Debian's Chromium without a screen and with a profile of its own that is
// thrown away, and a page whose complaints count as failures.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const FLAGS = [
    '--no-sandbox', '--disable-gpu', '--use-gl=angle', '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run', '--disable-sync',
    '--disable-background-networking', '--disable-component-update', '--disable-default-apps',
    '--disable-extensions', '--hide-scrollbars',
];

export const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
/* A wait ends when what it waits for is there; this is only the end of a wait for what never comes. A
 * software renderer and an engine on two cores that others use have needed 12 s for what takes one. */
const PATIENCE_MS = 60000;
export const OUT = process.env.LARIAT_TEST_OUT ?? join(tmpdir(), 'lariat-browser-test');

export async function openBrowser({ flags = [], ...options } = {}) {
    mkdirSync(OUT, { recursive: true });
    const profile = mkdtempSync(join(tmpdir(), 'lariat-browser-'));
    const context = await chromium.launchPersistentContext(profile, {
        executablePath: CHROMIUM,
        headless: true,
        args: [...FLAGS, ...flags],
        viewport: { width: 1000, height: 640 },
        deviceScaleFactor: 0.5, // drawn in software: a quarter of the points, half the time
        ...options,
    });
    return {
        context,
        async close() {
            await context.close();
            rmSync(profile, { recursive: true, force: true });
        },
    };
}

/* A page with `complaints`: errors, failed requests, breaches of the content security policy. Chromium
 * itself logs every refused WebSocket; who expects some, because the engine is gone, says so. */
export async function openPage(browser, url, { drawn = true, expected = [] } = {}) {
    const page = await browser.context.newPage();
    page.setDefaultTimeout(PATIENCE_MS);
    const complaints = [];
    const add = (text) => {
        if (!/GL Driver Message|GPU stall/.test(text) && !expected.some((e) => e.test(text)))
            complaints.push(text);
    };
    page.on('console', (message) => {
        if (['error', 'warning'].includes(message.type())) add(`console: ${message.text()}`);
    });
    page.on('pageerror', (error) => add(`error: ${error.message}`));
    page.on('requestfailed', (request) => {
        const why = request.failure()?.errorText;
        if (why !== 'net::ERR_ABORTED') add(`failed: ${request.url()} ${why}`); // aborted: by a reload
    });
    page.on('response', (response) => {
        if (response.status() >= 400) add(`${response.status()}: ${response.url()}`);
    });
    await page.goto(url);
    if (drawn) await page.waitForFunction(() => window.lariat?.frames > 1 && window.lariat.pictures > 1);
    const look = {
        page,
        complaints,
        get: (key) => page.evaluate((k) => window.lariat[k], key),
        until: (condition, argument, ms = PATIENCE_MS) =>
            page.waitForFunction(condition, argument, { timeout: ms, polling: 50 }),
        shot: (name) => page.screenshot({ path: join(OUT, `${name}.png`), scale: 'css' }),
        async close() {
            await page.close();
            assert.deepEqual(complaints, []);
        },
    };
    return look;
}

/* Places are told for a window of 1000 x 640 that the organ has for itself: its middle in the window's, and
 * from as far as a ball around it fits the height. Where that is on the page, whose cards leave a part of it. */
export async function placing(page) {
    const { fit, height } = await page.evaluate(() => ({ fit: window.lariat.fit, height: innerHeight }));
    const scale = ((fit.size * 1.02) / Math.tan((16 * Math.PI) / 180) / fit.distance) * (height / 640);
    return { scale, at: ([x, y]) => [fit.x + (x - 500) * scale, fit.y + (y - 320) * scale] };
}

/* In narrow windows the cards are folded into a button. */
export async function unfold(page) {
    const button = page.locator('#cards');
    if ((await button.isVisible()) && (await button.getAttribute('aria-expanded')) === 'false') await button.click();
}

/* Colours of such places of the picture, from a screenshot that the page itself decodes. */
export async function colours(page, places) {
    const { at: placed } = await placing(page);
    const points = places.map((place) => placed(place).map(Math.round));
    const shot = (await page.screenshot({ scale: 'css' })).toString('base64');
    return page.evaluate(
        async ([data, at]) => {
            const image = new Image();
            image.src = `data:image/png;base64,${data}`;
            await image.decode();
            const canvas = document.createElement('canvas');
            canvas.width = image.width;
            canvas.height = image.height;
            const pen = canvas.getContext('2d', { willReadFrequently: true });
            pen.drawImage(image, 0, 0);
            return at.map(([x, y]) => [...pen.getImageData(x, y, 1, 1).data].slice(0, 3));
        },
        [shot, points],
    );
}

export const difference = (a, b) => Math.max(...a.map((v, i) => Math.abs(v - b[i])));

export async function click(page, x, y) {
    await page.mouse.click(...(await placing(page)).at([x, y]));
}

/* Presses at a place, drags by some pixels within several moves, and holds. */
export async function drag(page, fromX, fromY, dx, dy, moves = 6) {
    const { scale, at } = await placing(page);
    const [x, y] = at([fromX, fromY]);
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let i = 1; i <= moves; i++) {
        await page.mouse.move(x + (dx * scale * i) / moves, y + (dy * scale * i) / moves);
        await page.waitForTimeout(30);
    }
}
