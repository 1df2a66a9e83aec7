/* Lines along the fibres, as three.js draws them: flat on the faces, brought a little towards the eye as
 * edges are (edges.ts), because the drawn surface is rounder than the mesh's faces or another one. Dark
 * at both sides, so that they are seen on every colour of values; the second family of a pair is blue.
 * Of a pair each lies beside its middle, or one would hide the other where they are projected alike.
 * From afar they are wider than they lie, so that they stay some points of the screen wide. */
import * as THREE from 'three';
import type { FibreLines } from './fibreLines';

const VERTEX = /* glsl */ `
#define WIDE 3.0 // points of the screen, at least
uniform float lift;
uniform float height;
uniform float pair;
attribute vec3 side;
attribute float aside;
attribute float family;
varying float vAside;
varying float vFamily;
varying float vFacing;
varying vec3 vPlace;
void main() {
    vAside = aside;
    vFamily = family;
    vPlace = position;
    vec3 p = (modelViewMatrix * vec4(position, 1.0)).xyz;
    float far = length(p);
    float points = WIDE * far / (projectionMatrix[1][1] * height);
    vec3 wide = normalMatrix * side;
    p += wide * max(1.0, points / max(length(wide), 1e-9)) * (1.0 + pair * (1.0 - 2.0 * family) * aside);
    vFacing = -dot(normalMatrix * normal, p) / far;
    p *= 1.0 - min(lift / (max(vFacing, 0.2) * far), 0.5);
    gl_Position = projectionMatrix * vec4(p, 1.0);
}`;
const FRAGMENT = /* glsl */ `
varying float vAside;
varying float vFamily;
varying float vFacing;
varying vec3 vPlace;
uniform vec4 cut;
void main() {
    if (vFacing < 0.0 || dot(cut.xyz, vPlace) > cut.w) discard;
    vec3 ink = mix(vec3(1.0, 0.88, 0.62), vec3(0.10, 0.55, 1.0), vFamily);
    gl_FragColor = vec4(mix(ink, vec3(0.012), smoothstep(0.45, 0.75, abs(vAside))), 1.0);
    #include <colorspace_fragment>
}`;

const SIZE = new THREE.Vector2(); // scratch

export class Fibres {
    readonly mesh: THREE.Mesh;
    drawn = 0; // lines
    private readonly ink: THREE.ShaderMaterial;

    /* `cut`: Cut.plane. */
    constructor(private readonly lines: FibreLines, cut: THREE.Vector4) {
        this.ink = new THREE.ShaderMaterial({
            vertexShader: VERTEX, fragmentShader: FRAGMENT, side: THREE.DoubleSide,
            uniforms: { lift: { value: 0 }, height: { value: 1 }, pair: { value: lines.families - 1 }, cut: { value: cut } },
        });
        const corners = lines.positions.length / 3;
        const aside = Float32Array.from({ length: corners }, (_, corner) => (corner & 1 ? -1 : 1));
        const family = Float32Array.from({ length: corners }, (_, corner) => (corner >> 2) % lines.families);
        const geometry = new THREE.BufferGeometry();
        for (const [name, array] of [['position', lines.positions], ['side', lines.sides], ['normal', lines.normals]] as const)
            geometry.setAttribute(name, new THREE.BufferAttribute(array, 3).setUsage(THREE.DynamicDrawUsage));
        geometry.setAttribute('aside', new THREE.BufferAttribute(aside, 1));
        geometry.setAttribute('family', new THREE.BufferAttribute(family, 1));
        geometry.setIndex(new THREE.BufferAttribute(new Uint32Array((corners / 4) * 6), 1));
        this.mesh = new THREE.Mesh(geometry, this.ink);
        this.mesh.frustumCulled = false;
        this.mesh.onBeforeRender = (renderer) => (this.ink.uniforms.height!.value = renderer.getDrawingBufferSize(SIZE).y);
        this.show(() => true);
    }

    /* Only those on some faces of the mesh. */
    show(wanted: (face: number) => boolean): void {
        const index = this.mesh.geometry.index!;
        this.drawn = 0;
        for (let i = 0; 4 * i < this.lines.positions.length / 3; i++) {
            if (!this.lines.has(i) || !wanted(this.lines.faceOf(i))) continue;
            [0, 1, 2, 2, 1, 3].forEach((corner, k) => (index.array[6 * this.drawn + k] = 4 * i + corner));
            this.drawn++;
        }
        index.needsUpdate = true;
        this.mesh.geometry.setDrawRange(0, 6 * this.drawn);
    }

    place(nodes: Float32Array): void {
        this.lines.place(nodes);
        for (const name of ['position', 'side', 'normal']) this.mesh.geometry.getAttribute(name).needsUpdate = true;
    }

    lift(metres: number): void {
        this.ink.uniforms.lift!.value = metres;
    }
}
