/* The mesh's edges as lines. Where an embedded surface is drawn instead of the mesh's own they would lie now
 * before, now behind it. Those on the side towards the eye are brought nearer to it then, along the line
 * of sight, so that they stay where they are in the picture: by `lift` metres, and by more where the
 * surface is seen aslant. */
import * as THREE from 'three';

const VERTEX = /* glsl */ `
uniform float lift;
varying float vFacing;
varying vec3 vPlace;
void main() {
    vPlace = position;
    vec3 p = (modelViewMatrix * vec4(position, 1.0)).xyz;
    float far = length(p);
    float cosine = -dot(normalMatrix * normal, p) / far;
    vFacing = lift > 0.0 ? cosine : 1.0;
    p *= 1.0 - min(lift / (max(cosine, 0.2) * far), 0.5);
    gl_Position = projectionMatrix * vec4(p, 1.0);
}`;
const FRAGMENT = /* glsl */ `
varying float vFacing;
varying vec3 vPlace;
uniform vec4 cut;
void main() {
    if (vFacing < 0.0 || dot(cut.xyz, vPlace) > cut.w) discard;
    gl_FragColor = vec4(0.0030, 0.0015, 0.0018, 0.55);
    #include <colorspace_fragment>
}`;

export class Edges {
    readonly lines: THREE.LineSegments;
    private readonly ink: THREE.ShaderMaterial;

    /* `ends`: of segments, among the places of the surface that has them. `cut`: Cut.plane. */
    constructor(private readonly ends: Uint32Array, surface: THREE.BufferGeometry, cut: THREE.Vector4) {
        this.ink = new THREE.ShaderMaterial({
            vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { lift: { value: 0 }, cut: { value: cut } },
            transparent: true,
        });
        const geometry = new THREE.BufferGeometry();
        geometry.setIndex(new THREE.BufferAttribute(ends.slice(), 1));
        for (const name of ['position', 'normal']) geometry.setAttribute(name, surface.getAttribute(name));
        this.lines = new THREE.LineSegments(geometry, this.ink);
        this.lines.frustumCulled = false;
    }

    /* Only some segments, by their number. */
    show(wanted: (segment: number) => boolean): void {
        const index = this.lines.geometry.index!;
        let to = 0;
        for (let i = 0; i < this.ends.length; i += 2) {
            if (!wanted(i / 2)) continue;
            index.array[to++] = this.ends[i]!;
            index.array[to++] = this.ends[i + 1]!;
        }
        index.needsUpdate = true;
        this.lines.geometry.setDrawRange(0, to);
    }

    lift(metres: number): void {
        this.ink.uniforms.lift!.value = metres;
    }
}
