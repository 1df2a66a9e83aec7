/* The buttons of the run: play, step, reset, record, save, load, pace. */
import { element, write } from '../dom';
import { note } from './notices';
import type { ReplayBar } from './replaybar';
import type { Session } from '../link/session';
import type { Hello, Status } from '../link/protocol';

const PLAY = 'M7 4v16l13-8z';
const PAUSE = 'M6 4h4v16H6zM14 4h4v16h-4z';
const NO_FOLDER = 'The engine was started without a folder to save to';
const RECORD_TITLE = 'Record what you do (C)';
const PROGRAMS = 'The program that serves this page records all of this session itself, until it ends.';

export class Transport {
    private readonly play = element<HTMLButtonElement>('play');
    private readonly record = element<HTMLButtonElement>('record');
    private readonly save = element<HTMLButtonElement>('save');
    private readonly load = element<HTMLButtonElement>('load');
    private readonly pace = element<HTMLSelectElement>('pace');
    private allButtons = [...element('transport').querySelectorAll('button, select')] as HTMLButtonElement[];
    private saves = false;
    private watches = false;
    private perTick = 10;
    private paceUntil = 0; // the user's choice stands until the engine has heard of it

    constructor(
        private readonly session: Session,
        private readonly help: () => void,
        private readonly replay: ReplayBar,
    ) {
        this.play.onclick = () => this.playOrPause();
        element('step').onclick = () => this.step();
        element('reset').onclick = () => this.reset();
        this.record.onclick = () => this.recordOrEnd();
        this.save.onclick = () => this.saveNow();
        this.load.onclick = () => this.loadLast();
        this.pace.onchange = () => this.setPace(Number(this.pace.value));
        element('ask').onclick = () => this.help();
        this.enable(false);
    }

    setHello(hello: Hello): void {
        this.saves = hello.saves;
        this.watches = hello.watches;
        this.perTick = Math.max(1, Math.round(hello.tick / hello.time_step));
        for (const button of [this.record, this.save]) if (!hello.saves) button.title = NO_FOLDER;
        this.enable(true);
    }

    /* Help is there always. */
    enable(connected: boolean): void {
        const yes = connected && !this.watches;
        for (const button of this.allButtons) button.disabled = !yes && button.id !== 'ask';
        if (yes) this.record.disabled = this.save.disabled = !this.saves;
        if (yes) this.load.disabled = true; // until status says otherwise
    }

    update(status: Status): void {
        const playing = status.state === 'playing';
        write(element('clock'), `${status.time.toFixed(2)} s`);
        const fixed = this.watches || status.state === 'stopped';
        this.play.disabled = fixed;
        element('step').toggleAttribute('disabled', fixed);
        write(element('play-text'), playing ? 'Pause' : 'Play');
        this.play.setAttribute('aria-label', playing ? 'Pause' : 'Play');
        element('play-shape').setAttribute('d', playing ? PAUSE : PLAY);
        this.showRecord(status);
        this.load.disabled = this.watches || !this.saves || status.saved.length === 0 || status.lost;
        element('reset').toggleAttribute('disabled', this.watches || status.lost);
        if (performance.now() > this.paceUntil) this.showPace(status.pace);
    }

    playOrPause(): void {
        if (this.replay.ended && this.session.status?.state !== 'playing') this.replay.restart();
        this.session.send({ do: this.session.status?.state === 'playing' ? 'pause' : 'play' });
    }

    step(): void {
        this.session.send({ do: 'step', steps: this.perTick });
    }

    reset(): void {
        if (this.session.status?.lost) return; // nothing takes it up again
        this.session.send({ do: 'reset' });
        if (this.session.status?.state === 'stopped') this.session.send({ do: 'play' });
    }

    recordOrEnd(): void {
        const status = this.session.status;
        if (status?.recording_by === 'program') return note(PROGRAMS);
        if (!this.record.disabled) this.session.send({ do: 'record', on: !status?.recording });
    }

    saveNow(): void {
        if (!this.save.disabled) this.session.send({ do: 'save' });
    }

    loadLast(): void {
        if (!this.load.disabled) this.session.send({ do: 'load' });
    }

    /* One pace slower or faster. */
    shift(by: number): void {
        if (this.pace.disabled) return;
        const index = this.pace.selectedIndex + by;
        if (index < 0 || index >= this.pace.options.length) return;
        this.pace.selectedIndex = index;
        this.setPace(Number(this.pace.value));
    }

    /* What the program records runs until that ends it: the button says that it does, and no more. */
    private showRecord(status: Status): void {
        const { record } = this;
        const programs = status.recording_by === 'program';
        record.disabled = this.watches || !this.saves || Boolean(status.replay) || programs;
        record.setAttribute('aria-pressed', String(status.recording));
        write(record.querySelector('span')!, programs ? 'Recording' : status.recording ? 'Stop' : 'Record');
        record.setAttribute('aria-label', programs ? 'Recording, by the program' : status.recording ? 'Stop recording' : 'Record');
        record.title = programs ? PROGRAMS : this.saves ? RECORD_TITLE : NO_FOLDER;
    }

    private setPace(value: number): void {
        this.paceUntil = performance.now() + 600;
        this.session.send({ do: 'pace', value });
    }

    private showPace(value: number): void {
        const options = [...this.pace.options];
        let found = options.findIndex((option) => Math.abs(Number(option.value) - value) < 1e-9);
        if (found < 0) {
            // Somebody else asked for it: shown as it is.
            this.pace.add(new Option(`${value} ×`, String(value)), 0);
            found = 0;
        }
        if (this.pace.selectedIndex !== found) this.pace.selectedIndex = found;
    }
}
