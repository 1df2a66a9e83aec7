/* The plane that cuts the picture open: what lies beyond it is neither drawn nor touched. It stands in space,
 * so tissue moves through it. The engine knows nothing of it. */
import * as THREE from 'three';

const NOTHING = new THREE.Vector4(0, 0, 0, 1); // hides nothing: 0 is never more than 1
export type Across = 'x' | 'y' | 'z' | 'eye';

export class Cut {
    /* Normal and distance: a point p is hidden where normal . p > distance. Shaders hold this very object. */
    readonly plane = NOTHING.clone();
    private readonly center = new THREE.Vector3();
    private readonly normal = new THREE.Vector3(1, 0, 0);
    private readonly eye = new THREE.Vector3(0, -1, 0);
    private size = 1;
    on = false;
    across: Across = 'x';
    share = 0.5; // of the way through the body
    other = false; // hides the other side

    /* The box of a new body. */
    setBody(center: readonly [number, number, number], size: number): void {
        this.center.set(...center);
        this.size = size;
        this.renew();
    }

    /* `eye`: from the body towards the camera, for a cut across the line of sight. */
    choose(across: Across, eye: THREE.Vector3): void {
        this.across = across;
        this.eye.copy(eye).normalize();
        this.renew();
    }

    renew(): void {
        const axis = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1], eye: this.eye.toArray() }[this.across];
        this.normal.fromArray(axis);
        if (!this.on) return void this.plane.copy(NOTHING);
        const { x, y, z } = this.normal;
        const sign = this.other ? -1 : 1;
        this.plane.set(sign * x, sign * y, sign * z, sign * this.place);
    }

    /* Where the plane meets its axis [m]. */
    get place(): number {
        return this.normal.dot(this.center) + (2 * this.share - 1) * this.size;
    }
}
