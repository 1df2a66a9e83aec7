/* Noise over the rest position that is coarse enough to be worked out once per drawn node: mottling, and
 * two nets of vessels. A vessel runs where a noise passes zero; divided by its slope the noise is about
 * the distance from that line, which stays a fine line when it is interpolated. */

const MOTTLE = 4.2; // cells per half size of the organ
const TRUNKS = 1.9;
const BRANCHES = 5.2;

/* Four numbers per node: mottling -1..1, distance from trunks and from branches, and `open`. */
export function tissueNoise(unit: Float32Array, open: Float32Array): Float32Array {
    const out = new Float32Array(open.length * 4);
    for (let i = 0; i < open.length; i++) {
        const x = unit[i * 3]!;
        const y = unit[i * 3 + 1]!;
        const z = unit[i * 3 + 2]!;
        // Lines that are bent a little look grown.
        const bend = noise(x * 6, y * 6, z * 6) * 0.07;
        out[i * 4] = noise(x * MOTTLE, y * MOTTLE, z * MOTTLE) * 0.7 + noise(x * 9, y * 9, z * 9) * 0.5;
        out[i * 4 + 1] = fromLine(x + bend, y - bend, z + bend, TRUNKS, 3.1);
        out[i * 4 + 2] = fromLine(x - bend, y + bend, z + bend, BRANCHES, 9.7);
        out[i * 4 + 3] = open[i]!;
    }
    return out;
}

function fromLine(x: number, y: number, z: number, cells: number, shift: number): number {
    const at = (dx: number, dy: number, dz: number): number =>
        noise((x + dx) * cells + shift, (y + dy) * cells + shift, (z + dz) * cells - shift);
    const h = 0.004;
    const value = at(0, 0, 0);
    const slope = Math.hypot(at(h, 0, 0) - value, at(0, h, 0) - value, at(0, 0, h) - value) / h;
    return value / (0.6 + slope);
}

/* Smooth noise, -1..1, one random number per cell corner. */
export function noise(x: number, y: number, z: number): number {
    const i = Math.floor(x);
    const j = Math.floor(y);
    const k = Math.floor(z);
    const u = ease(x - i);
    const v = ease(y - j);
    const w = ease(z - k);
    let sum = 0;
    for (let c = 0; c < 8; c++) {
        const a = c & 1;
        const b = (c >> 1) & 1;
        const d = c >> 2;
        sum += corner(i + a, j + b, k + d) * (a ? u : 1 - u) * (b ? v : 1 - v) * (d ? w : 1 - w);
    }
    return sum;
}

const ease = (t: number): number => t * t * t * (t * (t * 6 - 15) + 10);

function corner(i: number, j: number, k: number): number {
    let h = Math.imul(i, 0x27d4eb2d) ^ Math.imul(j, 0x165667b1) ^ Math.imul(k, 0x9e3779b1);
    h = Math.imul(h ^ (h >>> 15), 0x2c1b3c6d);
    h = Math.imul(h ^ (h >>> 12), 0x297a2d39);
    return ((h ^ (h >>> 15)) >>> 0) / 2147483648 - 1;
}
