/* Instruments that are added to a run and removed from it: a form below the list of tools. Which there
 * are is said by the engine, so all pages show the same. */
import { element, write } from '../dom';
import type { Instrument } from '../hands/instrument';
import { ONLY_WATCHES, type Session } from '../link/session';
import type { Hello, Request, Status, ToolInfo } from '../link/protocol';

type Shape = 'sphere' | 'capsule' | 'grasper';

/* Sizes that fit a body of that diagonal [mm], as people would choose them. */
export function usual(shape: Shape, size: number): { radius: number; length: number } {
    const neat = (metres: number): number => Number((1000 * metres).toPrecision(1));
    if (shape === 'sphere') return { radius: neat(0.03 * size), length: 0 };
    if (shape === 'capsule') return { radius: neat(0.02 * size), length: neat(0.5 * size) };
    return { radius: neat(0.012 * size), length: neat(0.12 * size) };
}

/* What is wrong with a size in mm, as a sentence; '': nothing that the page can know. */
export function fault(what: 'radius' | 'length', millimetres: number): string {
    if (Number.isNaN(millimetres)) return `Say the ${what} in millimetres.`;
    return millimetres > 0 ? '' : `The ${what} must be more than zero.`;
}

export class AddTool {
    private readonly part = element<HTMLDetailsElement>('tool-more');
    private readonly form = element<HTMLFormElement>('add-form');
    private readonly shape = element<HTMLSelectElement>('add-shape');
    private readonly radius = element<HTMLInputElement>('add-radius');
    private readonly length = element<HTMLInputElement>('add-length');
    private readonly add = element<HTMLButtonElement>('add-tool');
    private readonly away = element<HTMLButtonElement>('remove-tool');
    private hello: Hello | null = null;
    private size = 0; // of the body: its diagonal [m]
    private fixed = false; // nothing may be added or removed now

    constructor(
        private readonly session: Session,
        private readonly instrument: Instrument,
        private readonly say: (text: string) => void,
    ) {
        this.shape.onchange = () => this.suggest();
        this.form.onsubmit = (event) => {
            event.preventDefault();
            this.ask();
        };
        this.away.onclick = () => this.remove();
    }

    setHello(hello: Hello): void {
        this.hello = hello;
        this.size = Math.hypot(...hello.upper.map((upper, i) => upper - hello.lower[i]!));
        this.part.hidden = !this.possible || hello.watches;
        this.suggest();
        this.show();
    }

    update(status: Status): void {
        this.fixed = this.session.watches || status.state === 'stopped' || Boolean(status.replay);
        for (const control of [this.shape, this.radius, this.length, this.add, this.away]) control.disabled = this.fixed;
    }

    /* The chosen tool, or what it is, has changed. */
    show(): void {
        const info = this.isAdded ? this.instrument.info : null;
        this.away.hidden = !info || this.session.watches;
        write(this.away, info ? `Remove ${info.name}` : 'Remove');
    }

    /* Unfolds it and goes to its first field. */
    open(): void {
        if (!this.possible) return this.say('No tool can be added to this run.');
        if (this.session.watches) return this.say(ONLY_WATCHES);
        element<HTMLDetailsElement>('tools').open = this.part.open = true;
        this.shape.focus();
    }

    /* The engine has added one: it is the one that is used next. */
    added(tool: number, tools: readonly ToolInfo[]): void {
        this.instrument.choose(tool);
        if (this.part.contains(document.activeElement)) element('picture').focus();
        this.say(`${tools[tool]?.name ?? 'It'} stands above the body: drag it, or P and the arrow keys.`);
    }

    remove(): void {
        if (this.session.watches) return this.say(ONLY_WATCHES);
        if (!this.isAdded) return this.say('Choose a tool that was added: those of the scene stay.');
        if (this.fixed) return this.say('Nothing can be removed now.');
        if (document.activeElement === this.away) element('picture').focus();
        this.session.send({ do: 'remove_tool', tool: this.instrument.chosen });
    }

    private get possible(): boolean {
        return (this.hello?.spares?.length ?? 0) > 0;
    }

    private get isAdded(): boolean {
        return this.hello?.spares?.includes(this.instrument.chosen) ?? false;
    }

    private suggest(): void {
        const shape = this.shape.value as Shape;
        const { radius, length } = usual(shape, this.size);
        this.radius.value = String(radius);
        this.length.value = String(length);
        element('add-length-row').hidden = shape === 'sphere';
        this.trouble('');
    }

    private trouble(text: string): void {
        write(element('add-trouble'), text);
    }

    private ask(): void {
        const shape = this.shape.value as Shape;
        const long = shape !== 'sphere';
        const why = fault('radius', this.radius.valueAsNumber) || (long && fault('length', this.length.valueAsNumber));
        this.trouble(why || '');
        if (why) return;
        const request: Request = { do: 'add_tool', shape, radius: this.radius.valueAsNumber / 1000 };
        if (long) request.length = this.length.valueAsNumber / 1000;
        this.session.send(request);
    }
}
