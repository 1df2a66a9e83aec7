// The page against the stand-in for the server: what the engine does too rarely to test with it.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { colours, difference, drag, openBrowser, openPage, unfold } from './browser.mjs';
import { mock } from './mock.mjs';

const REFUSED = [/WebSocket connection to/];
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

test('slow motion is announced so that nobody misses it, and only while it lasts', async () => {
    const v = await openPage(browser, server.url);
    assert.equal(await v.page.locator('#slow').isVisible(), false);
    server.state.slow = true;
    await v.page.locator('#slow').waitFor({ state: 'visible' });
    assert.match(await v.page.locator('#slow').innerText(), /slow motion\s+0\.40 × real time/i);
    const box = await v.page.locator('#slow').boundingBox();
    assert.ok(box.width * box.height > 10000, 'the banner is large');
    assert.equal(await v.page.locator('#state-text').innerText(), 'slow motion');
    // Which of the two it is, and what would help; never a factor that is none.
    assert.match(await v.page.locator('#slow').innerText(), /A step takes 250 µs .* --grid 2x2x1, a mesh of about 700 elements/);
    await v.shot('slow-motion');
    server.state.slow = 1.01;
    // Catching up is not slow motion, and at no time do badge and banner say different things.
    const said = await v.page.evaluate(async () => {
        const seen = new Set();
        for (let i = 0; i < 40; i++) {
            seen.add(`${document.getElementById('state-text').textContent}, ${document.getElementById('slow').hidden ? 'no banner' : 'banner'}`);
            await new Promise((resolve) => setTimeout(resolve, 50));
        }
        return [...seen];
    });
    assert.deepEqual(said, ['slow motion, banner', 'catching up with the clock, no banner']);
    // Every row of the engine's panel says what it is.
    await v.page.locator('#panel').evaluate((card) => (card.open = true));
    const rows = await v.page.locator('#panel tr').evaluateAll((all) => all.map((row) => [row.innerText, row.title]));
    assert.ok(rows.length > 15);
    for (const [text, title] of rows) assert.ok(title.length > 20, `${text} has no explanation`);
    server.state.slow = false;
    await v.page.locator('#slow').waitFor({ state: 'hidden' });
    await v.close();
});

test('a stop of the engine is shown with its reason and a way out', async () => {
    const v = await openPage(browser, server.url);
    server.state.state = 'stopped';
    server.state.message = 'element 1204 at (0.01, 0.02, 0.07) is turned inside out';
    const title = v.page.getByRole('heading', { name: 'The simulation has stopped' });
    await title.waitFor();
    assert.match(await v.page.locator('#trouble-text').innerText(), /element 1204/);
    assert.ok(await v.page.locator('#picture.gone').isVisible(), 'the picture is greyed');
    assert.equal(await v.page.locator('#play').isDisabled(), true);
    await v.shot('stopped');
    await v.page.locator('#trouble-do').click();
    await v.page.locator('#trouble').waitFor({ state: 'hidden' });
    assert.equal(server.state.message, '');
    assert.equal(server.state.state, 'playing');
    await v.close();
});

test('a recording that ends by itself is told at once, once', async () => {
    const v = await openPage(browser, server.url);
    server.state.recordingLost = 'way.recording: the recording could not be written completely: No space left on device';
    const line = v.page.locator('#notes').getByText('Recording has ended: way.recording');
    await line.waitFor();
    await v.page.waitForTimeout(500);
    assert.equal(await v.page.locator('#notes p').count(), 1);
    server.state.recordingLost = '';
    await v.close();
});

test("what the program records is shown, and neither button nor key ends it", async () => {
    const v = await openPage(browser, server.url);
    Object.assign(server.state, { recording: true, recordingBy: 'program' });
    const button = v.page.getByRole('button', { name: 'Recording, by the program' });
    await button.waitFor();
    assert.equal(await button.isDisabled(), true);
    assert.equal(await button.getAttribute('aria-pressed'), 'true');
    assert.match(await button.getAttribute('title'), /records all of this session itself, until it ends/);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('c');
    await v.page.locator('#notes').getByText('records all of this session itself').waitFor();
    assert.equal(server.state.recording, true);
    // The same, by a viewer: anybody ends it.
    Object.assign(server.state, { recordingBy: undefined });
    await v.page.getByRole('button', { name: 'Stop recording' }).click();
    await v.page.getByRole('button', { name: 'Record', exact: true }).waitFor();
    assert.equal(await v.page.locator('#record').getAttribute('title'), 'Record what you do (C)');
    await v.close();
});

