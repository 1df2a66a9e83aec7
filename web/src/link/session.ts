/* What is known of the engine, and the rhythm of frames: the next one is asked for only when the
 * last has arrived (T 6.5.1), so a slow display slows nothing but itself. */
import { Connection, type Loss } from './connection';
import {
    KIND_FORCES, KIND_FRAME, KIND_EMBEDDED, KIND_SLICE, KIND_SURFACE, emptyFrame, kindOf, readForces, readFrame, readEmbedded,
    readSlice, readSurface, type Forces, type Frame, type HandNews, type Hello, type Request, type EmbeddedMessage,
    type Slice, type Status, type SurfaceMessage, type Text, type ToolInfo, type Values,
} from './protocol';

const FRAME_MS = 1000 / 100; // displays faster than that get by with this
const FORCES_MS = 1000 / 30;
const VALUES_MS = 1000 / 5;
const AFTER_NONE_MS = 200;

const LOOKING: Request['do'][] = ['frame', 'forces', 'inspect', 'slice'];
export const ONLY_WATCHES = 'This page may only watch. Ask for the other address to act on the run.';

export interface Events {
    hello(hello: Hello): void;
    surface(surface: SurfaceMessage): void;
    embedded(embedded: EmbeddedMessage): void;
    frame(frame: Frame): void;
    forces(forces: Forces): void;
    status(status: Status): void;
    tools(tools: ToolInfo[]): void; // some were added or removed
    added(tool: number): void; // what this page has asked for
    hand(news: HandNews): void;
    values(values: Values): void;
    slice(slice: Slice): void;
    note(text: string): void;
    lost(loss: Loss): void;
}

export class Session {
    hello: Hello | null = null;
    status: Status | null = null;
    tools: ToolInfo[] = []; // as they are now: those of hello, and what was added since
    readonly frame: Frame = emptyFrame();
    frames = 0;
    torn = 0; // frames whose positions were not those that the engine hashed: always 0
    connections = 0;
    field = 'none';
    forceTool = -1; // whose forces the graph shows
    inspected: { node: number; face: number } | null = null; // what values are asked for again and again
    energies = false; // whether those of the whole body are asked for, too
    private readonly connection: Connection;
    private waiting = false;
    private nextFrame = 0;
    private forcesWaiting = false;
    private forcesAfter = 0;
    private nextForces = 0;
    private valuesWaiting = false;
    private nextValues = 0;

    constructor(private readonly events: Events) {
        this.connection = new Connection({
            opened: () => {
                this.waiting = this.forcesWaiting = this.valuesWaiting = false;
                this.nextFrame = this.nextForces = this.nextValues = 0;
                this.connections++;
            },
            text: (message) => this.text(message as Text),
            binary: (data) => this.binary(data),
            lost: (loss) => this.events.lost(loss),
        });
    }

    connect(): void {
        this.connection.connect();
    }

    get connected(): boolean {
        return this.connection.open;
    }

    /* This page may look, and do nothing to the run: the engine would refuse it. */
    get watches(): boolean {
        return this.hello?.watches ?? false;
    }

    send(request: Request): void {
        if (this.watches && !LOOKING.includes(request.do)) return this.events.note(ONLY_WATCHES);
        this.connection.send(request);
    }

    showForcesOf(tool: number): void {
        if (tool === this.forceTool) return;
        this.forceTool = tool;
        this.forcesAfter = this.lastTick;
        this.forcesWaiting = false;
    }

    /* Once per animation frame. */
    ask(now: number): void {
        if (!this.connected || !this.hello) return;
        if (!this.waiting && now >= this.nextFrame) {
            this.waiting = true;
            this.nextFrame = now + FRAME_MS - 2; // animation frames are not quite even
            this.send({ do: 'frame', field: this.field });
        }
        if (!this.forcesWaiting && this.forceTool >= 0 && now >= this.nextForces) {
            this.forcesWaiting = true;
            this.nextForces = now + FORCES_MS - 4;
            this.send({ do: 'forces', tool: this.forceTool, after: this.forcesAfter });
        }
        if (!this.valuesWaiting && (this.inspected || this.energies) && now >= this.nextValues) {
            this.valuesWaiting = true;
            this.nextValues = now + VALUES_MS;
            this.send({ do: 'inspect', ...this.inspected, ...(this.energies ? { energy: true } : {}) });
        }
    }

    private lastTick = 0;

    private text(message: Text): void {
        switch (message.kind) {
            case 'hello':
                this.hello = message;
                this.forcesAfter = this.lastTick = 0;
                this.forceTool = -1;
                this.frame.step = 0;
                this.tools = [...message.tools];
                return this.events.hello(message);
            case 'status':
                this.status = message;
                this.takeTools(message);
                return this.events.status(message);
            case 'added':
                this.wanted = message.tool;
                return this.tellAdded();
            case 'values':
                this.valuesWaiting = false;
                return this.events.values(message);
            case 'no_values':
                this.valuesWaiting = false;
                return;
            case 'hand':
                return this.events.hand(message);
            case 'saved':
                return this.events.note(`Saved: ${message.what} ${message.name}`);
            case 'no_frame':
                this.waiting = false;
                this.nextFrame = performance.now() + AFTER_NONE_MS;
                return;
            case 'note':
                return this.events.note(message.text);
            default: // of a later version, or the last word before the end, which `lost` repeats
                return;
        }
    }

    private wanted = -1; // a tool that this page has added, until status has it

    private tellAdded(): void {
        const tool = this.wanted;
        if (tool < 0 || (this.tools[tool]?.shape ?? 'none') === 'none') return;
        this.wanted = -1;
        this.events.added(tool);
    }

    /* What the spares are now. A tool that did not change stays the same object. */
    private takeTools(status: Status): void {
        let changed = false;
        for (const i of this.hello?.spares ?? []) {
            const now = status.tools[i];
            const was = this.tools[i];
            if (!now?.shape || !was) continue;
            const { name = '', shape, radius = 0, length = 0, spread = 0 } = now;
            if (was.name === name && was.shape === shape && was.radius === radius && was.length === length) continue;
            this.tools[i] = { name, shape, radius, length, spread, rest: was.rest };
            changed = true;
        }
        if (changed) this.events.tools(this.tools);
        this.tellAdded();
    }

    private binary(data: ArrayBuffer): void {
        const kind = kindOf(data);
        if (kind === KIND_FRAME) {
            readFrame(data, this.frame);
            this.waiting = false;
            this.frames++;
            if (!this.frame.whole) this.torn++;
            this.events.frame(this.frame);
        } else if (kind === KIND_FORCES) {
            const forces = readForces(data);
            if (forces.tool !== this.forceTool) return;
            this.forcesWaiting = false;
            this.lastTick = this.forcesAfter = forces.last;
            this.events.forces(forces);
        } else if (kind === KIND_SURFACE) {
            this.events.surface(readSurface(data));
        } else if (kind === KIND_EMBEDDED) {
            this.events.embedded(readEmbedded(data));
        } else if (kind === KIND_SLICE) {
            this.events.slice(readSlice(data));
        }
    }
}
