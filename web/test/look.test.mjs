// Looking closer, against the stand-in for the server: what changes a page's own picture, what is read and
// measured, plotted and saved.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { click, colours, difference, drag, openBrowser, openPage, placing, unfold } from './browser.mjs';
import { mock } from './mock.mjs';

let browser;
let server;

before(async () => {
    browser = await openBrowser();
    server = await mock();
});
after(async () => {
    await browser?.close();
    await server?.close();
});

test('the picture is cut open, by mouse and by keys, and what is cut away cannot be pulled', async (t) => {
    const own = await mock();
    t.after(() => own.close());
    const v = await openPage(browser, own.url);
    await v.page.waitForTimeout(300);
    const LEFT = [430, 260];
    const RIGHT = [570, 260];
    const [left, right] = await colours(v.page, [LEFT, RIGHT]);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('k');
    assert.ok(await v.page.getByLabel('cut open').isChecked());
    assert.equal(await v.page.locator('#cut-text').innerText(), 'x below 0 m');
    await v.page.waitForTimeout(400);
    await v.shot('cut-x');
    const [leftCut, rightCut] = await colours(v.page, [LEFT, RIGHT]);
    assert.ok(difference(left, leftCut) < 25, `${left} stays, ${leftCut}`);
    assert.ok(difference(right, rightCut) > 40, `${right} is cut away, ${rightCut}`);
    // A press there looks around: nothing is held.
    await drag(v.page, ...RIGHT, 2, 2, 2);
    await v.page.waitForTimeout(200);
    assert.equal(await v.get('hand'), 'free');
    await v.page.mouse.up();
    await drag(v.page, ...LEFT, 2, 2, 2);
    await v.until(() => window.lariat.hand === 'holding');
    await v.page.mouse.up();
    // The other side, another direction, another place, and none.
    await v.page.getByLabel('the other side').check();
    await v.page.waitForTimeout(400);
    const [leftOther] = await colours(v.page, [LEFT]);
    assert.ok(difference(left, leftOther) > 40, `${leftOther}`);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('b');
    await v.page.keyboard.press('b');
    assert.match(await v.page.locator('#cut-text').innerText(), /^z above 45\.0 mm$/);
    await v.page.getByLabel('Place of the cut').fill('0.9');
    await v.page.locator('#picture').focus();
    const before = await v.page.locator('#cut-text').innerText();
    await v.page.keyboard.press('<');
    assert.notEqual(await v.page.locator('#cut-text').innerText(), before);
    await v.page.keyboard.press('b');
    assert.match(await v.page.locator('#cut-text').innerText(), /^towards the eye above/);
    await v.page.keyboard.press('k');
    assert.equal(await v.page.locator('#cut-part').isVisible(), false);
    await v.page.waitForTimeout(400);
    const [again] = await colours(v.page, [RIGHT]);
    assert.ok(difference(right, again) < 25, `${right} is back, ${again}`);
    await v.close();
});

for (const riding of [false, true])
    test(`organs are faded and hidden${riding ? ', also of an embedded surface' : ''}, and let the pointer through`, async (t) => {
        const own = await mock({ riding, organs: 'halves' });
        t.after(() => own.close());
        const v = await openPage(browser, own.url);
        await v.page.waitForTimeout(300);
        const UPPER = [500, 200]; // the second organ
        const LOWER = [500, 450];
        const [upper, lower, beside] = await colours(v.page, [UPPER, LOWER, [300, 560]]);
        await v.page.locator('#inside').evaluate((card) => (card.open = true));
        const entry = v.page.locator('#organs button').nth(1);
        assert.equal(await entry.getAttribute('aria-label'), 'tubes: shown');
        await entry.click();
        assert.equal(await entry.getAttribute('aria-label'), 'tubes: faded');
        await v.page.waitForTimeout(400);
        await v.shot(`organ-faded-${riding ? 'fine' : 'mesh'}`);
        const [faded, still] = await colours(v.page, [UPPER, LOWER]);
        assert.ok(difference(upper, faded) > 30, `${upper}, faded ${faded}`);
        assert.ok(difference(lower, still) < 25, `${lower} stays, ${still}`);
        await drag(v.page, ...UPPER, 2, 2, 2);
        await v.page.waitForTimeout(200);
        assert.equal(await v.get('hand'), 'free', 'what is faded is not pulled');
        await v.page.mouse.up();
        await entry.click();
        await v.page.waitForTimeout(400);
        const [hidden] = await colours(v.page, [UPPER]);
        assert.ok(difference(hidden, beside) < 40, `${hidden} is background, ${beside}`);
        await v.page.getByRole('button', { name: 'Show all' }).click();
        // By keyboard: the one in the middle, twice, and all again.
        await v.page.locator('#picture').focus();
        await v.page.keyboard.press('h');
        await v.page.keyboard.press('h');
        await v.page.getByText(/(uterus|tubes): hidden/).first().waitFor();
        await v.page.keyboard.press('u');
        await v.page.waitForTimeout(400);
        const [back] = await colours(v.page, [UPPER]);
        assert.ok(difference(upper, back) < 25, `${upper} is back, ${back}`);
        assert.equal(await v.page.getByRole('button', { name: 'Show all' }).isDisabled(), true);
        await v.close();
    });

