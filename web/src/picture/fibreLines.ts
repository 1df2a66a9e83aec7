/* Where the lines along fibres lie (docs/viewer-protocol.md, message 1): one for each family on a face
 * of the mesh, along what of the fibre's direction lies within the face. At rest that is a sum of the
 * face's two widths,
 *
 *     d----e2----c        direction within the face = p e1 + q e2, and p and q never change:
 *     |    |     |        in every frame the line goes along p E1 + q E2 of the widths as
 *    -e1---+-----|->      they are then. So it moves, turns and stretches with the tissue,
 *     |    |     |        and frames carry no more than without it.
 *     a----------b
 *
 * A fibre that leaves the face is shorter by as much; one that runs straight into depth is a dot. Where
 * a mesh has many faces some of them, evenly strewn, have lines, and longer ones. All arrays are made
 * once; a frame only writes into them. */

const LINES_MAX = 1500; // faces with lines
const COVER = 0.8; // of a face, or of the distance between lines
const THIN = 0.12; // a line's width, of its length

export class FibreLines {
    readonly faces: Uint32Array; // those that have lines
    readonly positions: Float32Array; // of four corners for each line: its ends, each twice
    readonly sides: Float32Array; // from there to the corners, half as long as the line is wide
    readonly normals: Float32Array; // of the face, at each corner
    private readonly along: Float32Array; // p and q of each line
    private readonly width: Float32Array; // half of it [m]; 0: this face has no such family

    /* `fibres`: `families` unit vectors or zeros for each face. */
    constructor(
        rest: Float32Array,
        private readonly quads: Uint32Array,
        fibres: Float32Array,
        readonly families: number,
        max = LINES_MAX,
    ) {
        const own = facesWithFibres(fibres, families);
        const { faces, apart } = strewn(rest, quads, own, max);
        this.faces = faces;
        const lines = faces.length * families;
        this.positions = new Float32Array(lines * 12);
        this.sides = new Float32Array(lines * 12);
        this.normals = new Float32Array(lines * 12);
        this.along = new Float32Array(lines * 2);
        this.width = new Float32Array(lines);
        for (let i = 0; i < lines; i++) this.lay(i, rest, fibres, apart);
        this.place(rest);
    }

    /* p, q and the width of line i. `apart`: distance between lines [m], 0: every face has some. */
    private lay(i: number, rest: Float32Array, fibres: Float32Array, apart: number): void {
        const face = this.faces[(i / this.families) | 0]!;
        const at = 3 * (face * this.families + (i % this.families));
        const [fx, fy, fz] = [fibres[at]!, fibres[at + 1]!, fibres[at + 2]!];
        if (!fx && !fy && !fz) return;
        const area = stand(rest, this.quads, face);
        const [ax, ay, az, bx, by, bz] = W as unknown as [number, number, number, number, number, number];
        const [aa, ab, bb] = [ax * ax + ay * ay + az * az, ax * bx + ay * by + az * bz, bx * bx + by * by + bz * bz];
        if (!(area > 0)) return;
        // The point of the face's plane that is nearest to the fibre's end.
        const [fa, fb] = [fx * ax + fy * ay + fz * az, fx * bx + fy * by + fz * bz];
        let p = (fa * bb - fb * ab) / (area * area);
        let q = (fb * aa - fa * ab) / (area * area);
        const within = Math.sqrt(p * p * aa + 2 * p * q * ab + q * q * bb); // cosine to the face
        if (within < THIN) {
            [p, q] = [THIN / Math.sqrt(aa), 0];
        }
        // Fibres have no sense; families that lie alike point alike, so that they can be drawn side by side.
        if (i % this.families > 0) {
            const [r, s] = [this.along[2 * i - 2]!, this.along[2 * i - 1]!];
            if (p * r * aa + (p * s + q * r) * ab + q * s * bb < 0) [p, q] = [-p, -q];
        }
        const room = 1 / Math.max(Math.abs(p), Math.abs(q)); // at which the face ends, seen from side to side
        const whole = COVER * (apart > 0 ? Math.max(apart, Math.sqrt(area)) : Math.min(room, 2 * Math.sqrt(area)));
        this.along[2 * i] = (p * whole) / 2;
        this.along[2 * i + 1] = (q * whole) / 2;
        this.width[i] = (THIN * whole) / 2;
    }

