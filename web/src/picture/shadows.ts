/* Shadows of instruments on tissue. An endoscope's light leaves beside its lens, so what stands before the
 * tissue throws a shadow a little aside, and the nearer it is the closer shadow and instrument are: that
 * is how one sees that a tip is about to touch.
 *
 *     lamp *          Instruments are rods: segments with a radius. Of the way from a place of the
 *           \   (rod)  tissue to the lamp the distance from each rod's axis is known in closed form;
 *            \  /      within its radius it is dark, and the edge is softer the farther the rod is.
 *     --------*-----   No maps of depth, so no steps and no noise in it.
 */
import * as THREE from 'three';

export const RODS = 12; // at most

export interface Rod {
    from: THREE.Vector3; // in the axes of `of`
    to: THREE.Vector3;
    radius: number;
    of: THREE.Object3D;
}

/* GLSL: how much of the lamp's light reaches a place, 0..1. */
export const SHADOWS = /* glsl */ `
uniform vec4 rods[${2 * RODS}]; // from and its radius, to
uniform int rodCount;
uniform vec3 lamp;
float lampReaches(vec3 place) {
    vec3 way = lamp - place;
    float all = 1.0;
    for (int i = 0; i < ${RODS}; i++) {
        if (i >= rodCount) break;
        // The nearest points of the way (s) and the axis (t): Ericson, Real-Time Collision Detection, 5.1.9.
        vec3 axis = rods[2 * i + 1].xyz - rods[2 * i].xyz, gap = place - rods[2 * i].xyz;
        float a = dot(way, way), e = dot(axis, axis), f = dot(axis, gap), c = dot(way, gap);
        float b = dot(way, axis), whole = a * e - b * b;
        float s = whole > 1e-9 * a * e ? clamp((b * f - c * e) / whole, 0.0, 1.0) : 0.0;
        float t = e > 0.0 ? clamp((b * s + f) / e, 0.0, 1.0) : 0.0;
        s = clamp((b * t - c) / a, 0.0, 1.0);
        float radius = rods[2 * i].w;
        float far = length(gap + way * s - axis * t) - radius;
        float soft = 0.35 * radius + 0.10 * s * length(way);
        // What lies in the rod itself is pressed by it: its own shadow begins beside it.
        all = min(all, smoothstep(-0.5 * soft, soft, far));
    }
    return all;
}`;

export class Shadows {
    readonly uniforms = {
        rods: { value: Array.from({ length: 2 * RODS }, () => new THREE.Vector4()) },
        rodCount: { value: 0 },
        lamp: { value: new THREE.Vector3() },
    };
    on = true;
    private readonly point = new THREE.Vector3();

    /* Once a picture. `size` of the body: the lamp stands aside of the eye by some of it. */
    update(rods: Rod[], camera: THREE.Camera, size: number): void {
        const { uniforms, point } = this;
        const count = Math.min(rods.length, RODS);
        uniforms.rodCount.value = count;
        uniforms.lamp.value.set(-0.55 * size, 0.75 * size, 0).applyMatrix4(camera.matrixWorld);
        for (let i = 0; i < count; i++) {
            const rod = rods[i]!;
            rod.of.updateWorldMatrix(true, false);
            point.copy(rod.from).applyMatrix4(rod.of.matrixWorld);
            uniforms.rods.value[2 * i]!.set(point.x, point.y, point.z, rod.radius);
            point.copy(rod.to).applyMatrix4(rod.of.matrixWorld);
            uniforms.rods.value[2 * i + 1]!.set(point.x, point.y, point.z, 0);
        }
    }
}
