/* The body while it runs: gravity, damping, stiffness and how active muscle is, as sliders. What somebody else sets is shown here,
 * too: the engine says what holds. */
import { showCards } from './desk';
import { element, write } from '../dom';
import { ONLY_WATCHES, type Session } from '../link/session';
import type { Hello, Request, Status } from '../link/protocol';

export type Vector = readonly [number, number, number];

const SEND_MS = 80; // a slider is dragged through many values: not all of them are sent
const OWN_MS = 700; // the user's choice stands until the engine has heard of it
const GRAVITY_MAX = 20; // [m/s²]
const DIRECTIONS: Record<string, Vector> = {
    '-z': [0, 0, -1], '+z': [0, 0, 1], '-x': [-1, 0, 0], '+x': [1, 0, 0], '-y': [0, -1, 0], '+y': [0, 1, 0],
};

export const sizeOf = (v: Vector): number => Math.hypot(...v);

/* Which entry of the list a gravity is: one of the axes, that of the scene, or none. */
export function directionOf(gravity: Vector, scene: Vector): string {
    const size = sizeOf(gravity);
    if (size === 0) return 'off';
    const along = (other: Vector): boolean =>
        gravity.reduce((sum, g, i) => sum + g * other[i]!, 0) > (1 - 1e-9) * size * sizeOf(other);
    const axis = Object.keys(DIRECTIONS).find((name) => along(DIRECTIONS[name]!));
    return axis ?? (sizeOf(scene) > 0 && along(scene) ? 'scene' : 'other');
}

/* Damping along a slider from 0 to 1: fine near nothing, which is where most bodies are. */
export const dampingAt = (place: number, max: number): number => Number((max * place ** 3).toPrecision(2));
export const placeOfDamping = (damping: number, max: number): number => Math.min(1, Math.cbrt(damping / max));

/* Stiffness likewise: as far to half as to double, and exactly 1 near 1. */
export function factorAt(place: number, min: number, max: number): number {
    const factor = min * (max / min) ** place;
    return Math.abs(Math.log(factor)) < 0.03 ? 1 : Number(Math.min(max, Math.max(min, factor)).toPrecision(3));
}
export const placeOfFactor = (factor: number, min: number, max: number): number =>
    Math.log(factor / min) / Math.log(max / min);

export class BodyCard {
    private readonly card = element<HTMLDetailsElement>('body-card');
    private readonly gravity = element<HTMLInputElement>('gravity');
    private readonly direction = element<HTMLSelectElement>('gravity-direction');
    private readonly damping = element<HTMLInputElement>('damping');
    private readonly stiffness = element<HTMLInputElement>('stiffness');
    private readonly which = element<HTMLSelectElement>('stiffness-of');
    private readonly back = element<HTMLButtonElement>('body-reset');
    private readonly activations = element('activations');
    private readonly muscle = new Map<number, HTMLInputElement>(); // by material
    private hello: Hello | null = null;
    private status: Status | null = null;
    private down: Vector = [0, 0, -1]; // unit
    private max = 200; // of damping [1/s]
    private own: Record<string, number> = {}; // until when the user's values stand
    private waiting = new Map<string, Request>();
    private sent = 0;
    private timer = 0;

    constructor(
        private readonly session: Session,
        private readonly say: (text: string) => void,
    ) {
        this.gravity.oninput = () => this.setGravity();
        this.direction.onchange = () => this.turn();
        this.damping.oninput = () => this.setDamping();
        this.stiffness.oninput = () => this.setStiffness();
        this.which.onchange = () => this.showStiffness();
        this.back.onclick = () => this.reset();
    }

    setHello(hello: Hello): void {
        this.hello = hello;
        this.card.hidden = !hello.body; // an engine of before
        if (!hello.body) return;
        this.max = Math.max(200, 10 * hello.body.damping);
        this.gravity.max = String(Math.max(GRAVITY_MAX, 2 * sizeOf(hello.body.gravity)));
        const names = hello.materials.map((material, i) => material.name || `organ ${i + 1}`);
        this.which.replaceChildren(new Option('all', '-1'), ...names.map((name, i) => new Option(name, String(i))));
        element('stiffness-row').hidden = names.length < 2;
        this.listMuscle(hello);
        this.waiting.clear();
        this.own = {};
    }

    update(status: Status): void {
        this.status = status;
        const { body } = status;
        if (!body || !this.hello?.body) return;
        const fixed = this.session.watches || status.state === 'stopped' || Boolean(status.replay);
        for (const part of [this.gravity, this.direction, this.damping, this.stiffness, this.back, ...this.muscle.values()])
            part.disabled = fixed;
        if (this.isTheirs('gravity')) this.showGravity(body.gravity);
        if (this.isTheirs('damping')) {
            this.damping.value = String(placeOfDamping(body.damping, this.max));
            this.tellDamping(body.damping);
        }
        if (this.isTheirs('stiffness')) this.showStiffness();
        for (const material of this.muscle.keys())
            if (this.isTheirs(`activate ${material}`)) this.showActivation(material, body.activation?.[material] ?? 1);
        this.tellShort(body);
    }

    /* Unfolds it and goes to its first slider. */
    open(): void {
        if (this.card.hidden) return this.say('This engine cannot change the body while it runs.');
        if (this.session.watches) return this.say(ONLY_WATCHES);
        showCards();
        this.card.open = true;
        this.gravity.focus();
    }

    private isTheirs(what: string): boolean {
        return performance.now() > (this.own[what] ?? 0);
    }