test('a run that went back says so, once, and goes on', async () => {
    Object.assign(server.state, { recoveries: 2, recovery: 'went back 0.62 s to step 15800: element 7' });
    const v = await openPage(browser, server.url);
    await v.page.waitForTimeout(500);
    assert.equal(await v.page.locator('#notes p').count(), 0, 'what was before the page is not told');
    Object.assign(server.state, { recoveries: 3, recovery: 'went back 0.31 s to step 9000: element 1828' });
    const line = v.page.locator('#notes').getByText('went back 0.31 s to step 9000: element 1828');
    await line.waitFor();
    await v.page.waitForTimeout(500);
    assert.equal(await v.page.locator('#notes p').count(), 1);
    assert.equal(await v.page.locator('#trouble').isVisible(), false);
    await v.shot('went-back');
    Object.assign(server.state, { recoveries: 0, recovery: '' });
    await v.close();
});

test('a tool that tissue stops says so, and divided steps are told', async () => {
    const v = await openPage(browser, server.url);
    const row = v.page.locator('#tool-list').getByRole('radio', { name: 'probe' });
    await v.page.locator('#tools').evaluate((card) => (card.open = true));
    await v.page.locator('#panel').evaluate((card) => (card.open = true));
    await row.getByText('0.00 of 1.76 N').waitFor();
    Object.assign(server.state, { pressed: true, parts: 4, divided: 340 });
    await row.getByText('1.80 of 1.76 N, 400 µm deep, limit reached').waitFor();
    assert.equal(await row.locator('.load.bad').count(), 1);
    assert.match(await row.getAttribute('title'), /stays behind its hand/);
    const division = v.page.locator('#panel tr', { hasText: 'step divided by 4' });
    await division.waitFor();
    assert.match(await division.getAttribute('title'), /shorter steps/);
    assert.match(await v.page.locator('#panel tr', { hasText: 'divided steps' }).innerText(), /340/);
    await v.shot('limit-reached');
    Object.assign(server.state, { pressed: false, parts: 1, divided: 0 });
    await row.getByText('limit reached').waitFor({ state: 'hidden' });
    await v.close();
});

test('a lost processor is named, and nothing that would be in vain is offered', async () => {
    const v = await openPage(browser, server.url);
    Object.assign(server.state, { state: 'stopped', lost: true, message: 'processor 1 is lost' });
    await v.page.getByRole('heading', { name: 'has lost a processor' }).waitFor();
    assert.match(await v.page.locator('#trouble-text').innerText(), /processor 1 is lost/);
    assert.equal(await v.page.locator('#trouble-do').isVisible(), false);
    assert.equal(await v.page.locator('#reset').isDisabled(), true);
    Object.assign(server.state, { state: 'playing', lost: false, message: '' });
    await v.page.locator('#trouble').waitFor({ state: 'hidden' });
    await v.close();
});

test('when all hands are taken, or nothing is within reach, a sentence says so', async () => {
    const v = await openPage(browser, server.url);
    server.state.refuse = true;
    await drag(v.page, 500, 320, 40, -40);
    await v.page.getByText('Other viewers have all hands').waitFor();
    assert.equal(await v.get('hand'), 'free');
    await v.page.mouse.up();
    server.state.refuse = false;
    await v.close();
});

test('a wrong token is answered with what to do, and not tried again', async () => {
    const locked = await mock({ token: 'right-token' });
    const v = await openPage(browser, `${locked.url}#token=wrong-token`, { drawn: false });
    await v.page.getByText('The engine asks for a token').waitFor();
    await v.page.waitForTimeout(1500);
    assert.equal(locked.state.connections, 0);
    await v.close();
    const w = await openPage(browser, `${locked.url}#token=right-token`);
    assert.equal(await w.get('connected'), true);
    await w.close();
    await locked.close();
});

