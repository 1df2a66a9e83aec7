/* Quads as flat arrays: four node indices each, counter-clockwise seen from outside. */

export interface Edges {
    ends: Uint32Array; // two nodes per edge
    ofSide: Uint32Array; // per quad four: side k joins corners k and k+1
    between(a: number, b: number): number; // the edge that joins two nodes
}

/* Every edge once, in the order in which the quads name it. */
export function edgesOf(nodes: number, quads: Uint32Array): Edges {
    const ends: number[] = [];
    const ofSide = new Uint32Array(quads.length);
    const known = new Map<number, number>();
    const key = (a: number, b: number): number => (a < b ? a * nodes + b : b * nodes + a);
    for (let i = 0; i < quads.length; i++) {
        const a = quads[i]!;
        const b = quads[(i & ~3) + ((i + 1) & 3)]!;
        let edge = known.get(key(a, b));
        if (edge === undefined) {
            edge = ends.length / 2;
            known.set(key(a, b), edge);
            ends.push(a, b);
        }
        ofSide[i] = edge;
    }
    return { ends: Uint32Array.from(ends), ofSide, between: (a, b) => known.get(key(a, b)) ?? 0 };
}

/* Every quad into four; middles of edges follow the nodes, centres of quads follow those. */
export function split(nodes: number, quads: Uint32Array, edges: Edges): Uint32Array {
    const out = new Uint32Array(quads.length * 4);
    const firstCenter = nodes + edges.ends.length / 2;
    let to = 0;
    for (let i = 0; i < quads.length; i += 4) {
        for (let k = 0; k < 4; k++) {
            out[to++] = quads[i + k]!;
            out[to++] = nodes + edges.ofSide[i + k]!;
            out[to++] = firstCenter + i / 4;
            out[to++] = nodes + edges.ofSide[i + ((k + 3) & 3)]!;
        }
    }
    return out;
}

export function trianglesOf(quads: Uint32Array): Uint32Array {
    const out = new Uint32Array((quads.length / 4) * 6);
    let to = 0;
    for (let i = 0; i < quads.length; i += 4) {
        out[to++] = quads[i]!;
        out[to++] = quads[i + 1]!;
        out[to++] = quads[i + 2]!;
        out[to++] = quads[i]!;
        out[to++] = quads[i + 2]!;
        out[to++] = quads[i + 3]!;
    }
    return out;
}

/* The cross product of the diagonals of the quad that starts at quads[q]: normal to it, and twice as
 * long as its area is large. */
function diagonalsCross(x: Float32Array, quads: Uint32Array, q: number, out: Float64Array): void {
    const a = quads[q]! * 3;
    const b = quads[q + 1]! * 3;
    const c = quads[q + 2]! * 3;
    const d = quads[q + 3]! * 3;
    const ux = x[c]! - x[a]!;
    const uy = x[c + 1]! - x[a + 1]!;
    const uz = x[c + 2]! - x[a + 2]!;
    const vx = x[d]! - x[b]!;
    const vy = x[d + 1]! - x[b + 1]!;
    const vz = x[d + 2]! - x[b + 2]!;
    out[0] = uy * vz - uz * vy;
    out[1] = uz * vx - ux * vz;
    out[2] = ux * vy - uy * vx;
}

const cross = new Float64Array(3); // scratch

/* Unit normal of the quad that starts at quads[q], into out[q / 4]. */
export function faceNormal(x: Float32Array, quads: Uint32Array, q: number, out: Float32Array): void {
    diagonalsCross(x, quads, q, cross);
    const length = Math.hypot(cross[0]!, cross[1]!, cross[2]!) || 1;
    for (let k = 0; k < 3; k++) out[(q / 4) * 3 + k] = cross[k]! / length;
}

/* Unit normals of the first `nodes` nodes: those of the quads around, weighted by area (the cross
 * product of the diagonals is twice the area). */
export function normalsOf(
    x: Float32Array,
    nodes: number,
    quads: Uint32Array,
    out: Float32Array,
): void {
    const end = nodes * 3;
    out.fill(0, 0, end);
    for (let q = 0; q < quads.length; q += 4) {
        diagonalsCross(x, quads, q, cross);
        const nx = cross[0]!;
        const ny = cross[1]!;
        const nz = cross[2]!;
        const a = quads[q]! * 3;
        const b = quads[q + 1]! * 3;
        const c = quads[q + 2]! * 3;
        const d = quads[q + 3]! * 3;
        out[a]! += nx;
        out[a + 1]! += ny;
        out[a + 2]! += nz;
        out[b]! += nx;
        out[b + 1]! += ny;
        out[b + 2]! += nz;
        out[c]! += nx;
        out[c + 1]! += ny;
        out[c + 2]! += nz;
        out[d]! += nx;
        out[d + 1]! += ny;
        out[d + 2]! += nz;
    }
    for (let i = 0; i < end; i += 3) {
        const length = Math.sqrt(out[i]! ** 2 + out[i + 1]! ** 2 + out[i + 2]! ** 2) || 1;
        out[i]! /= length;
        out[i + 1]! /= length;
        out[i + 2]! /= length;
    }
}
