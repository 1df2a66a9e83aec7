/* Force: number, bar with the peak of the last seconds, graph. */
import { element, scaleFor, write } from '../dom';
import { ForceHistory, Graph, niceRange } from './graph';
import { forceFloor } from './range';
import type { Forces, Hello } from '../link/protocol';

export class ForceCard {
    readonly history = new ForceHistory();
    range = 0.2; // N
    private floor = 0.2;
    private readonly graph = new Graph(element<HTMLCanvasElement>('graph'));
    private readonly bar = element('bar');
    private readonly fill = element('bar-fill');
    private readonly peak = element('bar-peak');
    private readonly value = element('force-value');
    private readonly rangeText = element('bar-range');
    private nextAria = 0;

    name(text: string): void {
        write(element('force-name'), text);
        element('force-name').title = text; // a long one is cut off with an ellipsis
    }

    setHello(hello: Hello): void {
        this.floor = forceFloor(hello);
        this.history.clear();
        this.range = this.floor;
        this.draw();
    }

    add(forces: Forces): void {
        this.history.add(forces.values, forces.interval);
        this.draw();
    }

    private draw(): void {
        const now = this.history.ago(0);
        const peak = this.history.peak();
        // The range follows the peak upwards at once; downwards only when it is far too large.
        const wanted = niceRange(peak * 0.99, this.floor);
        if (wanted > this.range || wanted < this.range / 4) this.range = wanted;
        const scale = scaleFor(this.range, 'N');
        write(this.value, `${scale.text(now)} ${scale.unit}`);
        write(this.rangeText, `${scale.short(this.range)} ${scale.unit}`);
        this.fill.style.transform = `scaleX(${Math.min(1, now / this.range).toFixed(4)})`;
        this.peak.style.left = `calc(${(Math.min(1, peak / this.range) * 100).toFixed(2)}% - 2px)`;
        this.peak.hidden = peak < this.range * 0.01;
        if (performance.now() > this.nextAria) {
            this.nextAria = performance.now() + 500;
            this.bar.setAttribute('aria-valuemax', String(this.range));
            this.bar.setAttribute('aria-valuenow', String(Number(now.toPrecision(3))));
        }
        this.graph.draw(this.history, this.range, scale);
    }
}
