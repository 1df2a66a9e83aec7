/* The picture: canvas, organ, instruments, pull. Draws when something has changed. */
import * as THREE from 'three';
import { PullPicture } from './arrow';
import { Endoscope } from './camera';
import { Instruments } from './instruments';
import { Cavity } from './cavity';
import { grain } from './grain';
import { openness } from './hollow';
import { organColour, processorColour } from './palette';
import type { Frame, SurfaceMessage } from './protocol';
import { Surface } from './surface';
import { Tissue } from './tissue';

export class View {
    readonly endoscope = new Endoscope();
    readonly instruments = new Instruments();
    readonly pull = new PullPicture();
    readonly tissue: Tissue;
    surface: Surface | null = null;
    drawn = 0; // pictures so far
    private readonly renderer: THREE.WebGLRenderer;
    private readonly scene = new THREE.Scene();
    private readonly cavity = new Cavity();
    private readonly fine: boolean;
    private readonly adapts: boolean;
    private sharpness = 1; // pixels drawn per pixel shown, along a side
    private slowFor = 0; // pictures in a row
    private organ: THREE.Mesh | null = null;
    private edges: THREE.LineSegments | null = null;
    private edgesShown = false;
    private values = new Float32Array(0);
    private valueAttribute: THREE.BufferAttribute | null = null;
    private tints: { organs: Float32Array; processors: Float32Array } | null = null;
    private stale = true;

    constructor(readonly canvas: HTMLCanvasElement) {
        const asked = new URLSearchParams(location.hash.slice(1)).get('quality');
        this.fine = asked ? asked === 'fine' : drawnInHardware();
        this.adapts = !asked;
        this.tissue = new Tissue(this.fine);
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias: this.fine, alpha: false });
        this.renderer.setClearColor(0x07080a);
        this.scene.add(this.cavity.mesh, this.instruments.group, this.pull.group);
        new ResizeObserver(() => {
            this.resize();
            this.draw(0); // at once: an empty canvas would flash
        }).observe(canvas);
        canvas.addEventListener('webglcontextrestored', () => (this.stale = true));
        this.resize();
    }

    /* A new organ. */
    setSurface(message: SurfaceMessage): void {
        this.dispose();
        const surface = new Surface(message.rest, message.faces, this.fine ? 24000 : 6000);
        this.surface = surface;
        const unit = new Float32Array(surface.rest.length);
        for (let i = 0; i < unit.length; i++)
            unit[i] = (surface.rest[i]! - surface.center[i % 3]!) / surface.size;
        this.values = new Float32Array(surface.nodes);
        this.tints = {
            organs: tintsOf(surface, (face) => organColour(message.material[face]!)),
            processors: nodeTints(surface, (node) => processorColour(message.processor[node]!)),
        };
        const geometry = new THREE.BufferGeometry();
        const changing = (array: Float32Array, width: number): THREE.BufferAttribute =>
            new THREE.BufferAttribute(array, width).setUsage(THREE.DynamicDrawUsage);
        this.valueAttribute = changing(this.values, 1);
        geometry.setIndex(new THREE.BufferAttribute(surface.triangles, 1));
        geometry.setAttribute('position', changing(surface.positions, 3));
        geometry.setAttribute('normal', changing(surface.normals, 3));
        geometry.setAttribute('rest', new THREE.BufferAttribute(unit, 3));
        geometry.setAttribute('tint', new THREE.BufferAttribute(this.tints.organs.slice(), 3));
        geometry.setAttribute('value', this.valueAttribute);
        geometry.setAttribute('grain', new THREE.BufferAttribute(grain(unit, openness(surface)), 4));
        this.organ = new THREE.Mesh(geometry, this.tissue.material);
        this.organ.frustumCulled = false;

        const lines = new THREE.BufferGeometry();
        lines.setIndex(new THREE.BufferAttribute(surface.lines, 1));
        lines.setAttribute('position', geometry.getAttribute('position'));
        const ink = new THREE.LineBasicMaterial({ color: 0x0a0506, transparent: true, opacity: 0.55 });
        this.edges = new THREE.LineSegments(lines, ink);
        this.edges.frustumCulled = false;
        this.edges.visible = this.edgesShown;
        this.scene.add(this.organ, this.edges);
        this.pull.setSize(surface.size);
        this.endoscope.frame(surface.center, surface.size);
        this.stale = true;
    }

    /* Positions, values and tools of a frame. */
    setFrame(frame: Frame): void {
        if (!this.surface || !this.organ) return;
        if (frame.positions.length !== this.surface.meshNodes * 3) return;
        this.surface.update(frame.positions);
        this.organ.geometry.getAttribute('position').needsUpdate = true;
        this.organ.geometry.getAttribute('normal').needsUpdate = true;
        if (frame.values.length === this.surface.meshNodes) {
            this.values.set(frame.values);
            this.surface.spread(this.values, 1);
            this.valueAttribute!.needsUpdate = true;
        }
        this.instruments.update(frame);
        this.stale = true;
    }

    showProcessors(yes: boolean): void {
        if (!this.organ || !this.tints) return;
        const tint = this.organ.geometry.getAttribute('tint') as THREE.BufferAttribute;
        tint.set(yes ? this.tints.processors : this.tints.organs);
        tint.needsUpdate = true;
        this.stale = true;
    }

    showEdges(yes: boolean): void {
        this.edgesShown = yes;
        if (this.edges) this.edges.visible = yes;
        this.stale = true;
    }

    /* The farthest that a node of the surface is from its place at rest [m]. */
    displacement(): number {
        const { positions, rest, meshNodes } = this.surface ?? { meshNodes: 0 };
        let most = 0;
        for (let i = 0; i < meshNodes * 3; i += 3)
            most = Math.max(
                most,
                Math.hypot(
                    positions![i]! - rest![i]!,
                    positions![i + 1]! - rest![i + 1]!,
                    positions![i + 2]! - rest![i + 2]!,
                ),
            );
        return most;
    }

    changed(): void {
        this.stale = true;
    }

    /* Draws if there is something new; true when it did. */
    draw(seconds: number): boolean {
        if (this.endoscope.update(seconds)) this.stale = true;
        if (!this.stale) return false;
        this.stale = false;
        this.tissue.follow(this.endoscope.camera);
        this.cavity.follow(this.endoscope.camera);
        this.renderer.render(this.scene, this.endoscope.camera);
        this.drawn++;
        this.adapt(seconds);
        return true;
    }

    /* Fewer pixels where pictures come slower than the 24 per second that movement needs (T 6.5.1). */
    private adapt(seconds: number): void {
        if (!this.adapts || this.sharpness <= 0.5) return;
        this.slowFor = seconds > 1 / 24 ? this.slowFor + 1 : Math.max(0, this.slowFor - 2);
        if (this.slowFor < 12) return;
        this.slowFor = 0;
        this.sharpness = Math.max(0.5, this.sharpness * 0.75);
        this.resize();
    }

    private resize(): void {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        if (!width || !height) return;
        this.renderer.setPixelRatio(this.sharpness * Math.min(devicePixelRatio, this.fine ? 2 : 1));
        this.renderer.setSize(width, height, false);
        this.endoscope.resize(width / height);
        this.stale = true;
    }

    private dispose(): void {
        for (const part of [this.organ, this.edges]) {
            if (!part) continue;
            this.scene.remove(part);
            part.geometry.dispose();
        }
        this.organ = this.edges = null;
    }
}

