/* Marks on the tissue, seen through all that lies before them: dots, and a line between two of them. */
import * as THREE from 'three';
import { instrumentMaterial } from '../picture/instrumentMaterial';

const COLOUR = [0.25, 1.0, 0.55] as const;
const Y = new THREE.Vector3(0, 1, 0);
const MOST = 2;

export class Marks {
    readonly group = new THREE.Group();
    private readonly dots: THREE.Mesh[] = [];
    private readonly line: THREE.Mesh;
    private readonly along = new THREE.Vector3();
    private size = 1;

    constructor() {
        const paint = instrumentMaterial({ colour: COLOUR, glow: 0.6, onTop: true });
        for (let i = 0; i < MOST; i++) this.dots.push(new THREE.Mesh(new THREE.SphereGeometry(1, 20, 14), paint));
        this.line = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 10).translate(0, 0.5, 0), paint);
        for (const part of [...this.dots, this.line]) {
            part.renderOrder = 20;
            part.frustumCulled = false;
            part.visible = false;
            this.group.add(part);
        }
    }

    setSize(size: number): void {
        this.size = size;
    }

    /* At most two points; two are joined by a line. False: nothing has moved. */
    show(points: THREE.Vector3[]): boolean {
        const still = this.dots.every((dot, i) => (points[i] ? dot.visible && dot.position.equals(points[i]!) : !dot.visible));
        if (still) return false;
        this.place(points);
        return true;
    }

    private place(points: THREE.Vector3[]): void {
        this.dots.forEach((dot, i) => {
            dot.visible = i < points.length;
            if (points[i]) dot.position.copy(points[i]);
            dot.scale.setScalar(this.size * 0.016);
        });
        const [from, to] = points;
        this.line.visible = to !== undefined;
        if (!from || !to) return;
        this.along.copy(to).sub(from);
        const length = this.along.length();
        this.line.position.copy(from);
        this.line.quaternion.setFromUnitVectors(Y, this.along.divideScalar(length || 1));
        this.line.scale.set(this.size * 0.005, length, this.size * 0.005);
    }
}