test('who may only watch sees everything and is offered nothing that the engine would refuse', async (t) => {
    const own = await mock({ token: 'right-token', watchToken: 'watch-token' });
    t.after(() => own.close());
    own.state.saved = ['pear-1.checkpoint'];
    own.state.recordings = ['pear-1.recording'];
    for (const address of ['#token=watch-token', '#token=right-token&watch=1']) {
        const v = await openPage(browser, own.url + address);
        assert.ok(await v.get('watches'));
        await v.page.getByText('only watching').waitFor();
        for (const id of ['play', 'step', 'reset', 'record', 'save', 'load', 'pace', 'gravity', 'gravity-direction', 'damping', 'stiffness', 'body-reset'])
            assert.equal(await v.page.locator(`#${id}`).isDisabled(), true, id);
        assert.equal(await v.page.locator('#ask').isDisabled(), false);
        assert.equal(await v.page.locator('#tool-more').isVisible(), false);
        assert.equal(await v.page.locator('#hint').innerText(), 'Drag to look around, wheel to zoom');
        // A drag on the organ turns the picture; keys that act on the run say why they do not.
        const pictures = await v.get('pictures');
        await drag(v.page, 500, 320, 60, -40);
        await v.page.mouse.up();
        await v.until((n) => window.lariat.pictures > n + 2, pictures);
        assert.equal(await v.get('hand'), 'free');
        await v.page.locator('#picture').focus();
        for (const key of ['Space', '.', 'r', 'j', 'c', 's', 'v', 'p', '[', 'x', ',', '0', 'Insert', 'Delete']) await v.page.keyboard.press(key);
        await v.page.getByText('This page may only watch').first().waitFor();
        await v.page.locator('#saved').evaluate((card) => (card.open = true));
        assert.equal(await v.page.locator('#saved-states button').first().isDisabled(), true);
        await v.page.keyboard.press('3');
        await v.until(() => window.lariat.field === 4);
        await v.shot('only-watching');
        await v.close();
    }
    assert.deepEqual(own.state.refused, [], 'nothing was sent that is refused');
    const w = await openPage(browser, `${own.url}#token=right-token`);
    assert.equal(await w.get('watches'), false);
    assert.equal(await w.page.locator('#play').isDisabled(), false);
    await w.close();
});

test('when the engine ends the page says so within 3 s, greys, and finds a new one by itself', async () => {
    const first = await mock();
    const v = await openPage(browser, first.url, { expected: [...REFUSED, /failed: /] });
    await first.close();
    await v.page.getByText('No connection to the engine').waitFor();
    assert.ok(await v.page.locator('#picture.gone').isVisible());
    assert.equal(await v.page.locator('#play').isDisabled(), true);
    const second = await mock({ port: first.port });
    await v.page.locator('#trouble').waitFor({ state: 'hidden' });
    const frames = await v.get('frames');
    await v.until((n) => window.lariat.frames > n + 2, frames);
    await v.close();
    await second.close();
});

test('frames are asked for one at a time, and never too many messages are sent', async () => {
    const v = await openPage(browser, server.url);
    server.state.mute = true; // no answer: no further question
    await v.page.waitForTimeout(300);
    const frames = await v.get('frames');
    await v.page.waitForTimeout(500);
    assert.equal(await v.get('frames'), frames);
    server.state.mute = false;
    await v.close();
    const w = await openPage(browser, server.url);
    await drag(w.page, 500, 320, 60, -40, 15);
    await w.page.mouse.up();
    await w.close();
    assert.deepEqual(server.faults, []);
});

