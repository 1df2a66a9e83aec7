/* The scene's tools as they are drawn, at the poses that the last frame told. A tool's own axes: the tip
 * is the origin, the shaft lies along +z, jaws open in the plane y = 0 towards -z. */
import * as THREE from 'three';
import type { Rod } from './shadows';
import { instrumentMaterial } from './instrumentMaterial';
import { TOOL_WORDS, type Frame, type ToolInfo } from '../link/protocol';

const METAL = [0.62, 0.65, 0.68] as const;
const CHOSEN = [0.45, 0.75, 0.95] as const;

interface DrawnTool {
    info: ToolInfo;
    group: THREE.Group;
    jaws: [THREE.Object3D, THREE.Object3D] | null;
    material: THREE.ShaderMaterial;
    rods: Rod[]; // its parts: what throws its shadow, and takes the pointer
}

/* A tool under the pointer, and how far from the eye it begins [m]. */
export interface Under {
    tool: number;
    distance: number;
}

export class Instruments {
    readonly group = new THREE.Group();
    private readonly drawn: (DrawnTool | null)[] = [];
    private readonly from = new THREE.Vector3(); // scratch
    private readonly to = new THREE.Vector3();
    private readonly nearest = new THREE.Vector3();

    /* Those that are drawn already stay. */
    set(tools: readonly ToolInfo[], hands: number[]): void {
        const before = this.drawn.splice(0);
        tools.forEach((info, i) => {
            const was = before[i];
            const unseen = hands.includes(i) || info.shape === 'hand' || info.shape === 'none';
            const one = unseen ? null : was?.info === info ? was : draw(info);
            this.drawn.push(one);
            if (one && one !== was) this.group.add(one.group);
        });
        for (const was of before) if (was && !this.drawn.includes(was)) this.forget(was);
    }

    private forget(one: DrawnTool): void {
        this.group.remove(one.group);
        one.group.traverse((part) => part instanceof THREE.Mesh && part.geometry.dispose());
        one.material.dispose();
    }

    update(frame: Frame): void {
        for (let i = 0; i < this.drawn.length; i++) {
            const one = this.drawn[i];
            const at = i * TOOL_WORDS;
            if (!one || at + TOOL_WORDS > frame.tools.length) continue;
            const t = frame.tools;
            one.group.position.set(t[at]!, t[at + 1]!, t[at + 2]!);
            one.group.quaternion.set(t[at + 4]!, t[at + 5]!, t[at + 6]!, t[at + 3]!);
            if (one.jaws) {
                const angle = (t[at + 7]! * one.info.spread) / 2;
                one.jaws[0].rotation.y = angle;
                one.jaws[1].rotation.y = -angle;
            }
        }
    }

    choose(tool: number): void {
        this.drawn.forEach((one, i) => {
            one?.material.uniforms.colour!.value.set(...(i === tool ? CHOSEN : METAL));
        });
    }

    /* The tool whose drawn outline a ray meets or passes within `margin` pixels; of several the nearest to
     * the eye. `pixel`: how wide one is per distance from the eye. */
    under(ray: THREE.Ray, margin: number, pixel: number): Under | null {
        let found: Under | null = null;
        this.drawn.forEach((one, tool) => {
            for (const rod of one?.rods ?? []) {
                const distance = this.meet(ray, rod, margin, pixel);
                if (distance < (found?.distance ?? Infinity)) found = { tool, distance };
            }
        });
        return found;
    }

    /* How far along the ray a rod begins; Infinity: it passes beside. */
    private meet(ray: THREE.Ray, rod: Rod, margin: number, pixel: number): number {
        rod.of.updateWorldMatrix(true, false);
        this.from.copy(rod.from).applyMatrix4(rod.of.matrixWorld);
        this.to.copy(rod.to).applyMatrix4(rod.of.matrixWorld);
        const square = ray.distanceSqToSegment(this.from, this.to, this.nearest);
        const distance = ray.origin.distanceTo(this.nearest);
        if (Math.sqrt(square) > rod.radius + margin * pixel * distance) return Infinity;
        return distance - Math.sqrt(Math.max(0, rod.radius ** 2 - square));
    }

    /* What throws shadows, in the order of the tools. */
    get rods(): Rod[] {
        return this.drawn.flatMap((one) => one?.rods ?? []);
    }

    position(tool: number): THREE.Vector3 | null {
        return this.drawn[tool]?.group.position ?? null;
    }
}

function draw(info: ToolInfo): DrawnTool {
    const group = new THREE.Group();
    const material = instrumentMaterial({ colour: METAL, polish: 1 });
    const add = (geometry: THREE.BufferGeometry, to: THREE.Object3D = group): THREE.Mesh => {
        const mesh = new THREE.Mesh(geometry, material);
        to.add(mesh);
        return mesh;
    };
    const rods: Rod[] = [];
    const shade = (from: number, to: number, radius: number, of: THREE.Object3D = group): void => {
        rods.push({ from: new THREE.Vector3(0, 0, from), to: new THREE.Vector3(0, 0, to), radius, of });
    };
    let jaws: [THREE.Object3D, THREE.Object3D] | null = null;
    if (info.shape === 'sphere') {
        add(new THREE.SphereGeometry(info.radius, 40, 28));
        // What holds the ball; it touches nothing.
        add(rod(info.radius * 0.28, info.radius * 0.9, info.radius * 14));
        shade(0, 0, info.radius);
        shade(info.radius * 0.9, info.radius * 14, info.radius * 0.28);
    } else if (info.shape === 'rigid') {
        // A mark where it is: what it moves is seen as it is.
        add(new THREE.SphereGeometry(info.radius / 2, 24, 18));
    } else if (info.shape === 'capsule') {
        add(round(info.radius, info.length)).position.z = info.length / 2;
        shade(0, info.length, info.radius);
    } else {
        const jaw = (): THREE.Object3D => {
            const pivot = new THREE.Group();
            add(round(info.radius, info.length), pivot).position.z = -info.length / 2;
            group.add(pivot);
            shade(0, -info.length, info.radius, pivot);
            return pivot;
        };
        jaws = [jaw(), jaw()];
        add(new THREE.SphereGeometry(info.radius * 1.35, 24, 18));
        add(rod(info.radius * 1.1, 0, info.length * 7));
        shade(0, info.length * 7, info.radius * 1.1);
    }
    return { info, group, jaws, material, rods };
}

const round = (radius: number, length: number): THREE.BufferGeometry =>
    new THREE.CapsuleGeometry(radius, length, 12, 28).rotateX(Math.PI / 2);

function rod(radius: number, from: number, to: number): THREE.BufferGeometry {
    const geometry = new THREE.CylinderGeometry(radius, radius, to - from, 24, 1);
    return geometry.rotateX(Math.PI / 2).translate(0, 0, (from + to) / 2);
}
