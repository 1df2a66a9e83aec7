/* One drawn surface with its colours, as three.js draws it. */
import * as THREE from 'three';
import type { SurfaceView } from './surfaceView';
import { tissueNoise } from './tissueNoise';
import { openness } from './ambientOcclusion';

export interface Tints {
    organs: Float32Array; // three per drawn node
    processors: Float32Array;
}

/* What of an organ is seen. */
export type Seen = 'shown' | 'faded' | 'hidden';

export class Organ {
    readonly mesh: THREE.Mesh;
    readonly triangles: Uint32Array; // in the order: shown, faded, hidden
    readonly regions: Uint32Array; // of these
    shown: number; // triangles that are seen, and those of them that are faded
    faded = 0;
    private readonly values: Float32Array;

    /* `regionOf`: the organ that a triangle of `surface` belongs to. `materials`: for what is shown, and
     * for what is faded. */
    constructor(
        readonly surface: SurfaceView,
        private readonly tints: Tints,
        materials: [THREE.Material, THREE.Material],
        private readonly regionOf: (triangle: number) => number,
    ) {
        this.triangles = surface.triangles.slice();
        this.shown = surface.triangles.length / 3;
        this.regions = new Uint32Array(this.shown);
        const unit = new Float32Array(surface.rest.length);
        for (let i = 0; i < unit.length; i++)
            unit[i] = (surface.rest[i]! - surface.center[i % 3]!) / surface.size;
        this.values = new Float32Array(surface.nodes);
        const geometry = new THREE.BufferGeometry();
        const changing = (array: Float32Array, width: number): THREE.BufferAttribute =>
            new THREE.BufferAttribute(array, width).setUsage(THREE.DynamicDrawUsage);
        geometry.setIndex(new THREE.BufferAttribute(this.triangles, 1));
        geometry.setAttribute('position', changing(surface.positions, 3));
        geometry.setAttribute('normal', changing(surface.normals, 3));
        geometry.setAttribute('rest', new THREE.BufferAttribute(unit, 3));
        geometry.setAttribute('tint', new THREE.BufferAttribute(tints.organs.slice(), 3));
        geometry.setAttribute('value', changing(this.values, 1));
        geometry.setAttribute('tissueNoise', new THREE.BufferAttribute(tissueNoise(unit, openness(surface)), 4));
        this.mesh = new THREE.Mesh(geometry, materials);
        this.mesh.frustumCulled = false;
        this.see(() => 'shown');
    }

    /* Shows, fades and hides organs. */
    see(seen: (region: number) => Seen): void {
        const from = this.surface.triangles;
        const counts = { shown: 0, faded: 0, hidden: 0 };
        let to = 0;
        for (const wanted of ['shown', 'faded', 'hidden'] as const)
            for (let t = 0; t < this.regions.length; t++) {
                const region = this.regionOf(t);
                if (seen(region) !== wanted) continue;
                for (let k = 0; k < 3; k++) this.triangles[3 * to + k] = from[3 * t + k]!;
                this.regions[to++] = region;
                counts[wanted]++;
            }
        this.shown = counts.shown;
        this.faded = counts.faded;
        const geometry = this.mesh.geometry;
        geometry.index!.needsUpdate = true;
        geometry.clearGroups();
        geometry.addGroup(0, 3 * this.shown, 0);
        geometry.addGroup(3 * this.shown, 3 * this.faded, 1);
    }

    place(nodes: Float32Array): void {
        this.surface.place(nodes);
        this.renew('position', 'normal');
    }

    paint(values: Float32Array): void {
        this.surface.paint(values, this.values);
        this.renew('value');
    }

    showProcessors(yes: boolean): void {
        const tint = this.mesh.geometry.getAttribute('tint') as THREE.BufferAttribute;
        tint.set(yes ? this.tints.processors : this.tints.organs);
        this.renew('tint');
    }

    private renew(...names: string[]): void {
        for (const name of names) this.mesh.geometry.getAttribute(name).needsUpdate = true;
    }
}
