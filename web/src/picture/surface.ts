/* The surface of the bodies as it is drawn.
 *
 * The engine sends positions of the mesh's surface nodes. Between them the surface is rounded, so
 * that coarse meshes do not look faceted: every edge gets a point in its middle, on the cubic curve
 * that leaves both ends at right angles to their normals; every face gets one in its centre (Coons
 * patch). Once or twice. Nodes of the mesh stay exactly where the engine says they are.
 *
 *     a-------b        a---m---b       nodes  [mesh nodes | middles | centres | those of level 2]
 *     |       |        |   |   |       quads  number q has the children 4q .. 4q+3
 *     |       |  -->   m---c---m
 *     |       |        |   |   |
 *     d-------c        d---m---c
 *
 * All arrays are made once; a frame only writes into them.
 */
import { boxOf, type SurfaceView } from './surfaceView';
import { edgesOf, faceNormal, normalsOf, split, trianglesOf, type Edges } from './quads';

interface Level {
    nodes: number; // a prefix of those of the next level
    quads: Uint32Array;
    edges: Edges;
    sharp: Uint8Array; // per node: on a crease, which stays one
}

const CREASE = Math.cos((55 * Math.PI) / 180);

export class Surface implements SurfaceView {
    readonly meshNodes: number;
    readonly meshQuads: Uint32Array;
    readonly nodes: number;
    readonly quads: Uint32Array;
    readonly positions: Float32Array;
    readonly normals: Float32Array;
    readonly rest: Float32Array;
    readonly triangles: Uint32Array;
    readonly lines: Uint32Array; // ends of segments along the edges of the mesh, edge after edge
    readonly sides: Uint32Array; // four per face of the mesh: the edges around it
    readonly center: [number, number, number];
    readonly size: number;
    readonly half: [number, number, number]; // of the sides of its box at rest
    readonly meanEdge: number; // of the mesh, at rest
    private readonly levels: Level[] = [];

    /* Rounded as long as there are no more than `max` nodes. */
    constructor(rest: Float32Array, quads: Uint32Array, max: number) {
        this.meshNodes = rest.length / 3;
        this.meshQuads = quads;
        let nodes = this.meshNodes;
        let edges = edgesOf(nodes, quads);
        let lines = edges.ends;
        this.sides = edges.ofSide;
        this.meanEdge = meanLength(rest, lines);
        let current = quads;
        while (this.levels.length < 2) {
            const finer = nodes + edges.ends.length / 2 + current.length / 4;
            if (finer > max) break;
            this.levels.push({ nodes, quads: current, edges, sharp: new Uint8Array(nodes) });
            current = split(nodes, current, edges);
            lines = halved(lines, nodes, edges);
            nodes = finer;
            edges = edgesOf(nodes, current);
        }
        this.nodes = nodes;
        this.quads = current;
        this.lines = lines;
        this.positions = new Float32Array(nodes * 3);
        this.normals = new Float32Array(nodes * 3);
        this.triangles = trianglesOf(current);

        this.markCreases(rest);
        this.update(rest);
        this.rest = this.positions.slice();
        ({ center: this.center, size: this.size, half: this.half } = boxOf(rest));
    }

    /* The face of the mesh that a drawn triangle is of. */
    faceOf(triangle: number): number {
        return triangle >> (1 + 2 * this.levels.length);
    }

    /* The edge of the mesh that a segment of its lines is of. */
    edgeOf(segment: number): number {
        return segment >> this.levels.length;
    }

    /* Takes the positions of a frame's nodes, of which the mesh's surface has the first. */
    place(nodes: Float32Array): void {
        this.update(nodes.subarray(0, this.meshNodes * 3));
    }

    /* The same without rounding: what is not drawn needs its nodes only. */
    keep(nodes: Float32Array): void {
        this.positions.set(nodes.subarray(0, this.meshNodes * 3));
    }

    paint(values: Float32Array, out: Float32Array): void {
        out.set(values.subarray(0, this.meshNodes));
        this.spread(out, 1);
    }

    /* Takes the positions of the mesh's surface nodes and rounds what lies between. */
    update(mesh: Float32Array): void {
        this.positions.set(mesh);
        for (const level of this.levels) {
            normalsOf(this.positions, level.nodes, level.quads, this.normals);
            round(this.positions, this.normals, level);
        }
        normalsOf(this.positions, this.nodes, this.quads, this.normals);
    }

