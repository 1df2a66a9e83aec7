/* One drawn surface with its colours, as three.js draws it. */
import * as THREE from 'three';
import type { Drawn } from './drawn';
import { grain } from './grain';
import { openness } from './hollow';

export interface Tints {
    organs: Float32Array; // three per drawn node
    processors: Float32Array;
}

export class Organ {
    readonly mesh: THREE.Mesh;
    private readonly values: Float32Array;

    constructor(
        readonly drawn: Drawn,
        private readonly tints: Tints,
        material: THREE.Material,
    ) {
        const unit = new Float32Array(drawn.rest.length);
        for (let i = 0; i < unit.length; i++)
            unit[i] = (drawn.rest[i]! - drawn.center[i % 3]!) / drawn.size;
        this.values = new Float32Array(drawn.nodes);
        const geometry = new THREE.BufferGeometry();
        const changing = (array: Float32Array, width: number): THREE.BufferAttribute =>
            new THREE.BufferAttribute(array, width).setUsage(THREE.DynamicDrawUsage);
        geometry.setIndex(new THREE.BufferAttribute(drawn.triangles, 1));
        geometry.setAttribute('position', changing(drawn.positions, 3));
        geometry.setAttribute('normal', changing(drawn.normals, 3));
        geometry.setAttribute('rest', new THREE.BufferAttribute(unit, 3));
        geometry.setAttribute('tint', new THREE.BufferAttribute(tints.organs.slice(), 3));
        geometry.setAttribute('value', changing(this.values, 1));
        geometry.setAttribute('grain', new THREE.BufferAttribute(grain(unit, openness(drawn)), 4));
        this.mesh = new THREE.Mesh(geometry, material);
        this.mesh.frustumCulled = false;
    }

    place(nodes: Float32Array): void {
        this.drawn.place(nodes);
        this.renew('position', 'normal');
    }

    paint(values: Float32Array): void {
        this.drawn.paint(values, this.values);
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
