/* What server and viewer say to each other: docs/viewer-protocol.md. */

export interface Pose {
    position: [number, number, number];
    orientation: [number, number, number, number]; // w, x, y, z
    opening: number;
}

export interface ToolInfo {
    name: string;
    shape: 'sphere' | 'capsule' | 'grasper' | 'hand' | 'none' | 'rigid'; // rigid: moves nodes; none: a place for one that is added
    radius: number;
    length: number;
    spread: number;
    rest: Pose;
}

export interface FieldInfo {
    name: string;
    number: number;
    title: string;
    unit: string;
}

export interface Hello {
    kind: 'hello';
    protocol: number;
    lariat: string;
    title: string;
    nodes: number;
    elements: number;
    scan?: { size: [number, number, number]; labels: { label: number; name: string }[] };
    riding?: { vertices: number; triangles: number; nodes: number };
    view?: [number, number, number];
    time_step: number;
    tick: number;
    isa: string;
    processors: number;
    threads: number;
    materials: { name: string; law: string; elements: number; shear_modulus: number; active?: boolean }[];
    tools: ToolInfo[];
    hands: number[];
    spares?: number[]; // tools that can be added: status says what they are
    lower: [number, number, number]; // of the body at rest [m]
    upper: [number, number, number];
    fields: FieldInfo[];
    saves: boolean;
    hand_force: number;
    tool_speed: number;
    body?: {
        // as the scene has it; gravity at the start where it varies
        gravity: [number, number, number];
        gravity_varies: boolean;
        damping: number; // [1/s]
        stiffness_min: number; // factors of it
        stiffness_max: number;
    };
    watches: boolean; // this viewer may look, and do nothing to the run
}

/* The diagonal of the body at rest [m]. */
export const sizeOfBody = (hello: Pick<Hello, 'lower' | 'upper'>): number =>
    Math.hypot(...hello.upper.map((upper, i) => upper - hello.lower[i]!));

export interface Percentiles {
    p50: number | null;
    p99: number | null;
    p999: number | null;
    max: number | null;
}

/* Of a spare also what it is, as in `hello`. */
export interface ToolStatus extends Pose, Partial<Omit<ToolInfo, 'rest'>> {
    force: [number, number, number];
    torque: [number, number, number];
    touching: number;
    held: number;
    limit: number; // it stays behind its hand where tissue pushes harder [N]; 0: it never does
    depth: number; // of the tissue in it [m]
    apart: number; // from its tip to where its hand asks the tip to be [m]
    limited: boolean; // tissue keeps it from following its hand
    grasp: number; // what both jaws press with on the tissue between them [N]
    by: 'nobody' | 'you' | 'other' | 'device';
}

export interface Status {
    kind: 'status';
    state: 'idle' | 'playing' | 'paused' | 'stopped';
    step: number;
    time: number;
    pace: number;
    step_us: Percentiles;
    tick_us: Percentiles;
    step_bins: number[]; // the same times as counts since the start: inspect/plots.ts
    tick_bins: number[];
    ticks: number;
    misses: number;
    slow_ticks: number; // late in slow motion, and no misses
    real_time_factor: number | null;
    real_time_factor_now: number | null;
    engine_rate: number;
    haptic_rate: number;
    snapshot_rate: number;
    slow_motion: boolean;
    slow_cause: '' | 'step' | 'division' | 'machine';
    slow_advice: string; // why, and what to do about it
    lag: number;
    skipped: number;
    recording: boolean;
    recording_by?: '' | 'viewer' | 'program'; // the program's no viewer can end
    recording_lost: string; // why a recording ended by itself; '': none did
    lost: boolean;
    message: string;
    recoveries: number; // times that the run became unstable and went back to a sound state
    recovery: string; // the last of them
    placed: number; // times that it was put somewhere else: reset, load, went back
    step_parts: number; // that every step is computed in now; 1: not divided
    divided_steps: number;
    heavier: number; // strained elements that are heavier now
    heavier_share: number; // what they have more, as a part of the model's mass
    viewers: number;
    saved: string[]; // saved states, oldest first
    recordings: string[];
    // now; stiffness and activation by material, the latter where something is active
    body?: { gravity: [number, number, number]; damping: number; stiffness: number[]; activation?: number[] };
    replay?: { name: string; time: number; length: number }; // what is played, in simulated seconds
    tools: ToolStatus[];
}

export interface HandNews {
    kind: 'hand';
    hand: number;
    tool: number | null;
    state: 'holding' | 'missed' | 'refused' | 'lost';
}