test('pressure has a map with zero in its middle; processors have colours of their own', async () => {
    const v = await openPage(browser, server.url);
    await v.page.getByRole('radio', { name: 'pressure' }).click();
    await v.until(() => window.lariat.field === 8);
    await drag(v.page, 500, 250, 0, -70);
    await v.page.waitForTimeout(700);
    // Both of one picture: the range follows every frame.
    const [min, max] = await v.page.evaluate(() =>
        ['legend-least', 'legend-most'].map((id) => document.getElementById(id).innerText));
    assert.equal(min, `−${max}`);
    await v.page.mouse.up();
    await v.page.getByRole('radio', { name: 'processor' }).click();
    assert.equal(await v.page.locator('#keys-of-colours li').count(), 4);
    await v.page.waitForTimeout(400);
    const [left, right] = await colours(v.page, [[430, 260], [570, 260]]);
    assert.ok(difference(left, right) > 25, 'the halves differ');
    await v.shot('processors');
    await v.close();
});

test('an organ at rest has one colour: the range has a floor', async (t) => {
    const own = await mock();
    t.after(() => own.close());
    own.state.noise = true; // values of rounding, as a body at rest has them
    const v = await openPage(browser, own.url);
    const places = [[470, 300], [530, 300], [500, 250], [500, 380]];
    for (const [name, max] of [['displacement', '50.0 µm'], ['von Mises stress', '1.00 Pa'], ['pressure', '1.00 Pa']]) {
        await v.page.getByRole('radio', { name }).click();
        await v.until((text) => document.getElementById('legend-most').innerText === text, max);
        await v.page.waitForTimeout(300);
        const seen = await colours(v.page, places);
        for (const colour of seen) assert.ok(difference(colour, seen[0]) < 45, `${name}: ${seen.join(' | ')}`);
    }
    await v.shot('at-rest');
    await v.close();
});

test('an embedded surface is drawn instead of the mesh, painted and pulled; one may look at either', async () => {
    const own = await mock({ riding: true });
    const v = await openPage(browser, own.url);
    assert.equal(await v.get('surface'), 'fine');
    const nodes = await v.get('nodes');
    assert.equal(await v.get('torn'), 0);
    // Seen from the front it stands off the mesh: what lies between both silhouettes tells them apart.
    await v.page.waitForTimeout(300);
    await v.shot('fine-surface');
    const rows = Array.from({ length: 200 }, (_, i) => [500 + i, 320]);
    const width = async () => (await colours(v.page, rows)).filter(([r, g]) => r > 60 && r > 1.2 * g).length;
    const fine = await width();
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('m');
    await v.until(() => window.lariat.surface === 'mesh');
    assert.notEqual(await v.get('nodes'), nodes);
    await v.page.waitForTimeout(300);
    const coarse = await width();
    assert.ok(fine >= coarse + 4, `${fine} places of the row are embedded surface, ${coarse} mesh`);
    await v.page.getByLabel('embedded surface').check();
    await v.until(() => window.lariat.surface === 'fine');

    // Pulled where it is drawn; the engine hears a point of the mesh.
    await drag(v.page, 500, 250, 40, -60);
    await v.until(() => window.lariat.hand === 'holding' && window.lariat.displacement > 0.003);
    const held = own.state.grabbed;
    const nearest = Math.min(...own.mesh.x.map((_, i, x) => (i % 3 ? 1 : Math.hypot(x[i] - held[0], x[i + 1] - held[1], x[i + 2] - held[2]))));
    assert.ok(nearest < 0.0035, `${nearest} m from the next node of the mesh`);
    await v.page.keyboard.press('m'); // while pulling, too
    await v.page.waitForTimeout(200);
    await v.page.keyboard.press('m');
    await v.page.getByRole('radio', { name: 'displacement' }).evaluate((choice) => choice.click());
    await v.until(() => window.lariat.field === 1);
    await v.page.waitForTimeout(400);
    await v.shot('fine-surface-pulled');
    const [pulled, below] = await colours(v.page, [[510, 225], [500, 480]]);
    assert.ok(difference(pulled, below) > 40, `${pulled} where it is pulled, ${below} far from there`);
    await v.page.mouse.up();
    await v.until(() => window.lariat.hand === 'free');
    await v.page.getByRole('radio', { name: 'tissue' }).evaluate((choice) => choice.click());

    const line = Array.from({ length: 60 }, (_, i) => [470 + i, 330]);
    const roughness = async () => {
        const row = await colours(v.page, line);
        return row.slice(1).reduce((sum, c, i) => sum + difference(c, row[i]), 0);
    };
    await v.page.waitForTimeout(800);
    const plain = await roughness();
    await v.page.getByLabel('mesh edges').check();
    await v.page.waitForTimeout(400);
    await v.shot('fine-surface-edges');
    const edged = await roughness();
    assert.ok(edged > plain * 1.5 + 40, `${edged} with edges, ${plain} without`);
    await v.close();
    await own.close();
});