test('lines along fibres are drawn where there are some, and not on hidden organs', async (t) => {
    const own = await mock({ fibres: 2, organs: 'halves' });
    t.after(() => own.close());
    const none = await openPage(browser, server.url);
    assert.equal(await none.page.locator('#fibres-row').isVisible(), false);
    await none.page.locator('#picture').focus();
    await none.page.keyboard.press('/');
    await none.page.getByText('Nothing in this scene has fibres.').waitFor();
    assert.equal(await none.get('fibres'), 0);
    await none.close();
    const v = await openPage(browser, own.url);
    const faces = 6 * 14 * 14;
    assert.equal(await v.page.locator('#fibres').isChecked(), false, 'off at first');
    assert.equal(await v.get('fibres'), 0);
    await v.page.waitForTimeout(300);
    const points = Array.from({ length: 400 }, (_, i) => [450 + 5 * (i % 20), 200 + 5 * Math.floor(i / 20)]);
    const plain = await colours(v.page, points);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('/');
    assert.ok(await v.page.getByLabel('fibres').isChecked());
    await v.until((n) => window.lariat.fibres === n, 2 * faces);
    await v.page.waitForTimeout(400);
    await v.shot('fibres');
    const lined = await colours(v.page, points);
    const changed = lined.filter((c, i) => difference(c, plain[i]) > 40).length;
    assert.ok(changed > 20 && changed < 300, `${changed} of 400 points`);
    const blue = lined.filter(([r, , b]) => b > r + 30).length;
    const pale = lined.filter(([r, g, b], i) => r + g + b > plain[i][0] + plain[i][1] + plain[i][2] + 100).length;
    assert.ok(blue > 3 && pale > 3, `two colours: ${blue} and ${pale}`);
    // They go with the tissue that is pulled.
    await drag(v.page, 500, 200, 60, -40);
    await v.until(() => window.lariat.displacement > 0.004);
    await v.page.waitForTimeout(300);
    await v.shot('fibres-pulled');
    await v.page.mouse.up();
    await v.page.locator('#inside').evaluate((card) => (card.open = true));
    const entry = v.page.locator('#organs button').nth(1);
    await entry.click();
    await entry.click();
    await v.until((n) => window.lariat.fibres > 0 && window.lariat.fibres < n, 2 * faces);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('/');
    await v.until(() => window.lariat.fibres === 0);
    await v.close();
});