    /* The newest value of each kind, not too often. */
    private send(what: string, request: Request): void {
        this.own[what] = performance.now() + OWN_MS;
        this.waiting.set(what, request);
        if (this.timer) return;
        this.timer = window.setTimeout(() => this.flush(), Math.max(0, this.sent + SEND_MS - performance.now()));
    }

    private flush(): void {
        this.timer = 0;
        this.sent = performance.now();
        for (const request of this.waiting.values()) this.session.send(request);
        this.waiting.clear();
    }

    private setGravity(): void {
        const size = this.gravity.valueAsNumber;
        this.send('gravity', { do: 'gravity', to: [size * this.down[0], size * this.down[1], size * this.down[2]] });
        this.direction.value = size > 0 ? directionOf(this.down, this.hello!.body!.gravity) : 'off';
        this.tellGravity(size);
    }

    private turn(): void {
        const scene = this.hello!.body!.gravity;
        const axis = DIRECTIONS[this.direction.value];
        const size = this.gravity.valueAsNumber || sizeOf(scene) || 9.81;
        if (axis) this.down = axis;
        if (this.direction.value === 'scene' && sizeOf(scene) > 0) this.down = unit(scene);
        this.gravity.value = this.direction.value === 'off' ? '0' : String(size);
        this.setGravity();
    }

    private showGravity(gravity: Vector): void {
        const size = sizeOf(gravity);
        if (size > 0) this.down = unit(gravity);
        else if (this.direction.value === 'off' && this.gravity.valueAsNumber === 0) return this.tellGravity(0);
        this.gravity.value = String(size);
        this.direction.value = directionOf(gravity, this.hello!.body!.gravity);
        this.tellGravity(size);
    }

    private tellGravity(size: number): void {
        write(element('gravity-text'), size > 0 ? `${size.toFixed(2)} m/s²` : 'off');
    }

    private setDamping(): void {
        const value = dampingAt(this.damping.valueAsNumber, this.max);
        this.send('damping', { do: 'damping', value });
        this.tellDamping(value);
    }

    private tellDamping(value: number): void {
        write(element('damping-text'), `${Number(value.toPrecision(3))} 1/s`);
    }

    private get limits(): [number, number] {
        const { stiffness_min, stiffness_max } = this.hello!.body!;
        return [stiffness_min, stiffness_max];
    }

    private setStiffness(): void {
        const value = factorAt(this.stiffness.valueAsNumber, ...this.limits);
        const material = Number(this.which.value);
        this.send(`stiffness ${material}`, { do: 'stiffness', value, ...(material >= 0 ? { material } : {}) });
        this.own['stiffness'] = performance.now() + OWN_MS;
        this.tellStiffness(`× ${value.toFixed(2)}`);
    }

    /* Of the chosen material; of all: the first, and whether others differ. */
    private showStiffness(): void {
        const factors = this.status?.body?.stiffness;
        if (!factors?.length) return;
        const chosen = Math.max(0, Number(this.which.value));
        const factor = factors[chosen]!;
        const mixed = this.which.value === '-1' && factors.some((other) => other !== factor);
        this.stiffness.value = String(placeOfFactor(factor, ...this.limits));
        this.tellStiffness(mixed ? 'mixed' : `× ${factor.toFixed(2)}`);
    }

    private tellStiffness(text: string): void {
        write(element('stiffness-text'), text);
    }

    /* A slider for each material with active stress. */
    private listMuscle(hello: Hello): void {
        this.muscle.clear();
        this.activations.replaceChildren();
        hello.materials.forEach((material, i) => {
            if (!material.active) return;
            const id = `activation-${i}`;
            const label = Object.assign(document.createElement('label'), { className: 'row', htmlFor: id });
            const text = Object.assign(document.createElement('output'), { id: `${id}-text` });
            const slider = Object.assign(document.createElement('input'), { id, type: 'range', min: '0', max: '1', step: '0.01' });
            slider.title = 'How active this muscle is, times what the scene says of it at that time';
            slider.oninput = () => this.activate(i, slider.valueAsNumber);
            label.append(`active: ${material.name || `organ ${i + 1}`} `, text);
            this.activations.append(label, slider);
            this.muscle.set(i, slider);
        });
        this.activations.hidden = this.muscle.size === 0;
    }

    private activate(material: number, value: number): void {
        this.send(`activate ${material}`, { do: 'activate', value, material });
        this.tellActivation(material, value);
    }

    private showActivation(material: number, value: number): void {
        this.muscle.get(material)!.value = String(value);
        this.tellActivation(material, value);
    }

    private tellActivation(material: number, value: number): void {
        write(element(`activation-${material}-text`), `${Math.round(100 * value)} %`);
    }

    private reset(): void {
        this.waiting.clear();
        this.own = {};
        for (const what of ['gravity', 'damping', 'stiffness'] as const) this.session.send({ do: what });
        if (this.muscle.size > 0) this.session.send({ do: 'activate' });
    }

    /* Behind the card's name, that a folded card says it, too. */
    private tellShort(body: NonNullable<Status['body']>): void {
        const { gravity, gravity_varies, damping } = this.hello!.body!;
        const same = body.damping === damping && body.stiffness.every((factor) => factor === 1) &&
            (body.activation ?? []).every((value) => value === 1) &&
            (gravity_varies || body.gravity.every((g, i) => g === gravity[i]));
        write(element('body-short'), same ? '' : 'changed');
    }
}

function unit(v: Vector): Vector {
    const size = sizeOf(v);
    return [v[0] / size, v[1] / size, v[2] / size];
}
