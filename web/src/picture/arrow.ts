/* The pull as one sees it: a dot where the tissue is held, a thread to where the hand is, and an arrow
 * along the force. Its length is in newtons: about a fifth of the organ's width at the full range of the bar. */
import * as THREE from 'three';
import { instrumentMaterial } from './instrumentMaterial';

const BRIGHT = [0.35, 0.85, 1.0] as const;
const YOURS = [1.0, 0.72, 0.12] as const;
export const OTHERS = [0.62, 0.55, 0.95] as const; // the pulls of other viewers
const Y = new THREE.Vector3(0, 1, 0);

export class PullPicture {
    readonly group = new THREE.Group();
    private readonly dot: THREE.Mesh;
    private readonly shaft: THREE.Mesh;
    private readonly head: THREE.Mesh;
    private readonly thread: THREE.Mesh;
    private readonly target: THREE.Mesh;
    private readonly direction = new THREE.Vector3();
    private size = 1;

    constructor(colour: readonly [number, number, number] = YOURS) {
        const arrow = instrumentMaterial({ colour, glow: 0.45, onTop: true });
        const hand = instrumentMaterial({ colour: BRIGHT, glow: 0.9, alpha: 0.75, onTop: true });
        this.dot = new THREE.Mesh(new THREE.SphereGeometry(1, 24, 16), arrow);
        this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 24).translate(0, 0.5, 0), arrow);
        this.head = new THREE.Mesh(new THREE.ConeGeometry(1, 1, 32).translate(0, 0.5, 0), arrow);
        this.thread = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 8).translate(0, 0.5, 0), hand);
        this.target = new THREE.Mesh(new THREE.TorusGeometry(1, 0.12, 10, 40), hand);
        const parts = [this.thread, this.target, this.shaft, this.head, this.dot];
        parts.forEach((part, i) => {
            part.renderOrder = 10 + i;
            part.frustumCulled = false;
            this.group.add(part);
        });
        this.group.visible = false;
    }

    setSize(size: number): void {
        this.size = size;
    }

    hide(): void {
        this.group.visible = false;
    }

    /* `share` of the range: the arrow's length; `force` gives its direction. `to` may be null. */
    show(
        grip: THREE.Vector3,
        to: THREE.Vector3 | null,
        force: THREE.Vector3,
        share: number,
        camera: THREE.Camera,
    ): void {
        const unit = this.size;
        this.group.visible = true;
        this.dot.position.copy(grip);
        this.dot.scale.setScalar(unit * 0.02);

        const length = Math.min(1, share) * unit * 0.4;
        const visible = length > unit * 0.01;
        this.shaft.visible = this.head.visible = visible;
        if (visible) {
            this.direction.copy(force).normalize();
            const head = Math.min(unit * 0.13, length * 0.55);
            this.shaft.position.copy(grip);
            this.shaft.quaternion.setFromUnitVectors(Y, this.direction);
            this.shaft.scale.set(unit * 0.014, length - head * 0.9, unit * 0.014);
            this.head.position.copy(grip).addScaledVector(this.direction, length - head);
            this.head.quaternion.copy(this.shaft.quaternion);
            this.head.scale.set(head * 0.34, head, head * 0.34);
        }

        this.target.visible = this.thread.visible = to !== null;
        if (!to) return;
        this.target.position.copy(to);
        this.target.quaternion.copy(camera.quaternion);
        this.target.scale.setScalar(unit * 0.045);
        this.direction.copy(to).sub(grip);
        const gap = this.direction.length();
        this.thread.visible = gap > unit * 0.03;
        this.thread.position.copy(grip);
        this.thread.quaternion.setFromUnitVectors(Y, this.direction.normalize());
        this.thread.scale.set(unit * 0.004, gap, unit * 0.004);
    }
}
