// The picture of docs/viewer.md: the organ of the demonstration while it is pulled.
//
//     LARIAT=../build/lariat node test/picture.mjs ../docs/images/viewer.png
import { mkdirSync, writeFileSync } from 'node:fs';
import { deflateSync, inflateSync } from 'node:zlib';
import { OUT, openBrowser, openPage, placing } from './browser.mjs';
import { demo, view } from './engine.mjs';

mkdirSync(OUT, { recursive: true });
const model = demo();
const engine = await view(model.scene, '--port', '0', '--save-folder', model.saved);
const browser = await openBrowser({ viewport: { width: 1600, height: 1000 }, deviceScaleFactor: 1 });
const { page, get } = await openPage(browser, `${engine.url}#quality=fine`);
// A look around, so that the hints are done with.
await page.mouse.move(300, 300);
await page.mouse.down();
await page.mouse.move(294, 302, { steps: 2 });
await page.mouse.up();
await page.waitForTimeout(1500);
const [x, y] = (await placing(page)).at([500, 205]);
await page.mouse.move(x, y);
await page.mouse.down();
// Out, back a little, and further out, so that the graph has something to tell.
for (const [dx, dy, wait] of [[25, -25, 300], [60, -50, 500], [40, -30, 500], [65, -60, 300], [78, -76, 900]]) {
    await page.mouse.move(x + dx, y + dy, { steps: 2 });
    await page.waitForTimeout(wait);
}
console.log(await get('hand'), await get('force'), 'N', await get('displacement'), 'm');
// Paused: a machine that draws a fine picture without a graphics processor computes nothing else in time.
await page.keyboard.press('Space');
await page.keyboard.press('g');
await page.waitForTimeout(2500);
writeFileSync(process.argv[2] ?? 'viewer.png', smaller(await page.screenshot()));
await page.mouse.up();
await browser.close();
await engine.end();

/* The same PNG, packed harder than the browser has time for. */
function smaller(png) {
    const parts = [];
    for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at))
        parts.push([png.toString('latin1', at + 4, at + 8), png.subarray(at + 8, at + 8 + png.readUInt32BE(at))]);
    const data = Buffer.concat(parts.filter(([type]) => type === 'IDAT').map(([, part]) => part));
    const head = parts.find(([type]) => type === 'IHDR')[1];
    const bytes = { 2: 3, 6: 4 }[head[9]];
    const rows = filtered(inflateSync(data), head.readUInt32BE(0) * bytes, bytes);
    const packed = deflateSync(rows, { level: 9, memLevel: 9 });
    const chunk = (type, part) => {
        const out = Buffer.alloc(12 + part.length);
        out.writeUInt32BE(part.length);
        out.write(type, 4, 'latin1');
        part.copy(out, 8);
        out.writeUInt32BE(crc(out.subarray(4, 8 + part.length)) >>> 0, 8 + part.length);
        return out;
    };
    const keep = (name) => parts.filter(([type]) => type === name).map(([, part]) => chunk(name, part));
    return Buffer.concat([png.subarray(0, 8), ...keep('IHDR'), chunk('IDAT', packed), ...keep('IEND')]);
}

/* Rows of pixels, each with the one of PNG's five filters that leaves the smallest numbers. */
function filtered(data, width, bytes) {
    const height = data.length / (width + 1);
    const pixels = Buffer.alloc(height * width);
    const paeth = (a, b, c) => {
        const [p, q, r] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
        return p <= q && p <= r ? a : q <= r ? b : c;
    };
    const guess = (filter, y, x) => {
        const at = y * width + x;
        const a = x >= bytes ? pixels[at - bytes] : 0;
        const b = y > 0 ? pixels[at - width] : 0;
        const c = x >= bytes && y > 0 ? pixels[at - width - bytes] : 0;
        return [0, a, b, (a + b) >> 1, paeth(a, b, c)][filter];
    };
    const out = Buffer.alloc(data.length);
    for (let y = 0; y < height; y++) {
        const from = y * (width + 1);
        for (let x = 0; x < width; x++)
            pixels[y * width + x] = data[from + 1 + x] + guess(data[from], y, x);
    }
    // Nobody sees the last bit, and it takes a fifth of the room.
    for (let i = 0; i < pixels.length; i++) pixels[i] &= 0xfe;
    for (let y = 0; y < height; y++) {
        const from = y * (width + 1);
        let min = Infinity;
        for (let filter = 0; filter < 5; filter++) {
            const row = Buffer.alloc(width + 1, filter);
            let sum = 0;
            for (let x = 0; x < width; x++) {
                row[x + 1] = pixels[y * width + x] - guess(filter, y, x);
                sum += Math.min(row[x + 1], 256 - row[x + 1]);
            }
            if (sum < min) [min] = [sum, row.copy(out, from)];
        }
    }
    return out;
}

/* The check sum of PNG (ISO 3309). */
function crc(bytes) {
    let c = ~0;
    for (const byte of bytes) {
        c ^= byte;
        for (let k = 0; k < 8; k++) c = (c >>> 1) ^ (c & 1 ? 0xedb88320 : 0);
    }
    return ~c;
}
