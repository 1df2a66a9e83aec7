/* The force over the last five seconds, one value per tick, and the range that bar, graph and arrow
 * share. A ring of numbers; drawing takes the least and greatest of each column of pixels. */

import type { Scale } from '../dom';

const SECONDS = 5;
const MOST = 8192;

export class ForceHistory {
    readonly values = new Float32Array(MOST);
    count = 0; // ever
    interval = 0.001;

    clear(): void {
        this.count = 0;
    }

    /* Lengths of vectors, three numbers each. */
    add(vectors: Float32Array, interval: number): void {
        this.interval = interval;
        for (let i = 0; i + 2 < vectors.length; i += 3)
            this.values[this.count++ % MOST] = Math.hypot(vectors[i]!, vectors[i + 1]!, vectors[i + 2]!);
    }

    /* How many make up the time that is shown. */
    get shown(): number {
        return Math.min(MOST, Math.round(SECONDS / this.interval));
    }

    /* The value so many ticks ago; 0 is the last one. */
    ago(ticks: number): number {
        return ticks < Math.min(this.count, MOST) ? this.values[(this.count - 1 - ticks) % MOST]! : 0;
    }

    peak(): number {
        let max = 0;
        for (let i = Math.min(this.shown, this.count) - 1; i >= 0; i--) max = Math.max(max, this.ago(i));
        return max;
    }
}

/* The least of 1, 2, 5, 10, 20 ... and their tenths that is below neither. */
export function niceRange(value: number, from = 0.05): number {
    const wanted = Math.max(value, from);
    const decade = 10 ** Math.floor(Math.log10(wanted));
    const range = [1, 2, 5, 10].find((one) => one * decade >= wanted * (1 - 1e-9))! * decade;
    return Number(range.toPrecision(2));
}

export class Graph {
    private readonly pen: CanvasRenderingContext2D | null;
    private width = 0;
    private height = 0;

    constructor(private readonly canvas: HTMLCanvasElement) {
        this.pen = canvas.getContext('2d');
        new ResizeObserver(() => this.resize()).observe(canvas);
        this.resize();
    }

    draw(history: ForceHistory, range: number, scale: Scale): void {
        const pen = this.pen;
        if (!pen || !this.width) return;
        const left = 44; // room for `0.5 mN`
        const bottom = this.height - 17;
        const top = 7;
        const wide = this.width - left - 4;
        const tall = bottom - top;
        pen.clearRect(0, 0, this.width, this.height);
        this.axes(pen, left, top, wide, tall, range, scale);

        const shown = history.shown;
        const have = Math.min(history.count, shown);
        const columns = Math.max(1, Math.floor(wide));
        pen.beginPath();
        let started = false;
        let first = left;
        for (let column = 0; column <= columns; column++) {
            const from = Math.floor(((columns - column) / columns) * (shown - 1));
            const to = Math.max(0, Math.floor(((columns - column - 1) / columns) * (shown - 1)) + 1);
            if (from >= have) continue;
            let max = -1;
            let min = Infinity;
            for (let ago = from; ago >= Math.min(to, from); ago--) {
                const value = history.ago(ago);
                max = Math.max(max, value);
                min = Math.min(min, value);
            }
            const x = left + (column / columns) * wide;
            if (!started) {
                pen.moveTo(x, bottom - Math.min(1, min / range) * tall);
                first = x;
            }
            started = true;
            pen.lineTo(x, bottom - Math.min(1, max / range) * tall);
            if (max - min > range / tall) pen.lineTo(x, bottom - Math.min(1, min / range) * tall);
        }
        if (!started) return;
        pen.strokeStyle = '#ffb938';
        pen.lineWidth = 1.6;
        pen.lineJoin = 'round';
        pen.stroke();
        pen.lineTo(left + wide, bottom);
        pen.lineTo(first, bottom);
        pen.fillStyle = 'rgb(255 185 56 / 0.14)';
        pen.fill();
    }

    private axes(
        pen: CanvasRenderingContext2D,
        left: number,
        top: number,
        wide: number,
        tall: number,
        range: number,
        scale: Scale,
    ): void {
        pen.font = '11px system-ui, "DejaVu Sans", sans-serif';
        pen.fillStyle = '#a3abb5';
        pen.strokeStyle = 'rgb(255 255 255 / 0.10)';
        pen.lineWidth = 1;
        pen.textBaseline = 'middle';
        pen.textAlign = 'right';
        for (let i = 0; i <= 2; i++) {
            const y = Math.round(top + (tall * i) / 2) + 0.5;
            pen.beginPath();
            pen.moveTo(left, y);
            pen.lineTo(left + wide, y);
            pen.stroke();
            pen.fillText(scale.short((range * (2 - i)) / 2) + (i === 0 ? ` ${scale.unit}` : ''), left - 5, y);
        }
        pen.textBaseline = 'alphabetic';
        pen.textAlign = 'center';
        for (let second = 0; second <= SECONDS; second++) {
            const x = Math.round(left + (wide * (SECONDS - second)) / SECONDS) + 0.5;
            pen.beginPath();
            pen.moveTo(x, top);
            pen.lineTo(x, top + tall);
            pen.stroke();
            if (second > (wide < 200 ? 1 : 0) && second < SECONDS) pen.fillText(second === SECONDS - 1 ? `−${second} s` : `−${second}`, x, top + tall + 13);
        }
        pen.textAlign = 'right';
        pen.fillText('now', left + wide + 2, top + tall + 13);
    }

    private resize(): void {
        const ratio = devicePixelRatio || 1;
        this.width = this.canvas.clientWidth;
        this.height = this.canvas.clientHeight;
        this.canvas.width = Math.round(this.width * ratio);
        this.canvas.height = Math.round(this.height * ratio);
        this.pen?.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
}