test('nothing overlaps, from phones to wide windows, also low ones', async (t) => {
    const own = await mock({ scan: true, toolName: 'a probe with a name of sixty-three characters, as scenes may have' });
    t.after(() => own.close());
    const always = ['header', '#slow', '#force', '#looks', '#transport'];
    const v = await openPage(browser, own.url);
    await v.page.getByRole('radio', { name: 'a probe' }).click(); // whose name is longer than its card
    const name = v.page.locator('#force-name');
    assert.equal(await name.getAttribute('title'), await name.innerText());
    const oneLine = await name.evaluate((e) => e.clientHeight < 30 && e.scrollWidth > e.clientWidth);
    assert.ok(oneLine, 'one line, that ends with an ellipsis');
    const slowAdvice = 'a step takes 24.1 us of the 94.6 us that it has, but other programs keep the processor busy, here or on a virtual machine\'s host; end them, or try --grid 1x1x1: it may hold beside a browser that draws in software, or try --priority 10';
    Object.assign(own.state, { slow: true, slowAdvice, saved: ['pear-1.checkpoint'], recordings: ['pear-1.recording'] });
    await v.page.locator('#slow').waitFor({ state: 'visible' });
    await v.page.evaluate(() => {
        const line = document.createElement('p');
        line.textContent = 'Saved: checkpoint abdomen_pelvis_of_a_long_name-1.checkpoint';
        document.getElementById('notes').append(line);
    });
    await laidOut(v, [...always, '#hint', '#notes p'], 'hint');
    await v.page.evaluate(() => document.getElementById('notes').replaceChildren());
    own.state.replay = { name: 'pear-1.recording', time: 0.4, length: 2 };
    await v.page.locator('#replay').waitFor({ state: 'visible' });
    await laidOut(v, [...always, '#replay'], 'replay');
    const agreed = v.page.locator('#replay-agreed');
    assert.equal(await agreed.innerText(), '', 'not before its end');
    own.state.replay.time = 2;
    await agreed.getByText('all hashes agreed').waitFor();
    own.state.message = 'the hash of step 100 is not the recorded one';
    await v.page.locator('#replay-trouble').getByText('not the recorded one').waitFor();
    own.state.message = '';
    await v.page.waitForTimeout(300);
    assert.equal(await agreed.innerText(), '', 'one that differed is not forgotten');
    own.state.replay = null;
    await v.page.locator('#replay').waitFor({ state: 'hidden' });
    // Every panel unfolded and full: it scrolls, and is nowhere wider than its column.
    await v.page.evaluate(() => document.querySelectorAll('#looks details').forEach((card) => (card.open = true)));
    await v.page.getByLabel('cut open').check();
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('2');
    await v.page.keyboard.press('i');
    await v.page.keyboard.press('Enter');
    await v.page.keyboard.press('d');
    await v.page.keyboard.press('Enter');
    await v.until(() => window.lariat.reading.node > 0);
    await v.page.keyboard.press('w');
    await v.page.keyboard.press('q');
    await v.until(() => window.lariat.scan);
    await laidOut(v, always, 'unfolded');
    for (const width of [390, 800, 1024, 1600]) {
        await v.page.setViewportSize({ width, height: 780 });
        await unfold(v.page);
        await v.page.waitForTimeout(150);
        const wide = await v.page.evaluate(() => {
            const looks = document.getElementById('looks');
            const { right } = looks.getBoundingClientRect();
            return [...looks.querySelectorAll('*')].filter((part) => part.getBoundingClientRect().right > right + 1).map((part) => part.id || part.outerHTML.slice(0, 80));
        });
        assert.deepEqual(wide, [], `wider than the column at ${width}`);
        const padding = await v.page.evaluate(() => {
            const { right } = document.getElementById('panel').getBoundingClientRect();
            return Math.min(...[...document.querySelectorAll('#panel td')].map((cell) => right - cell.getBoundingClientRect().right));
        });
        assert.ok(padding > 6, `the engine's numbers are ${padding} pixels from the edge at ${width}`);
        const place = (part) => v.page.locator(part).evaluate((e) => e.getBoundingClientRect().toJSON());
        const free = (await place('#transport')).top - (await place('#looks')).bottom;
        assert.ok(free < 12, `${free} pixels below the column are not used at ${width}`);
        const legend = (await place('#legend-map + .row')).height;
        assert.ok(legend < 24, `the legend's numbers are broken at ${width}: ${legend} pixels high`);
        await v.page.locator('#cut-across').scrollIntoViewIfNeeded();
        await v.shot(`layout-inside-${width}`);
        await v.page.locator('#steps').scrollIntoViewIfNeeded();
        await v.shot(`layout-plots-${width}`);
    }
    await Promise.all([v.page.waitForEvent('download'), v.page.keyboard.press('w')]);
    // The keys are read from the top, and the way out is in sight.
    for (const [width, height] of [[390, 780], [800, 600]]) {
        await v.page.setViewportSize({ width, height });
        await v.page.keyboard.press('?');
        assert.equal(await v.page.locator('#help').evaluate((help) => help.scrollTop), 0, `scrolled at ${width}`);
        const close = await v.page.getByRole('button', { name: 'Close' }).boundingBox();
        assert.ok(close.y + close.height < height, `Close is out of sight at ${width}`);
        await v.shot(`layout-help-${width}`);
        await v.page.keyboard.press('Escape');
    }
    await v.close();
});

