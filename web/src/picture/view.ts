/* The picture: canvas, organ, instruments, pull. Draws when something has changed. */
import * as THREE from 'three';
import { PullPicture } from './arrow';
import { Endoscope } from './camera';
import { Instruments } from './instruments';
import { Background } from './background';
import { freePart, type Box } from './freepart';
import type { SurfaceView } from './surfaceView';
import { Cut } from '../inspect/cut';
import { Marks } from '../inspect/marks';
import { Edges } from './edges';
import { FibreLines } from './fibreLines';
import { Fibres } from './fibres';
import { Organ, type Seen } from './organ';
import { Others } from './others';
import { organColour, processorColour, type Rgb } from './palette';
import { nearestPoint, pick, type Hit } from '../hands/pick';
import type { Frame, EmbeddedMessage, SurfaceMessage } from '../link/protocol';
import { EmbeddedSurface } from './embedded';
import { Surface } from './surface';
import { Tissue } from './tissue';

export class View {
    readonly endoscope = new Endoscope();
    readonly instruments = new Instruments();
    readonly pull = new PullPicture();
    readonly others = new Others();
    readonly cut = new Cut();
    readonly marks = new Marks();
    readonly tissue: Tissue;
    pictures = 0; // pictures so far
    private readonly renderer: THREE.WebGLRenderer;
    private readonly scene = new THREE.Scene();
    private readonly background = new Background();
    private readonly fine: boolean;
    private readonly adapts: boolean;
    private sharpness = 1; // pixels drawn per pixel shown, along a side
    private slowFor = 0; // pictures in a row
    private mesh: Surface | null = null;
    private processors: Uint32Array = new Uint32Array(0); // of the mesh's surface nodes
    private organ: Organ | null = null; // the mesh's own surface
    private fineOrgan: Organ | null = null; // the embedded one
    private edges: Edges | null = null;
    private edgesShown = false;
    private fibres: Fibres | null = null; // null: nothing has any
    private fibresShown = false;
    private fineShown = true;
    private processorsShown = false;
    private faceRegions: Uint32Array = new Uint32Array(0); // the organ of each face of the mesh
    private seen: (region: number) => Seen = () => 'shown';
    private frameNodes = 0;
    private positions: Float32Array | null = null; // of the last frame
    private values: Float32Array | null = null;
    private stale = true;
    private colourOf: (material: number) => Rgb = () => [1, 1, 1];

