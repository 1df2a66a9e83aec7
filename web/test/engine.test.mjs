// The page against the engine itself: everything that a person does in the first minutes.
import assert from 'node:assert/strict';
import { mkdirSync, readdirSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { click, OUT, colours, difference, drag, openBrowser, openPage, unfold } from './browser.mjs';
import { demo, endAll, rider, scanned, tornDemo, view } from './engine.mjs';

mkdirSync(OUT, { recursive: true });
const model = demo();
const MIDDLE = [500, 330];
const FUNDUS = [500, 220];
let browser;
let engine;
let v; // the page that most tests go on with

before(async () => {
    [browser, engine] = await Promise.all([
        openBrowser(),
        view(model.scene, '--port', '0', '--save-folder', model.saved),
    ]);
    v = await openPage(browser, engine.url);
});
after(async () => {
    await browser?.close();
    await engine?.end();
    endAll();
});

const button = (name) => v.page.getByRole('button', { name, exact: true });
const state = (wanted) => v.until((s) => window.lariat.state === s, wanted);

/* The run as at the start, playing. */
async function fresh() {
    await v.page.keyboard.press('Escape');
    await button('Reset').click();
    await v.until(() => window.lariat.displacement < 1e-4);
    if ((await v.get('state')) !== 'playing') await button('Play').click();
    await state('playing');
}

test('the organ is drawn, in the middle, and in tissue colours', async () => {
    assert.equal(await v.page.title(), 'Uterus – Lariat');
    const [organ, corner] = await colours(v.page, [MIDDLE, [300, 600]]);
    assert.ok(difference(organ, corner) > 60, `organ ${organ}, background ${corner}`);
    assert.ok(organ[0] > organ[1] * 1.3, 'tissue is red');
    assert.match(await v.page.locator('#hint').innerText(), /drag to pull/);
    await v.shot('1-start');
});

test('a drag pulls the organ, and letting go lets it return', async () => {
    await fresh();
    const rest = await v.get('checksum');
    await drag(v.page, ...FUNDUS, 60, -70);
    await v.until(() => window.lariat.hand === 'holding');
    await v.until(() => window.lariat.force > 0.02 && window.lariat.displacement > 0.003);
    assert.notEqual(await v.get('checksum'), rest);
    assert.ok((await v.get('forces')) > 100, 'the graph has a value for every tick');
    assert.match(await v.page.locator('#force-value').innerText(), /[1-9].* N$/);
    await v.shot('2-pulled');
    await v.page.mouse.up();
    await v.until(() => window.lariat.force === 0 && window.lariat.displacement < 0.002);
    assert.equal(await v.get('hand'), 'free');
    assert.ok((await v.get('peak')) > 0.02, 'the graph keeps the last seconds');
    await v.until(() => !/drag to pull/.test(document.getElementById('hint').innerText));
});

test('pause, step, play and reset', async () => {
    await fresh();
    await button('Pause').click();
    await state('paused');
    await v.page.waitForTimeout(300);
    const paused = await v.get('step');
    await v.page.waitForTimeout(500);
    assert.equal(await v.get('step'), paused, 'pause stops the steps');
    await button('Step').click();
    await v.until((s) => window.lariat.step > s, paused);
    await v.page.waitForTimeout(300);
    const stepped = await v.get('step');
    assert.ok(stepped - paused <= 20, `${stepped - paused} steps`);
    await button('Play').click();
    await v.until((s) => window.lariat.step > s + 1000, stepped);
    await button('Pause').click();
    await state('paused');
    await button('Reset').click();
    await v.until(() => window.lariat.step === 0);
});

test('pace', async () => {
    await fresh();
    await v.page.getByLabel('Pace').selectOption('0.1');
    await v.page.getByText('0.1 × real time, as asked for').waitFor();
    await v.page.getByLabel('Pace').selectOption('1');
    await v.page.locator('#state-text', { hasText: /real time|slow motion/ }).waitFor();
});

test('record, save and load', async () => {
    await fresh();
    await button('Record').click();
    await v.page.locator('#record[aria-pressed="true"]').waitFor();
    await drag(v.page, ...FUNDUS, 30, -40, 3);
    await v.page.waitForTimeout(200);
    await v.page.mouse.up();
    await button('Stop recording').click();
    await v.page.getByText(/Saved: recording/).waitFor();
    await button('Save').click();
    await v.page.getByText(/Saved: checkpoint/).waitFor();
    const files = readdirSync(model.saved);
    assert.equal(files.length, 2, files.join(' '));
    for (const file of files) assert.ok(statSync(join(model.saved, file)).size > 1000, file);
    const at = await v.get('step');
    await v.until((s) => window.lariat.step > s + 5000, at);
    await button('Load').click();
    await v.until((s) => window.lariat.step < s + 4000, at);
});

test('a recording is played: listed, paused, scrubbed, left; and it outlives the session', async (t) => {
    await fresh();
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('c');
    await v.page.locator('#record[aria-pressed="true"]').waitFor();
    await drag(v.page, ...FUNDUS, 40, -60, 8);
    await v.until(() => window.lariat.hand === 'holding' && window.lariat.displacement > 0.003);
    await v.page.waitForTimeout(600);
    await v.page.mouse.up();
    await v.page.waitForTimeout(800);
    await v.page.keyboard.press('c');
    await v.page.locator('#record[aria-pressed="false"]').waitFor();
    await v.page.keyboard.press('o');
    const list = v.page.locator('#saved-recordings button');
    await list.first().waitFor();
    const name = await list.first().innerText();
    await fresh();

    // Listed by another engine too, which plays it.
    const later = await view(model.scene, '--port', '0', '--save-folder', model.saved);
    const p = await openPage(browser, later.url);
    t.after(async () => {
        if (p.page.isClosed()) return;
        await p.page.close(); // what failed is not to be in the way of what follows
        await later.end();
    });
    await p.page.locator('#saved').evaluate((card) => (card.open = true));
    assert.equal(await p.page.locator('#saved-states button').count(), await v.page.locator('#saved-states button').count());
    await p.page.getByRole('button', { name: `Play ${name}` }).click();
    await p.page.locator('#replay').waitFor({ state: 'visible' });
    await p.until(() => window.lariat.displacement > 0.003);
    await p.page.locator('#picture').focus();
    await p.page.keyboard.press('Space');
    await p.until(() => window.lariat.state === 'paused');
    assert.equal(await p.page.locator('#hint').innerText(), '', 'nobody can pull now');
    await p.shot('11-replay');
    const slider = p.page.getByLabel('Place in the recording');
    const half = (Number(await slider.getAttribute('max')) / 2).toFixed(2);
    const arrived = (place) => p.until((text) => document.getElementById('replay-time').innerText.startsWith(`${text} of`), place);
    await slider.fill('0'); // as the browser writes numbers: it refuses 0.30
    await arrived('0.00');
    await p.until(() => window.lariat.displacement < 1e-3 && window.lariat.state === 'paused');
    assert.equal(await p.get('state'), 'paused', 'where it was scrubbed to it rests');
    const hash = await p.get('hash');
    await slider.fill(String(Number(half)));
    await arrived(half);
    await p.until((h) => window.lariat.hash !== h, hash);
    const seen = await p.get('frames');
    await p.until((n) => window.lariat.frames > n + 2, seen);
    const middle = await p.get('hash');
    await slider.fill('0');
    await p.until((h) => window.lariat.hash === h, hash);
    await slider.fill(String(Number(half)));
    await p.until((h) => window.lariat.hash === h, middle);
    await p.page.locator('#picture').focus();
    await p.page.keyboard.press(';');
    await p.until((text) => parseFloat(document.getElementById('replay-time').innerText) > Number(text) + 0.1 && window.lariat.state === 'paused', half);
    await drag(p.page, ...FUNDUS, 10, -10, 2);
    await p.page.getByText('a recording is being played').waitFor();
    await p.page.mouse.up();
    await p.page.waitForTimeout(300);
    const notes = (await p.page.locator('#notes').innerText()).trim();
    assert.match(notes, /^A recording is being played; leave it/, 'one note, though the recording is paused and nothing was held');
    assert.equal(notes.split('\n').length, 1, notes);
    await p.page.keyboard.press('Space');
    await p.until(() => {
        const [here, end] = document.getElementById('replay-time').innerText.split(' of ').map(parseFloat);
        return window.lariat.state === 'paused' && end - here < 0.02;
    });
    assert.equal(await p.page.locator('#replay-trouble').innerText(), '', 'all hashes are equal');
    await p.page.getByText('all hashes agreed').waitFor();
    await p.page.keyboard.press('x');
    await p.page.locator('#replay').waitFor({ state: 'hidden' });
    await p.page.keyboard.press('Space');
    await p.until(() => window.lariat.state === 'playing');
    await p.close();
    await later.end();
});

test('colour maps change the picture, the legend and its range', async () => {
    await fresh();
    await drag(v.page, ...FUNDUS, 30, -60);
    // Far enough that no range is at its floor.
    await v.until(() => window.lariat.hand === 'holding' && window.lariat.force > 0.01 && window.lariat.displacement > 0.003);
    const [tissue] = await colours(v.page, [MIDDLE]);
    const seen = new Set();
    const fields = [['displacement', 1, /m$/], ['von Mises stress', 4, /Pa$/], ['pressure', 8, /Pa$/]];
    for (const [name, number, unit] of fields) {
        await v.page.getByRole('radio', { name }).evaluate((choice) => choice.click());
        await v.until((n) => window.lariat.field === n, number);
        await v.page.waitForTimeout(250);
        const max = await v.page.locator('#legend-most').innerText();
        assert.match(max, unit);
        assert.notEqual(parseFloat(max), 0, `${name} up to ${max}`);
        const [colour] = await colours(v.page, [MIDDLE]);
        assert.ok(difference(colour, tissue) > 25, `${name}: ${colour}, tissue: ${tissue}`);
        seen.add(max);
        await v.shot(`3-${name.replaceAll(' ', '-')}`);
    }
    assert.equal(seen.size, 3);
    await v.page.mouse.up();

    await v.page.getByRole('radio', { name: 'displacement' }).click();
    await v.page.getByLabel('range follows the picture').uncheck();
    await v.page.getByLabel('from', { exact: true }).fill('-1');
    await v.page.getByLabel('to', { exact: true }).fill('0.00001');
    assert.equal(await v.page.locator('#legend-least').innerText(), '−1.00 m');
    await v.until(() => window.lariat.field === 1);
    await v.page.waitForTimeout(400);
    const [yellow] = await colours(v.page, [MIDDLE]);
    assert.ok(yellow[0] > yellow[2] + 50, `all at the upper end: ${yellow}`);
    await v.page.getByRole('radio', { name: 'tissue' }).click();
    assert.equal(await v.page.locator('#legend').isVisible(), false);
});

test('mesh edges', async () => {
    await fresh();
    const row = Array.from({ length: 60 }, (_, i) => [470 + i, 330]);
    const roughness = async () => {
        const line = await colours(v.page, row);
        return line.slice(1).reduce((sum, c, i) => sum + difference(c, line[i]), 0);
    };
    const plain = await roughness();
    await v.page.getByLabel('mesh edges').check();
    await v.page.waitForTimeout(400);
    const edged = await roughness();
    assert.ok(edged > plain * 1.5 + 40, `${edged} with edges, ${plain} without`);
    await v.page.getByLabel('mesh edges').uncheck();
});

test('everything by keyboard', async () => {
    await fresh();
    await v.page.locator('#picture').focus();
    const keys = v.page.keyboard;
    await keys.press('Space');
    await state('paused');
    const before = await v.get('step');
    await keys.press('.');
    await v.until((s) => window.lariat.step > s, before);
    await keys.press('Space');
    await state('playing');
    await keys.press('3');
    await v.until(() => window.lariat.field === 4);
    await keys.press('1');
    await v.until(() => window.lariat.field === 0);
    const pictures = await v.get('pictures');
    await keys.press('ArrowLeft');
    await v.until((n) => window.lariat.pictures > n, pictures);
    await keys.press('f');
    await keys.press('?');
    assert.ok(await v.page.getByRole('dialog').isVisible());
    await v.shot('4-help');
    await keys.press('Escape');
    await v.page.getByRole('dialog').waitFor({ state: 'hidden' });
    await v.page.waitForTimeout(500);
    await keys.press('p');
    await v.until(() => window.lariat.hand === 'holding');
    for (let i = 0; i < 6; i++) await keys.press('ArrowUp');
    await v.until(() => window.lariat.force > 0.01);
    await keys.press('p');
    await v.until(() => window.lariat.hand === 'free' && window.lariat.force === 0);
});

test('the hands of other viewers are drawn, and your pull is yours', async () => {
    await fresh();
    const other = await openPage(browser, engine.url);
    await drag(other.page, ...FUNDUS, 40, -60);
    await other.until(() => window.lariat.hand === 'holding' && window.lariat.force > 0.01);
    await v.page.bringToFront();
    await v.until(() => window.lariat.others === 1);
    await v.shot('12-other-hand');
    assert.equal(await v.get('force'), 0, 'your pull is not theirs');
    assert.equal(await v.get('hand'), 'free');
    await other.page.bringToFront();
    await other.until(() => window.lariat.others === 0);
    await other.page.mouse.up();
    await other.close();
    await v.page.bringToFront();
    await v.until(() => window.lariat.others === 0);
});

test('gravity pulls the organ down, a stiffer one gives less, and other viewers see it', async () => {
    await fresh();
    const other = await openPage(browser, engine.url);
    await v.page.bringToFront();
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('0');
    await v.page.getByLabel('towards').selectOption('-z');
    await v.page.locator('#gravity').fill('15');
    await v.until(() => window.lariat.displacement > 1e-3);
    await v.until(() => window.lariat.body.gravity[2] === -15);
    await v.page.locator('#damping').fill('0.5');
    await v.page.waitForTimeout(1500);
    const sagged = await v.get('displacement');
    await v.page.locator('#stiffness').fill('1');
    await v.until((soft) => window.lariat.body.stiffness.every((factor) => factor === 4) && window.lariat.displacement < 0.6 * soft, sagged);
    await v.shot('13-body');
    await other.page.bringToFront();
    await other.until(() => window.lariat.body.stiffness[0] === 4 && document.getElementById('body-short').textContent === 'changed');
    await other.close();
    await v.page.bringToFront();
    await v.page.getByRole('button', { name: 'As the scene' }).click();
    await v.until(() => window.lariat.body.gravity[2] === 0 && window.lariat.body.stiffness[0] === 1);
    await v.page.locator('#body-card').evaluate((card) => (card.open = false));
    assert.equal(await v.get('state'), 'playing');
});

test('values of a node and an element are those of the engine', async () => {
    await fresh();
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('i');
    await click(v.page, ...FUNDUS);
    await v.until(() => window.lariat.reading.node > 0 && window.lariat.reading.element > 0);
    await v.page.keyboard.press('i');
    await drag(v.page, ...FUNDUS, 40, -60);
    await v.until(() => window.lariat.hand === 'holding' && window.lariat.displacement > 0.003);
    await v.until(() => /von Mises\s+[1-9][\d.]* k?Pa/.test(document.getElementById('reading').innerText));
    // As colours have it: the node that is read is below the greatest of all.
    const text = await v.page.locator('#reading').innerText();
    assert.match(text, /displacement\s+[1-9][\d.]* mm/);
    assert.match(text, /organ\s+uterus/i);
    await v.shot('13-reading');
    await v.page.mouse.up();
    await v.page.getByRole('button', { name: 'Clear' }).click();
});

test('a scene from a scan: its slices, and the instruments beside it', async () => {
    const { image, scene } = scanned();
    const own = await view(scene, '--port', '0', '--scan', image);
    const s = await openPage(browser, own.url);
    await s.page.locator('#picture').focus();
    await s.page.keyboard.press('q');
    await s.until(() => window.lariat.scan);
    await s.page.keyboard.press('a');
    await s.page.getByText('i 12 of 24').waitFor();
    assert.deepEqual(await s.page.locator('#tool-list button').evaluateAll((all) => all.map((one) => one.getAttribute('aria-label') ?? one.textContent)), ['hand', 'probe', 'grasper']);
    await s.page.waitForTimeout(400);
    await s.shot('14-scan');
    await s.close();
    await own.end();
});

test('who opens the second address can only watch', async () => {
    const own = await view(model.scene, '--port', '0', '--token', 'for-the-surgeon', '--watch-token', 'for-the-class');
    const w = await openPage(browser, own.url.replace('for-the-surgeon', 'for-the-class'));
    assert.match(own.said(), /#token=for-the-class\nWho opens that one can only watch/);
    assert.equal(await w.get('watches'), true);
    // Past its own page: the engine itself refuses.
    const answer = await w.page.evaluate(() => new Promise((done) => {
        const socket = new WebSocket(`ws://${location.host}/socket?token=for-the-class`, 'lariat.1');
        socket.onopen = () => socket.send('{"do":"pause"}');
        socket.onmessage = ({ data }) => typeof data === 'string' && /"note"/.test(data) && done(data);
    }));
    assert.match(answer, /may only watch/);
    assert.equal(await w.page.locator('#gravity').isDisabled(), true);
    assert.equal(await w.get('state'), 'playing');
    await w.close();
    await own.end();
});

test('instruments are chosen, moved and closed', async () => {
    await fresh();
    const tools = () => v.get('tools');
    await v.page.getByRole('radio', { name: 'grasper' }).click();
    const [, rest] = await tools();
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('p');
    for (let i = 0; i < 5; i++) await v.page.keyboard.press('ArrowRight');
    await v.until((x) => Math.abs(window.lariat.tools[1][0] - x) > 0.003, rest[0]);
    await v.page.keyboard.press('Escape');
    await v.page.locator('#opening').fill('0.4');
    await v.until(() => Math.abs(window.lariat.tools[1][3] - 0.4) < 0.01);
    await v.page.getByRole('radio', { name: 'hand' }).click();
    assert.equal(await v.page.locator('#opening-row').isVisible(), false);
});

test('a tool is added by keyboard, presses the organ, is felt, and is removed', async () => {
    await fresh();
    const keys = v.page.keyboard;
    await v.page.locator('#picture').focus();
    await keys.press('Insert');
    await keys.press('Tab');
    await keys.press('Control+A');
    await keys.type('8');
    await keys.press('Enter');
    await v.until(() => window.lariat.names.includes('sphere 1'));
    const tool = (await v.get('names')).indexOf('sphere 1');
    await v.until(() => document.activeElement.id === 'picture');
    assert.equal(await v.page.locator('#force-name').innerText(), 'sphere 1');
    assert.ok((await v.get('displacement')) < 1e-3, 'it touches nothing yet');
    const second = await openPage(browser, engine.url);
    await second.until(() => window.lariat.names.includes('sphere 1'));
    await second.page.getByRole('radio', { name: 'sphere 1' }).waitFor();
    await second.close();
    await v.page.bringToFront();
    // Down into the organ: its force and its limit are shown, and the tissue gives way.
    await keys.press('p');
    const pressed = () => window.lariat.force > 0.05 && window.lariat.displacement > 2e-3;
    for (let i = 0; i < 14 && !(await v.page.evaluate(pressed)); i++) {
        await keys.press('ArrowDown');
        await v.page.waitForTimeout(120);
    }
    await v.until(pressed);
    assert.match(await v.page.getByRole('radio', { name: 'sphere 1' }).innerText(), /of \d+\.\d\d N/);
    await v.shot('tool-pressed');
    // A size that cannot be is said by the engine.
    await keys.press('Escape');
    await keys.press('Insert');
    await v.page.locator('#add-radius').fill('4000');
    await keys.press('Enter');
    await v.page.getByText('too large for a body').waitFor();
    await v.page.getByText('the field has the one that it names').waitFor();
    const named = Number(await v.page.locator('#add-radius').inputValue());
    assert.ok(named > 10 && named < 500, `${named} mm`);
    // However absurd: the connection stays.
    await v.page.locator('#add-radius').fill('2000000');
    await keys.press('Enter');
    await v.page.getByText('a radius of 2e+06 mm is too large').waitFor();
    assert.equal(await v.get('connections'), 1);
    // A reset keeps it, above the body.
    await v.page.locator('#picture').focus();
    await fresh();
    assert.ok((await v.get('names')).includes('sphere 1'));
    await v.page.waitForTimeout(300);
    assert.ok((await v.get('displacement')) < 1e-3);
    for (const [width, height] of [[390, 780], [800, 700], [1600, 900]]) {
        await v.page.setViewportSize({ width, height });
        await unfold(v.page);
        await v.page.locator('#add-tool').scrollIntoViewIfNeeded();
        await v.page.waitForTimeout(400);
        await v.shot(`tool-added-${width}`);
    }
    await v.page.setViewportSize({ width: 1000, height: 640 });
    await v.page.getByRole('radio', { name: 'sphere 1' }).click();
    await v.page.locator('#picture').focus();
    await keys.press('Delete');
    await v.until(() => !window.lariat.names.includes('sphere 1'));
    assert.equal((await v.get('names'))[tool], '');
    assert.equal(await v.page.locator('#force-name').innerText(), 'Your pull');
});

test('after a reset an instrument is where the scene has it, and stays there', async () => {
    await fresh();
    const grasper = async () => (await v.get('tools'))[1].slice(0, 3);
    const apart = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
    const rest = await grasper();
    await v.page.getByRole('radio', { name: 'grasper' }).click();
    await v.page.locator('#picture').focus();
    const keys = v.page.keyboard;
    await keys.press('p');
    for (let i = 0; i < 8; i++) await keys.press('ArrowLeft');
    await v.until((x) => Math.hypot(...window.lariat.tools[1].slice(0, 3).map((y, i) => y - x[i])) > 0.005, rest);
    await keys.press('r');
    await v.until((x) => Math.hypot(...window.lariat.tools[1].slice(0, 3).map((y, i) => y - x[i])) < 1e-6, rest);
    await v.page.getByText('take it anew').waitFor();
    await keys.press('ArrowLeft'); // it is nobody's now: this turns the view
    await v.page.waitForTimeout(500);
    assert.ok(apart(await grasper(), rest) < 1e-6, 'a key brings it back');
    await v.page.reload();
    await v.until(() => window.lariat?.frames > 2 && window.lariat.tools.length > 1);
    await v.page.waitForTimeout(500);
    assert.ok(apart(await grasper(), rest) < 1e-6, 'leaving brings it back');
    // Taken anew, it goes on from there.
    await v.page.getByRole('radio', { name: 'grasper' }).click();
    await v.page.locator('#picture').focus();
    await keys.press('p');
    await keys.press('ArrowRight');
    await v.until((x) => Math.hypot(...window.lariat.tools[1].slice(0, 3).map((y, i) => y - x[i])) > 1e-4, rest);
    assert.ok(apart(await grasper(), rest) < 0.004);
    await keys.press('Escape');
    await v.page.getByRole('radio', { name: 'hand' }).click();
});

test('one finger pulls, two zoom', async () => {
    await fresh();
    const phone = await openBrowser({ viewport: { width: 412, height: 780 }, hasTouch: true, isMobile: true, deviceScaleFactor: 1 });
    const p = await openPage(phone, engine.url);
    const touch = await phone.context.newCDPSession(p.page);
    const fingers = (type, ...points) =>
        touch.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    await fingers('touchStart', [206, 350]);
    for (let i = 1; i <= 6; i++) await fingers('touchMove', [206 + 3 * i, 350 - 7 * i]);
    await p.until(() => window.lariat.hand === 'holding' && window.lariat.force > 0.01);
    await p.shot('5-phone');
    await fingers('touchEnd');
    await p.until(() => window.lariat.hand === 'free');
    const far = await p.get('distance');
    await fingers('touchStart', [180, 350], [230, 350]);
    for (let i = 1; i <= 6; i++) await fingers('touchMove', [180 - 20 * i, 350], [230 + 20 * i, 350]);
    await fingers('touchEnd');
    await p.until((d) => window.lariat.distance < 0.7 * d, far);
    assert.equal(await p.get('hand'), 'free');
    await p.close();
    await phone.close();
});

test('ten reloads in a row, quickly; every frame was of one step', async () => {
    for (let i = 0; i < 10; i++) {
        await v.page.reload({ waitUntil: 'commit' });
        await v.page.waitForTimeout(60);
    }
    await v.until(() => window.lariat?.frames > 2);
    assert.equal(await v.get('torn'), 0);
    await v.close();
});

test('an embedded surface follows its mesh: drawn, pulled where it stands off, and switched off', async () => {
    const riding = await view(rider(), '--port', '0');
    const r = await openPage(browser, riding.url);
    assert.equal(await r.get('surface'), 'fine');
    assert.equal(await r.get('nodes'), 2 * 40 * 39 + 2);
    await r.page.waitForTimeout(300);
    await r.shot('8-fine');
    // The ball stands 8 mm off the block's sides.
    await drag(r.page, ...MIDDLE, 70, -50);
    await r.until(() => window.lariat.hand === 'holding' && window.lariat.displacement > 0.004);
    await r.shot('9-fine-pulled');
    await r.page.keyboard.press('m');
    await r.until(() => window.lariat.surface === 'mesh' && window.lariat.nodes !== 3122);
    await r.page.keyboard.press('e');
    await r.page.keyboard.press('m');
    await r.until(() => window.lariat.surface === 'fine' && window.lariat.hand === 'holding');
    await r.page.waitForTimeout(300);
    await r.shot('10-fine-edges');
    await r.page.mouse.up();
    await r.page.getByRole('radio', { name: 'von Mises stress' }).evaluate((choice) => choice.click());
    await r.until(() => window.lariat.field === 4 && window.lariat.displacement < 0.003);
    assert.equal(await r.get('torn'), 0);
    await r.close();
    await riding.end();
});

test('two families of fibres in an artery: lines on its faces, which turn with them', async () => {
    const artery = await view(join(process.cwd(), '../examples/scenes/artery.yaml'), '--port', '0');
    const a = await openPage(browser, artery.url);
    await a.page.getByLabel('fibres').evaluate((box) => box.click());
    await a.until(() => window.lariat.fibres > 0);
    assert.equal((await a.get('fibres')) % 2, 0);
    await a.until(() => window.lariat.displacement > 0.0002);
    await a.page.waitForTimeout(300);
    await a.shot('11-artery-fibres');
    assert.equal(await a.get('torn'), 0);
    await a.close();
    await artery.end();
});

test('a run that breaks is explained, and reset takes it up again', async () => {
    const torn = await view(tornDemo(model), '--port', '0');
    const t = await openPage(browser, torn.url, { drawn: false });
    await t.page.getByText('The simulation has stopped').waitFor();
    assert.match(await t.page.locator('#trouble-text').innerText(), /element|node/);
    await t.shot('6-stopped');
    await t.page.locator('#trouble-do').click();
    await t.page.locator('#trouble').waitFor({ state: 'hidden' });
    await t.close();
    await torn.end();
});

test('an engine that is killed is missed within 3 s, and found again', async () => {
    const first = await view(model.scene, '--port', '0');
    const t = await openPage(browser, first.url, { expected: [/WebSocket connection/, /failed: /] });
    await first.end('SIGKILL');
    await t.page.getByText('No connection to the engine').waitFor();
    await t.shot('7-lost');
    const second = await view(model.scene, '--port', String(first.port));
    assert.equal(second.port, first.port);
    await t.page.locator('#trouble').waitFor({ state: 'hidden' });
    const frames = await t.get('frames');
    await t.until((n) => window.lariat.frames > n + 1, frames);
    await t.close();
    await second.end();
});