/** The parts of the page lie inside the window, beside each other and not squeezed, at many sizes. */
async function laidOut(v, parts, name) {
    for (const [width, height] of [[320, 240], [390, 780], [500, 320], [640, 480], [640, 900], [800, 600], [900, 700], [1024, 600], [1024, 420], [1320, 700], [1600, 900]]) {
        await v.page.setViewportSize({ width, height });
        await v.page.waitForTimeout(150);
        // In a narrow window the button that cards are folded into takes their place; in a low one a note the hint's.
        const there = await v.page.evaluate((all) => all.filter((part) => part !== '#hint' || innerHeight > 400)
            .map((part) => (part === '#looks' && document.getElementById('cards').offsetWidth ? '#cards' : part)), parts);
        const boxes = await v.page.evaluate((all) => all.map((part) => {
            const { left, top, right, bottom } = document.querySelector(part).getBoundingClientRect();
            return { part, left, top, right, bottom };
        }), there);
        const say = (a) => `${a.part} (${[a.left, a.top, a.right, a.bottom].map(Math.round)})`;
        for (const a of boxes) {
            assert.ok(a.left >= 0 && a.top >= 0 && a.right <= width + 0.5 && a.bottom <= height + 0.5, `${say(a)} at ${width} x ${height}`);
            assert.ok(a.bottom - a.top > 16 && a.right - a.left > 40, `${say(a)} is squeezed at ${width} x ${height}`);
            for (const b of boxes)
                assert.ok(a === b || a.right <= b.left + 1 || b.right <= a.left + 1 || a.bottom <= b.top + 1 || b.bottom <= a.top + 1,
                    `${say(a)} and ${say(b)} overlap at ${width} x ${height}`);
        }
        if ([390, 800, 1024, 1600].includes(width) && height > 500) await v.shot(`layout-${name}-${width}`);
    }
}

