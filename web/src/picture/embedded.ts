/* An embedded surface (docs/viewer-protocol.md, message 4): every vertex is the sum of
 * eight nodes of an element by weights that never change, and its values are so too.
 *
 *     frame: nodes of the mesh --weights--> vertices --triangles--> normals
 *
 * All arrays are made once; a frame only writes into them. 17,000 vertices take about a millisecond. */
import { boxOf, type SurfaceView } from './surfaceView';
import type { EmbeddedMessage } from '../link/protocol';

export class EmbeddedSurface implements SurfaceView {
    readonly nodes: number;
    readonly positions: Float32Array;
    readonly normals: Float32Array;
    readonly rest: Float32Array;
    readonly triangles: Uint32Array;
    readonly center: [number, number, number];
    readonly size: number;
    private readonly weights: Float32Array; // eight per vertex
    private readonly carriers: Uint32Array; // the nodes that these are of

    /* `nodes`: of frames, at rest. */
    constructor(nodes: Float32Array, message: EmbeddedMessage) {
        this.nodes = message.material.length;
        this.weights = message.weights;
        this.carriers = message.carriers;
        this.triangles = message.triangles;
        this.positions = new Float32Array(this.nodes * 3);
        this.normals = new Float32Array(this.nodes * 3);
        this.place(nodes);
        this.rest = this.positions.slice();
        ({ center: this.center, size: this.size } = boxOf(this.rest));
    }

    get quads(): Uint32Array {
        const t = this.triangles;
        const out = new Uint32Array((t.length / 3) * 4);
        for (let i = 0, to = 0; i < t.length; i += 3, to += 4)
            out.set([t[i]!, t[i + 1]!, t[i + 2]!, t[i + 2]!], to);
        return out;
    }

    place(nodes: Float32Array): void {
        const { weights, carriers, positions } = this;
        for (let to = 0, at = 0; to < positions.length; to += 3) {
            let x = 0;
            let y = 0;
            let z = 0;
            for (const end = at + 8; at < end; at++) {
                const weight = weights[at]!;
                const node = carriers[at]! * 3;
                x += weight * nodes[node]!;
                y += weight * nodes[node + 1]!;
                z += weight * nodes[node + 2]!;
            }
            positions[to] = x;
            positions[to + 1] = y;
            positions[to + 2] = z;
        }
        smooth(positions, this.triangles, this.normals);
    }

    paint(values: Float32Array, out: Float32Array): void {
        const { weights, carriers } = this;
        for (let v = 0, at = 0; v < this.nodes; v++) {
            let sum = 0;
            for (const end = at + 8; at < end; at++) sum += weights[at]! * values[carriers[at]!]!;
            out[v] = sum;
        }
    }

    /* The node that has most to say about a vertex. */
    leader(vertex: number): number {
        let best = vertex * 8;
        for (let at = best + 1; at < vertex * 8 + 8; at++)
            if (this.weights[at]! > this.weights[best]!) best = at;
        return this.carriers[best]!;
    }
}

/* Unit normals: those of the triangles around, weighted by area. */
function smooth(x: Float32Array, triangles: Uint32Array, out: Float32Array): void {
    out.fill(0);
    for (let i = 0; i < triangles.length; i += 3) {
        const a = triangles[i]! * 3;
        const b = triangles[i + 1]! * 3;
        const c = triangles[i + 2]! * 3;
        const ux = x[b]! - x[a]!;
        const uy = x[b + 1]! - x[a + 1]!;
        const uz = x[b + 2]! - x[a + 2]!;
        const vx = x[c]! - x[a]!;
        const vy = x[c + 1]! - x[a + 1]!;
        const vz = x[c + 2]! - x[a + 2]!;
        const nx = uy * vz - uz * vy;
        const ny = uz * vx - ux * vz;
        const nz = ux * vy - uy * vx;
        out[a]! += nx;
        out[a + 1]! += ny;
        out[a + 2]! += nz;
        out[b]! += nx;
        out[b + 1]! += ny;
        out[b + 2]! += nz;
        out[c]! += nx;
        out[c + 1]! += ny;
        out[c + 2]! += nz;
    }
    for (let i = 0; i < out.length; i += 3) {
        const length = Math.sqrt(out[i]! ** 2 + out[i + 1]! ** 2 + out[i + 2]! ** 2) || 1;
        out[i]! /= length;
        out[i + 1]! /= length;
        out[i + 2]! /= length;
    }
}