test('values of a node and its element are read where one presses, also by keyboard', async (t) => {
    const own = await mock({ riding: true });
    t.after(() => own.close());
    const v = await openPage(browser, own.url);
    await v.page.locator('#measure').evaluate((card) => (card.open = true));
    await v.page.getByRole('radio', { name: 'read values' }).click();
    await click(v.page, 500, 250);
    await v.until(() => window.lariat.reading.node >= 1000);
    assert.equal(await v.get('hand'), 'free', 'a press reads and does not pull');
    const first = await v.get('reading');
    // The node is the mesh's nearest to where it was pressed: high up, in front.
    const at = [0, 1, 2].map((k) => own.mesh.x[3 * (first.node - 1000) + k]);
    assert.ok(Math.abs(at[0]) < 0.008 && at[1] < 0 && at[2] > 0.05, `${at}`);
    const text = await v.page.locator('#reading').innerText();
    assert.match(text, /node 1\d\d\d[^]*von Mises[^]*pressure\s+−1\.25 kPa[^]*at rest[^]*mm[^]*element 5\d\d\d[^]*pressure\s+–[^]*(uterus|tubes)[^]*shear modulus\s+1\.50 kPa/);
    await v.page.waitForTimeout(300);
    const [mark] = await colours(v.page, [[500, 250]]);
    await v.shot('reading');
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('Escape');
    assert.equal(await v.get('press'), 'pull');
    await v.page.keyboard.press('i');
    assert.equal(await v.get('press'), 'read');
    await v.page.keyboard.press('Enter');
    await v.until((n) => window.lariat.reading.node !== n, first.node);
    // Values follow the tissue.
    await v.page.keyboard.press('i');
    await v.page.keyboard.press('p');
    await v.until(() => window.lariat.hand === 'holding');
    for (let i = 0; i < 8; i++) await v.page.keyboard.press('ArrowUp');
    await v.until(() => /displacement\s+[1-9][\d.]* mm/.test(document.getElementById('reading').innerText));
    await v.page.keyboard.press('p');
    await v.page.getByRole('button', { name: 'Clear' }).click();
    assert.equal((await v.get('reading')).node, -1);
    assert.equal(await v.page.locator('#reading').innerText(), '');
    assert.ok(mark.length === 3);
    await v.close();
});

test('a distance is measured between two places, now and at rest, and follows the tissue', async (t) => {
    const own = await mock();
    t.after(() => own.close());
    const v = await openPage(browser, own.url);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('d');
    await click(v.page, 500, 160);
    await v.page.getByText('One end is set.').waitFor();
    await click(v.page, 500, 480);
    await v.until(() => window.lariat.measured > 0);
    const still = await v.get('measured');
    // The pear is 90 mm high.
    assert.ok(still > 0.05 && still < 0.09, `${still} m`);
    assert.match(await v.page.locator('#distance').innerText(), /^\d\d\.\d mm now, \d\d\.\d mm at rest \([+−]0\.0 %\)$/);
    await v.page.waitForTimeout(300);
    await v.shot('distance');
    // Marks that rest cost no pictures.
    own.state.mute = true;
    await v.page.waitForTimeout(400);
    const pictures = await v.get('pictures');
    await v.page.waitForTimeout(500);
    assert.equal(await v.get('pictures'), pictures);
    own.state.mute = false;
    await v.page.reload();
    await v.until(() => window.lariat?.frames > 1);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('d');
    await click(v.page, 500, 160);
    await click(v.page, 500, 480);
    await v.until(() => window.lariat.measured > 0);
    await v.page.waitForTimeout(300);
    const [line] = await colours(v.page, [[500, 320]]);
    assert.ok(line[1] > line[0] + 30, `the line is green: ${line}`);
    await v.page.keyboard.press('d');
    await drag(v.page, 500, 180, 0, -60);
    await v.until((d) => window.lariat.measured > d + 0.002, still);
    assert.match(await v.page.locator('#distance').innerText(), /\(\+[1-9][\d.]* %\)$/);
    await v.page.mouse.up();
    // By keyboard alone, and from anew with the third end.
    await v.page.keyboard.press('d');
    await v.page.keyboard.press('Enter');
    await v.page.getByText('One end is set.').waitFor();
    for (let i = 0; i < 4; i++) await v.page.keyboard.press('ArrowUp');
    await v.page.waitForTimeout(600);
    await v.page.keyboard.press('Enter');
    await v.until(() => window.lariat.measured > 0);
    await v.close();
});

