/* The keyboard: everything that the mouse can do. The list for people is in index.html (#help). */
import { element } from '../dom';
import type { AddTool } from '../cards/addtool';
import type { BodyCard } from '../cards/bodycard';
import type { Colours } from '../cards/colours';
import type { Hand } from './hand';
import type { Instrument } from './instrument';
import type { ReplayBar } from '../cards/replaybar';
import type { InsideCard } from '../inspect/insidecard';
import type { Capture } from '../inspect/capture';
import type { Scan } from '../inspect/scan';
import type { Plots } from '../inspect/plots';
import type { MeasureCard } from '../inspect/measurecard';
import type { SavedCard } from '../cards/savedcard';
import type { Panel } from '../cards/panel';
import { ONLY_WATCHES } from '../link/session';
import type { Transport } from '../cards/transport';
import type { View } from '../picture/view';

export interface Served {
    view: View;
    hand: Hand;
    instrument: Instrument;
    transport: Transport;
    replay: ReplayBar;
    saved: SavedCard;
    body: BodyCard;
    addTool: AddTool;
    colours: Colours;
    panel: Panel;
    inside: InsideCard;
    measure: MeasureCard;
    capture: Capture;
    plots: Plots;
    scan: Scan;
    say(text: string): void;
    used(what: 'pull' | 'look' | 'move'): void;
    help(): void;
}

const TURN = 0.09;
const MOVE = 0.02; // of the organ's size

export function listenToKeys(s: Served): void {
    window.addEventListener('keydown', (event) => {
        if (event.ctrlKey || event.altKey || event.metaKey) return;
        const target = event.target as HTMLElement;
        if (document.querySelector('dialog[open]')) return;
        if (target.matches('input, select') && event.key !== 'Escape') return;
        if ([' ', 'Enter'].includes(event.key) && target.matches('button, summary')) return;
        if (press(s, event)) event.preventDefault();
    });
}

/* True when the key means something. */
function press(s: Served, event: KeyboardEvent): boolean {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const digit = Number(key);
    if (key >= '1' && key <= '9') {
        s.colours.choose(digit - 1);
        return true;
    }
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[key];
    if (arrow) return go(s, arrow[0]!, arrow[1]!, event.shiftKey);
    if (event.repeat && !['+', '-', '=', 'PageUp', 'PageDown', '[', ']', '.', ',', ';', '<', '>', '{', '}'].includes(key)) return false;
    const acts: Record<string, () => void> = {
        ' ': () => s.transport.playOrPause(),
        '.': () => s.transport.step(),
        r: () => s.transport.reset(),
        j: () => s.transport.shift(-1),
        l: () => s.transport.shift(1),
        c: () => s.transport.recordOrEnd(),
        s: () => s.transport.saveNow(),
        v: () => s.transport.loadLast(),
        o: () => s.saved.toggle(),
        0: () => s.body.open(),
        Insert: () => s.addTool.open(),
        '*': () => s.addTool.open(),
        Delete: () => s.addTool.remove(),
        x: () => s.replay.leave(),
        ',': () => s.replay.seekBy(-0.25),
        ';': () => s.replay.seekBy(0.25),
        e: () => element('edges').click(),
        z: () => element('shadows').click(),
        '/': () => (element('fibres-row').hidden ? s.say('Nothing in this scene has fibres.') : element('fibres').click()),
        m: () => (element('fine-row').hidden ? s.say('This scene has no embedded surface.') : element('fine').click()),
        f: () => s.view.endoscope.reset(),
        g: () => s.panel.toggle(),
        q: () => s.scan.toggle(),
        a: () => s.scan.nextAxis(),
        '{': () => s.scan.move(-1),
        '}': () => s.scan.move(1),
        y: () => s.plots.toggle(),
        n: () => s.capture.takePicture(),
        w: () => s.capture.filmOrEnd(),
        i: () => s.measure.toggle('read'),
        d: () => s.measure.toggle('distance'),
        Enter: () => s.measure.pressMiddle(),
        h: () => s.inside.fadeMiddle(),
        u: () => s.inside.showAll(),
        k: () => s.inside.toggleCut(),
        b: () => s.inside.nextDirection(),
        '<': () => s.inside.moveCut(-0.02),
        '>': () => s.inside.moveCut(0.02),
        t: () => s.instrument.next(),
        p: () => hold(s),
        '+': () => s.view.endoscope.zoom(0.88),
        '=': () => s.view.endoscope.zoom(0.88),
        '-': () => s.view.endoscope.zoom(1 / 0.88),
        PageUp: () => deeper(s, -1),
        PageDown: () => deeper(s, 1),
        '[': () => s.instrument.open(s.instrument.opening - 0.05),
        ']': () => s.instrument.open(s.instrument.opening + 0.05),
        '?': () => s.help(),
        Escape: () => letGo(s),
    };
    const act = acts[key];
    if (!act) return false;
    act();
    return true;
}

function go(s: Served, x: number, y: number, shift: boolean): boolean {
    const by = MOVE * (s.view.surface?.size ?? 1);
    if (s.hand.busy) s.hand.pullBy(x * by, y * by, 0);
    else if (s.instrument.held) s.instrument.moveBy(x * by, y * by, 0);
    else if (shift) s.view.endoscope.pan(-x * 0.04, y * 0.04);
    else {
        s.view.endoscope.turn(-x * TURN, y * TURN);
        s.used('look');
    }
    return true;
}

function deeper(s: Served, near: number): void {
    const by = near * MOVE * (s.view.surface?.size ?? 1);
    if (s.hand.busy) s.hand.pullBy(0, 0, by);
    else if (s.instrument.held) s.instrument.moveBy(0, 0, by);
}

function letGo(s: Served): void {
    s.hand.release();
    s.instrument.drop();
    if (s.measure.press !== 'pull') s.measure.choose('pull');
    element('cross').hidden = true;
}

/* Takes hold of the chosen tool, or of the surface in the middle of the picture; again lets go. */
function hold(s: Served): void {
    if (s.hand.busy || s.instrument.held) return letGo(s);
    if (!s.hand.allowed) return s.say(ONLY_WATCHES);
    if (s.hand.prevented()) return;
    if (s.instrument.chosen >= 0) {
        s.instrument.take(null);
        s.used('move');
        return s.say('Arrow keys move the instrument, P lets it go.');
    }
    const hit = s.view.middle();
    if (!hit) return s.say('Nothing in the middle of the picture.');
    s.hand.grab(hit);
    s.used('pull');
    s.say('Arrow keys pull, P lets go.');
}