    /* `covers`: boxes of what lies over the picture. */
    constructor(
        readonly canvas: HTMLCanvasElement,
        private readonly covers: () => Box[],
    ) {
        const asked = new URLSearchParams(location.hash.slice(1)).get('quality');
        this.fine = asked ? asked === 'fine' : rendersInHardware();
        this.adapts = !asked;
        this.tissue = new Tissue(this.fine, this.cut.plane);
        this.tissue.shadows.on = this.fine;
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias: this.fine, alpha: false });
        this.renderer.setClearColor(0x07080a);
        this.scene.add(this.background.mesh, this.instruments.group, this.pull.group, this.others.group, this.marks.group);
        new ResizeObserver(() => {
            this.resize();
            this.draw(0); // at once: an empty canvas would flash
        }).observe(canvas);
        canvas.addEventListener('webglcontextrestored', () => (this.stale = true));
        this.resize();
    }

    /* Something else that is drawn. */
    add(object: THREE.Object3D): void {
        this.scene.add(object);
    }

    /* What is drawn, and can be taken hold of. */
    get surface(): SurfaceView | null {
        return this.shown?.surface ?? null;
    }

    get finer(): boolean {
        return this.shown !== null && this.shown === this.fineOrgan;
    }

    private get materials(): [THREE.Material, THREE.Material] {
        return [this.tissue.material, this.tissue.faded];
    }

    private get shown(): Organ | null {
        return (this.fineShown && this.fineOrgan) || this.organ;
    }

    /* A new body, with the names of its organs, seen at first from where the scene says. */
    setSurface(message: SurfaceMessage, organs: string[], from?: [number, number, number]): void {
        this.dispose();
        this.colourOf = (material) => organColour(organs[material] ?? '', material);
        const surface = new Surface(message.rest, message.faces, this.fine ? 24000 : 6000);
        const tints = {
            organs: tintsOf(surface, (face) => this.colourOf(message.material[face]!)),
            processors: nodeTints(surface, (node) => processorColour(message.processor[node]!)),
        };
        this.mesh = surface;
        this.frameNodes = surface.meshNodes;
        this.processors = message.processor;
        this.organ = new Organ(surface, tints, this.materials, (t) => message.material[surface.faceOf(t)]!);
        this.edges = new Edges(surface.lines, this.organ.mesh.geometry, this.cut.plane);
        this.faceRegions = message.material;
        this.scene.add(this.organ.mesh, this.edges.lines);
        if (message.families) {
            this.fibres = new Fibres(new FibreLines(message.rest, message.faces, message.fibres, message.families), this.cut.plane);
            this.scene.add(this.fibres.mesh);
        }
        this.pull.setSize(surface.size);
        this.others.setSize(surface.size);
        this.marks.setSize(surface.size);
        this.cut.setBody(surface.center, surface.size);
        this.endoscope.frame(surface.center, surface.size, from, surface.half);
        this.see(this.seen);
    }

    /* An embedded surface of the organ's mesh. */
    setEmbedded(message: EmbeddedMessage): void {
        if (!this.mesh || this.fineOrgan) return;
        const first = this.mesh.meshNodes * 3;
        const rest = new Float32Array(first + message.rest.length);
        rest.set(this.mesh.rest.subarray(0, first));
        rest.set(message.rest, first);
        const embedded = new EmbeddedSurface(rest, message);
        const processor = (node: number): number =>
            this.processors[node] ?? message.processor[node - this.processors.length]!;
        const tints = {
            organs: vertexTints(embedded, (vertex) => this.colourOf(message.material[vertex]!)),
            processors: vertexTints(embedded, (vertex) => processorColour(processor(embedded.leader(vertex)))),
        };
        this.frameNodes = rest.length / 3;
        this.positions = this.values = null;
        this.fineOrgan = new Organ(embedded, tints, this.materials, (t) => message.material[embedded.triangles[3 * t]!]!);
        this.scene.add(this.fineOrgan.mesh);
        this.see(this.seen);
    }

    /* Positions, values and tools of a frame. */
    setFrame(frame: Frame): void {
        if (frame.positions.length !== this.frameNodes * 3) return;
        this.positions = frame.positions;
        this.values = frame.values.length === this.frameNodes ? frame.values : null;
        this.place();
        this.instruments.update(frame);
    }

    /* The embedded surface, where there is one, or the mesh's own. */
    showFine(yes: boolean): void {
        this.fineShown = yes;
        this.arrange();
    }

    showProcessors(yes: boolean): void {
        this.processorsShown = yes;
        this.shown?.showProcessors(yes);
        this.stale = true;
    }

    get shadows(): boolean {
        return this.tissue.shadows.on;
    }

    showShadows(yes: boolean): void {
        this.tissue.shadows.on = yes;
        this.stale = true;
    }

    showEdges(yes: boolean): void {
        this.edgesShown = yes;
        this.arrange();
    }

    showFibres(yes: boolean): void {
        this.fibresShown = yes;
        this.arrange();
    }

    /* Lines along fibres that are drawn. */
    get fibreLines(): number {
        return this.fibresShown ? (this.fibres?.drawn ?? 0) : 0;
    }

    /* The point of the mesh's surface that is taken hold of when this one is pressed. */
    holdAt(point: [number, number, number]): [number, number, number] {
        if (!this.finer || !this.mesh) return point;
        const [x, y, z] = point;
        return nearestPoint(this.mesh.positions, this.mesh.meshQuads, { x, y, z }).point;
    }

    /* The face of the mesh's surface that is nearest to a point, and the nearest of its corners. */
    nodeAt([x, y, z]: readonly [number, number, number]): { node: number; face: number } | null {
        if (!this.mesh) return null;
        const { positions, meshQuads } = this.mesh;
        const face = nearestPoint(positions, meshQuads, { x, y, z }).quad;
        if (face < 0) return null;
        const far = (node: number): number =>
            Math.hypot(positions[3 * node]! - x, positions[3 * node + 1]! - y, positions[3 * node + 2]! - z);
        const corners = [...meshQuads.subarray(4 * face, 4 * face + 4)];
        return { face, node: corners.reduce((best, node) => (far(node) < far(best) ? node : best)) };
    }

    /* Where a node of the mesh's surface is now. */
    placeOf(node: number, out: THREE.Vector3): void {
        if (this.mesh) out.fromArray(this.mesh.positions, 3 * node);
    }

    /* Shows, fades and hides organs, by their index. */
    see(seen: (region: number) => Seen): void {
        this.seen = seen;
        if (!this.mesh || !this.edges) return;
        for (const organ of [this.organ, this.fineOrgan]) organ?.see(seen);
        const { mesh, faceRegions } = this;
        const visible = new Uint8Array(mesh.sides.length);
        mesh.sides.forEach((edge, side) => {
            if (seen(faceRegions[side >> 2]!) !== 'hidden') visible[edge] = 1;
        });
        this.edges.show((segment) => visible[mesh.edgeOf(segment)] === 1);
        this.fibres?.show((face) => seen(faceRegions[face]!) !== 'hidden');
        this.arrange();
    }

    /* What of the organs a ray meets: what is hidden or cut away lets it through, and what is faded too,
     * unless `faded`. */
    hit(ray: THREE.Ray, faded = false): Hit | null {
        const organ = this.shown;
        if (!organ) return null;
        const count = organ.shown + (faded ? organ.faded : 0);
        const triangles = organ.triangles.subarray(0, 3 * count);
        return pick(organ.surface, ray.origin, ray.direction, { triangles, plane: this.cut.plane });
    }

    /* The organ that a hit is of, as it was when it was hit. */
    regionOf(hit: Hit): number {
        return this.shown?.regions[hit.triangle] ?? -1;
    }

    /* What is in the middle of the free part of the picture, or around it in widening circles. */
    middle(faded = false): Hit | null {
        const { x, y } = this.endoscope.centre;
        for (let ring = 0; ring < 8; ring++)
            for (let i = 0; i < (ring ? 8 : 1); i++) {
                const angle = (i * Math.PI) / 4;
                const ray = this.endoscope.rayThrough(x + 0.08 * ring * Math.cos(angle), y + 0.08 * ring * Math.sin(angle));
                const hit = this.hit(ray, faded);
                if (hit) return hit;
            }
        return null;
    }

    /* What is drawn has changed. */
    private arrange(): void {
        if (!this.organ || !this.edges || !this.mesh) return;
        const shown = this.shown!;
        for (const organ of [this.organ, this.fineOrgan]) if (organ) organ.mesh.visible = organ === shown;
        this.edges.lines.visible = this.edgesShown;
        this.edges.lift(this.finer ? 0.75 * this.mesh.meanEdge : 0);
        if (this.fibres) this.fibres.mesh.visible = this.fibresShown;
        this.fibres?.lift((this.finer ? 0.75 : 0.2) * this.mesh.meanEdge);
        shown.showProcessors(this.processorsShown);
        this.place();
    }

    /* What is drawn goes where the last frame has it. Of what is not drawn, the mesh's nodes do: they tell
     * how far it is moved, and are taken hold of. */
    private place(): void {
        this.stale = true;
        const positions = this.positions;
        if (!positions || !this.organ || !this.mesh) return;
        const shown = this.shown!;
        shown.place(positions);
        if (shown !== this.organ && this.edgesShown) this.organ.place(positions);
        else if (shown !== this.organ) this.mesh.keep(positions);
        if (this.fibresShown) this.fibres?.place(positions);
        if (this.values) shown.paint(this.values);
    }

    /* The farthest that a node of the surface is from its place at rest [m]. */
    displacement(): number {
        const { positions, rest, meshNodes } = this.mesh ?? { meshNodes: 0 };
        let max = 0;
        for (let i = 0; i < meshNodes * 3; i += 3)
            max = Math.max(
                max,
                Math.hypot(
                    positions![i]! - rest![i]!,
                    positions![i + 1]! - rest![i + 1]!,
                    positions![i + 2]! - rest![i + 2]!,
                ),
            );
        return max;
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
        const rods = this.tissue.shadows.on ? this.instruments.rods : [];
        this.tissue.use(this.cut.on, rods.length > 0);
        this.tissue.shadows.update(rods, this.endoscope.camera, this.mesh?.size ?? 1);
        this.background.follow(this.endoscope.camera);
        this.renderer.render(this.scene, this.endoscope.camera);
        this.pictures++;
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
        this.arrangeInWindow();
    }

    /* What covers the window may have changed: the organ is placed in what is free. */
    arrangeInWindow(): void {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        if (!width || !height) return;
        this.endoscope.resize(width, height, freePart(width, height, this.covers()));
        this.stale = true;
    }

    private dispose(): void {
        for (const part of [this.organ?.mesh, this.fineOrgan?.mesh, this.edges?.lines, this.fibres?.mesh]) {
            if (!part) continue;
            this.scene.remove(part);
            part.geometry.dispose();
        }
        this.mesh = this.organ = this.fineOrgan = this.edges = this.fibres = null;
        this.positions = this.values = null;
    }
}

/* Whether a graphics processor draws. Where the main processor has to, which the engine needs too, the
 * picture is plainer; the address may say otherwise, with #quality=fine or #quality=plain. */
function rendersInHardware(): boolean {
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

function vertexTints(embedded: EmbeddedSurface, colourOf: (vertex: number) => number[]): Float32Array {
    const out = new Float32Array(embedded.nodes * 3);
    for (let i = 0; i < embedded.nodes; i++) out.set(colourOf(i), i * 3);
    return out;
}