test('energies and times are plotted, and asked for only while they are seen', async (t) => {
    const own = await mock();
    const sharp = await openBrowser({ deviceScaleFactor: 1 }); // lines of a plot are a point wide
    t.after(() => Promise.all([own.close(), sharp.close()]));
    const v = await openPage(sharp, own.url);
    await v.page.waitForTimeout(500);
    assert.equal(own.state.energies, 0);
    own.state.late = 3;
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('y');
    await v.page.getByText('strain 1.01 mJ, kinetic').waitFor();
    await v.page.getByText(/Answers to tools, due within 1\.00 ms: 3 of \d+ missed/).waitFor();
    await v.page.getByText('A step, of the 100 µs that it stands for').waitFor();
    await v.page.waitForTimeout(1500);
    const drawn = (id) => v.page.evaluate((name) => {
        const canvas = document.getElementById(name);
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        const count = (match) => data.reduce((sum, _, i) => sum + (i % 4 === 0 && data[i + 3] > 100 && match(data[i], data[i + 1], data[i + 2]) ? 1 : 0), 0);
        return { red: count((r, g, b) => r > 200 && g < 150 && b < 150), blue: count((r, g, b) => b > 200 && r < 150), amber: count((r, g, b) => r > 200 && g > 150 && b < 100) };
    }, id);
    const [energies, answers, steps] = [await drawn('energies'), await drawn('answers'), await drawn('steps')];
    assert.ok(energies.amber > 5, JSON.stringify(energies));
    assert.ok(answers.blue > 20 && answers.red > 5, `late ones are red: ${JSON.stringify(answers)}`);
    assert.ok(steps.blue > 20 && steps.red === 0, JSON.stringify(steps));
    await v.page.setViewportSize({ width: 1000, height: 900 });
    await v.page.waitForTimeout(700);
    await v.shot('plots');
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('y');
    await v.page.waitForTimeout(300);
    const asked = own.state.energies;
    await v.page.waitForTimeout(700);
    assert.equal(own.state.energies, asked);
    await v.close();
});

test('instruments throw shadows on tissue, not on colours that stand for values', async (t) => {
    const own = await mock();
    t.after(() => own.close());
    // The jaws point at the organ from the front, a little above its middle.
    own.poses[0].position = [0, -0.05, 0.055];
    own.poses[0].orientation = [Math.SQRT1_2, Math.SQRT1_2, 0, 0];
    const v = await openPage(browser, own.url);
    assert.equal(await v.page.getByLabel('shadows').isChecked(), false, 'not where the main processor draws');
    const places = Array.from({ length: 400 }, (_, i) => [390 + (i % 20) * 12, 180 + Math.floor(i / 20) * 16]);
    const dark = async () => {
        await v.page.waitForTimeout(500);
        return colours(v.page, places);
    };
    const plain = await dark();
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('z');
    const shaded = await dark();
    await v.shot('shadows');
    const darker = plain.filter((colour, i) => colour[0] - shaded[i][0] > 30).length;
    const brighter = plain.filter((colour, i) => shaded[i][0] - colour[0] > 30).length;
    assert.ok(darker > 8 && darker < 200, `${darker} of 400 places are in the shadow`);
    assert.ok(brighter < 5, `${brighter} are brighter`);
    await v.page.keyboard.press('3');
    await v.until(() => window.lariat.field === 4);
    const mapped = await dark();
    await v.page.keyboard.press('z');
    const without = await dark();
    assert.ok(mapped.every((colour, i) => difference(colour, without[i]) < 20), 'values keep their colours');
    await v.close();
});

test('slices of the scan are shown where they lie, and are asked for one at a time', async (t) => {
    const own = await mock({ scan: true });
    t.after(() => own.close());
    const v = await openPage(browser, own.url);
    const BONE = [685, 320]; // beside the organ
    await v.page.waitForTimeout(300);
    const [before, organ] = await colours(v.page, [BONE, [500, 320]]);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('q');
    await v.until(() => window.lariat.scan);
    await v.page.keyboard.press('a');
    await v.page.keyboard.press('a'); // k, i, j: across the line of sight
    await v.page.getByText('j 8 of 17').waitFor();
    await v.page.waitForTimeout(400);
    await v.shot('scan');
    const [bone, still] = await colours(v.page, [BONE, [500, 320]]);
    assert.ok(difference(before, bone) > 80, `bone ${bone} where there was ${before}`);
    assert.ok(difference(organ, still) < 25, 'the organ stands before it');
    // Cut open along it, one sees the slice within the organ.
    await v.page.keyboard.press('k');
    await v.page.keyboard.press('b');
    await v.page.getByLabel('the other side').check();
    await v.page.waitForTimeout(400);
    await v.shot('scan-cut');
    // As fast as the slider goes, one is under way at a time.
    await v.page.getByLabel('Which slice').fill('3');
    await v.page.getByText('j 3 of 17').waitFor();
    await v.page.locator('#picture').focus();
    const asked = own.state.slices;
    for (let i = 0; i < 5; i++) await v.page.keyboard.press('}');
    await v.page.getByText('j 8 of 17').waitFor();
    assert.ok(own.state.slices <= asked + 5, `${own.state.slices - asked} slices`);
    await v.page.keyboard.press('q');
    assert.equal(await v.get('scan'), false);
    await v.page.waitForTimeout(300);
    const [gone] = await colours(v.page, [BONE]);
    assert.ok(difference(before, gone) < 25);
    await v.close();
    const w = await openPage(browser, server.url);
    await w.page.locator('#picture').focus();
    await w.page.keyboard.press('q');
    await w.page.getByText('There is no scan').waitFor();
    assert.equal(await w.page.getByLabel('scan slice').isVisible(), false);
    await w.close();
});