test('a long title takes two lines, and all of it is where the pointer rests', async (t) => {
    const title = `Uterus of the demonstration, ${'with a description that goes on and on, '.repeat(6)}as scenes may have`;
    const own = await mock({ title });
    t.after(() => own.close());
    const v = await openPage(browser, own.url);
    for (const [width, height] of [[400, 700], [1000, 640]]) {
        await v.page.setViewportSize({ width, height });
        await v.page.waitForTimeout(150);
        const high = await v.page.locator('#title').evaluate((e) => e.clientHeight);
        assert.ok(high < 65, `${high} pixels in a window of ${width}`);
        const state = await v.page.locator('#state').boundingBox();
        assert.ok(state.x + state.width <= width && state.y < 110, `the badge is at ${state.y}`);
    }
    assert.equal(await v.page.locator('#title').getAttribute('title'), title);
    await v.close();
});

test('with forced colours swatches keep theirs, and graphs can be read', async (t) => {
    const own = await mock({ organs: 'halves' });
    t.after(() => own.close());
    const v = await openPage(browser, own.url);
    const shown = (selector) => v.page.locator(selector).first().evaluate((e) => getComputedStyle(e).backgroundColor);
    await v.page.locator('#inside').evaluate((card) => (card.open = true));
    const organ = await shown('#organs canvas');
    await v.page.getByRole('radio', { name: 'processor' }).click();
    await v.page.locator('#keys-of-colours canvas').first().waitFor();
    const key = await shown('#keys-of-colours canvas');
    for (const colorScheme of ['light', 'dark']) {
        await v.page.emulateMedia({ forcedColors: 'active', colorScheme });
        assert.equal(await shown('#organs canvas'), organ);
        assert.equal(await shown('#keys-of-colours canvas'), key);
        assert.equal(await shown('#graph'), 'rgb(20, 24, 28)', 'the dark ground that its lines are made for');
        await v.page.waitForTimeout(300);
        await v.shot(`forced-colours-${colorScheme}`);
    }
    await v.close();
});

test('a page that the engine cuts off for its own fault says so, and keeps what was written', async () => {
    const v = await openPage(browser, server.url);
    await v.page.getByText('Add a tool', { exact: true }).click();
    await v.page.locator('#add-radius').fill('7.25');
    server.cut(1008, 'there is no key x');
    await v.page.locator('#notes').getByText('closed the connection: there is no key x. That is a fault of this page.').waitFor();
    await v.until(() => window.lariat.connections === 2 && window.lariat.connected);
    await v.page.locator('#trouble').waitFor({ state: 'hidden' });
    await v.page.waitForTimeout(300);
    assert.equal(await v.page.locator('#notes').getByText('a fault of this page').count(), 1);
    assert.equal(await v.page.locator('#add-radius').inputValue(), '7.25');
    await v.close();
});

