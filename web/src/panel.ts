/* How the engine does: times, deadlines, rates. And what nobody must miss: slow motion. */
import { element, number, write } from './dom';
import type { Hello, Status } from './protocol';

/* Whether steps are computed in parts now. */
export function division(parts: number): string {
    return parts > 1 ? `step divided by ${parts}` : 'none';
}

type Row = [name: string, value: (s: Status) => string, bad?: (s: Status) => boolean, title?: string];

const DIVIDED =
    'Strained tissue and tools that press hard need shorter steps: while they do, every step is ' +
    'computed in several parts, which takes as many times as long.';

const rate = (perSecond: number): string =>
    perSecond >= 9999.5 ? `${(perSecond / 1000).toFixed(1)} kHz` : `${perSecond.toFixed(0)} Hz`;

/* Microseconds, with three digits. */
function span(us: number | null): string {
    if (us === null) return '–';
    if (us >= 1000) return `${(us / 1000).toFixed(us >= 99950 ? 0 : 1)} ms`;
    return `${us.toFixed(us >= 99.95 ? 0 : 1)} µs`;
}

export class Panel {
    pictureRate = 0;
    private tick = 0.001;
    private readonly cells: HTMLTableCellElement[] = [];
    private readonly body = element('panel-rows');
    private readonly details = element<HTMLDetailsElement>('panel');

    private readonly rows: Row[] = [
        ['simulated time', (s) => `${s.time.toFixed(2)} s`],
        ['steps', (s) => String(s.step)],
        ['real-time factor', (s) => number(s.real_time_factor_now, 2), (s) => s.slow_motion],
        ['since the start', (s) => number(s.real_time_factor, 3)],
        ['step, median', (s) => span(s.step_us.p50)],
        ['step, 99 %', (s) => span(s.step_us.p99)],
        ['step, longest', (s) => span(s.step_us.max)],
        ['answer, 99.9 %', (s) => span(s.tick_us.p999), (s) => this.late(s)],
        ['missed', (s) => this.misses(s), (s) => s.misses > 0.001 * s.ticks],
        ['engine', (s) => rate(s.engine_rate)],
        ['haptics', (s) => rate(s.haptic_rate)],
        ['pictures', () => rate(this.pictureRate)],
        ['given up', (s) => `${s.skipped.toFixed(2)} s`, (s) => s.skipped > 0],
        ['went back', (s) => `${s.recoveries} ×`, (s) => s.recoveries > 0],
        ['division', (s) => division(s.step_parts), (s) => s.step_parts > 1, DIVIDED],
        ['divided steps', (s) => String(s.divided_steps), undefined, `${DIVIDED} So many were, since the engine was started.`],
        ['viewers', (s) => String(s.viewers)],
    ];

    constructor() {
        for (const [name, , , title] of this.rows) {
            const row = document.createElement('tr');
            if (title) row.title = title;
            const head = document.createElement('th');
            head.scope = 'row';
            head.textContent = name;
            const cell = document.createElement('td');
            row.append(head, cell);
            this.body.append(row);
            this.cells.push(cell);
        }
        // On a phone the organ needs the place.
        const wide = innerWidth > 760;
        this.details.open = wide && innerHeight > 860;
        element<HTMLDetailsElement>('colour-card').open = wide;
        element<HTMLDetailsElement>('tools').open = wide;
    }

    setHello(hello: Hello): void {
        this.tick = hello.tick;
        this.details.title =
            `${hello.elements} elements, ${hello.nodes} nodes, ${hello.processors} processors, ` +
            (hello.riding ? `fine surface of ${hello.riding.triangles} triangles, ` : '') +
            `${hello.isa}, steps of ${(hello.time_step * 1e6).toFixed(1)} µs, Lariat ${hello.lariat}`;
    }

    toggle(): void {
        this.details.open = !this.details.open;
    }

    update(status: Status): void {
        const factor = `${number(status.real_time_factor_now, 2)} × real time`;
        write(element('panel-short'), status.state === 'playing' ? factor : '');
        if (!this.details.open) return;
        this.rows.forEach(([, value, bad], i) => {
            const cell = this.cells[i]!;
            write(cell, value(status));
            cell.parentElement!.classList.toggle('bad', bad?.(status) ?? false);
        });
    }

    private late(status: Status): boolean {
        return (status.tick_us.p999 ?? 0) > this.tick * 1e6;
    }

    private misses(status: Status): string {
        const share = status.ticks > 0 ? (100 * status.misses) / status.ticks : 0;
        return `${status.misses} (${share.toFixed(share < 0.1 ? 3 : 1)} %)`;
    }
}

/* What the badge says of a run that plays: slower than asked for is never called real time, also
 * where the engine does not call it slow motion (yet). 0: no second has passed yet. */
export function playing(status: Pick<Status, 'pace' | 'real_time_factor_now'>): { text: string; slow: boolean } {
    const factor = status.real_time_factor_now ?? 0;
    if (status.pace === 0)
        return { text: `as fast as it goes: ${number(status.real_time_factor_now, 1)} × real time`, slow: false };
    if (factor > 0 && factor < 0.97 * status.pace) return { text: `${factor.toFixed(2)} × real time`, slow: true };
    return { text: status.pace === 1 ? 'real time' : `${status.pace} × real time, as asked for`, slow: false };
}

/* The title line and the banner. */
export class StateLine {
    private readonly line = element('state');
    private readonly text = element('state-text');
    private readonly slow = element('slow');
    private shownSince = 0;

    setTitle(title: string): void {
        write(element('title'), title || 'Lariat');
        document.title = `${title || 'Model'} – Lariat`;
    }

    update(status: Status): void {
        const run = playing(status);
        const texts: Record<Status['state'], string> = {
            idle: 'not started',
            playing: run.text,
            paused: 'paused',
            stopped: 'stopped',
        };
        const slow = status.slow_motion && status.state === 'playing';
        this.line.className = slow || (run.slow && status.state === 'playing') ? 'slow' : status.state;
        write(this.text, slow ? 'slow motion' : texts[status.state]);
        const now = performance.now();
        if (slow) this.shownSince = now;
        // Stays for a second, so that it can be read.
        this.slow.hidden =
            status.state !== 'playing' || (!slow && (this.shownSince === 0 || now - this.shownSince > 1000));
        const factor = status.real_time_factor_now;
        if (slow)
            write(
                element('slow-text'),
                factor !== null && factor < 0.995 * (status.pace || 1)
                    ? `${factor.toFixed(2)} × real time`
                    : 'catching up with the clock',
            );
    }

    lost(): void {
        this.line.className = 'lost';
        this.slow.hidden = true;
        this.shownSince = 0;
        write(this.text, 'no connection');
    }
}