/* What is read of a node or an element; null where there is none. */
export interface Read {
    index: number; // in the model
    number: number; // in the mesh's file
    von_mises: number | null;
    pressure: number | null;
    energy: number | null;
}

/* The answer to `inspect`: what was asked for, of one step. */
export interface Values {
    kind: 'values';
    step: number;
    time: number;
    node?: Read & { rest: [number, number, number]; displacement: [number, number, number] };
    element?: Read & { material: number };
    energy?: { kinetic: number; strain: number; hourglass: number };
}

export type Text =
    | Values
    | { kind: 'no_values'; text: string }
    | Hello
    | Status
    | HandNews
    | { kind: 'saved'; what: string; name: string }
    | { kind: 'added'; tool: number }
    | { kind: 'no_frame' | 'note' | 'error'; text: string };

export interface SurfaceMessage {
    rest: Float32Array;
    faces: Uint32Array;
    material: Uint32Array;
    body: Uint32Array;
    processor: Uint32Array;
    families: number; // of fibres, 0 to 2
    fibres: Float32Array; // for each face and family a unit vector at rest, or zeros
}

/* An embedded surface. Frames have the surface's nodes first, then these. */
export interface EmbeddedMessage {
    rest: Float32Array; // of the further nodes
    processor: Uint32Array; // of these
    weights: Float32Array; // eight per vertex
    carriers: Uint32Array; // nodes of frames, eight per vertex
    material: Uint32Array; // per vertex
    triangles: Uint32Array;
}

/* One frame. The arrays look into the message; the object is made once and filled again. */
export interface Frame {
    step: number;
    time: number;
    hash: string;
    whole: boolean; // the positions are those that the engine hashed
    checksum: number;
    field: number;
    min: number;
    max: number;
    positions: Float32Array;
    values: Float32Array;
    tools: Float32Array; // 16 words per tool
    counts: Uint32Array; // the same words: 14 touching, 15 held
}

export const TOOL_WORDS = 16;
export const KIND_SURFACE = 1;
export const KIND_FRAME = 2;
export const KIND_FORCES = 3;
export const KIND_EMBEDDED = 4;
export const KIND_SLICE = 5;

export const kindOf = (data: ArrayBuffer): number =>
    data.byteLength >= 4 ? new DataView(data).getUint32(0, true) : 0;

/* One array after the other: so many words each. */
function partsOf(data: ArrayBuffer, from: number): (words: number) => [ArrayBuffer, number, number] {
    let at = from;
    return (words) => {
        at += 4 * words;
        return [data, at - 4 * words, words];
    };
}

export function readSurface(data: ArrayBuffer): SurfaceMessage {
    const head = new Uint32Array(data, 0, 4);
    const n = head[1]!;
    const f = head[2]!;
    const families = head[3]!;
    if (data.byteLength !== 16 + 20 * n + (24 + 12 * families) * f) throw new Error('a surface of wrong length');
    const part = partsOf(data, 16);
    const rest = new Float32Array(...part(3 * n));
    const faces = new Uint32Array(...part(4 * f));
    const material = new Uint32Array(...part(f));
    const body = new Uint32Array(...part(f));
    const processor = new Uint32Array(...part(n));
    part(n); // indices in the model
    return { rest, faces, material, body, processor, families, fibres: new Float32Array(...part(3 * families * f)) };
}

export function readEmbedded(data: ArrayBuffer): EmbeddedMessage {
    const head = new Uint32Array(data, 0, 4);
    const m = head[1]!;
    const k = head[2]!;
    const s = head[3]!;
    if (data.byteLength !== 16 + 20 * s + 68 * m + 12 * k)
        throw new Error('an embedded surface of wrong length');
    const part = partsOf(data, 16);
    const rest = new Float32Array(...part(3 * s));
    const processor = new Uint32Array(...part(s));
    part(s); // indices in the model
    return {
        rest,
        processor,
        weights: new Float32Array(...part(8 * m)),
        carriers: new Uint32Array(...part(8 * m)),
        material: new Uint32Array(...part(m)),
        triangles: new Uint32Array(...part(3 * k)),
    };
}

export function emptyFrame(): Frame {
    const none = new Float32Array(0);
    return {
        step: 0, time: 0, hash: '', whole: true, checksum: 0, field: 0, min: 0, max: 0,
        positions: none, values: none, tools: none, counts: new Uint32Array(0),
    };
}

