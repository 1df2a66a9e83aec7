/* The mesh's edges as lines. Where a fine surface is drawn instead of the mesh's own they would lie now
 * before, now behind it. Those on the side towards the eye are brought nearer to it then, along the line
 * of sight, so that they stay where they are in the picture: by `lift` metres, and by more where the
 * surface is seen aslant. */
import * as THREE from 'three';

const VERTEX = /* glsl */ `
uniform float lift;
varying float vFacing;
void main() {
    vec3 p = (modelViewMatrix * vec4(position, 1.0)).xyz;
    float far = length(p);
    float cosine = -dot(normalMatrix * normal, p) / far;
    vFacing = lift > 0.0 ? cosine : 1.0;
    p *= 1.0 - min(lift / (max(cosine, 0.2) * far), 0.5);
    gl_Position = projectionMatrix * vec4(p, 1.0);
}`;
const FRAGMENT = /* glsl */ `
varying float vFacing;
void main() {
    if (vFacing < 0.0) discard;
    gl_FragColor = vec4(0.0030, 0.0015, 0.0018, 0.55);
    #include <colorspace_fragment>
}`;

export class Edges {
    readonly lines: THREE.LineSegments;
    private readonly ink = new THREE.ShaderMaterial({
        vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { lift: { value: 0 } }, transparent: true,
    });

    /* `ends`: of segments, among the places of the surface that has them. */
    constructor(ends: Uint32Array, surface: THREE.BufferGeometry) {
        const geometry = new THREE.BufferGeometry();
        geometry.setIndex(new THREE.BufferAttribute(ends, 1));
        for (const name of ['position', 'normal']) geometry.setAttribute(name, surface.getAttribute(name));
        this.lines = new THREE.LineSegments(geometry, this.ink);
        this.lines.frustumCulled = false;
    }

    lift(metres: number): void {
        this.ink.uniforms.lift!.value = metres;
    }
}
