/* Which point of the surface lies under the pointer: a ray against all drawn triangles. Asked for
 * when a button goes down and at most once a frame while the pointer moves, so brute force does. */
import type { Surface } from './surface';

export interface Hit {
    point: [number, number, number];
    distance: number;
    corners: [number, number, number]; // nodes of the drawn triangle
    weights: [number, number, number]; // of these, sum 1
}

type Vector = { x: number; y: number; z: number };

/* The nearest hit of the ray on the outside of the surface (Möller and Trumbore 1997). */
export function pick(surface: Surface, origin: Vector, direction: Vector): Hit | null {
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
