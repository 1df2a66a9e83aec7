/* The viewer: puts the parts together and runs the loop of animation frames. */
import { AddTool } from './cards/addtool';
import { BodyCard } from './cards/bodycard';
import { Colours } from './cards/colours';
import { Desk, covers } from './cards/desk';
import { element } from './dom';
import { ForceCard } from './cards/forcecard';
import { Hand } from './hands/hand';
import { InsideCard } from './inspect/insidecard';
import { Capture } from './inspect/capture';
import { MeasureCard } from './inspect/measurecard';
import { Plots } from './inspect/plots';
import { Scan } from './inspect/scan';
import { Instrument } from './hands/instrument';
import { listenToKeys } from './hands/keys';
import { Hints, Trouble, note } from './cards/notices';
import { Panel, StateLine } from './cards/panel';
import { Pointer } from './hands/pointer';
import type { Status } from './link/protocol';
import { ReplayBar } from './cards/replaybar';
import { SavedCard } from './cards/savedcard';
import { Session } from './link/session';
import { ToolCard } from './cards/toolcard';
import { Transport } from './cards/transport';
import { View } from './picture/view';
import { publish } from './window';

const trouble = new Trouble();
const START_AGAIN = 'If it has ended, start it anew: lariat view SCENE';

function start(): void {
    const canvas = element<HTMLCanvasElement>('picture');
    if (!document.createElement('canvas').getContext('webgl2')) {
        return trouble.show(
            'This browser shows no 3D pictures',
            'The viewer draws with WebGL 2, and this browser has none, or it is switched off.',
            'Switch on hardware acceleration in its settings, or open this address in a current Firefox or Chromium.',
            { text: 'Try again', do: () => location.reload() },
        );
    }
    const view = new View(canvas, covers);
    new Desk(() => view.arrangeInWindow());
    const force = new ForceCard();
    const panel = new Panel();
    const line = new StateLine();
    const hints = new Hints();
    const help = (): void => element<HTMLDialogElement>('help').showModal();
    const used = (what: string): void => hints.used(what);

    const session = new Session({
        hello(hello) {
            line.setTitle(hello.title);
            panel.setHello(hello);
            transport.setHello(hello);
            saved.setHello(hello);
            body.setHello(hello);
            inside.setHello(hello);
            measure.setHello(hello);
            plots.setHello(hello);
            scan.setHello(hello);
            view.instruments.set(hello.tools, hello.hands);
            toolCard.setHello(hello);
            addTool.setHello(hello);
            hand.forget();
            element('watching').hidden = !hello.watches;
            force.setHello(hello);
            instrument.choose(-1);
            stopped = '';
            recoveries = placed = -1;
            trouble.hide();
        },
        surface(surface) {
            const { materials, view: from } = session.hello!;
            view.setSurface(surface, materials.map((material) => material.name), from);
            colours.setHello(session.hello!);
            addTool.setSurface(surface);
            element('fine-row').hidden = true;
            element('fibres-row').hidden = surface.families === 0;
            element('fibres-second').hidden = surface.families < 2;
            hints.start(session.watches);
        },
        embedded(embedded) {
            view.setEmbedded(embedded);
            element('fine-row').hidden = false;
        },
        frame(frame) {
            view.setFrame(frame);
            view.others.update(frame, session.status, session.hello!.hands, force.range, view.endoscope.camera);
            colours.frame(frame);
        },
        forces(forces) {
            // A hand that holds nothing of ours may hold somebody else's.
            const ours = hand.state === 'holding' || (instrument.chosen >= 0 && !hand.busy);
            if (!ours) forces.values.fill(0);
            force.add(forces);
        },
        status(status) {
            transport.update(status);
            saved.update(status);
            body.update(status);
            replay.update(status);
            hints.silence(replay.shown || trouble.shown || measure.press !== 'pull');
            panel.update(status);
            plots.update(status);
            line.update(status);
            toolCard.update(status);
            addTool.update(status);
            showStop(status);
            showRecovery(status);
        showRecordingLost(status);
            dropPlaced(status);
        },
        tools(tools) {
            view.instruments.set(tools, session.hello!.hands);
            toolCard.setTools(tools);
            if (instrument.changed()) pointer.drop();
            addTool.show();
            chooseForce();
            view.changed();
        },
        added: (tool) => addTool.added(tool, session.tools),
        hand(news) {
            hand.news(news);
            chooseForce();
        },
        values(values) {
            measure.values(values);
            plots.values(values);
        },
        slice(slice) {
            scan.take(slice);
        },
        note(text) {
            note(text);
            addTool.refused(text);
        },
        lost(loss) {
            pointer.end();
            hand.forget();
            transport.enable(false);
            line.lost();
            panel.lost();
            hints.silence(true);
            // It connects again within a second: without a word nobody would know what has happened.
            if (loss.again && loss.ours)
                note(`The engine has closed the connection: ${loss.because || 'a message that it does not know'}. That is a fault of this page.`, 30000);
            const again = { text: 'Try now', do: () => session.connect() };
            if (!loss.again)
                return trouble.show(
                    'The engine asks for a token',
                    loss.because || 'The token in the address is missing or wrong.',
                    'Open the whole address that lariat view has printed, with what follows the #.',
                    again,
                );
            trouble.show(
                'No connection to the engine',
                (session.status?.lost && session.status.message) ||
                    loss.because ||
                    'It has ended, or cannot be reached.',
                'This page connects by itself as soon as the engine is there again. ' + START_AGAIN,
                again,
            );
        },
    });

    const hand = new Hand(session, view, note);
    const instrument = new Instrument(session, view, (tool) => {
        toolCard.show(tool);
        addTool.show();
        chooseForce();
    });
    const toolCard = new ToolCard(instrument);
    const addTool = new AddTool(session, instrument, note);
    const saved = new SavedCard(session);
    const body = new BodyCard(session, note);
    const replay = new ReplayBar(session);
    const transport = new Transport(session, help, replay);
    const measure = new MeasureCard(session, view, note);
    const capture = new Capture(session, view, note);
    const plots = new Plots(session);
    const scan = new Scan(session, view, note);
    const inside = new InsideCard(view, note);
    const colours = new Colours(view, (field) => (session.field = field));
    const pointer = new Pointer(view, hand, instrument, measure, used);
    listenToKeys({
        view, hand, instrument, transport, replay, saved, body, addTool, colours, panel, inside, measure, capture, plots, scan, used, help, say: note,
    });

    const edges = element<HTMLInputElement>('edges');
    edges.addEventListener('change', () => view.showEdges(edges.checked));
    const fibres = element<HTMLInputElement>('fibres');
    fibres.addEventListener('change', () => view.showFibres(fibres.checked));
    const shadows = element<HTMLInputElement>('shadows');
    shadows.checked = view.shadows;
    shadows.addEventListener('change', () => view.showShadows(shadows.checked));
    const fine = element<HTMLInputElement>('fine');
    fine.addEventListener('change', () => {
        view.showFine(fine.checked);
        hand.surfaceChanged();
        measure.surfaceChanged();
    });

    /* Bar and graph show the chosen instrument, or the hand. */
    function chooseForce(): void {
        const hello = session.hello;
        if (!hello) return;
        const pulling = hand.busy || instrument.chosen < 0;
        const tool = pulling ? (hand.tool >= 0 ? hand.tool : (hello.hands[0] ?? -1)) : instrument.chosen;
        if (tool !== session.forceTool) force.history.clear();
        session.showForcesOf(tool);
        force.name(pulling ? 'Your pull' : (session.tools[tool]?.name || 'Force'));
    }

    let stopped = ''; // why, as shown
    function showStop(status: Status): void {
        const because = status.state === 'stopped' ? status.message || 'It does not say why.' : '';
        if (because === stopped) return;
        stopped = because;
        if (!because) return trouble.hide();
        hints.silence(true);
        pointer.end();
        hand.forget();
        if (status.lost)
            return trouble.show('The engine has lost a processor and ends', because, START_AGAIN);
        const ways = [{ text: 'Reset', do: () => transport.reset() }];
        if (status.saved.length)
            ways.push({ text: 'Load the last checkpoint', do: () => transport.loadLast() });
        trouble.show(
            'The simulation has stopped',
            because,
            'Reset takes it back to the start. Pull less far, or more slowly, if it stops again.',
            ...ways,
        );
    }

    let recoveries = -1; // as shown; -1: those before this page was there are not
    function showRecovery(status: Status): void {
        if (recoveries >= 0 && status.recoveries > recoveries)
            note(`The tissue was strained too much, and the run ${status.recovery}`, 9000);
        recoveries = status.recoveries;
    }

    let recordingLost = '';
    function showRecordingLost(status: Status): void {
        const why = status.recording_lost ?? '';
        if (why && why !== recordingLost) note(`Recording has ended: ${why}`, 30000);
        recordingLost = why;
    }

    let placed = -1;
    function dropPlaced(status: Status): void {
        if (placed >= 0 && status.placed > placed) {
            pointer.drop();
            if (instrument.placed()) note('The instrument is where this state has it; take it anew to move it.');
        }
        placed = status.placed;
    }

    let before = performance.now();
    let pictures = 0;
    let counted = before;
    function loop(now: number): void {
        requestAnimationFrame(loop);
        session.ask(now);
        hand.update(now, force.range);
        instrument.update(now);
        measure.update(now);
        pointer.update();
        replay.look(now);
        if (view.draw(Math.min(0.1, (now - before) / 1000))) pictures++;
        before = now;
        if (now - counted > 1000) {
            panel.pictureRate = (pictures * 1000) / (now - counted);
            pictures = 0;
            counted = now;
        }
    }
    publish(session, view, hand, force, measure, scan);
    requestAnimationFrame(loop);
    session.connect();
}

start();
