/* Instruments that are added to a run and removed from it: a form below the list of tools. Which there
 * are is said by the engine, so all pages show the same. */
import { showCards } from './desk';
import { decimal, element, scaleFor, write, type Scale } from '../dom';
import type { Instrument } from '../hands/instrument';
import { ONLY_WATCHES, type Session } from '../link/session';
import { sizeOfBody, type Hello, type Request, type Status, type SurfaceMessage, type ToolInfo } from '../link/protocol';

const FIELD_PART = 40; // sizes of tools are written in the unit of that part of the body

type Shape = 'sphere' | 'capsule' | 'grasper';

interface Size {
    radius: number; // [m]
    length: number;
}

// The engine's rules, with room: what is thinner than this part of the longest edge is refused, as what is
// thicker than half of the body.
const THINNEST = (1.2 * Math.SQRT1_2) / 6; // of the longest edge of a face
const THICKEST = 0.45; // of the body's size
const PARTS: Record<Shape, [radius: number, length: number]> = {
    sphere: [0.03, 0], capsule: [0.02, 0.5], grasper: [0.012, 0.12],
};

/* Sizes that fit a body of that diagonal whose faces have edges of up to `edge` [m], as people would choose them. */
export function usual(shape: Shape, size: number, edge: number): Size {
    const [thick, long] = PARTS[shape];
    const thin = THINNEST * edge;
    const radius = thick * size > thin ? neat(thick * size) : neatAbove(thin);
    return {
        radius: Math.min(Math.max(radius, thin), THICKEST * size),
        length: long ? neat(Math.max(long * size, 4 * radius)) : 0,
    };
}

const neat = (value: number): number => Number(value.toPrecision(1));

/* Two digits, and not below. */
function neatAbove(value: number): number {
    const unit = 10 ** (Math.floor(Math.log10(value)) - 1);
    return Number((Math.ceil(value / unit - 1e-9) * unit).toPrecision(2));
}

/* The longest edge of a surface's faces at rest [m]. */
export function longestEdge({ rest, faces }: Pick<SurfaceMessage, 'rest' | 'faces'>): number {
    let square = 0;
    faces.forEach((node, i) => {
        const [a, b] = [3 * node, 3 * faces[i % 4 === 3 ? i - 3 : i + 1]!];
        square = Math.max(square, [0, 1, 2].reduce((sum, k) => sum + (rest[a + k]! - rest[b + k]!) ** 2, 0));
    });
    return Math.sqrt(square);
}

/* What is wrong with a size, as a sentence; '': nothing that the page can know. */
export function fault(what: 'radius' | 'length', value: number, unit: string): string {
    if (Number.isNaN(value)) return `Say the ${what} in ${unit}, as a number such as 2.5.`;
    return value > 0 ? '' : `The ${what} must be more than zero.`;
}

/* The size that the engine names where it refuses one [m]. */
export function namedSize(refusal: string): { what: 'radius' | 'length'; size: number } | null {
    const found = /\b(radius|length) of .*give (?:it|the tool) ([\d.e+-]+) mm/.exec(refusal);
    return found && { what: found[1] as 'radius' | 'length', size: Number(found[2]) / 1000 };
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
    private edge = 0; // the longest of its faces [m]
    private scale: Scale = scaleFor(1e-3, 'm'); // of the fields
    private asked = false; // the engine has not answered yet
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
        const size = sizeOfBody(hello);
        const same = size === this.size; // connected anew to the same body: what was written stays
        this.hello = hello;
        this.size = size;
        this.scale = scaleFor(this.size / FIELD_PART, 'm');
        this.asked = false;
        for (const what of ['radius', 'length']) write(element(`add-${what}-unit`), this.scale.unit);
        this.part.hidden = !this.possible || hello.watches;
        if (!same) this.suggest();
        this.show();
    }

    setSurface(surface: SurfaceMessage): void {
        const edge = longestEdge(surface);
        if (edge === this.edge) return;
        this.edge = edge;
        this.suggest();
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
        showCards();
        element<HTMLDetailsElement>('tools').open = this.part.open = true;
        this.shape.focus();
    }

    /* The engine has added one: it is the one that is used next. */
    added(tool: number, tools: readonly ToolInfo[]): void {
        this.asked = false;
        this.instrument.choose(tool);
        if (this.part.contains(document.activeElement)) element('picture').focus();
        this.say(`${tools[tool]?.name ?? 'It'} stands above the body: drag it, or P and the arrow keys.`);
    }

    /* A sentence of the engine: where it refuses a size, the one that it names goes into the field. */
    refused(text: string): void {
        const named = this.asked ? namedSize(text) : null;
        this.asked = false;
        if (!named) return;
        this[named.what].value = this.inField(named.size);
        this.trouble(`The engine refused that ${named.what}; the field has the one that it names.`);
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
        const { radius, length } = usual(shape, this.size, this.edge);
        this.radius.value = this.inField(radius);
        this.length.value = this.inField(length);
        element('add-length-row').hidden = shape === 'sphere';
        this.trouble('');
    }

    private inField(metres: number): string {
        return String(Number((metres / this.scale.factor).toPrecision(3)));
    }

    private trouble(text: string): void {
        write(element('add-trouble'), text);
    }

    private ask(): void {
        const shape = this.shape.value as Shape;
        const long = shape !== 'sphere';
        const { unit, factor } = this.scale;
        const metres = (value: number): number => Number((value * factor).toPrecision(9));
        const [radius, length] = [decimal(this.radius.value), decimal(this.length.value)];
        const why = fault('radius', radius, unit) || (long && fault('length', length, unit));
        this.trouble(why || '');
        if (why) return;
        const request: Request = { do: 'add_tool', shape, radius: metres(radius) };
        if (long) request.length = metres(length);
        this.asked = true;
        this.session.send(request);
    }
}
