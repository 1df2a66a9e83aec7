/* What is drawn of the bodies: the mesh's own surface, rounded (surface.ts), or a fine one embedded in
 * the mesh (embedded.ts). Both follow the nodes that frames carry. */
export interface SurfaceView {
    readonly nodes: number; // drawn ones
    readonly positions: Float32Array;
    readonly normals: Float32Array;
    readonly rest: Float32Array;
    readonly triangles: Uint32Array;
    readonly quads: Uint32Array; // the same area, in fours; a triangle has one corner twice
    readonly center: [number, number, number];
    readonly size: number; // half the diagonal of the box around it

    /* Takes the positions of a frame's nodes. */
    place(nodes: Float32Array): void;
    /* Continues values of a frame's nodes to all drawn ones. */
    paint(values: Float32Array, out: Float32Array): void;
}

/* Centre, half the diagonal and half the sides of the box around some positions. */
export function boxOf(x: Float32Array): { center: [number, number, number]; size: number; half: [number, number, number] } {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < x.length; i++) {
        low[i % 3] = Math.min(low[i % 3]!, x[i]!);
        high[i % 3] = Math.max(high[i % 3]!, x[i]!);
    }
    const half = [0, 1, 2].map((i) => (high[i]! - low[i]!) / 2) as [number, number, number];
    return {
        half,
        center: [(low[0]! + high[0]!) / 2, (low[1]! + high[1]!) / 2, (low[2]! + high[2]!) / 2],
        size: Math.hypot(...half) || 1,
    };
}
