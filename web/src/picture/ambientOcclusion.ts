/* How open the surroundings of each drawn node are at rest, 0..1: folds and gaps between organs are
 * darker. Coarse and made once: cells that the surface passes through are marked, and from every
 * node some rays look how soon they meet a marked one. */
import type { SurfaceView } from './surfaceView';

const CELLS = 56; // along the longest side
const RAYS = 24;

export function openness(surface: SurfaceView): Float32Array {
    const { rest, nodes, size, center, normals, quads } = surface;
    const cell = (2.4 * size) / CELLS;
    const low = center.map((c) => c - 1.2 * size);
    const marked = new Uint8Array(CELLS ** 3);
    const at = (x: number, y: number, z: number): number => {
        const i = Math.floor((x - low[0]!) / cell);
        const j = Math.floor((y - low[1]!) / cell);
        const k = Math.floor((z - low[2]!) / cell);
        if (i < 0 || j < 0 || k < 0 || i >= CELLS || j >= CELLS || k >= CELLS) return -1;
        return (k * CELLS + j) * CELLS + i;
    };
    for (let q = 0; q < quads.length; q += 4)
        for (let u = 0; u <= 4; u++)
            for (let v = 0; v <= 4; v++) {
                const p = [0, 1, 2].map((k) => {
                    const bottom = lerp(rest[quads[q]! * 3 + k]!, rest[quads[q + 1]! * 3 + k]!, u / 4);
                    const top = lerp(rest[quads[q + 3]! * 3 + k]!, rest[quads[q + 2]! * 3 + k]!, u / 4);
                    return lerp(bottom, top, v / 4);
                });
                const index = at(p[0]!, p[1]!, p[2]!);
                if (index >= 0) marked[index] = 1;
            }

    // Directions spread evenly over the sphere (Fibonacci); a node uses those above its surface.
    const out = new Float32Array(nodes);
    for (let i = 0; i < nodes; i++) {
        const n = i * 3;
        let sky = 0;
        let all = 0;
        for (let r = 0; r < RAYS * 2; r++) {
            const z = 1 - (2 * r + 1) / (RAYS * 2);
            const rim = Math.sqrt(1 - z * z);
            const dx = rim * Math.cos(r * 2.399963);
            const dy = rim * Math.sin(r * 2.399963);
            const cosine = dx * normals[n]! + dy * normals[n + 1]! + z * normals[n + 2]!;
            if (cosine < 0.15) continue;
            all += cosine;
            let free = 1;
            for (let step = 2; step < 11; step++) {
                const far = (step + 0.2) * cell;
                const index = at(
                    rest[n]! + dx * far + normals[n]! * cell,
                    rest[n + 1]! + dy * far + normals[n + 1]! * cell,
                    rest[n + 2]! + z * far + normals[n + 2]! * cell,
                );
                if (index >= 0 && marked[index]) {
                    free = (step - 2) / 14;
                    break;
                }
            }
            sky += cosine * free;
        }
        out[i] = all > 0 ? 0.28 + 0.72 * (sky / all) : 1;
    }
    return smoothed(out, quads);
}

const lerp = (a: number, b: number, t: number): number => a + (b - a) * t;

/* Twice the mean of a node and its quads' corners: takes the grain of few rays away. */
function smoothed(values: Float32Array, quads: Uint32Array): Float32Array {
    let from = values;
    for (let round = 0; round < 3; round++) {
        const sum = new Float32Array(from.length);
        const count = new Float32Array(from.length);
        for (let q = 0; q < quads.length; q += 4) {
            const mean =
                (from[quads[q]!]! + from[quads[q + 1]!]! + from[quads[q + 2]!]! + from[quads[q + 3]!]!) / 4;
            for (let k = 0; k < 4; k++) {
                sum[quads[q + k]!]! += mean;
                count[quads[q + k]!]!++;
            }
        }
        from = sum.map((s, i) => (count[i]! > 0 ? s / count[i]! : from[i]!));
    }
    return from;
}
