/* What lies behind the organ: the dim wall of the cavity, out of focus. A ball seen from inside whose
 * corners are coloured once; it turns with the view, so that one feels how the camera moves. */
import * as THREE from 'three';
import { noise } from './tissueNoise';

export class Background {
    readonly mesh: THREE.Mesh;

    constructor() {
        const ball = new THREE.SphereGeometry(1, 72, 48).rotateX(Math.PI / 2);
        const at = ball.getAttribute('position');
        const colours = new Float32Array(at.count * 3);
        for (let i = 0; i < at.count; i++) {
            const x = at.getX(i);
            const y = at.getY(i);
            const z = at.getZ(i);
            const folds = noise(x * 2.2, y * 2.2, z * 2.2) * 0.6 + noise(x * 4.6 + 9, y * 4.6, z * 4.6) * 0.4;
            const fat = Math.max(0, noise(x * 1.7 + 4, y * 1.7, z * 1.7 - 7));
            const light = 0.03 * Math.exp(folds * 2.1) * (0.8 + 0.3 * z);
            colours[i * 3] = light * (1 + 0.25 * fat);
            colours[i * 3 + 1] = light * (0.30 + 0.22 * fat);
            colours[i * 3 + 2] = light * (0.29 + 0.06 * fat);
        }
        ball.setAttribute('color', new THREE.BufferAttribute(colours, 3));
        const paint = new THREE.MeshBasicMaterial({
            vertexColors: true, side: THREE.BackSide, depthWrite: false, depthTest: false,
        });
        this.mesh = new THREE.Mesh(ball, paint);
        this.mesh.renderOrder = -1;
        this.mesh.frustumCulled = false;
    }

    /* Always around the camera, as far as it can see. */
    follow(camera: THREE.PerspectiveCamera): void {
        this.mesh.position.copy(camera.position);
        this.mesh.scale.setScalar((camera.near + camera.far) / 2);
    }
}
