// What once broke a session: jaws that close where they are pressed into the organ, and open again
// while a probe presses beside them. It goes on, and the page says what happens.
import assert from 'node:assert/strict';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { OUT, openBrowser, openPage } from './browser.mjs';
import { demo, endAll, view } from './engine.mjs';

mkdirSync(OUT, { recursive: true });
let browser;
let engine;
let v;

const PROBE = `time,x,y,z,opening
0,0.045,-0.045,0.075,1
0.3,0.0158,-0.04445,0.06484,1
1,0.02256,-0.00129,0.04836,1
`;
// In by 1.3 s, where the organ pushes with 0.7 N; closed by 2.2 s, open by 2.7 s, and closed again.
const GRASPER = `time,x,y,z,opening
0,-0.035,-0.055,0.09,1
0.3,-0.022,-0.052,0.078,1
1.3,-0.0150,0.0020,0.0620,1
1.7,-0.0150,0.0020,0.0620,1
2.2,-0.0150,0.0020,0.0620,0
2.4,-0.0150,0.0020,0.0620,0
2.7,-0.0150,0.0020,0.0620,1
3.0,-0.0150,0.0020,0.0620,0
`;

const END = 34000; // 3.2 s

before(async () => {
    const model = demo();
    const file = (name, text) => {
        const path = join(model.folder, name);
        writeFileSync(path, text);
        return path;
    };
    const devices = [`probe=script:${file('probe.csv', PROBE)}`, `grasper=script:${file('grasper.csv', GRASPER)}`];
    const started = view(model.scene, '--port', '0', ...devices.flatMap((device) => ['--device', device]));
    [browser, engine] = await Promise.all([openBrowser(), started]);
    v = await openPage(browser, engine.url);
});
after(async () => {
    await browser?.close();
    await engine?.end();
    endAll();
});

/* What the entry of the grasper says, at any moment from now on. */
const says = (words) =>
    v.until((w) => new RegExp(w).test(document.getElementById('tool-list').innerText), words);

test('jaws close at 0.7 N, and open, while a probe presses: it goes on, and the page says how hard', async () => {
    await says('0\\.[67]\\d of \\d\\.\\d\\d N, grasp 0\\.\\d\\d N');
    await v.shot('jaws-pressed');
    await says('limit reached'); // they close no further
    await v.until((steps) => window.lariat.step > steps, END, 120000);
    assert.equal(await v.get('state'), 'playing');
    assert.doesNotMatch(engine.said(), /unstable/); // it went back nowhere
    await v.shot('jaws-closed');
});