test('tools are added and removed, by mouse and by keys, and what cannot be is said', async (t) => {
    const own = await mock();
    t.after(() => own.close());
    const [v, other] = [await openPage(browser, own.url), await openPage(browser, own.url)];
    const radio = (page, name) => page.getByRole('radio', { name });
    await v.page.bringToFront();
    // By mouse: sizes that fit the body are there already, in millimetres.
    await v.page.getByText('Add a tool', { exact: true }).click();
    assert.equal(await v.page.locator('#add-length-row').isVisible(), false);
    assert.ok(Number(await v.page.locator('#add-radius').inputValue()) > 0);
    for (const [radius, because] of [['0', 'more than zero'], ['-3', 'more than zero'], ['', 'in mm'], ['1e400', 'in mm'], ['1,250', 'in mm'], ['1.2.3', 'in mm'], ['five', 'in mm']]) {
        await v.page.locator('#add-radius').fill(radius);
        await v.page.getByRole('button', { name: 'Add', exact: true }).click();
        await v.page.locator('#add-trouble').getByText(because).waitFor();
    }
    assert.deepEqual(own.state.asked, [], 'and is not asked for');
    assert.equal(await v.page.locator('#add-radius').inputValue(), 'five', 'and stays to be mended');
    // A comma is a decimal point, typed as well.
    await v.page.locator('#add-radius').fill('');
    await v.page.locator('#add-radius').pressSequentially('6,5');
    await v.page.getByRole('button', { name: 'Add', exact: true }).click();
    await radio(v.page, 'sphere 1').waitFor();
    assert.deepEqual(own.state.asked, [{ do: 'add_tool', shape: 'sphere', radius: 0.0065 }]);
    assert.equal(await v.page.locator('#add-trouble').innerText(), '');
    await v.page.getByText('stands above the body').waitFor();
    assert.equal(await radio(v.page, 'sphere 1').getAttribute('aria-checked'), 'true');
    assert.equal(await v.page.locator('#force-name').innerText(), 'sphere 1');
    await other.until(() => window.lariat.names.includes('sphere 1'));
    assert.equal(await radio(other.page, 'hand').getAttribute('aria-checked'), 'true', 'others go on with theirs');
    // By keys alone.
    const keys = v.page.keyboard;
    await v.page.locator('#picture').focus();
    await keys.press('Insert');
    assert.equal(await v.page.evaluate(() => document.activeElement.id), 'add-shape');
    await keys.press('s'); // shaft: the second of that letter
    await keys.press('s');
    await v.page.locator('#add-shape').selectOption('capsule');
    await keys.press('Tab');
    await keys.press('Tab');
    await keys.press('Control+A');
    await keys.type('80');
    await keys.press('Enter');
    await radio(v.page, 'capsule 2').waitFor();
    assert.equal(own.state.asked[1].length, 0.08);
    await v.until(() => document.activeElement.id === 'picture');
    await keys.press('p');
    for (let i = 0; i < 4; i++) await keys.press('ArrowRight');
    await v.until(() => Math.hypot(window.lariat.tools[4][0] - 0.02, window.lariat.tools[4][1]) > 0.003);
    await keys.press('Escape');
    await v.shot('tools-added');
    // No place is left, and says so; one that is removed leaves the lists of both pages.
    await keys.press('*');
    await v.page.getByRole('button', { name: 'Add', exact: true }).click();
    await v.page.getByText('no place is left').waitFor();
    await v.page.locator('#picture').focus();
    await keys.press('Delete');
    await v.until(() => !window.lariat.names.includes('capsule 2'));
    assert.equal(await radio(v.page, 'hand').getAttribute('aria-checked'), 'true');
    await other.until(() => !window.lariat.names.includes('capsule 2'));
    await keys.press('Delete');
    await v.page.getByText('those of the scene stay').waitFor();
    await radio(v.page, 'sphere 1').click();
    await v.page.getByRole('button', { name: 'Remove sphere 1' }).click();
    await v.until(() => !window.lariat.names.includes('sphere 1'));
    assert.equal(await v.page.locator('#remove-tool').isVisible(), false);
    assert.deepEqual(own.state.asked.slice(-2), [{ do: 'remove_tool', tool: 4 }, { do: 'remove_tool', tool: 3 }]);
    await v.close();
    await other.close();
});

test('where nothing rides there is no switch for it, and its key says so', async () => {
    const v = await openPage(browser, server.url);
    assert.equal(await v.get('surface'), 'mesh');
    assert.equal(await v.page.getByLabel('embedded surface').isVisible(), false);
    await v.page.locator('#picture').focus();
    await v.page.keyboard.press('m');
    await v.page.getByText('has no embedded surface').waitFor();
    await v.close();
});

test('a browser without WebGL gets a sentence instead of an empty page', async () => {
    const blind = await openBrowser({ flags: ['--disable-3d-apis'] });
    const v = await openPage(blind, server.url, { drawn: false });
    await v.page.getByText('shows no 3D pictures').waitFor();
    await v.close();
    await blind.close();
});

test('memory stays level while frames come', async () => {
    const v = await openPage(browser, server.url);
    const devtools = await browser.context.newCDPSession(v.page);
    const used = async () => {
        await devtools.send('HeapProfiler.collectGarbage');
        return (await devtools.send('Runtime.getHeapUsage')).usedSize;
    };
    const frames = await v.get('frames');
    await v.until((n) => window.lariat.frames > n + 20, frames);
    const before = await used();
    await v.until((n) => window.lariat.frames > n + 70, frames);
    const grown = (await used()) - before;
    assert.ok(grown < 400e3, `grew by ${grown} bytes in 50 frames`);
    await v.close();
});
