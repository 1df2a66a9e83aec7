/* Plots of the run: energies over the last half minute, and how long steps and answers took, with the line
 * by which they were due. Energies are asked for only while the card is open: the engine's server goes
 * through all elements for them. (The force has its own graph, cards/graph.ts.) */
import { element, withUnit, write } from '../dom';
import type { Hello, Status, Values } from '../link/protocol';
import type { Session } from '../link/session';

const SECONDS = 30;
const MOST = 400; // samples
const FIRST_BIN = 1.024e-6; // s
const STRAIN = '#ffb938';
const KINETIC = '#6fc3f5';
const LATE = '#ff6f61';
const QUIET = '#a3abb5';

/* Where a bin of `step_bins` begins [s]: two to every doubling. */
export function binStart(bin: number): number {
    return FIRST_BIN * 2 ** Math.floor(bin / 2) * (bin % 2 ? 1.5 : 1);
}

/* The place of a time among the bins, whole numbers where they begin. */
export function binAt(seconds: number): number {
    if (!(seconds > FIRST_BIN)) return 0;
    const octave = Math.floor(Math.log2(seconds / FIRST_BIN));
    const part = seconds / (FIRST_BIN * 2 ** octave) - 1;
    return 2 * octave + 2 * part;
}

/* The bins from the first to the last that holds something, with one more on either side; at least
 * as far as `due`. */
export function shownBins(bins: number[], due: number): [number, number] {
    const held = bins.map((count, i) => (count > 0 ? i : -1)).filter((i) => i >= 0);
    const min = Math.min(...held, Math.floor(due));
    const max = Math.max(...held, Math.ceil(due));
    return [Math.max(0, min - 1), Math.min(bins.length, max + 2)];
}

/* Whole decades around some numbers, six at most: what is smaller is as good as nothing. */
export function decades(values: number[]): [number, number] {
    const above = values.filter((value) => value > 0);
    if (!above.length) return [-6, -3];
    const max = Math.ceil(Math.log10(Math.max(...above)) - 1e-9);
    const min = Math.floor(Math.log10(Math.min(...above)));
    return [Math.max(Math.min(min, max - 1), max - 6), max];
}

interface Sample {
    time: number;
    strain: number;
    kinetic: number;
}

export class Plots {
    private readonly card = element<HTMLDetailsElement>('plots');
    private readonly energies = new Sheet('energies');
    private readonly answers = new Sheet('answers');
    private readonly steps = new Sheet('steps');
    private samples: Sample[] = [];
    private hello: Hello | null = null;
    private nextBars = 0;

    constructor(session: Session) {
        this.card.addEventListener('toggle', () => (session.energies = this.card.open));
    }

    setHello(hello: Hello): void {
        this.hello = hello;
        this.samples = [];
    }

    toggle(): void {
        this.card.open = !this.card.open;
        if (this.card.open) this.card.scrollIntoView({ block: 'nearest' });
    }

    values(values: Values): void {
        const energy = values.energy;
        if (!energy) return;
        const last = this.samples[this.samples.length - 1];
        if (last && values.time < last.time) this.samples = []; // reset, loaded, or gone back
        if (last?.time !== values.time)
            this.samples.push({ time: values.time, strain: energy.strain + energy.hourglass, kinetic: energy.kinetic });
        while (this.samples.length > MOST || this.samples[0]!.time < values.time - SECONDS) this.samples.shift();
        this.drawEnergies();
    }

    /* Twice a second is enough for bars. */
    update(status: Status): void {
        const now = performance.now();
        if (!this.card.open || !this.hello || now < this.nextBars) return;
        this.nextBars = now + 500;
        const pace = status.pace || Infinity; // as fast as it goes, nothing is due
        this.drawBars(this.answers, status.tick_bins, this.hello.tick / pace);
        this.drawBars(this.steps, status.step_bins, this.hello.time_step / pace);
        const due = status.pace ? `, due within ${withUnit(this.hello.tick / pace, 's')}` : '';
        write(element('answers-text'), `Answers to tools${due}: ${status.misses} of ${status.ticks} missed`);
        const has = status.pace ? `, of the ${withUnit(this.hello.time_step / pace, 's')} that it stands for` : '';
        write(element('steps-text'), `A step${has}`);
    }