/* What the browser saves when something is done, and its name. */
async function saved(page, act) {
    const [download] = await Promise.all([page.waitForEvent('download', ), act()]);
    return { name: download.suggestedFilename(), data: readFileSync(await download.path()) };
}

test('a picture with its legend is saved, by button and by key', async () => {
    const v = await openPage(browser, server.url);
    await v.page.getByRole('radio', { name: 'von Mises stress' }).click();
    await v.until(() => window.lariat.field === 4);
    await v.page.locator('#picture').focus();
    const { name, data } = await saved(v.page, () => v.page.keyboard.press('n'));
    assert.match(name, /^pear-\d+\.png$/);
    assert.equal(data.subarray(1, 4).toString(), 'PNG');
    // As large as the picture, and a line of text below it; the organ is in its middle.
    const seen = await v.page.evaluate(async (base64) => {
        const image = new Image();
        image.src = `data:image/png;base64,${base64}`;
        await image.decode();
        const canvas = document.createElement('canvas');
        [canvas.width, canvas.height] = [image.width, image.height];
        const pen = canvas.getContext('2d', { willReadFrequently: true });
        pen.drawImage(image, 0, 0);
        const row = (y) => {
            const colours = new Set();
            for (let x = 0; x < image.width; x++) colours.add(pen.getImageData(x, y, 1, 1).data.join());
            return colours.size;
        };
        const picture = document.getElementById('picture');
        const foot = image.height - picture.height;
        const two = foot > 50 * Math.max(1, picture.height / 640); // lines: the legend is in the second
        return {
            width: image.width, foot, drawn: picture.width,
            middle: [...pen.getImageData(image.width / 2, picture.height / 2, 1, 1).data],
            legend: row(picture.height + Math.round((two ? 0.7 : 0.5) * foot)),
        };
    }, data.toString('base64'));
    assert.equal(seen.width, seen.drawn);
    assert.ok(seen.foot >= 30, `${seen.foot} pixels below`);
    assert.ok(seen.middle[2] > seen.middle[1], `violet: ${seen.middle}`);
    assert.ok(seen.legend > 60, `${seen.legend} colours in the line below`);
    await v.page.locator('#keep').evaluate((card) => (card.open = true));
    const second = await saved(v.page, () => v.page.getByRole('button', { name: 'Picture', exact: true }).click());
    assert.match(second.name, /\.png$/);
    await v.close();
});

test('a video is filmed and saved', async () => {
    const v = await openPage(browser, server.url);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('w');
    await v.page.locator('#filming').waitFor({ state: 'visible' });
    for (let i = 0; i < 20; i++) {
        await v.page.keyboard.press('ArrowLeft');
        await v.page.waitForTimeout(60);
    }
    const { name, data } = await saved(v.page, () => v.page.keyboard.press('w'));
    assert.match(name, /^pear-\d+\.webm$/);
    assert.equal(data.readUInt32BE(0), 0x1a45dfa3, 'WebM');
    assert.ok(data.length > 5000, `${data.length} bytes`);
    await v.page.locator('#filming').waitFor({ state: 'hidden' });
    // Clusters with blocks of pictures, one after the other.
    assert.ok(data.includes(Buffer.from([0x1f, 0x43, 0xb6, 0x75])), 'pictures are in it');
    await v.close();
});

