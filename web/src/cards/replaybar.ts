/* The bar of a recording that is played: where it is, to any place of it, and out of it. Play and pause are
 * those of the run. */
import { element, write } from '../dom';
import type { Session } from '../link/session';
import type { Status } from '../link/protocol';

const SEEK_MS = 80;
const AGREED = 'At its end: all hashes agreed with the recorded ones.';
const HEARD_MS = 400; // the user's choice stands until the engine has heard of it

export class ReplayBar {
    private readonly bar = element('replay');
    private readonly slider = element<HTMLInputElement>('replay-at');
    private wanted: number | null = null;
    private nextSeek = 0;
    private movedAt = 0;
    private length = 0;
    private at = 0;
    private name = '';
    private differed = false; // a hash of this recording, since it is played

    constructor(private readonly session: Session) {
        this.slider.addEventListener('input', () => {
            this.wanted = this.slider.valueAsNumber;
            this.movedAt = performance.now();
        });
        element('replay-leave').onclick = () => this.leave();
    }

    get shown(): boolean {
        return !this.bar.hidden;
    }

    /* At its end, play begins anew. */
    get ended(): boolean {
        return this.shown && this.at >= this.length - 1e-9;
    }

    leave(): void {
        if (this.shown) this.session.send({ do: 'replay' });
    }

    /* By so many seconds. */
    seekBy(seconds: number): void {
        if (!this.shown || this.session.watches) return;
        const from = this.wanted ?? (performance.now() - this.movedAt < HEARD_MS ? this.slider.valueAsNumber : this.at);
        this.wanted = Math.max(0, Math.min(this.length, from + seconds));
        this.slider.value = String(this.wanted);
        this.movedAt = performance.now();
    }

    restart(): void {
        this.session.send({ do: 'seek', time: 0 });
    }

    update(status: Status): void {
        const replay = status.replay;
        this.bar.hidden = !replay;
        if (!replay) this.name = '';
        if (!replay) return;
        if (replay.name !== this.name) this.differed = false;
        this.name = replay.name;
        this.differed ||= status.message !== '';
        this.slider.disabled = element<HTMLButtonElement>('replay-leave').disabled = this.session.watches;
        this.length = replay.length;
        this.at = replay.time;
        write(element('replay-name'), replay.name);
        this.slider.max = String(replay.length);
        if (performance.now() - this.movedAt > HEARD_MS) this.slider.value = String(replay.time);
        write(element('replay-time'), `${replay.time.toFixed(2)} of ${replay.length.toFixed(2)} s`);
        write(element('replay-trouble'), status.message);
        write(element('replay-agreed'), this.ended && !this.differed ? AGREED : '');
    }

    /* Once per animation frame: the engine hears of a slider a dozen times a second. */
    look(now: number): void {
        if (this.wanted === null || now < this.nextSeek) return;
        this.nextSeek = now + SEEK_MS;
        this.session.send({ do: 'seek', time: this.wanted });
        this.wanted = null;
    }
}
