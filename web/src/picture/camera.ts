/* The endoscope: a camera that looks at a point, turned about it, moved nearer and aside. z is up.
 * Movements glide to where they are meant to end, unless the user prefers less motion. */
import * as THREE from 'three';
import type { Box } from './freepart';

const GLIDE = 0.09; // s, time constant
const LOOK_ABOVE = 0.05; // of the body's size
const ROOM = 1.12; // around the body, of the part of the window that is free
const STEEPEST = 1.5; // rad above or below the horizon

export class Endoscope {
    readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 10);
    private readonly still = matchMedia('(prefers-reduced-motion: reduce)');
    private readonly home = { target: new THREE.Vector3(), size: 1, azimuth: 0, height: 0, half: [1, 1, 1] };
    private window = { width: 1, height: 1 };
    private free: Box = { left: 0, top: 0, right: 1, bottom: 1 }; // what nothing covers
    private readonly wanted = { target: new THREE.Vector3(), distance: 4, azimuth: 0, height: 0 };
    private readonly now = { target: new THREE.Vector3(), distance: 4, azimuth: 0, height: 0 };
    private readonly ray = new THREE.Raycaster();
    private readonly screen = new THREE.Vector2();

    /* Everything in sight, from where the scene says, or from the front and a little above. */
    frame(
        center: readonly [number, number, number],
        size: number,
        [x, y, z]: readonly [number, number, number] = [-0.14, -0.925, 0.352],
        half: readonly number[] = [size, size, size], // of the sides of the body's box
    ): void {
        // There is more to do above than below: one pulls upwards.
        this.home.target.set(center[0], center[1], center[2] + LOOK_ABOVE * size);
        this.home.size = size;
        this.home.half = [...half];
        this.home.azimuth = x === 0 && y === 0 ? 0 : Math.atan2(x, -y);
        this.home.height = clamped(Math.atan2(z, Math.hypot(x, y)));
        this.reset(true);
    }

    reset(atOnce = false): void {
        this.wanted.target.copy(this.home.target);
        this.wanted.azimuth = nearestTurn(this.home.azimuth, this.now.azimuth);
        this.wanted.height = this.home.height;
        this.wanted.distance = this.fitting();
        if (atOnce) this.jump();
    }

    get distance(): number {
        return this.now.distance;
    }

    turn(dx: number, dy: number): void {
        this.wanted.azimuth -= dx;
        this.wanted.height = clamped(this.wanted.height + dy);
    }

    zoom(factor: number): void {
        const distance = this.wanted.distance * factor;
        this.wanted.distance = Math.min(this.home.size * 40, Math.max(this.home.size * 0.25, distance));
    }

    /* By fractions of the picture's height. */
    pan(dx: number, dy: number): void {
        const scale = 2 * this.now.distance * Math.tan((this.camera.fov * Math.PI) / 360);
        this.shift(this.wanted.target, -dx * scale, dy * scale, 0);
    }

    /* Moves a point along the picture's axes, in metres: right, up, towards the viewer. */
    shift(point: THREE.Vector3, right: number, up: number, near: number): void {
        const e = this.camera.matrixWorld.elements;
        for (let k = 0; k < 3; k++) {
            const by = right * e[k]! + up * e[4 + k]! + near * e[8 + k]!;
            point.setComponent(k, point.getComponent(k) + by);
        }
    }

    /* Looks at a point from nearer. */
    focus(point: readonly [number, number, number]): void {
        this.wanted.target.set(point[0], point[1], point[2]);
        this.zoom(0.6);
    }

    /* Moves on by `seconds`. True while the picture changes. */
    update(seconds: number): boolean {
        const before = this.now.azimuth + this.now.height + this.now.distance + this.now.target.length();
        if (this.still.matches) this.jump();
        const part = 1 - Math.exp(-seconds / GLIDE);
        this.now.target.lerp(this.wanted.target, part);
        this.now.distance += (this.wanted.distance - this.now.distance) * part;
        this.now.azimuth += (this.wanted.azimuth - this.now.azimuth) * part;
        this.now.height += (this.wanted.height - this.now.height) * part;
        const { target, distance, azimuth, height } = this.now;
        const flat = distance * Math.cos(height);
        this.camera.position.set(
            target.x + flat * Math.sin(azimuth),
            target.y - flat * Math.cos(azimuth),
            target.z + distance * Math.sin(height),
        );
        this.camera.up.set(0, 0, 1);
        this.camera.near = Math.max(distance - this.home.size * 4, distance * 0.02);
        this.camera.far = distance + this.home.size * 8;
        this.camera.updateProjectionMatrix();
        this.camera.lookAt(target);
        this.camera.updateMatrixWorld();
        const after = this.now.azimuth + this.now.height + this.now.distance + this.now.target.length();
        return Math.abs(after - before) > 1e-6 * distance;
    }

    /* The window's size and the part of it that nothing covers: where what one looks at is. */
    resize(width: number, height: number, free: Box): void {
        const before = this.fitting();
        const atHome = Math.abs(this.wanted.distance - before) < 1e-9 * before;
        this.window = { width, height };
        this.free = free;
        this.camera.aspect = width / height;
        const { x, y } = this.centre;
        this.camera.setViewOffset(width, height, -0.5 * x * width, 0.5 * y * height, width, height);
        if (atHome) this.wanted.distance = this.fitting();
    }

    /* Of the free part, in the picture: x and y from -1 to 1. */
    get centre(): { x: number; y: number } {
        const { left, right, top, bottom } = this.free;
        return { x: (left + right) / this.window.width - 1, y: 1 - (top + bottom) / this.window.height };
    }

    /* In pixels, and how far away the eye is when all of the body is seen. */
    get fit(): { x: number; y: number; distance: number; size: number } {
        const { left, right, top, bottom } = this.free;
        return { x: (left + right) / 2, y: (top + bottom) / 2, distance: this.fitting(), size: this.home.size };
    }

    /* The ray through a point of the picture, x and y from -1 to 1. */
    rayThrough(x: number, y: number): THREE.Ray {
        this.ray.setFromCamera(this.screen.set(x, y), this.camera);
        return this.ray.ray;
    }

    /* How wide a pixel is, per distance from the eye, of a picture that is so many high. */
    pixel(height: number): number {
        return (2 * Math.tan((this.camera.fov * Math.PI) / 360)) / height;
    }

    /* From where all corners of the body's box lie in the free part, with some room. */
    private fitting(): number {
        const { half, azimuth, height, size } = this.home;
        const { left, right, top, bottom } = this.free;
        const unit = Math.tan((this.camera.fov * Math.PI) / 360) / (ROOM * this.window.height); // per pixel from the middle
        const [sinA, cosA, sinH, cosH] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(height), Math.cos(height)];
        let distance = 0;
        for (let corner = 0; corner < 8; corner++) {
            const [x, y, z] = half.map((side, k) => (corner & (1 << k) ? side : -side)) as [number, number, number];
            const up = z - LOOK_ABOVE * size;
            const near = cosH * (sinA * x - cosA * y) + sinH * up;
            const aside = Math.abs(cosA * x + sinA * y) / (right - left);
            const above = Math.abs(cosH * up - sinH * (sinA * x - cosA * y)) / (bottom - top);
            distance = Math.max(distance, near + Math.max(aside, above) / unit);
        }
        return distance;
    }

    private jump(): void {
        this.now.target.copy(this.wanted.target);
        this.now.distance = this.wanted.distance;
        this.now.azimuth = this.wanted.azimuth;
        this.now.height = this.wanted.height;
    }
}

function clamped(height: number): number {
    return Math.min(STEEPEST, Math.max(-STEEPEST, height));
}

/* The same angle, plus whole turns, next to another: the camera returns the short way. */
function nearestTurn(angle: number, to: number): number {
    return angle + Math.round((to - angle) / (2 * Math.PI)) * 2 * Math.PI;
}