    private drawEnergies(): void {
        const last = this.samples[this.samples.length - 1]!;
        const text = `strain ${withUnit(last.strain, 'J')}, kinetic ${withUnit(last.kinetic, 'J')}`;
        write(element('energies-text'), text);
        const pen = this.energies.begin(text);
        if (!pen) return;
        const [low, high] = decades(this.samples.flatMap((sample) => [sample.strain, sample.kinetic]));
        const { width, height } = this.energies;
        const left = 52;
        const y = (value: number): number =>
            height - 4 - ((Math.log10(Math.max(value, 10 ** low)) - low) / (high - low)) * (height - 12);
        pen.textAlign = 'right';
        for (let power = low; power <= high; power++) {
            rule(pen, left, y(10 ** power), width, y(10 ** power));
            if (power === low || power === high) pen.fillText(withUnit(10 ** power, 'J'), left - 4, y(10 ** power));
        }
        for (const [key, colour] of [['kinetic', KINETIC], ['strain', STRAIN]] as const) {
            pen.beginPath();
            for (const sample of this.samples)
                pen.lineTo(width - ((last.time - sample.time) / SECONDS) * (width - left), y(sample[key]));
            pen.strokeStyle = colour;
            pen.lineWidth = 1.6;
            pen.stroke();
        }
    }

    /* Heights are logarithms: one late answer in a million is to be seen. */
    private drawBars(sheet: Sheet, bins: number[], due: number): void {
        const max = Math.max(...bins, 1);
        const pen = sheet.begin(`${bins.reduce((sum, n) => sum + n, 0)} times`);
        if (!pen) return;
        const at = due === Infinity || due === 0 ? -1 : binAt(due);
        const [from, to] = shownBins(bins, Math.max(at, 0));
        const { width, height } = sheet;
        const x = (bin: number): number => ((bin - from) / (to - from)) * width;
        const foot = height - 14;
        for (let bin = from; bin < to; bin++) {
            const tall = bins[bin] ? (0.08 + 0.92 * (Math.log(bins[bin]!) / Math.log(max + 1))) * (foot - 4) : 0;
            pen.fillStyle = at >= 0 && bin >= at ? LATE : KINETIC;
            pen.fillRect(x(bin) + 0.5, foot - tall, Math.max(1, x(bin + 1) - x(bin) - 1), tall);
        }
        pen.fillStyle = QUIET;
        pen.textAlign = 'left';
        pen.fillText(withUnit(binStart(from), 's'), 0, height - 6);
        pen.textAlign = 'right';
        pen.fillText(withUnit(binStart(to), 's'), width, height - 6);
        if (at < 0) return;
        pen.strokeStyle = '#e9ecef';
        pen.setLineDash([3, 2]);
        rule(pen, x(at), 0, x(at), foot);
        pen.setLineDash([]);
    }
}

function rule(pen: CanvasRenderingContext2D, x: number, y: number, toX: number, toY: number): void {
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(toX, toY);
    pen.stroke();
}

/* A canvas as large as it is shown. */
class Sheet {
    width = 0;
    height = 0;
    private readonly canvas: HTMLCanvasElement;
    private readonly pen: CanvasRenderingContext2D | null;

    constructor(id: string) {
        this.canvas = element<HTMLCanvasElement>(id);
        this.pen = this.canvas.getContext('2d');
    }

    /* Empty, ready to be drawn on; null while it is not shown. `says`: for who cannot see it. */
    begin(says: string): CanvasRenderingContext2D | null {
        const { clientWidth, clientHeight } = this.canvas;
        const ratio = devicePixelRatio || 1;
        if (!this.pen || !clientWidth) return null;
        if (clientWidth !== this.width || clientHeight !== this.height) {
            this.width = clientWidth;
            this.height = clientHeight;
            this.canvas.width = Math.round(clientWidth * ratio);
            this.canvas.height = Math.round(clientHeight * ratio);
        }
        this.canvas.setAttribute('aria-label', says);
        this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
        this.pen.clearRect(0, 0, clientWidth, clientHeight);
        this.pen.font = '11px system-ui, "DejaVu Sans", sans-serif';
        this.pen.textBaseline = 'middle';
        this.pen.fillStyle = QUIET;
        this.pen.strokeStyle = 'rgb(255 255 255 / 0.12)';
        this.pen.lineWidth = 1;
        return this.pen;
    }
}
