/* Which point of the surface lies under the pointer: a ray against all drawn triangles. Asked for
 * when a button goes down and at most once a frame while the pointer moves, so brute force does. And
 * where the point that was hit is later, and which point of the mesh is nearest to it. */
import type { Drawn } from './drawn';

export interface Hit {
    point: [number, number, number];
    distance: number;
    corners: [number, number, number]; // nodes of the drawn triangle
    weights: [number, number, number]; // of these, sum 1
}

type Vector = { x: number; y: number; z: number };

/* The nearest hit of the ray on the outside of the surface (Möller and Trumbore 1997). */
export function pick(surface: Drawn, origin: Vector, direction: Vector): Hit | null {
    const x = surface.positions;
    const t = surface.triangles;
    let best = Infinity;
    let found = -1;
    let weightB = 0;
    let weightC = 0;
    for (let i = 0; i < t.length; i += 3) {
        const a = t[i]! * 3;
        const b = t[i + 1]! * 3;
        const c = t[i + 2]! * 3;
        const ux = x[b]! - x[a]!;
        const uy = x[b + 1]! - x[a + 1]!;
        const uz = x[b + 2]! - x[a + 2]!;
        const vx = x[c]! - x[a]!;
        const vy = x[c + 1]! - x[a + 1]!;
        const vz = x[c + 2]! - x[a + 2]!;
        const px = direction.y * vz - direction.z * vy;
        const py = direction.z * vx - direction.x * vz;
        const pz = direction.x * vy - direction.y * vx;
        const det = ux * px + uy * py + uz * pz;
        if (det <= 0) continue; // seen from inside, or edge-on
        const sx = origin.x - x[a]!;
        const sy = origin.y - x[a + 1]!;
        const sz = origin.z - x[a + 2]!;
        const u = sx * px + sy * py + sz * pz;
        if (u < 0 || u > det) continue;
        const qx = sy * uz - sz * uy;
        const qy = sz * ux - sx * uz;
        const qz = sx * uy - sy * ux;
        const v = direction.x * qx + direction.y * qy + direction.z * qz;
        if (v < 0 || u + v > det) continue;
        const distance = (vx * qx + vy * qy + vz * qz) / det;
        if (distance > 0 && distance < best) {
            best = distance;
            found = i;
            weightB = u / det;
            weightC = v / det;
        }
    }
    if (found < 0) return null;
    return {
        point: [
            origin.x + direction.x * best,
            origin.y + direction.y * best,
            origin.z + direction.z * best,
        ],
        distance: best,
        corners: [t[found]!, t[found + 1]!, t[found + 2]!],
        weights: [1 - weightB - weightC, weightB, weightC],
    };
}

/* Where a point that was hit is now. */
export function follow(surface: Drawn, hit: Hit, out: Vector): void {
    out.x = out.y = out.z = 0;
    for (let k = 0; k < 3; k++) {
        const at = hit.corners[k]! * 3;
        out.x += hit.weights[k]! * surface.positions[at]!;
        out.y += hit.weights[k]! * surface.positions[at + 1]!;
        out.z += hit.weights[k]! * surface.positions[at + 2]!;
    }
}

/* The nearest drawn node, as a hit. */
export function nearestNode(surface: Drawn, to: Vector): Hit {
    const x = surface.positions;
    let best = Infinity;
    let found = 0;
    for (let i = 0; i < x.length; i += 3) {
        const square = (x[i]! - to.x) ** 2 + (x[i + 1]! - to.y) ** 2 + (x[i + 2]! - to.z) ** 2;
        if (square >= best) continue;
        best = square;
        found = i / 3;
    }
    return {
        point: [x[found * 3]!, x[found * 3 + 1]!, x[found * 3 + 2]!],
        distance: Math.sqrt(best),
        corners: [found, found, found],
        weights: [1, 0, 0],
    };
}

/* The nearest point of quads, each as two triangles. */
export function nearestPoint(x: Float32Array, quads: Uint32Array, to: Vector): [number, number, number] {
    const best: [number, number, number] = [to.x, to.y, to.z];
    let least = Infinity;
    for (let q = 0; q < quads.length; q += 4)
        for (let half = 1; half < 3; half++) {
            nearestOfTriangle(x, quads[q]! * 3, quads[q + half]! * 3, quads[q + half + 1]! * 3, to);
            const square = (nearest[0]! - to.x) ** 2 + (nearest[1]! - to.y) ** 2 + (nearest[2]! - to.z) ** 2;
            if (square >= least) continue;
            least = square;
            for (let k = 0; k < 3; k++) best[k] = nearest[k]!;
        }
    return best;
}

const nearest = new Float64Array(3); // the answer of what follows

/* The nearest of the points a + u (b - a) + v (c - a): within the triangle where the plane's nearest point
 * is, else on one of its sides. */
function nearestOfTriangle(x: Float32Array, a: number, b: number, c: number, to: Vector): void {
    const p = [to.x, to.y, to.z];
    let uu = 0;
    let uv = 0;
    let vv = 0;
    let up = 0;
    let vp = 0;
    for (let k = 0; k < 3; k++) {
        const u = x[b + k]! - x[a + k]!;
        const v = x[c + k]! - x[a + k]!;
        const d = p[k]! - x[a + k]!;
        uu += u * u;
        uv += u * v;
        vv += v * v;
        up += u * d;
        vp += v * d;
    }
    const det = uu * vv - uv * uv;
    const u = det > 0 ? (vv * up - uv * vp) / det : -1;
    const v = det > 0 ? (uu * vp - uv * up) / det : -1;
    if (u >= 0 && v >= 0 && u + v <= 1) {
        for (let k = 0; k < 3; k++)
            nearest[k] = x[a + k]! + u * (x[b + k]! - x[a + k]!) + v * (x[c + k]! - x[a + k]!);
        return;
    }
    let least = Infinity;
    for (const [from, end] of [[a, b], [b, c], [c, a]] as const) {
        let along = 0;
        let length = 0;
        for (let k = 0; k < 3; k++) {
            along += (p[k]! - x[from + k]!) * (x[end + k]! - x[from + k]!);
            length += (x[end + k]! - x[from + k]!) ** 2;
        }
        const t = length > 0 ? Math.min(1, Math.max(0, along / length)) : 0;
        const here = [0, 1, 2].map((k) => x[from + k]! + t * (x[end + k]! - x[from + k]!));
        const square = here.reduce((sum, value, k) => sum + (value - p[k]!) ** 2, 0);
        if (square >= least) continue;
        least = square;
        nearest.set(here);
    }
}