    /* The nodes are here now. */
    place(x: Float32Array): void {
        const { faces, families, positions, sides, normals, along, width, quads } = this;
        for (let f = 0, i = 0; f < faces.length; f++) {
            const face = faces[f]!;
            stand(x, quads, face);
            middle(x, quads, face, C);
            for (const end = i + families; i < end; i++) {
                for (let k = 0; k < 3; k++) H[k] = along[2 * i]! * W[k]! + along[2 * i + 1]! * W[3 + k]!;
                cross(N, H, S);
                unit(S);
                for (let corner = 0, to = 12 * i; corner < 4; corner++) {
                    const ahead = corner < 2 ? -1 : 1;
                    const aside = (corner & 1 ? -1 : 1) * width[i]!;
                    for (let k = 0; k < 3; k++, to++) {
                        positions[to] = C[k]! + ahead * H[k]!;
                        sides[to] = aside * S[k]!;
                        normals[to] = N[k]!;
                    }
                }
            }
        }
    }

    /* Whether line i is there at all. */
    has(i: number): boolean {
        return this.width[i]! > 0;
    }

    faceOf(i: number): number {
        return this.faces[(i / this.families) | 0]!;
    }
}

// Scratch of the above: a face's widths, normal, middle; half a line, and its side.
const W = new Float64Array(6);
const E2 = W.subarray(3);
const N = new Float64Array(3);
const C = new Float64Array(3);
const H = new Float64Array(3);
const S = new Float64Array(3);

/* From the middle of side da to that of bc, and from that of ab to that of cd. */
function widths(x: Float32Array, quads: Uint32Array, face: number, out: Float64Array): void {
    const [a, b, c, d] = [0, 1, 2, 3].map((k) => 3 * quads[4 * face + k]!) as [number, number, number, number];
    for (let k = 0; k < 3; k++) {
        const [p, q, r, s] = [x[a + k]!, x[b + k]!, x[c + k]!, x[d + k]!];
        out[k] = (q + r - p - s) / 2;
        out[3 + k] = (r + s - p - q) / 2;
    }
}

/* A face's widths into W and its unit normal into N; its area. */
function stand(x: Float32Array, quads: Uint32Array, face: number): number {
    widths(x, quads, face, W);
    cross(W, E2, N);
    return unit(N);
}

function middle(x: Float32Array, quads: Uint32Array, face: number, out: Float64Array): void {
    for (let k = 0; k < 3; k++) {
        out[k] = 0;
        for (let a = 0; a < 4; a++) out[k]! += x[3 * quads[4 * face + a]! + k]! / 4;
    }
}

function cross(a: Float64Array, b: Float64Array, out: Float64Array): void {
    out[0] = a[1]! * b[2]! - a[2]! * b[1]!;
    out[1] = a[2]! * b[0]! - a[0]! * b[2]!;
    out[2] = a[0]! * b[1]! - a[1]! * b[0]!;
}

/* Returns how long it was. */
function unit(v: Float64Array): number {
    const length = Math.hypot(v[0]!, v[1]!, v[2]!);
    for (let k = 0; k < 3; k++) v[k]! /= length || 1;
    return length;
}

function facesWithFibres(fibres: Float32Array, families: number): Uint32Array {
    const width = 3 * families;
    const out: number[] = [];
    for (let face = 0; face * width < fibres.length; face++)
        if (fibres.subarray(face * width, (face + 1) * width).some((v) => v !== 0)) out.push(face);
    return Uint32Array.from(out);
}

/* At most `max` of some faces, evenly strewn: in each cell of a lattice, and for each of six directions
 * that faces look in (thin walls have two sides), the one that is nearest to the cell's middle. */
function strewn(
    rest: Float32Array, quads: Uint32Array, own: Uint32Array, max: number,
): { faces: Uint32Array; apart: number } {
    if (own.length <= max) return { faces: own, apart: 0 };
    let area = 0;
    for (const face of own) area += stand(rest, quads, face);
    let apart = Math.sqrt(area / max);
    for (;;) {
        const best = new Map<string, { face: number; far: number }>();
        for (const face of own) {
            middle(rest, quads, face, C);
            stand(rest, quads, face);
            let far = 0;
            let key = '';
            for (let k = 0; k < 3; k++) {
                const cell = Math.floor(C[k]! / apart);
                far += (C[k]! / apart - cell - 0.5) ** 2;
                key += `${cell},`;
            }
            const axis = [0, 1, 2].reduce((most, k) => (Math.abs(N[k]!) > Math.abs(N[most]!) ? k : most), 0);
            key += N[axis]! < 0 ? axis : axis + 3;
            const known = best.get(key);
            if (!known || far < known.far) best.set(key, { face, far });
        }
        if (best.size <= max)
            return { faces: Uint32Array.from([...best.values()].map(({ face }) => face)), apart };
        apart *= Math.max(1.05, Math.sqrt(best.size / max));
    }
}