    /* Continues values of the mesh's nodes, `width` of them per node, to all drawn nodes, in place. */
    spread(values: Float32Array, width: number): void {
        for (const level of this.levels) {
            const ends = level.edges.ends;
            const quads = level.quads;
            let to = level.nodes * width;
            for (let i = 0; i < ends.length; i += 2) {
                const a = ends[i]! * width;
                const b = ends[i + 1]! * width;
                for (let k = 0; k < width; k++) values[to++] = (values[a + k]! + values[b + k]!) / 2;
            }
            for (let i = 0; i < quads.length; i += 4) {
                const a = quads[i]! * width;
                const b = quads[i + 1]! * width;
                const c = quads[i + 2]! * width;
                const d = quads[i + 3]! * width;
                for (let k = 0; k < width; k++)
                    values[to++] =
                        (values[a + k]! + values[b + k]! + values[c + k]! + values[d + k]!) / 4;
            }
        }
    }

    /* Where faces of the mesh meet at a sharp angle, as in blocks, nothing is rounded. */
    private markCreases(rest: Float32Array): void {
        const [first, second] = this.levels;
        if (!first) return;
        const { ends, ofSide } = first.edges;
        const faces = new Float32Array((first.quads.length / 4) * 3);
        for (let q = 0; q < first.quads.length; q += 4) faceNormal(rest, first.quads, q, faces);
        const before = new Int32Array(ends.length / 2).fill(-1);
        const sharpEdge = new Uint8Array(ends.length / 2);
        for (let side = 0; side < ofSide.length; side++) {
            const edge = ofSide[side]!;
            const f = (side >> 2) * 3;
            const g = before[edge]! * 3;
            before[edge] = side >> 2;
            if (g < 0) continue;
            const cosine =
                faces[f]! * faces[g]! + faces[f + 1]! * faces[g + 1]! + faces[f + 2]! * faces[g + 2]!;
            if (cosine > CREASE) continue;
            sharpEdge[edge] = 1;
            first.sharp[ends[edge * 2]!] = 1;
            first.sharp[ends[edge * 2 + 1]!] = 1;
        }
        if (!second) return;
        second.sharp.set(first.sharp);
        second.sharp.set(sharpEdge, first.nodes);
    }
}

function meanLength(x: Float32Array, ends: Uint32Array): number {
    let sum = 0;
    for (let i = 0; i < ends.length; i += 2) {
        const a = ends[i]! * 3;
        const b = ends[i + 1]! * 3;
        sum += Math.hypot(x[a]! - x[b]!, x[a + 1]! - x[b + 1]!, x[a + 2]! - x[b + 2]!);
    }
    return ends.length ? (2 * sum) / ends.length : 0;
}

/* Middles of edges, centres of faces: the rule of the picture above. */
function round(x: Float32Array, n: Float32Array, level: Level): void {
    const { nodes, quads, sharp } = level;
    const { ends, ofSide } = level.edges;
    let to = nodes * 3;
    for (let i = 0; i < ends.length; i += 2) {
        const a = ends[i]! * 3;
        const b = ends[i + 1]! * 3;
        const dx = x[b]! - x[a]!;
        const dy = x[b + 1]! - x[a + 1]!;
        const dz = x[b + 2]! - x[a + 2]!;
        const atA = sharp[ends[i]!] ? 0 : (dx * n[a]! + dy * n[a + 1]! + dz * n[a + 2]!) / 8;
        const atB = sharp[ends[i + 1]!] ? 0 : (dx * n[b]! + dy * n[b + 1]! + dz * n[b + 2]!) / 8;
        for (let k = 0; k < 3; k++)
            x[to++] = (x[a + k]! + x[b + k]!) / 2 - atA * n[a + k]! + atB * n[b + k]!;
    }
    for (let i = 0; i < quads.length; i += 4) {
        const a = quads[i]! * 3;
        const b = quads[i + 1]! * 3;
        const c = quads[i + 2]! * 3;
        const d = quads[i + 3]! * 3;
        const p = (nodes + ofSide[i]!) * 3;
        const q = (nodes + ofSide[i + 1]!) * 3;
        const r = (nodes + ofSide[i + 2]!) * 3;
        const s = (nodes + ofSide[i + 3]!) * 3;
        for (let k = 0; k < 3; k++)
            x[to++] =
                (x[p + k]! + x[q + k]! + x[r + k]! + x[s + k]!) / 2 -
                (x[a + k]! + x[b + k]! + x[c + k]! + x[d + k]!) / 4;
    }
}

/* Segments of lines, each cut at the middle of the edge on which it lies. */
function halved(lines: Uint32Array, nodes: number, edges: Edges): Uint32Array {
    const out = new Uint32Array(lines.length * 2);
    for (let i = 0; i < lines.length; i += 2) {
        const middle = nodes + edges.between(lines[i]!, lines[i + 1]!);
        out.set([lines[i]!, middle, middle, lines[i + 1]!], i * 2);
    }
    return out;
}
