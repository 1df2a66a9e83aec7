/* Moving one of the scene's instruments: with the pointer in a plane through its tip that is parallel
 * to the screen, with keys, with the slider of its opening. */
import * as THREE from 'three';
import type { Session } from '../link/session';
import type { View } from '../picture/view';

const MOVE_MS = 1000 / 100;

export class Instrument {
    chosen = -1; // a tool, or -1: the hand
    held = false; // by the pointer or by keys
    opening = 1;
    private readonly target = new THREE.Vector3();
    private readonly plane = new THREE.Plane();
    private readonly normal = new THREE.Vector3();
    private readonly offset = new THREE.Vector3();
    private moved = false;
    private nextMove = 0;

    constructor(
        private readonly session: Session,
        private readonly view: View,
        private readonly chose: (tool: number) => void,
    ) {}

    get info() {
        return this.chosen < 0 ? null : (this.session.tools[this.chosen] ?? null);
    }

    choose(tool: number): void {
        this.held = false;
        this.chosen = tool;
        this.refresh();
        this.view.instruments.choose(tool);
        this.view.changed();
        this.chose(tool);
    }

    /* The next one: the hand, then the instruments in their order. */
    next(): void {
        const hello = this.session.hello;
        if (!hello) return;
        for (let tool = this.chosen + 1; tool < this.session.tools.length; tool++)
            if (!hello.hands.includes(tool) && this.session.tools[tool]!.shape !== 'none') return this.choose(tool);
        this.choose(-1);
    }

    take(ray: THREE.Ray | null): void {
        const tip = this.view.instruments.position(this.chosen);
        if (!tip) return;
        this.held = true;
        this.refresh();
        this.target.copy(tip);
        this.setPlane();
        this.offset.set(0, 0, 0);
        if (ray?.intersectPlane(this.plane, this.offset)) this.offset.sub(tip);
    }

    /* Some were added or removed: true when the chosen one is gone, and the hand is chosen. */
    changed(): boolean {
        this.view.instruments.choose(this.chosen);
        if (this.info?.shape !== 'none') return false;
        this.choose(-1);
        return true;
    }

    /* The run was put somewhere else, and the instrument with it. True when it was held. */
    placed(): boolean {
        const held = this.held;
        this.held = this.moved = false;
        this.refresh();
        return held;
    }

    drop(): void {
        this.held = false;
    }

    moveTo(ray: THREE.Ray): void {
        if (!this.held || !ray.intersectPlane(this.plane, this.target)) return;
        this.target.sub(this.offset);
        this.moved = true;
    }

    moveBy(right: number, up: number, near: number): void {
        if (!this.held) return;
        this.view.endoscope.shift(this.target, right, up, near);
        this.setPlane();
        this.moved = true;
    }

    open(opening: number): void {
        const tip = this.view.instruments.position(this.chosen);
        if (!tip || this.session.watches) return;
        this.opening = Math.min(1, Math.max(0, opening));
        if (!this.held) this.target.copy(tip);
        this.moved = true;
    }

    update(now: number): void {
        if (!this.moved || this.chosen < 0 || now < this.nextMove) return;
        this.moved = false;
        this.nextMove = now + MOVE_MS - 2;
        this.session.send({
            do: 'tool',
            tool: this.chosen,
            position: [this.target.x, this.target.y, this.target.z],
            opening: this.opening,
        });
    }

    private refresh(): void {
        this.opening = this.session.status?.tools[this.chosen]?.opening ?? 1;
    }

    private setPlane(): void {
        this.view.endoscope.camera.getWorldDirection(this.normal);
        this.plane.setFromNormalAndCoplanarPoint(this.normal, this.target);
    }
}
