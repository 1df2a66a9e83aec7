/* How the engine does: times, deadlines, rates. And what nobody must miss: slow motion. */
import { element, number, write } from '../dom';
import type { Hello, Status } from '../link/protocol';

/* Whether steps are computed in parts now. */
export function division(parts: number): string {
    return parts > 1 ? `step divided by ${parts}` : 'none';
}

type Row = [name: string, title: string, value: (s: Status) => string, bad?: (s: Status) => boolean];

const DIVIDED =
    'Strained tissue, tools that press hard and organs made stiffer need shorter steps: while they do, every step is ' +
    'computed in several parts, which takes as many times as long.';

const ANSWER =
    'From the moment an exchange with the tools is due (in slow motion: begins) to its forces. ';

const rate = (perSecond: number): string =>
    perSecond >= 9999.5 ? `${(perSecond / 1000).toFixed(1)} kHz` : `${perSecond.toFixed(0)} Hz`;

/* Microseconds, as milliseconds from a tenth of one on. */
export function span(us: number | null): string {
    if (us === null) return '–';
    const ms = us / 1000;
    if (ms >= 0.09995) return `${ms.toFixed(ms >= 99.95 ? 0 : ms >= 9.995 ? 1 : 2)} ms`;
    return `${us.toFixed(1)} µs`;
}

export class Panel {
    pictureRate = 0;
    private tick = 0.001;
    private readonly cells: HTMLTableCellElement[] = [];
    private readonly body = element('panel-rows');
    private readonly details = element<HTMLDetailsElement>('panel');

    private readonly rows: Row[] = [
        ['simulated time', 'Time in the simulated world since the start.', (s) => `${s.time.toFixed(2)} s`],
        ['steps', 'Steps of the simulation since the start.', (s) => String(s.step)],
        ['real-time factor', 'Simulated time per time of the clock, over the last second: 1 is real time.',
            (s) => number(s.real_time_factor_now, 2), (s) => s.slow_motion],
        ['since the start', 'The same since the engine was started, pauses left out.', (s) => number(s.real_time_factor, 3)],
        ['step, median', 'What a step takes to compute: half of them take less.', (s) => span(s.step_us.p50)],
        ['step, 99 %', 'What a step takes: 99 of 100 take less.', (s) => span(s.step_us.p99)],
        ['step, longest', 'The longest that a step has taken.', (s) => span(s.step_us.max)],
        ['answer, median', ANSWER + 'Half of all answers come sooner.', (s) => span(s.tick_us.p50)],
        ['answer, 99.9 %', ANSWER + '999 of 1000 answers come sooner.', (s) => span(s.tick_us.p999), (s) => this.late(s)],
        ['missed', 'Exchanges with the tools whose forces came after the next exchange was due. Those of slow motion are counted below.',
            (s) => this.misses(s), (s) => s.misses > 0.001 * s.ticks],
        ['late, slow motion', 'Exchanges that were late because the run is in slow motion: each had to wait for the one before it.',
            (s) => String(s.slow_ticks), (s) => s.slow_motion],
        ['engine', 'Steps per second, over the last second.', (s) => rate(s.engine_rate)],
        ['haptics', 'Exchanges of positions and forces with tools and devices per second.', (s) => rate(s.haptic_rate)],
        ['pictures', 'Pictures that this page draws per second.', () => rate(this.pictureRate)],
        ['given up', 'Time by which the run is behind the clock and that it no longer tries to make up for.',
            (s) => `${s.skipped.toFixed(2)} s`, (s) => s.skipped > 0],
        ['went back', 'How often the run became unstable and went back to a sound state by itself.',
            (s) => `${s.recoveries} ×`, (s) => s.recoveries > 0],
        ['division', DIVIDED, (s) => division(s.step_parts), (s) => s.step_parts > 1],
        ['divided steps', `${DIVIDED} So many were, since the engine was started.`, (s) => String(s.divided_steps)],
        ['heavier', 'Strained elements that move with more mass now, so that steps are divided into fewer parts, and how much that is of the mass of all.',
            (s) => `${s.heavier} by ${(100 * s.heavier_share).toFixed(2)} %`, (s) => s.heavier > 0],
        ['viewers', 'Pages that look at this run, this one included.', (s) => String(s.viewers)],
    ];

    constructor() {
        for (const [name, title] of this.rows) {
            const row = document.createElement('tr');
            row.title = title;
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
            (hello.riding ? `embedded surface of ${hello.riding.triangles} triangles, ` : '') +
            `${hello.isa}, steps of ${(hello.time_step * 1e6).toFixed(1)} µs, Lariat ${hello.lariat}`;
    }

    toggle(): void {
        this.details.open = !this.details.open;
    }

    update(status: Status): void {
        const factor = `${number(status.real_time_factor_now, 2)} × real time`;
        write(element('panel-short'), status.state === 'playing' ? factor : '');
        if (!this.details.open) return;
        this.rows.forEach(([, , value, bad], i) => {
            const cell = this.cells[i]!;
            write(cell, value(status));
            cell.parentElement!.classList.toggle('bad', bad?.(status) ?? false);
        });
    }

    /* Nothing is known any more. */
    lost(): void {
        write(element('panel-short'), '');
    }

    private late(status: Status): boolean {
        return (status.tick_us.p999 ?? 0) > this.tick * 1e6;
    }

    private misses(status: Status): string {
        const share = status.ticks > 0 ? (100 * status.misses) / status.ticks : 0;
        return `${status.misses} (${share.toFixed(share < 0.1 ? 3 : 1)} %)`;
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

/* What the banner says beside the words slow motion, '' while no second has passed. null: the run is behind
 * the clock, but as fast as asked for or faster. It catches up, which is not slow. */
export function slowness(status: Pick<Status, 'pace' | 'real_time_factor_now'>): string | null {
    const factor = status.real_time_factor_now;
    if (factor === null || factor <= 0) return '';
    return factor < 0.99 * (status.pace || 1) ? `${factor.toFixed(2)} × real time` : null;
}

const sentence = (text: string): string => (text ? text[0]!.toUpperCase() + text.slice(1).replaceAll(' us', ' µs') + '.' : '');

/* The title line and the banner. */
export class StateLine {
    private readonly line = element('state');
    private readonly text = element('state-text');
    private readonly slow = element('slow');
    private shownSince = 0;

    setTitle(title: string): void {
        write(element('title'), title || 'Lariat');
        element('title').title = title;
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
        const runs = status.state === 'playing';
        const late = status.slow_motion && runs;
        const slow = late ? slowness(status) : null;
        const banner = this.bannerStays(slow !== null, runs);
        // Badge and banner say the same: as long as the one is there the other says so, too.
        this.line.className = banner || late || (run.slow && runs) ? 'slow' : status.state;
        write(this.text, banner ? 'slow motion' : late ? 'catching up with the clock' : texts[status.state]);
        this.slow.hidden = !banner;
        if (slow === null) return;
        write(element('slow-text'), slow);
        write(element('slow-advice'), sentence(status.slow_advice));
    }

    /* For a second after the last slow moment, so that it can be read. */
    private bannerStays(slow: boolean, runs: boolean): boolean {
        const now = performance.now();
        if (slow) this.shownSince = now;
        if (!runs) this.shownSince = 0;
        return this.shownSince > 0 && now - this.shownSince <= 1000;
    }

    lost(): void {
        this.line.className = 'lost';
        this.slow.hidden = true;
        this.shownSince = 0;
        write(this.text, 'no connection');
    }
}
