// A stand-in for the engine's server: speaks docs/viewer-protocol.md over an organ that is no more than a
// surface with springs. For work on the viewer without the engine, and for tests of what the
// engine rarely does (slow motion, a stop, refusals).
//
//     node test/mock.mjs [--port 8123] [--surface FILE.json] [--riding 1] [--dist DIR]
import { createServer } from 'node:http';
import { readFileSync, existsSync } from 'node:fs';
import { dirname, extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { WebSocketServer } from 'ws';

const here = dirname(fileURLToPath(import.meta.url));
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };
const POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; " +
    "font-src 'self'; connect-src 'self'; worker-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const SCAN = [29, 17, 25]; // voxels

/* A pear of quads: a cube blown up to a sphere, narrower below. */
function pear(n = 14) {
    const x = [];
    const f = [];
    const known = new Map();
    const node = (a, b, c) => {
        const key = `${a},${b},${c}`;
        if (known.has(key)) return known.get(key);
        const p = [a, b, c].map((v) => Math.tan(((v / n) * 2 - 1) * (Math.PI / 4)));
        const l = Math.hypot(...p);
        const [u, v, w] = p.map((k) => k / l);
        const wide = 0.035 * (0.75 + 0.35 * w);
        x.push(u * wide, v * wide * 0.75, 0.045 * w + 0.045);
        known.set(key, x.length / 3 - 1);
        return x.length / 3 - 1;
    };
    for (let i = 0; i < n; i++)
        for (let j = 0; j < n; j++) {
            f.push(node(i, j, 0), node(i, j + 1, 0), node(i + 1, j + 1, 0), node(i + 1, j, 0));
            f.push(node(i, j, n), node(i + 1, j, n), node(i + 1, j + 1, n), node(i, j + 1, n));
            f.push(node(i, 0, j), node(i + 1, 0, j), node(i + 1, 0, j + 1), node(i, 0, j + 1));
            f.push(node(i, n, j), node(i, n, j + 1), node(i + 1, n, j + 1), node(i + 1, n, j));
            f.push(node(0, i, j), node(0, i, j + 1), node(0, i + 1, j + 1), node(0, i + 1, j));
            f.push(node(n, i, j), node(n, i + 1, j), node(n, i + 1, j + 1), node(n, i, j + 1));
        }
    return { x, f, m: f.filter((_, i) => i % 4 === 0).map((_, i) => (i % 6 === 0 ? 1 : 0)) };
}

/* An embedded surface on a layer of elements under the mesh's surface: every quad is one's outer face,
 * its inner nodes lie halfway to the middle. Vertices stand off by `off` of the layer's depth. */