/* Whether a graphics processor draws. Where the main processor has to, which the engine needs too, the
 * picture is plainer; the address may say otherwise, with #quality=fine or #quality=plain. */
function drawnInHardware(): boolean {
    const probe = document.createElement('canvas').getContext('webgl2');
    const names = probe?.getExtension('WEBGL_debug_renderer_info');
    const name = probe && names ? String(probe.getParameter(names.UNMASKED_RENDERER_WEBGL)) : '';
    probe?.getExtension('WEBGL_lose_context')?.loseContext();
    return !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/* Colours per node, the mean of those of the faces around; borders between organs are soft. */
function tintsOf(surface: Surface, colourOf: (face: number) => number[]): Float32Array {
    const sum = new Float32Array(surface.nodes * 3);
    const count = new Float32Array(surface.meshNodes);
    const quads = surface.meshQuads;
    for (let i = 0; i < quads.length; i++) {
        const colour = colourOf(i >> 2);
        count[quads[i]!]!++;
        for (let k = 0; k < 3; k++) sum[quads[i]! * 3 + k]! += colour[k]!;
    }
    for (let i = 0; i < surface.meshNodes * 3; i++) sum[i]! /= count[(i / 3) | 0]! || 1;
    surface.spread(sum, 3);
    return sum;
}

function nodeTints(surface: Surface, colourOf: (node: number) => number[]): Float32Array {
    const out = new Float32Array(surface.nodes * 3);
    for (let i = 0; i < surface.meshNodes; i++) out.set(colourOf(i), i * 3);
    surface.spread(out, 3);
    return out;
}