const within = (a, b, by) => assert.ok(Math.abs(a - b) < by, `${a} is not ${b}`);

test('each muscle has a slider of its own', async (t) => {
    const own = await mock({ organs: 'halves', active: [1] });
    t.after(() => own.close());
    const v = await openPage(browser, own.url);
    const other = await openPage(browser, own.url);
    await v.page.bringToFront();
    const text = (id) => v.page.locator(`#${id}`).innerText();
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('0');
    assert.equal(await v.page.locator('#activation-0').count(), 0);
    await v.until(() => document.getElementById('activation-1-text').textContent === '100 %');
    await v.page.getByLabel('active: tubes').fill('0.25');
    await v.until(() => window.lariat.body.activation[1] === 0.25);
    assert.deepEqual(own.state.body.activation, [1, 0.25]);
    assert.equal(await text('activation-1-text'), '25 %');
    assert.equal(await text('body-short'), 'changed');
    await v.shot('muscle');
    await other.page.bringToFront();
    await other.until(() => document.getElementById('activation-1').value === '0.25');
    await v.page.bringToFront();
    await v.page.getByRole('button', { name: 'As the scene' }).click();
    await v.until(() => window.lariat.body.activation[1] === 1 && document.getElementById('body-short').textContent === '');
    assert.deepEqual(own.faults, []);
    await other.close();
    await v.close();
});

test('gravity, damping and stiffness are set by slider and by keyboard, and go back', async (t) => {
    const own = await mock({ organs: 'halves' });
    t.after(() => own.close());
    const { body } = own.state;
    const v = await openPage(browser, own.url);
    const other = await openPage(browser, own.url);
    await v.page.bringToFront();
    const card = v.page.locator('#body-card');
    const text = (id) => v.page.locator(`#${id}`).innerText();
    assert.equal(await card.evaluate((it) => it.open), false);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('0');
    assert.equal(await card.evaluate((it) => it.open), true);
    assert.equal(await v.page.evaluate(() => document.activeElement.id), 'gravity');
    assert.equal(await text('gravity-text'), '9.81 m/s²');
    assert.equal(await text('damping-text'), '4 1/s');
    assert.equal(await text('stiffness-text'), '× 1.00');
    assert.equal(await v.page.locator('#gravity-direction').inputValue(), '-z');
    for (const width of [390, 1024]) {
        await v.page.setViewportSize({ width, height: 780 });
        await unfold(v.page);
        await v.page.locator('#body-reset').scrollIntoViewIfNeeded();
        await v.page.waitForTimeout(150);
        await v.shot(`body-${width}`);
    }
    await v.page.setViewportSize({ width: 1000, height: 640 });

    // Arrow keys move the slider, and not the picture, once it has glided to its new frame.
    let eye = 0;
    for (let tries = 0; tries < 50; tries++) {
        const before = eye;
        eye = await v.get('distance');
        if (Math.abs(eye - before) < 1e-4 * eye) break;
        await v.page.waitForTimeout(200);
    }
    await v.page.locator('#gravity').focus();
    await v.page.keyboard.press('ArrowRight');
    await v.until(() => window.lariat.body.gravity[2] < -9.9);
    within(await v.get('distance'), eye, 0.01 * eye);
    await v.page.locator('#gravity').fill('5');
    await v.until(() => window.lariat.body.gravity[2] === -5);
    await v.page.getByLabel('towards').selectOption('+x');
    await v.until(() => window.lariat.body.gravity[0] === 5);
    assert.deepEqual(body.gravity.map(Math.abs), [5, 0, 0]);
    await v.page.getByLabel('towards').selectOption('off');
    await v.until(() => window.lariat.body.gravity[0] === 0);
    assert.equal(await text('gravity-text'), 'off');
    await v.page.getByLabel('towards').selectOption('-y');
    await v.until(() => window.lariat.body.gravity[1] < -9);

    await v.page.locator('#damping').fill('0.5');
    await v.until(() => window.lariat.body.damping === 25);
    await v.page.locator('#stiffness').fill('1');
    await v.until(() => window.lariat.body.stiffness.every((factor) => factor === 4));
    assert.equal(await text('body-short'), 'changed');
    await v.page.locator('#stiffness-of').selectOption('tubes');
    await v.page.locator('#stiffness').fill('0');
    await v.until(() => window.lariat.body.stiffness[1] === 0.1);
    assert.equal(body.stiffness[0], 4);
    await v.page.locator('#stiffness-of').selectOption('all');
    assert.equal(await text('stiffness-text'), 'mixed');
    await other.until(() => document.getElementById('body-short').textContent === 'changed');
    within(Number(await other.page.locator('#damping').inputValue()), 0.5, 0.01);

    // Dragged through many values: few messages, and the last one counts.
    const before = own.state.settings;
    const began = Date.now();
    const box = await v.page.locator('#damping').boundingBox();
    await v.page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await v.page.mouse.down();
    for (let i = 0; i <= 60; i += 20) await v.page.mouse.move(box.x + box.width * (0.5 + i / 150), box.y + box.height / 2, { steps: 20 });
    await v.page.mouse.up();
    await v.page.waitForTimeout(300);
    const [sent, max] = [own.state.settings - before, (Date.now() - began) / 70 + 2];
    assert.ok(sent > 0 && sent < max, `${sent} messages, ${max} may be`);
    await v.until((shown) => Math.abs(window.lariat.body.damping - shown) < 1e-9, parseFloat(await text('damping-text')));

    await v.page.getByRole('button', { name: 'As the scene' }).click();
    await v.until(() => document.getElementById('body-short').textContent === '');
    assert.deepEqual(body, { gravity: [0, 0, -9.81], damping: 4, stiffness: [1, 1] });
    await v.until(() => document.getElementById('gravity-text').textContent === '9.81 m/s²');
    assert.deepEqual(own.faults, []);
    await other.close();
    await v.close();
});