export function readFrame(data: ArrayBuffer, into: Frame): void {
    const view = new DataView(data);
    const n = view.getUint32(4, true);
    const v = view.getUint32(44, true);
    const t = view.getUint32(64, true);
    if (data.byteLength !== 72 + 12 * n + 4 * v + 64 * t) throw new Error('a frame of wrong length');
    into.step = view.getUint32(8, true) + view.getUint32(12, true) * 2 ** 32;
    into.time = view.getFloat64(16, true);
    into.hash = hex(view.getUint32(28, true)) + hex(view.getUint32(24, true));
    into.field = view.getUint32(40, true);
    into.min = view.getFloat64(48, true);
    into.max = view.getFloat64(56, true);
    into.positions = new Float32Array(data, 72, 3 * n);
    into.values = new Float32Array(data, 72 + 12 * n, v);
    into.tools = new Float32Array(data, 72 + 12 * n + 4 * v, TOOL_WORDS * t);
    into.counts = new Uint32Array(data, 72 + 12 * n + 4 * v, TOOL_WORDS * t);
    const words = new Uint32Array(data, 72, 3 * n);
    let a = 0;
    let b = 0;
    for (let i = 0; i < words.length; i++) {
        if (i & 1) b = Math.imul(((b << 5) | (b >>> 27)) ^ words[i]!, 0x9e3779b1);
        else a = Math.imul(((a << 5) | (a >>> 27)) ^ words[i]!, 0x9e3779b1);
    }
    into.checksum = (a ^ b) >>> 0;
    into.whole = a >>> 0 === view.getUint32(32, true) && b >>> 0 === view.getUint32(36, true);
}

/* A slice of the scan: labels, and where they lie [m]. */
export interface Slice {
    axis: number;
    index: number;
    count: number; // of slices along the axis
    width: number;
    height: number;
    corner: Float32Array; // centre of the first pixel
    across: Float32Array; // from one pixel to the next
    down: Float32Array;
    labels: Uint16Array;
}

export function readSlice(data: ArrayBuffer): Slice {
    const [, axis, index, count, width, height] = new Uint32Array(data, 0, 6) as unknown as number[];
    const pixels = width! * height!;
    if (data.byteLength !== 72 + 4 * Math.ceil(pixels / 2)) throw new Error('a slice of wrong length');
    return {
        axis: axis!, index: index!, count: count!, width: width!, height: height!,
        corner: new Float32Array(data, 32, 3),
        across: new Float32Array(data, 44, 3),
        down: new Float32Array(data, 56, 3),
        labels: new Uint16Array(data, 72, pixels),
    };
}

export interface Forces {
    tool: number;
    last: number;
    interval: number;
    values: Float32Array; // three per tick, oldest first
}

export function readForces(data: ArrayBuffer): Forces {
    const view = new DataView(data);
    const count = view.getUint32(8, true);
    if (data.byteLength !== 32 + 12 * count) throw new Error('forces of wrong length');
    return {
        tool: view.getUint32(4, true),
        last: view.getUint32(16, true) + view.getUint32(20, true) * 2 ** 32,
        interval: view.getFloat64(24, true),
        values: new Float32Array(data, 32, 3 * count),
    };
}

const hex = (word: number): string => word.toString(16).padStart(8, '0');

type Point = readonly [number, number, number];

/* Everything that a viewer may ask for. */
export type Request =
    | { do: 'frame'; field: string }
    | { do: 'forces'; tool: number; after: number }
    | { do: 'inspect'; node?: number; face?: number; energy?: boolean }
    | { do: 'slice'; axis: number; index: number }
    | { do: 'grab'; hand: number; point: Point }
    | { do: 'pull'; hand: number; to: Point }
    | { do: 'release'; hand: number }
    | {
          do: 'tool';
          tool: number;
          position: Point;
          orientation?: readonly [number, number, number, number];
          opening?: number;
      }
    | { do: 'play' | 'pause' | 'reset' | 'save' }
    | { do: 'step'; steps: number }
    | { do: 'pace'; value: number }
    | { do: 'record'; on: boolean }
    | { do: 'load'; name?: string }
    | { do: 'replay'; name?: string }
    | { do: 'seek'; time: number }
    | { do: 'gravity'; to?: Point }
    | { do: 'damping'; value?: number }
    | { do: 'stiffness'; value?: number; material?: number }
    | { do: 'activate'; value?: number; material?: number }
    | { do: 'add_tool'; shape: 'sphere' | 'capsule' | 'grasper'; radius: number; length?: number }
    | { do: 'remove_tool'; tool: number };