function fineSurface(mesh, pieces = 4, off = 0.12) {
    const n = mesh.x.length / 3;
    const weights = [];
    const carriers = [];
    const triangles = [];
    const material = [];
    const known = new Map();
    const inner = mesh.x.map((v, i) => (i % 3 === 2 ? 0.045 + (v - 0.045) / 2 : v / 2));
    for (let q = 0; q < mesh.f.length; q += 4) {
        const corners = mesh.f.slice(q, q + 4);
        const vertex = (i, j) => {
            const [u, v] = [i / pieces, j / pieces];
            const shape = [(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v];
            const place = [0, 1, 2].map((k) => shape.reduce((sum, s, c) => sum + s * mesh.x[3 * corners[c] + k], 0));
            const key = place.map((p) => Math.round(p * 1e7)).join();
            if (known.has(key)) return known.get(key);
            weights.push(...shape.map((s) => s * (1 + off)), ...shape.map((s) => -s * off));
            carriers.push(...corners, ...corners.map((c) => c + n));
            material.push(mesh.m[q / 4]);
            known.set(key, known.size);
            return known.size - 1;
        };
        for (let i = 0; i < pieces; i++)
            for (let j = 0; j < pieces; j++) {
                const [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
                triangles.push(a, b, c, a, c, d);
            }
    }
    return { inner, weights, carriers, triangles, material, vertices: known.size };
}

export function mock({ port = 0, surface = null, riding = false, token = null, watchToken = null, organs = null, active = [], scan = false, fibres = 0, toolName = 'probe', title = surface ? 'Uterus' : 'Pear', dist = join(here, '../dist') } = {}) {
    const mesh = surface ? JSON.parse(readFileSync(surface, 'utf8')) : pear();
    // Two organs, one above the other.
    if (organs === 'halves')
        mesh.m = mesh.m.map((_, q) => ([0, 1, 2, 3].reduce((z, c) => z + mesh.x[3 * mesh.f[4 * q + c] + 2], 0) > 4 * 0.045 ? 1 : 0));
    const n = mesh.x.length / 3;
    const faces = mesh.f.length / 4;
    const fine = riding ? fineSurface(mesh) : null;
    const shown = fine ? 2 * n : n; // nodes in frames
    const rest = Float32Array.from(mesh.x);
    const now = rest.slice();
    const speed = new Float32Array(rest.length);
    const low = Math.min(...mesh.x.filter((_, i) => i % 3 === 2));
    const high = Math.max(...mesh.x.filter((_, i) => i % 3 === 2));
    const bound = (of) => [0, 1, 2].map((axis) => mesh.x.reduce((best, v, i) => (i % 3 === axis ? of(best, v) : best), mesh.x[axis]));
    const materials = 1 + Math.max(...mesh.m);

    const state = {
        state: 'playing', step: 0, tick: 0, pace: 1, recording: false, lost: false, message: '', saved: [], recordings: [], replay: null,
        recoveries: 0, recovery: '', slow: false, refuse: false, mute: false, connections: 0, grabbed: null,
        noise: false, placed: 0, parts: 1, divided: 0, pressed: false,
        slices: 0, // that were asked for
        late: 0, energies: 0, // answers that were; questions for energies
        body: { gravity: [0, 0, -9.81], damping: 4, stiffness: Array(materials).fill(1), ...(active.length ? { activation: Array(materials).fill(1) } : {}) }, settings: 0, // and how often they were set
        asked: [], // for tools to be added and removed
        refused: [], // what those who may only watch have asked for
    };
    const tool = { name: toolName, shape: 'grasper', radius: 0.0025, length: 0.014, spread: 1.0,
        rest: { position: [0.05, -0.03, 0.08], orientation: turned(), opening: 1 } };
    const none = { name: '', shape: 'none', radius: 0, length: 0, spread: 0, rest: { position: [0, 0, 0], orientation: [1, 0, 0, 0], opening: 1 } };
    const tools = [tool, hand('hand 1'), hand('hand 2'), none, none];
    const spares = [3, 4];
    const poses = tools.map((t) => structuredClone(t.rest));
    const forces = tools.map(() => []);
    let held = null; // { client, hand, node, target }

    function hand(name) {
        return { name, shape: 'hand', radius: 0.006, length: 0, spread: 0,
            rest: { position: [0, 0, 0.1], orientation: [1, 0, 0, 0], opening: 1 } };
    }
    function turned() {
        const a = 0.9 / 2;
        return [Math.cos(a), 0, Math.sin(a), 0];
    }

    /* One tick: every node returns to rest; a held one pulls its surroundings along. */
    function tick() {
        state.tick++;
        state.step += 10;
        let force = [0, 0, 0];
        if (held) {
            const h = held.node * 3;
            for (let i = 0; i < n; i++) {
                const d = Math.hypot(rest[3 * i] - rest[h], rest[3 * i + 1] - rest[h + 1], rest[3 * i + 2] - rest[h + 2]);
                const hold = Math.min(1, (rest[3 * i + 2] - low) / (high - low) * 2.5);
                const share = Math.exp(-((d / 0.026) ** 2)) * hold;
                for (let k = 0; k < 3; k++) {
                    const goal = rest[3 * i + k] + share * (held.target[k] - rest[h + k]);
                    speed[3 * i + k] += (goal - now[3 * i + k]) * 0.004 - speed[3 * i + k] * 0.09;
                }
            }
            force = [0, 1, 2].map((k) => (rest[h + k] - now[h + k]) * 18 + Math.sin(state.tick / 9) * 0.003);
        } else {
            for (let i = 0; i < rest.length; i++) speed[i] += (rest[i] - now[i]) * 0.0025 - speed[i] * 0.03;
        }
        for (let i = 0; i < rest.length; i++) now[i] += speed[i];
        for (let t = 0; t < 3; t++) {
            forces[t].push(t === 1 ? force : [0, 0, 0]);
            if (forces[t].length > 8192) forces[t].shift();
        }
        if (held) poses[1].position = [...held.target];
    }

    /* Inner nodes go half as far as those above them. */
    function places() {
        if (!fine) return now;
        const out = new Float32Array(6 * n);
        out.set(now);
        for (let i = 0; i < 3 * n; i++) out[3 * n + i] = fine.inner[i] + (now[i] - rest[i]) / 2;
        return out;
    }

    let due = performance.now();
    const engine = setInterval(() => {
        const at = performance.now();
        if (state.state !== 'playing') return (due = at);
        const every = 1 / (state.pace || 3) / (state.slow ? 0.4 : 1);
        let max = 60;
        while (due < at && max-- > 0) {
            tick();
            due += every;
        }
        if (due < at) due = at;
    }, 4);

    const hello = () => ({
        kind: 'hello', protocol: 1, lariat: '0.1.0', viewer: 1, title, nodes: n, elements: faces,
        surface: { nodes: n, faces },
        ...(fine ? { riding: { vertices: fine.vertices, triangles: fine.triangles.length / 3, nodes: n } } : {}),
        ...(scan ? { scan: { size: SCAN, labels: [{ label: 1, name: 'uterus' }, { label: 2, name: 'bone' }] } } : {}),
        lower: bound(Math.min), upper: bound(Math.max), time_step: 0.0001, tick: 0.001,
        isa: 'mock', processors: 4, threads: 1,
        materials: ['uterus', 'tubes', 'ovaries', 'ligaments'].slice(0, materials).map((name, i) => ({ ...(active.includes(i) ? { active: true } : {}),
            name, law: 'neo-hookean', elements: 1, density: 1050, shear_modulus: 1500, bulk_modulus: 3e5 })),
        tools: tools.map((t, i) => (spares.includes(i) ? none : t)), hands: [1, 2], spares,
        fields: [
            { name: 'displacement', number: 1, title: 'displacement', unit: 'm' },
            { name: 'von_mises', number: 4, title: 'von Mises stress', unit: 'Pa' },
            { name: 'pressure', number: 8, title: 'pressure', unit: 'Pa' },
            { name: 'energy', number: 16, title: 'strain energy density', unit: 'J/m³' },
            { name: 'processor', number: 32, title: 'processor', unit: '' },
        ],
        saves: true, hand_force: 5, tool_speed: 1, watches: false,
        body: { gravity: [0, 0, -9.81], gravity_varies: false, damping: 4, stiffness_min: 0.1, stiffness_max: 4 },
    });
    const bins = (...held) => Array.from({ length: 40 }, (_, i) => held.find(([bin]) => bin === i)?.[1] ?? 0);
    const status = () => ({
        kind: 'status', state: state.state, step: state.step, time: state.step * 1e-4, pace: state.pace,
        step_us: { p50: 21.0, p99: 30.1, p999: 44.0, max: 120.0 },
        tick_us: { p50: 231.0, p99: 320.0, p999: 450.0, max: 1520.0 },
        step_bins: bins([8, state.tick]), tick_bins: bins([15, state.tick], [24, state.late]),
        ticks: state.tick, misses: state.late, slow_ticks: state.slow ? state.tick : 0, real_time_factor: 1, real_time_factor_now: state.slow ? state.slow === true ? 0.4 : state.slow : 1,
        engine_rate: 10000, haptic_rate: 1000, snapshot_rate: 58, slow_motion: state.slow, slow_cause: state.slow ? 'step' : '',
        slow_advice: state.slow ? (state.slowAdvice ?? 'a step takes 250 us and stands for 100 us of the clock; what would hold: --grid 2x2x1, a mesh of about 700 elements, or a slower pace') : '', lag: 0, skipped: 0,
        recording: state.recording, recording_by: state.recordingBy ?? (state.recording ? 'viewer' : ''), recording_lost: state.recordingLost ?? '', lost: state.lost, message: state.message, viewers: 1, saved: state.saved, recordings: state.recordings, ...(state.replay ? { replay: state.replay } : {}),
        recoveries: state.recoveries, recovery: state.recovery, body: state.body,
        placed: state.placed, step_parts: state.parts, divided_steps: state.divided, heavier: 0, heavier_share: 0,
        tools: tools.map((_, i) => ({ ...poses[i], force: forces[i].at(-1) ?? [0, 0, 0], torque: [0, 0, 0],
            ...(state.pressed && i === 0 ? { force: [0, 0, 1.8], depth: 0.0004, apart: 0.006, limited: true, grasp: 0 }
                : { depth: 0, apart: 0, limited: false, grasp: 0 }),
            ...(spares.includes(i) ? { ...tools[i], rest: undefined } : {}),
            limit: tools[i].shape === 'hand' ? 0 : 1.76, touching: 0, held: 0, by: 'nobody' })),
    });

    function surfaceMessage() {
        const out = new ArrayBuffer(16 + 20 * n + (24 + 12 * fibres) * faces);
        new Uint32Array(out, 0, 4).set([1, n, faces, fibres]);
        new Float32Array(out, 16, 3 * n).set(rest);
        new Uint32Array(out, 16 + 12 * n, 4 * faces).set(mesh.f);
        new Uint32Array(out, 16 + 12 * n + 16 * faces, faces).set(mesh.m);
        const processor = new Uint32Array(out, 16 + 12 * n + 24 * faces, n);
        for (let i = 0; i < n; i++) processor[i] = processorOf(i);
        // One family goes up, another one around the body's axis.
        const along = new Float32Array(out, 16 + 20 * n + 24 * faces, 3 * fibres * faces);
        for (let f = 0; f < faces && fibres; f++) {
            const [x, y] = [0, 1].map((k) => mesh.x[3 * mesh.f[4 * f] + k]);
            const far = Math.hypot(x, y) || 1;
            along.set([0, 0, 1, ...(x || y ? [-y / far, x / far, 0] : [1, 0, 0])].slice(0, 3 * fibres), 3 * fibres * f);
        }
        return out;
    }
    const processorOf = (i) => (rest[3 * i] > 0 ? 1 : 0) + (rest[3 * i + 2] > (low + high) / 2 ? 2 : 0);

    function embeddedMessage() {
        const [m, k] = [fine.vertices, fine.triangles.length / 3];
        const out = new ArrayBuffer(16 + 20 * n + 68 * m + 12 * k);
        let at = 16;
        const put = (Type, values) => {
            new Type(out, at, values.length).set(values);
            at += 4 * values.length;
        };
        new Uint32Array(out, 0, 4).set([4, m, k, n]);
        put(Float32Array, fine.inner);
        put(Uint32Array, fine.inner.slice(0, n).map((_, i) => processorOf(i)));
        put(Uint32Array, fine.inner.slice(0, n).map((_, i) => n + i));
        put(Float32Array, fine.weights);
        put(Uint32Array, fine.carriers);
        put(Uint32Array, fine.material);
        put(Uint32Array, fine.triangles);
        return out;
    }

    function frameMessage(field) {
        const info = hello().fields.find((f) => f.name === field);
        const n = shown;
        const v = info ? n : 0;
        const t = tools.length;
        const out = new ArrayBuffer(72 + 12 * n + 4 * v + 64 * t);
        const view = new DataView(out);
        view.setUint32(0, 2, true);
        view.setUint32(4, n, true);
        view.setBigUint64(8, BigInt(state.step), true);
        view.setFloat64(16, state.step * 1e-4, true);
        view.setUint32(40, info?.number ?? 0, true);
        view.setUint32(44, v, true);
        view.setUint32(64, t, true);
        const positions = new Float32Array(out, 72, 3 * n);
        positions.set(places());
        const words = new Uint32Array(out, 72, 3 * n);
        let a = 0, b = 0;
        for (let i = 0; i < words.length; i++)
            if (i & 1) b = Math.imul(((b << 5) | (b >>> 27)) ^ words[i], 0x9e3779b1);
            else a = Math.imul(((a << 5) | (a >>> 27)) ^ words[i], 0x9e3779b1);
        view.setUint32(32, a >>> 0, true);
        view.setUint32(36, b >>> 0, true);
        if (v) {
            const values = new Float32Array(out, 72 + 12 * n, n);
            for (let i = 0; i < n; i++) {
                const d = [0, 1, 2].map((k) => positions[3 * i + k] - (fine && i >= rest.length / 3 ? fine.inner[3 * i - rest.length + k] : rest[3 * i + k]));
                const length = Math.hypot(...d);
                values[i] = { displacement: length, von_mises: length * 40000, pressure: d[2] * 30000, energy: length * 900 }[field] ?? 0;
                if (state.noise) values[i] = (field === 'pressure' ? ((i * 37) % 19) - 9 : (i * 37) % 19) * 1e-12;
            }
            view.setFloat64(48, Math.min(...values), true);
            view.setFloat64(56, Math.max(...values), true);
        }
        const words2 = new Float32Array(out, 72 + 12 * n + 4 * v, 16 * t);
        for (let i = 0; i < t; i++) {
            words2.set([...poses[i].position, ...poses[i].orientation, poses[i].opening, ...(forces[i].at(-1) ?? [0, 0, 0])], 16 * i);
        }
        return out;
    }

    /* The numbers of the mesh's file begin at 1000 and 5000. */
    function valuesMessage({ node, face, energy }) {
        if (energy) state.energies++;
        const moved = (i) => [0, 1, 2].map((k) => now[3 * i + k] - rest[3 * i + k]);
        const size = node === undefined ? 0 : Math.hypot(...moved(node));
        const read = { von_mises: size * 40000, pressure: -1250, energy: size * 900 };
        return {
            kind: 'values', step: state.step, time: state.step * 1e-4,
            ...(node === undefined ? {} : { node: { index: node, number: 1000 + node, rest: [0, 1, 2].map((k) => rest[3 * node + k]), displacement: moved(node), ...read } }),
            ...(face === undefined ? {} : { element: { index: face, number: 5000 + face, material: mesh.m[face], ...read, pressure: null } }),
            ...(energy ? { energy: { kinetic: speed.reduce((s, v) => s + v * v, 0), strain: size || 1e-3, hourglass: 1e-5 } } : {}),
        };
    }

    /* Voxels of 5 mm around the pear: itself, and a post of bone to its right. */
    function sliceMessage({ axis, index }) {
        const [u, v] = [[1, 2], [0, 2], [0, 1]][axis];
        const [width, height] = [SCAN[u], SCAN[v]];
        const out = new ArrayBuffer(72 + 4 * Math.ceil((width * height) / 2));
        const origin = [-0.07, -0.04, -0.015];
        const unit = (k, size) => [0, 1, 2].map((i) => (i === k ? size : 0));
        new Uint32Array(out, 0, 6).set([5, axis, index, SCAN[axis], width, height]);
        new Float32Array(out, 32, 3).set(origin.map((x, i) => x + (i === axis ? 0.005 * index : 0)));
        new Float32Array(out, 44, 3).set(unit(u, 0.005));
        new Float32Array(out, 56, 3).set(unit(v, 0.005));
        const labels = new Uint16Array(out, 72, width * height);
        for (let y = 0; y < height; y++)
            for (let x = 0; x < width; x++) {
                const at = [0, 0, 0];
                [at[axis], at[u], at[v]] = [index, x, y];
                const [px, py, pz] = at.map((n, i) => origin[i] + 0.005 * n);
                labels[y * width + x] = px > 0.044 ? 2 : (px / 0.035) ** 2 + (py / 0.026) ** 2 + ((pz - 0.045) / 0.045) ** 2 < 1 ? 1 : 0;
            }
        state.slices++;
        return out;
    }

    function forcesMessage(index, after) {
        const all = forces[index];
        const count = Math.min(all.length, Math.max(0, state.tick - after));
        const out = new ArrayBuffer(32 + 12 * count);
        const view = new DataView(out);
        view.setUint32(0, 3, true);
        view.setUint32(4, index, true);
        view.setUint32(8, count, true);
        view.setBigUint64(16, BigInt(state.tick), true);
        view.setFloat64(24, 0.001, true);
        new Float32Array(out, 32).set(all.slice(all.length - count).flat());
        return out;
    }

    function nearest(point) {
        let best = Infinity, found = -1;
        for (let i = 0; i < n; i++) {
            const d = Math.hypot(now[3 * i] - point[0], now[3 * i + 1] - point[1], now[3 * i + 2] - point[2]);
            if (d < best) [best, found] = [d, i];
        }
        return best < 0.008 ? found : -1;
    }

    const server = createServer((request, response) => {
        const path = normalize(request.url.split('?')[0]);
        const file = join(dist, path === '/' ? 'index.html' : path);
        if (!existsSync(file)) return response.writeHead(404).end();
        response.writeHead(200, { 'Content-Type': TYPES[extname(file)] ?? 'application/octet-stream', 'Content-Security-Policy': POLICY });
        response.end(readFileSync(file));
    });
    const sockets = new WebSocketServer({ server, path: '/socket', handleProtocols: (p) => (p.has('lariat.1') ? 'lariat.1' : false) });
    const faults = []; // what a real server would have cut the viewer off for
    sockets.on('connection', (socket, request) => {
        const asked = new URL(request.url, 'http://x').searchParams;
        if (token && ![token, watchToken].includes(asked.get('token')))
            return socket.close(4001, 'The token is missing or wrong.');
        const watches = asked.has('watch') || (watchToken !== null && asked.get('token') === watchToken);
        state.connections++;
        const say = (message) => socket.send(JSON.stringify(message));
        say({ ...hello(), watches });
        socket.send(surfaceMessage());
        if (fine) socket.send(embeddedMessage());
        say(status());
        const beat = setInterval(() => say(status()), 100);
        let messages = 0;
        const count = setInterval(() => {
            if (messages > 300) faults.push(`${messages} messages in a second`);
            messages = 0;
        }, 1000);
        socket.on('close', () => {
            clearInterval(beat);
            clearInterval(count);
            if (held?.socket === socket) held = null;
        });
        socket.on('message', (data) => {
            messages++;
            const m = JSON.parse(data);
            const acts = {
                frame: () => !state.mute && socket.send(frameMessage(m.field)),
                forces: () => socket.send(forcesMessage(m.tool, m.after)),
                slice: () => socket.send(sliceMessage(m)),
                inspect: () => say(valuesMessage(m)),
                grab() {
                    state.grabbed = m.point;
                    const node = nearest(m.point);
                    if (state.refuse) return say({ kind: 'hand', hand: m.hand, tool: null, state: 'refused' });
                    if (node < 0) return say({ kind: 'hand', hand: m.hand, tool: 1, state: 'missed' });
                    held = { socket, node, target: m.point };
                    say({ kind: 'hand', hand: m.hand, tool: 1, state: 'holding' });
                },
                pull: () => held && (held.target = m.to),
                release: () => (held = null),
                tool() {
                    poses[m.tool].position = m.position;
                    if (m.opening !== undefined) poses[m.tool].opening = m.opening;
                },
                add_tool() {
                    state.asked.push(m);
                    const i = spares.find((k) => tools[k] === none);
                    if (i === undefined) return say({ kind: 'note', text: 'no place is left: 2 tools were added, which is the most; remove one of them' });
                    tools[i] = { ...none, name: `${m.shape} ${i - 2}`, shape: m.shape, radius: m.radius, length: m.length ?? 0, spread: m.shape === 'grasper' ? 1 : 0,
                        rest: { ...none.rest, position: [0.02 * (i - 3), 0, 0.11] } };
                    poses[i] = structuredClone(tools[i].rest);
                    say({ kind: 'added', tool: i });
                },
                remove_tool() {
                    state.asked.push(m);
                    tools[m.tool] = none;
                    poses[m.tool] = structuredClone(none.rest);
                },
                play: () => (state.state = 'playing'),
                pause: () => (state.state = 'paused'),
                step() {
                    for (let i = 0; i < m.steps / 10; i++) tick();
                    state.state = 'paused';
                },
                reset() {
                    now.set(rest);
                    speed.fill(0);
                    held = null;
                    state.step = 0;
                    state.placed++;
                    tools.forEach((t, i) => (poses[i] = structuredClone(t.rest)));
                    state.message = '';
                    if (state.state === 'stopped') state.state = 'paused';
                    say({ kind: 'hand', hand: 0, tool: 1, state: 'lost' });
                },
                pace: () => (state.pace = m.value),
                record() {
                    state.recording = m.on;
                    if (!m.on) state.recordings.push('pear-1.recording');
                    if (!m.on) say({ kind: 'saved', what: 'recording', name: 'pear-1.recording' });
                },
                save() {
                    state.saved.push(`pear-${state.saved.length + 1}.checkpoint`);
                    say({ kind: 'saved', what: 'checkpoint', name: state.saved.at(-1) });
                },
                load: () => now.set(rest),
                gravity: () => (state.settings++, state.body.gravity = m.to ?? [0, 0, -9.81]),
                damping: () => (state.settings++, state.body.damping = m.value ?? 4),
                stiffness: () => (state.settings++, state.body.stiffness.forEach((_, i, all) => m.material === undefined || m.material === i ? (all[i] = m.value ?? 1) : 0)),
                activate: () => (state.settings++, state.body.activation.forEach((_, i, all) => m.material === undefined || m.material === i ? (all[i] = m.value ?? 1) : 0)),
                replay() {
                    state.replay = m.name ? { name: m.name, time: 0, length: 2 } : null;
                },
                seek: () => (state.replay.time = m.time),
            };
            if (watches && !['frame', 'forces', 'inspect', 'slice'].includes(m.do)) state.refused.push(m.do);
            if (watches && !['frame', 'forces', 'inspect', 'slice'].includes(m.do)) return say({ kind: 'note', text: 'this viewer may only watch' });
            if (!acts[m.do]) return faults.push(`unknown: ${data}`);
            acts[m.do]();
        });
    });
    return new Promise((resolve) => {
        server.listen(port, '127.0.0.1', () =>
            resolve({
                url: `http://127.0.0.1:${server.address().port}/`,
                port: server.address().port,
                state,
                faults,
                mesh,
                poses,
                cut(code, reason) {
                    for (const socket of sockets.clients) socket.close(code, reason);
                },
                close() {
                    clearInterval(engine);
                    for (const socket of sockets.clients) socket.terminate();
                    return new Promise((done) => server.close(done));
                },
            }),
        );
    });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
    const option = (name) => {
        const at = process.argv.indexOf(`--${name}`);
        return at < 0 ? undefined : process.argv[at + 1];
    };
    const server = await mock({ port: Number(option('port') ?? 8123), surface: option('surface') ?? null, riding: Boolean(option('riding')), ...(option('dist') ? { dist: option('dist') } : {}) });
    console.log(server.url);
}