test('an instrument is taken at its outline and the organ beside it, and the cursor says which', async (t) => {
    const own = await mock();
    t.after(() => own.close());
    Object.assign(own.poses[0], { position: [0, -0.06, 0.03], orientation: [1, 0, 0, 0] }); // upright before the organ
    const v = await openPage(browser, own.url);
    await v.page.waitForTimeout(400);
    const row = Array.from({ length: 190 }, (_, i) => [450 + i, 240]);
    const metal = (await colours(v.page, row)).map(([r, , b]) => r - b < 15);
    const [left, right] = [450 + metal.indexOf(true), 450 + metal.lastIndexOf(true)];
    assert.ok(right - left > 5 && right - left < 70, `the shaft is drawn from ${left} to ${right}`);
    const { at } = await placing(v.page);
    const cursor = async (place, pixels) => {
        const [x, y] = at([place, 240]);
        await v.page.mouse.move(x + pixels, y);
        await v.page.waitForTimeout(150);
        return v.page.locator('#picture').evaluate((canvas) => getComputedStyle(canvas).cursor);
    };
    assert.equal(await cursor((left + right) / 2, 0), 'pointer');
    assert.equal(await cursor(left, -3), 'pointer');
    assert.equal(await cursor(right, 3), 'pointer');
    for (const [edge, pixels] of [[left, -11], [right, 11]]) {
        assert.equal(await cursor(edge, pixels), 'grab');
        await v.page.mouse.down();
        await v.until(() => window.lariat.hand === 'holding');
        await v.page.mouse.up();
    }
    // Behind the organ it is not taken, wherever it is.
    own.poses[0].position = [0, 0.06, 0.03];
    await v.page.waitForTimeout(400);
    assert.equal(await cursor((left + right) / 2, 1), 'grab');
    await v.close();
});

test('a pull ends when the button that began it is up, also while another one is down', async (t) => {
    const own = await mock();
    t.after(() => own.close());
    const v = await openPage(browser, own.url);
    await drag(v.page, 500, 320, 40, -40);
    await v.until(() => window.lariat.hand === 'holding');
    await v.page.mouse.down({ button: 'right' });
    await v.page.waitForTimeout(100);
    assert.equal(await v.get('hand'), 'holding', 'the other button does nothing');
    await v.page.mouse.up({ button: 'left' });
    await v.until(() => window.lariat.hand === 'free');
    await v.page.mouse.up({ button: 'right' });
    await v.close();
});
