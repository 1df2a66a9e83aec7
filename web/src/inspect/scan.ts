/* A slice of the scan that the body was meshed from, where it lies in the body at rest: a card to choose it,
 * and the picture. Labels have the colours of their organs. One slice is asked for at a time. */
import * as THREE from 'three';
import { element, write } from '../dom';
import { organColour } from '../picture/palette';
import type { Hello, Slice } from '../link/protocol';
import type { Session } from '../link/session';
import type { View } from '../picture/view';

const NOTHING = [0.02, 0.022, 0.026, 0.55] as const; // of voxels without a label
const AXES = ['i', 'j', 'k'];

/* The four corners of a slice's pixels, which reach half a pixel beyond the centres of the outer ones. */
export function cornersOf(slice: Pick<Slice, 'corner' | 'across' | 'down' | 'width' | 'height'>): Float32Array {
    const out = new Float32Array(12);
    const ends = [[-0.5, -0.5], [slice.width - 0.5, -0.5], [slice.width - 0.5, slice.height - 0.5], [-0.5, slice.height - 0.5]];
    ends.forEach(([x, y], i) => {
        for (let k = 0; k < 3; k++) out[3 * i + k] = slice.corner[k]! + x! * slice.across[k]! + y! * slice.down[k]!;
    });
    return out;
}

export class Scan {
    private hello: Hello | null = null;
    private axis = 2;
    private waiting = false;
    private stale = false; // another slice is wanted than the one that was asked for
    private readonly on = element<HTMLInputElement>('scan');
    private readonly across = element<HTMLSelectElement>('scan-axis');
    private readonly slider = element<HTMLInputElement>('scan-index');
    private readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;

    constructor(
        private readonly session: Session,
        private readonly view: View,
        private readonly say: (text: string) => void,
    ) {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(12), 3));
        geometry.setAttribute('uv', new THREE.BufferAttribute(Float32Array.of(0, 0, 1, 0, 1, 1, 0, 1), 2));
        geometry.setIndex([0, 1, 2, 0, 2, 3]);
        const paint = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, transparent: true });
        this.mesh = new THREE.Mesh(geometry, paint);
        this.mesh.frustumCulled = this.mesh.visible = false;
        view.add(this.mesh);
        this.on.addEventListener('change', () => this.renew());
        this.slider.addEventListener('input', () => this.renew());
        this.across.addEventListener('change', () => this.turn(Number(this.across.value)));
    }

    get shown(): boolean {
        return this.mesh.visible;
    }

    setHello(hello: Hello): void {
        this.hello = hello;
        this.waiting = this.mesh.visible = false;
        element('scan-part').hidden = !hello.scan;
        this.turn(this.axis);
    }

    toggle(): void {
        if (!this.hello?.scan) return this.say('There is no scan: start lariat view with --scan.');
        this.on.checked = !this.on.checked;
        if (this.on.checked) element<HTMLDetailsElement>('inside').open = true;
        this.renew();
    }

    nextAxis(): void {
        this.turn((this.axis + 1) % 3);
    }

    move(by: number): void {
        if (!this.on.checked) return;
        this.slider.value = String(this.slider.valueAsNumber + by);
        this.renew();
    }

    /* The slice that was asked for. */
    take(slice: Slice): void {
        this.waiting = false;
        if (this.stale) this.renew();
        if (!this.on.checked || slice.axis !== this.axis) return;
        const place = this.mesh.geometry.getAttribute('position') as THREE.BufferAttribute;
        place.set(cornersOf(slice));
        place.needsUpdate = true;
        this.mesh.material.map?.dispose();
        this.mesh.material.map = this.textureOf(slice);
        this.mesh.material.needsUpdate = true;
        this.mesh.visible = true;
        write(element('scan-text'), `${AXES[slice.axis]} ${slice.index} of ${slice.count}`);
        this.view.changed();
    }

    private turn(axis: number): void {
        this.axis = axis;
        this.across.value = String(axis);
        const size = this.hello?.scan?.size[axis] ?? 1;
        this.slider.max = String(size - 1);
        this.slider.value = String(Math.floor(size / 2));
        this.renew();
    }

    private renew(): void {
        const on = this.on.checked && this.hello?.scan !== undefined;
        element('scan-row').hidden = !on;
        if (!on) {
            this.mesh.visible = false;
            return this.view.changed();
        }
        this.stale = this.waiting;
        if (this.waiting) return;
        this.waiting = true;
        this.session.send({ do: 'slice', axis: this.axis, index: this.slider.valueAsNumber });
    }

    private textureOf(slice: Slice): THREE.DataTexture {
        const colours = new Map<number, readonly number[]>([[0, NOTHING]]);
        const data = new Uint8Array(slice.labels.length * 4);
        slice.labels.forEach((label, i) => {
            let colour = colours.get(label);
            if (!colour) colours.set(label, (colour = [...this.colourOf(label), 1]));
            for (let k = 0; k < 4; k++) data[4 * i + k] = Math.round(255 * colour[k]!);
        });
        const texture = new THREE.DataTexture(data, slice.width, slice.height, THREE.RGBAFormat);
        texture.needsUpdate = true;
        return texture;
    }

    private colourOf(label: number): readonly number[] {
        const name = this.hello?.scan?.labels.find((one) => one.label === label)?.name ?? '';
        return organColour(name, label - 1);
    }
}
