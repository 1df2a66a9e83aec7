/* Which point of the surface lies under the pointer: a ray against all drawn triangles. Asked for
 * when a button goes down and at most once a frame while the pointer moves, so brute force does. And
 * where the point that was hit is later, and which point of the mesh is nearest to it. */
import type { SurfaceView } from '../picture/surfaceView';

export interface Hit {
    point: [number, number, number];
    distance: number;
    corners: [number, number, number]; // nodes of the drawn triangle
    weights: [number, number, number]; // of these, sum 1
    triangle: number; // of those that were looked at; -1: a node
}

type Vector = { x: number; y: number; z: number };

/* What a ray may hit of a surface: these triangles, but not where the plane (normal, distance) hides them. */
export interface Among {
    triangles: Uint32Array;
    plane: { x: number; y: number; z: number; w: number };
}

/* The nearest hit of the ray on the outside of the surface (Möller and Trumbore 1997). */
export function pick(surface: SurfaceView, origin: Vector, direction: Vector, among?: Among): Hit | null {
    const x = surface.positions;
    const t = among?.triangles ?? surface.triangles;
    // Along the ray: is beyond the plane where `ahead` + distance `speed` > 0.
    const { x: nx, y: ny, z: nz, w } = among?.plane ?? { x: 0, y: 0, z: 0, w: 1 };
    const ahead = nx * origin.x + ny * origin.y + nz * origin.z - w;
    const speed = nx * direction.x + ny * direction.y + nz * direction.z;
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
        if (distance > 0 && distance < best && ahead + distance * speed <= 0) {
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
        triangle: found / 3,
    };
}

/* Where a point that was hit is now. */
export function follow(surface: SurfaceView, hit: Hit, out: Vector): void {
    out.x = out.y = out.z = 0;
    for (let k = 0; k < 3; k++) {
        const at = hit.corners[k]! * 3;
        out.x += hit.weights[k]! * surface.positions[at]!;
        out.y += hit.weights[k]! * surface.positions[at + 1]!;
        out.z += hit.weights[k]! * surface.positions[at + 2]!;
    }
}

/* The nearest drawn node, as a hit. */
export function nearestNode(surface: SurfaceView, to: Vector): Hit {
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
        triangle: -1,
    };
}

/* The nearest point of quads, each as two triangles, and the quad that it is on. */
export function nearestPoint(
    x: Float32Array, quads: Uint32Array, to: Vector,
): { point: [number, number, number]; quad: number } {
    const best: [number, number, number] = [to.x, to.y, to.z];
    let quad = -1;
    let min = Infinity;
    for (let q = 0; q < quads.length; q += 4)
        for (let half = 1; half < 3; half++) {
            const square = nearOnTriangle(x, quads[q]! * 3, quads[q + half]! * 3, quads[q + half + 1]! * 3, to);
            if (square >= min) continue;
            min = square;
            quad = q / 4;
            for (let k = 0; k < 3; k++) best[k] = near[k]!;
        }
    return { point: best, quad };
}

const near = new Float64Array(3); // the answer of what follows

/* The nearest of the points a + u (b - a) + v (c - a): within the triangle where the plane's nearest point
 * is, else on one of its sides. Gives the square of the distance. */
function nearOnTriangle(x: Float32Array, a: number, b: number, c: number, to: Vector): number {
    const ux = x[b]! - x[a]!;
    const uy = x[b + 1]! - x[a + 1]!;
    const uz = x[b + 2]! - x[a + 2]!;
    const vx = x[c]! - x[a]!;
    const vy = x[c + 1]! - x[a + 1]!;
    const vz = x[c + 2]! - x[a + 2]!;
    const dx = to.x - x[a]!;
    const dy = to.y - x[a + 1]!;
    const dz = to.z - x[a + 2]!;
    const uu = ux * ux + uy * uy + uz * uz;
    const uv = ux * vx + uy * vy + uz * vz;
    const vv = vx * vx + vy * vy + vz * vz;
    const up = ux * dx + uy * dy + uz * dz;
    const vp = vx * dx + vy * dy + vz * dz;
    const det = uu * vv - uv * uv;
    const u = (vv * up - uv * vp) / det;
    const v = (uu * vp - uv * up) / det;
    if (det > 0 && u >= 0 && v >= 0 && u + v <= 1) {
        near[0] = x[a]! + u * ux + v * vx;
        near[1] = x[a + 1]! + u * uy + v * vy;
        near[2] = x[a + 2]! + u * uz + v * vz;
        return squareTo(to);
    }
    let min = nearOnSide(x, a, b, to, Infinity);
    min = nearOnSide(x, b, c, to, min);
    return nearOnSide(x, c, a, to, min);
}

function squareTo(to: Vector): number {
    return (near[0]! - to.x) ** 2 + (near[1]! - to.y) ** 2 + (near[2]! - to.z) ** 2;
}

/* The nearest point of a side where it is nearer than `min`, the square of a distance. */
function nearOnSide(x: Float32Array, a: number, b: number, to: Vector, min: number): number {
    const ux = x[b]! - x[a]!;
    const uy = x[b + 1]! - x[a + 1]!;
    const uz = x[b + 2]! - x[a + 2]!;
    const length = ux * ux + uy * uy + uz * uz;
    const along = ux * (to.x - x[a]!) + uy * (to.y - x[a + 1]!) + uz * (to.z - x[a + 2]!);
    const t = length > 0 ? Math.min(1, Math.max(0, along / length)) : 0;
    const px = x[a]! + t * ux;
    const py = x[a + 1]! + t * uy;
    const pz = x[a + 2]! + t * uz;
    const square = (px - to.x) ** 2 + (py - to.y) ** 2 + (pz - to.z) ** 2;
    if (square >= min) return min;
    near[0] = px;
    near[1] = py;
    near[2] = pz;
    return square;
}
