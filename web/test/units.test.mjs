// Parts of the viewer that need no browser, compiled as they are.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const source = join(dirname(fileURLToPath(import.meta.url)), '../src');
const folder = mkdtempSync(join(tmpdir(), 'lariat-units-'));
const parts = {};

before(async () => {
    const files = [
        'picture/surface', 'picture/fibreLines', 'picture/embedded', 'picture/palette', 'picture/tissueNoise', 'picture/camera', 'picture/freepart', 'hands/pick',
        'inspect/measurecard', 'inspect/capture', 'inspect/plots', 'inspect/scan', 'cards/graph', 'cards/panel', 'cards/toolcard', 'cards/range', 'cards/bodycard', 'cards/addtool', 'link/protocol', 'dom',
    ];
    await build({
        entryPoints: files.map((file) => join(source, `${file}.ts`)),
        bundle: true, format: 'esm', outdir: folder, outExtension: { '.js': '.mjs' }, logLevel: 'error',
    });
    for (const file of files) parts[file.split('/').pop()] = await import(join(folder, `${file}.mjs`));
});
after(() => rmSync(folder, { recursive: true, force: true }));

/* A cube of n x n quads per side, blown up to a ball of radius 1 or left as it is. */
function cube(n, ball) {
    const known = new Map();
    const x = [];
    const quads = [];
    const node = (a, b, c) => {
        const key = `${a},${b},${c}`;
        if (!known.has(key)) {
            const p = [a, b, c].map((v) => (v / n) * 2 - 1);
            const size = ball ? Math.hypot(...p) : 1;
            known.set(key, x.length / 3);
            x.push(...p.map((v) => v / size));
        }
        return known.get(key);
    };
    for (let i = 0; i < n; i++)
        for (let j = 0; j < n; j++) {
            quads.push(node(i, j, 0), node(i, j + 1, 0), node(i + 1, j + 1, 0), node(i + 1, j, 0));
            quads.push(node(i, j, n), node(i + 1, j, n), node(i + 1, j + 1, n), node(i, j + 1, n));
            quads.push(node(i, 0, j), node(i + 1, 0, j), node(i + 1, 0, j + 1), node(i, 0, j + 1));
            quads.push(node(i, n, j), node(i, n, j + 1), node(i + 1, n, j + 1), node(i + 1, n, j));
            quads.push(node(0, i, j), node(0, i, j + 1), node(0, i + 1, j + 1), node(0, i + 1, j));
            quads.push(node(n, i, j), node(n, i + 1, j), node(n, i + 1, j + 1), node(n, i, j + 1));
        }
    return { x: Float32Array.from(x), quads: Uint32Array.from(quads) };
}

const radius = (p, i) => Math.hypot(p[3 * i], p[3 * i + 1], p[3 * i + 2]);

test('rounding leaves nodes of the mesh where they are and comes close to a ball', () => {
    const { x, quads } = cube(4, true);
    const surface = new parts.surface.Surface(x, quads, 24000);
    assert.equal(surface.quads.length, quads.length * 16, 'twice rounded');
    assert.deepEqual(surface.positions.slice(0, x.length), x);
    let worst = 0;
    for (let i = 0; i < surface.nodes; i++) worst = Math.max(worst, Math.abs(radius(surface.positions, i) - 1));
    assert.ok(worst < 0.012, `${worst} off the ball; straight edges would be off by 0.05`);
    for (let i = 0; i < surface.nodes; i++) {
        assert.ok(Math.abs(radius(surface.normals, i) - 1) < 1e-5, 'unit normals');
        const outward = [0, 1, 2].reduce((s, k) => s + surface.normals[3 * i + k] * surface.positions[3 * i + k], 0);
        assert.ok(outward > 0.98, 'normals point outwards');
    }
});

test('blocks stay blocks', () => {
    const { x, quads } = cube(3, false);
    const surface = new parts.surface.Surface(x, quads, 24000);
    for (const v of surface.positions) assert.ok(Math.abs(v) <= 1 + 1e-6, `${v} sticks out`);
});

test('large surfaces are rounded less, or not at all', () => {
    const { x, quads } = cube(4, true);
    assert.equal(new parts.surface.Surface(x, quads, 1000).quads.length, quads.length * 4);
    assert.equal(new parts.surface.Surface(x, quads, 100).quads.length, quads.length);
});

/* From one end of line i to the other, and across it. */
function lineOf({ positions, sides }, i) {
    const corner = (k) => [...positions.subarray(12 * i + 3 * k, 12 * i + 3 * k + 3)].map((v, c) => v + sides[12 * i + 3 * k + c]);
    const between = (a, b) => a.map((v, k) => b[k] - v);
    return { along: between(corner(0), corner(2)), aside: between(corner(0), corner(1)) };
}
const length = (v) => Math.hypot(...v);

test('lines along fibres lie in the faces, and move, turn and stretch with them', () => {
    const { x, quads } = cube(4, false);
    const faces = quads.length / 4;
    const a = [0.6, 0.8, 0];
    const b = [0, 0, 1];
    const fibres = new Float32Array(6 * faces);
    for (let f = 1; f < faces; f++) fibres.set([...a, ...b], 6 * f); // the first face has none
    const lines = new parts.fibreLines.FibreLines(x, quads, fibres, 2);
    assert.deepEqual([...lines.faces], Array.from({ length: faces - 1 }, (_, i) => i + 1));
    const F = [[0.9, 0.5, 0.1], [-0.4, 1.1, 0.2], [0.3, -0.1, 1.3]];
    const moved = (p) => F.map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2]);
    const turned = new Float32Array(x.length);
    for (let i = 0; i < x.length; i += 3) turned.set(moved(x.subarray(i, i + 3)), i);
    const rest = Array.from({ length: 2 * (faces - 1) }, (_, i) => lineOf(lines, i));
    lines.place(turned);
    rest.forEach(({ along }, i) => {
        const face = lines.faceOf(i);
        const corners = [0, 1, 2, 3].map((k) => [...x.subarray(3 * quads[4 * face + k], 3 * quads[4 * face + k] + 3)]);
        const axis = [0, 1, 2].find((k) => corners.every((c) => c[k] === corners[0][k])); // the face's normal
        const within = (i % 2 ? b : a).map((v, k) => (k === axis ? 0 : v));
        assert.ok(Math.abs(along[axis]) < 1e-6, 'within the face');
        if (length(within) > 0) {
            // A line is 0.8 of the face's width long where the fibre is in it, and less where it leaves it.
            assert.ok(length(along) > 0.3 * length(within) && length(along) < 0.51, `${along}`);
            for (let k = 0; k < 3; k++)
                assert.ok(Math.abs(along[k] / length(along) - within[k] / length(within)) < 1e-5, `${along} is along ${within}`);
        } else assert.ok(length(along) > 0.02 && length(along) < 0.1, 'a dot');
        const now = lineOf(lines, i);
        moved(along).forEach((v, k) => assert.ok(Math.abs(v - now.along[k]) < 1e-5, `${now.along} went to F ${along}`));
        const cosine = now.along.reduce((sum, v, k) => sum + v * now.aside[k], 0) / length(now.along) / length(now.aside);
        assert.ok(Math.abs(cosine) < 1e-3 && length(now.aside) > 0, 'as wide as at rest, whatever happens');
    });
});

test('lines of two families that lie alike point alike, whatever the sense of their directions', () => {
    const x = Float32Array.from([0, 0, 0, 1, 0, 0, 1.3, 1, 0, 0.3, 1, 0]);
    for (const sense of [1, -1]) {
        const fibres = Float32Array.from([0.8, 0, 0.6, -0.8 * sense, 0, 0.6]);
        const lines = new parts.fibreLines.FibreLines(x, Uint32Array.from([0, 1, 2, 3]), fibres, 2);
        const [a, b] = [0, 1].map((i) => lineOf(lines, i));
        for (let k = 0; k < 3; k++) assert.ok(Math.abs(a.along[k] - b.along[k]) < 1e-6, `${a.along} and ${b.along}`);
    }
});

test('where there are many faces, some of them have lines along fibres, evenly strewn', () => {
    const { x, quads } = cube(30, true);
    const faces = quads.length / 4;
    const fibres = Float32Array.from({ length: 3 * faces }, (_, i) => (i % 3 === 2 ? 1 : 0));
    const lines = new parts.fibreLines.FibreLines(x, quads, fibres, 1, 600);
    assert.ok(lines.faces.length <= 600 && lines.faces.length > 300, `${lines.faces.length} of ${faces}`);
    const middle = (i) => [0, 1, 2].map((k) => (lines.positions[12 * i + k] + lines.positions[12 * i + 9 + k]) / 2);
    const places = Array.from(lines.faces, (_, i) => middle(i));
    const octants = new Map();
    for (const p of places) {
        const octant = p.map((v) => (v > 0 ? '+' : '-')).join('');
        octants.set(octant, (octants.get(octant) ?? 0) + 1);
    }
    for (const count of octants.values()) assert.ok(Math.abs(count / lines.faces.length - 1 / 8) < 0.03, `${count}`);
    // Nowhere on the ball, whose area is 12.6, is the next line far away.
    let farthest = 0;
    for (let i = 0; i < x.length; i += 30)
        farthest = Math.max(farthest, Math.min(...places.map((p) => Math.hypot(p[0] - x[i], p[1] - x[i + 1], p[2] - x[i + 2]))));
    assert.ok(farthest < 0.3, `${farthest}`);
});

test('edges of the mesh are drawn all along', () => {
    const { x, quads } = cube(2, true);
    const surface = new parts.surface.Surface(x, quads, 24000);
    assert.equal(surface.lines.length, 48 * 4 * 2, '48 edges of four segments');
    for (let i = 0; i < surface.lines.length; i += 2) {
        const [a, b] = [surface.lines[i] * 3, surface.lines[i + 1] * 3];
        const gap = Math.hypot(...[0, 1, 2].map((k) => surface.positions[a + k] - surface.positions[b + k]));
        assert.ok(gap > 0.1 && gap < 0.35, `a segment of ${gap}`);
    }
});

test('values are continued between nodes', () => {
    const { x, quads } = cube(3, false);
    const surface = new parts.surface.Surface(x, quads, 24000);
    const values = new Float32Array(surface.nodes);
    for (let i = 0; i < surface.meshNodes; i++) values[i] = x[3 * i] + 2 * x[3 * i + 1];
    surface.spread(values, 1);
    for (let i = 0; i < surface.nodes; i++)
        assert.ok(Math.abs(values[i] - surface.positions[3 * i] - 2 * surface.positions[3 * i + 1]) < 1e-5);
});

test('the nearest outside of the surface is picked, and followed when it moves', () => {
    const { x, quads } = cube(4, true);
    const surface = new parts.surface.Surface(x, quads, 24000);
    const hit = parts.pick.pick(surface, { x: 0.1, y: -5, z: 0.2 }, { x: 0, y: 1, z: 0 });
    assert.ok(Math.abs(hit.distance - (5 - Math.sqrt(1 - 0.05))) < 0.013, `${hit.distance}`);
    assert.equal(parts.pick.pick(surface, { x: 2, y: -5, z: 0 }, { x: 0, y: 1, z: 0 }), null);
    assert.equal(parts.pick.pick(surface, { x: 0, y: 0, z: 0 }, { x: 0, y: 1, z: 0 }), null, 'from inside');
    surface.update(x.map((v, i) => (i % 3 === 2 ? v + 0.5 : v)));
    const now = {};
    parts.pick.follow(surface, hit, now);
    assert.ok(Math.abs(now.z - 0.7) < 1e-5 && Math.abs(now.x - 0.1) < 1e-5);
});

test('20,000 nodes are rounded and lit; how long that takes is printed', (t) => {
    const { x, quads } = cube(14, true);
    const surface = new parts.surface.Surface(x, quads, 24000);
    assert.ok(surface.nodes > 18000, `${surface.nodes}`);
    let best = Infinity;
    for (let i = 0; i < 40; i++) {
        const start = performance.now();
        surface.update(x);
        best = Math.min(best, performance.now() - start);
    }
    t.diagnostic(`${surface.nodes} nodes: ${best.toFixed(2)} ms a picture; at 60 Hz there are 16.7`);
    assert.ok(x.every(Number.isFinite));
});

/* One element from -1 to 1 and a ball of radius `size` in it, n circles of latitude with 2n vertices each. */
function ballInCube(n, size) {
    const nodes = Float32Array.from([0, 1, 2, 3, 4, 5, 6, 7].flatMap((a) => [a & 1 ? 1 : -1, a & 2 ? 1 : -1, a & 4 ? 1 : -1]));
    const weights = [];
    const triangles = [];
    for (let row = 0; row < n; row++)
        for (let column = 0; column < 2 * n; column++) {
            const [a, b] = [(Math.PI * (row + 0.5)) / n, (Math.PI * column) / n];
            const p = [Math.sin(a) * Math.cos(b), Math.sin(a) * Math.sin(b), Math.cos(a)].map((v) => v * size);
            for (let c = 0; c < 8; c++)
                weights.push([0, 1, 2].reduce((w, k) => (w * (1 + (nodes[3 * c + k] * p[k]))) / 2, 1));
            const next = row * 2 * n + ((column + 1) % (2 * n));
            const [me, below] = [row * 2 * n + column, (row + 1) * 2 * n];
            if (row + 1 < n) triangles.push(me, me + 2 * n, below + ((column + 1) % (2 * n)), me, below + ((column + 1) % (2 * n)), next);
        }
    const vertices = weights.length / 8;
    return {
        nodes,
        message: {
            rest: new Float32Array(0), processor: new Uint32Array(0), material: new Uint32Array(vertices),
            weights: Float32Array.from(weights), triangles: Uint32Array.from(triangles),
            carriers: Uint32Array.from({ length: 8 * vertices }, (_, i) => i % 8),
        },
    };
}

test('an embedded surface follows its nodes, also beyond them, and so do its normals and values', () => {
    const { nodes, message } = ballInCube(12, 1.3);
    const embedded = new parts.embedded.EmbeddedSurface(nodes, message);
    assert.equal(embedded.nodes, 12 * 24);
    for (let i = 0; i < embedded.nodes; i++) {
        assert.ok(Math.abs(radius(embedded.rest, i) - 1.3) < 1e-5);
        const outward = [0, 1, 2].reduce((s, k) => s + embedded.normals[3 * i + k] * embedded.rest[3 * i + k], 0);
        if (i >= 24 && i < embedded.nodes - 24) assert.ok(outward > 1.25, `normal ${i}: ${outward}`);
    }
    const f = [[0.3, -1.1, 0.2], [0.9, 0.4, 0.3], [-0.1, 0.2, 1.4]];
    const turn = (x, i, k) => 0.7 * k + f[k].reduce((s, v, j) => s + v * x[3 * i + j], 0);
    embedded.place(nodes.map((_, i) => turn(nodes, Math.floor(i / 3), i % 3)));
    for (let i = 0; i < embedded.nodes * 3; i++)
        assert.ok(Math.abs(embedded.positions[i] - turn(embedded.rest, Math.floor(i / 3), i % 3)) < 1e-5);
    const values = new Float32Array(embedded.nodes);
    embedded.paint(nodes.filter((_, i) => i % 3 === 1), values);
    for (let i = 0; i < embedded.nodes; i++) assert.ok(Math.abs(values[i] - embedded.rest[3 * i + 1]) < 1e-5);
    const high = embedded.rest.indexOf(Math.max(...embedded.rest.filter((_, i) => i % 3 === 2)));
    assert.ok(embedded.leader((high - 2) / 3) >= 4, 'the highest vertex listens to a node above');
});

test('an embedded surface is picked, followed, and held at the mesh', () => {
    const { nodes, message } = ballInCube(24, 1.3);
    const embedded = new parts.embedded.EmbeddedSurface(nodes, message);
    const hit = parts.pick.pick(embedded, { x: 0.1, y: -5, z: 0.2 }, { x: 0, y: 1, z: 0 });
    assert.ok(Math.abs(hit.point[1] + Math.sqrt(1.69 - 0.05)) < 0.01, `${hit.point}`);
    const near = parts.pick.nearestNode(embedded, { x: 0.1, y: -1.3, z: 0.2 });
    const now = {};
    parts.pick.follow(embedded, near, now);
    assert.ok(Math.hypot(now.x - 0.1, now.y + 1.3, now.z - 0.2) < 0.15);
    const { x, quads } = cube(3, false);
    const at = (p) => parts.pick.nearestPoint(x, quads, { x: p[0], y: p[1], z: p[2] }).point;
    assert.deepEqual(at([0.25, -1.5, 0.5]).map((v) => Math.round(v * 1e6) / 1e6), [0.25, -1, 0.5]);
    assert.deepEqual(at([3, 3, 3]), [1, 1, 1]);
    assert.deepEqual(at([2, 0.125, -4]).map((v) => Math.round(v * 1e6) / 1e6), [1, 0.125, -1]);
});

test('17,000 embedded vertices are moved and lit; how long that takes is printed', (t) => {
    const { nodes, message } = ballInCube(92, 0.9);
    const embedded = new parts.embedded.EmbeddedSurface(nodes, message);
    const values = new Float32Array(embedded.nodes);
    let best = Infinity;
    for (let i = 0; i < 60; i++) {
        const start = performance.now();
        embedded.place(nodes);
        embedded.paint(nodes, values);
        best = Math.min(best, performance.now() - start);
    }
    t.diagnostic(`${embedded.nodes} vertices: ${best.toFixed(2)} ms a picture`);
    assert.ok(embedded.positions.every(Number.isFinite));
});

test('the range of the force is a round number not below the peak', () => {
    const { niceRange } = parts.graph;
    assert.deepEqual([0.01, 0.05, 0.06, 0.3, 0.51, 1.2, 3, 7].map((v) => niceRange(v)), [0.05, 0.05, 0.1, 0.5, 1, 2, 5, 10]);
    assert.equal(niceRange(1.3e-6, 5e-9), 2e-6);
});

test('the history keeps the last ticks in order, beyond its size too', () => {
    const history = new parts.graph.ForceHistory();
    for (let i = 0; i < 10000; i++) history.add(Float32Array.of(0, i, 0), 0.001);
    assert.equal(history.ago(0), 9999);
    assert.equal(history.ago(4999), 5000);
    assert.equal(history.ago(9000), 0, 'forgotten');
    assert.equal(history.peak(), 9999);
    assert.equal(history.shown, 5000);
});

test('the map for values grows evenly lighter; that around zero is lightest in its middle', () => {
    const lightness = ([r, g, b]) =>
        0.2104542553 * Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b) +
        0.793617785 * Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b) -
        0.0040720468 * Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    const rising = parts.palette.colourMap('rising').map(lightness);
    for (let i = 1; i < rising.length; i++) {
        const step = (rising[i] - rising[i - 1]) * 255;
        assert.ok(step > 0.3 && step < 0.9, `step ${i}: ${step}`);
    }
    const signed = parts.palette.colourMap('signed').map(lightness);
    assert.ok(signed[127] > 0.85 && signed[0] < 0.5 && signed[255] < 0.55);
});

test('organs differ in lightness, for people who confuse hues', () => {
    const grey = (c) => 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    const values = ['uterus', 'tubes', 'ovaries', 'ligaments'].map((name) => grey(parts.palette.organColour(name, 0))).sort((a, b) => a - b);
    for (let i = 1; i < values.length; i++) assert.ok(values[i] / values[i - 1] > 1.1);
});

test('an organ has the same colour in every scene, and others have others', () => {
    const { organColour, css } = parts.palette;
    assert.equal(css(organColour('Liver', 0)), css(organColour('liver', 7)));
    assert.equal(css(organColour('left kidney', 1)), css(organColour('kidney', 4)));
    assert.equal(css(organColour('wall_17', 0)), css(organColour('wall_17', 3)));
    const names = ['uterus', 'tubes', 'ovaries', 'ligaments', 'liver', 'kidney', 'spleen', 'heart', 'lung', 'brain', 'artery', 'vein', 'wall_17', 'thing'];
    const seen = new Set(names.map((name) => css(organColour(name, 0))));
    assert.equal(seen.size, names.length);
    assert.notEqual(css(organColour('', 0)), css(organColour('', 1)), 'without names, by their order');
});

test('numbers are written with three digits and a unit', () => {
    const { withUnit } = parts.dom;
    assert.equal(withUnit(0.00342, 'm'), '3.42 mm');
    assert.equal(withUnit(-1250, 'Pa'), '−1.25 kPa');
    assert.equal(withUnit(0, 'Pa'), '0 Pa');
    assert.equal(withUnit(999.9, 'Pa'), '1.00 kPa');
    assert.equal(withUnit(1.31e-9, 'N'), '1.31 nN');
});

test('numbers of one kind share a unit and places, whatever the size of the body', () => {
    const { scaleFor } = parts.dom;
    const says = (value, largest, unit) => `${scaleFor(largest, unit).text(value)} ${scaleFor(largest, unit).unit}`;
    assert.equal(says(0, 0.2, 'N'), '0.000 N');
    assert.equal(says(1.306, 5, 'N'), '1.31 N');
    assert.equal(says(1.31e-6, 2e-6, 'N'), '1.31 µN');
    assert.equal(says(4e-10, 5e-9, 'N'), '0.40 nN');
    assert.equal(says(13, 200, 'N'), '13 N');
    assert.equal(scaleFor(0.02, 'N').short(0.02), '20');
    const { placeText } = parts.measurecard;
    assert.equal(placeText([0.0123, -0.2, 0], 0.35), '12.30, −200.00, 0.00 mm');
    assert.equal(placeText([4e-5, 1.25e-6, 0], 69e-6), '40.00, 1.25, 0.00 µm');
});

test('the range of a resting organ has a floor, so that rounding is not spread over all colours', () => {
    const { follow, floorOf, forceFloor } = parts.range;
    assert.deepEqual(['m', 'Pa', 'J/m³', ''].map((unit) => floorOf(unit, 0.35)), [1e-4, 1, 0.01, 0]);
    assert.equal(floorOf('m', 69e-6), 2e-8, 'that of a length is a part of the body');
    const body = (size, ...moduli) => ({ lower: [0, 0, 0], upper: [size, 0, 0], materials: moduli.map((shear_modulus) => ({ shear_modulus })) });
    assert.equal(forceFloor(body(0.35, 4e3)), 0.2);
    assert.equal(forceFloor(body(69e-6, 9e9, 2e3)), 5e-9);
    assert.equal(forceFloor(body(1, 8e10)), 0.2);
    const still = { min: 0, max: 0 };
    assert.deepEqual(follow(still, 3e-19, 4e-18, 1e-4, false), { min: 0, max: 1e-4 });
    assert.deepEqual(follow(still, -2e-9, 1e-9, 1, true), { min: -1, max: 1 });
    assert.deepEqual(follow(still, 0, 250, 1, false), { min: 0, max: 250 });
    assert.deepEqual(follow(still, -250, 100, 1, true), { min: -250, max: 250 });
    // Downwards slowly, and never below the floor.
    let range = { min: 0, max: 250 };
    range = follow(range, 0, 0, 1, false);
    assert.ok(range.max < 250 && range.max > 230);
    for (let i = 0; i < 500; i++) range = follow(range, 0, 0, 1, false);
    assert.ok(Math.abs(range.max - 1) < 1e-6, `${range.max}`);
});

test('messages of a wrong length are refused', () => {
    const message = new ArrayBuffer(72);
    new DataView(message).setUint32(4, 5, true);
    assert.throws(() => parts.protocol.readFrame(message, parts.protocol.emptyFrame()), /wrong length/);
    assert.throws(() => parts.protocol.readSurface(new ArrayBuffer(20)), /wrong length/);
    assert.throws(() => parts.protocol.readEmbedded(new Uint32Array([4, 1, 1, 1, 0, 0]).buffer), /wrong length/);
});

test('times are written in milliseconds, and slow motion is never faster than asked for', () => {
    const { span, slowness } = parts.panel;
    assert.deepEqual([21, 99.95, 231, 1520, 99920, null].map(span), ['21.0 µs', '0.10 ms', '0.23 ms', '1.52 ms', '99.9 ms', '–']);
    assert.equal(slowness({ pace: 1, real_time_factor_now: 0.82 }), '0.82 × real time');
    assert.equal(slowness({ pace: 1, real_time_factor_now: null }), '', 'not known yet');
    assert.equal(slowness({ pace: 1, real_time_factor_now: 1.01 }), null, 'it catches up');
    assert.equal(slowness({ pace: 0.5, real_time_factor_now: 0.499 }), null);
});

test('the badge says real time only where it is', () => {
    const { playing } = parts.panel;
    const at = (pace, factor) => playing({ pace, real_time_factor_now: factor });
    assert.deepEqual(at(1, 1), { text: 'real time', slow: false });
    assert.deepEqual(at(1, 0.98), { text: 'real time', slow: false });
    assert.deepEqual(at(1, 0), { text: 'real time', slow: false }); // not known yet
    assert.deepEqual(at(1, 0.82), { text: '0.82 × real time', slow: true });
    assert.deepEqual(at(0.1, 0.1), { text: '0.1 × real time, as asked for', slow: false });
    assert.deepEqual(at(0.1, 0.05), { text: '0.05 × real time', slow: true });
    assert.equal(at(0, 0.3).slow, false);
});

test('the first look is from where the scene says, or from low y', () => {
    globalThis.matchMedia = () => ({ matches: false });
    const endoscope = new parts.camera.Endoscope();
    const look = (...view) => {
        endoscope.frame([1, 2, 3], 1, ...view);
        endoscope.update(0);
        const { x, y, z } = endoscope.camera.position;
        return [x - 1, y - 2, z - 3.05].map((v) => v / endoscope.distance);
    };
    const near = (got, wanted) => got.forEach((v, i) => assert.ok(Math.abs(v - wanted[i]) < 2e-3, `${got}`));
    near(look(), [-0.14, -0.925, 0.352]);
    near(look([0, 0.8, 0.6]), [0, 0.8, 0.6]);
    near(look([-0.6, 0, -0.8]), [-0.6, 0, -0.8]);
    near(look([0, 0, 1]), [0, -Math.cos(1.5), Math.sin(1.5)]);
    endoscope.turn(1, 0.3);
    endoscope.reset(true);
    endoscope.update(0);
    assert.ok(Math.abs(endoscope.camera.position.x - 1) < 1e-6);
    delete globalThis.matchMedia;
});

test('the organ is placed where cards and bars leave room, and all of it is there', () => {
    const { freePart } = parts.freepart;
    const covers = [{ left: 750, top: 0, right: 1000, bottom: 570 }, { left: 380, top: 570, right: 980, bottom: 626 }, { left: 18, top: 400, right: 268, bottom: 626 }];
    const free = freePart(1000, 640, covers);
    assert.deepEqual(free, { left: 274, top: 0, right: 744, bottom: 564 });
    assert.deepEqual(freePart(300, 300, [{ left: 0, top: 20, right: 300, bottom: 280 }]), { left: 0, top: 0, right: 300, bottom: 300 }, 'nothing is free: the window');
    globalThis.matchMedia = () => ({ matches: false });
    for (const view of [[-0.14, -0.925, 0.352], [0, 0.8, 0.6], [0.6, 0, -0.8]]) {
        const endoscope = new parts.camera.Endoscope();
        const half = [0.05, 0.02, 0.01];
        endoscope.resize(1000, 640, free);
        endoscope.frame([1, 2, 3], Math.hypot(...half), view, half);
        endoscope.update(0);
        const { camera } = endoscope;
        const matrix = camera.projectionMatrix.clone().multiply(camera.matrixWorld.clone().invert()).elements;
        const pixel = (p) => {
            const [x, y, , w] = [0, 1, 2, 3].map((row) => matrix[row] * p[0] + matrix[4 + row] * p[1] + matrix[8 + row] * p[2] + matrix[12 + row]);
            return [500 * (1 + x / w), 320 * (1 - y / w)];
        };
        const corners = Array.from({ length: 8 }, (_, c) => pixel([1, 2, 3].map((v, k) => v + (c & (1 << k) ? half[k] : -half[k]))));
        for (const [x, y] of corners) assert.ok(x > free.left && x < free.right && y > free.top && y < free.bottom, `${x}, ${y}`);
        const wide = Math.max(...corners.map(([x]) => x)) - Math.min(...corners.map(([x]) => x));
        const high = Math.max(...corners.map(([, y]) => y)) - Math.min(...corners.map(([, y]) => y));
        assert.ok(wide > 0.7 * 470 || high > 0.7 * 564, `it fills the part: ${wide} x ${high}`);
    }
    delete globalThis.matchMedia;
});

test('a tool says its force, its limit, and when that is reached', () => {
    const { load } = parts.toolcard;
    const rest = { force: [0, 0, 0], limit: 4.39, depth: 0, limited: false, grasp: 0 };
    assert.equal(load(rest), '0.00 of 4.39 N');
    assert.equal(load({ ...rest, force: [3, 0, 4], depth: 0.00112, limited: true }),
        '5.00 of 4.39 N, 1.12 mm deep, limit reached');
    assert.equal(load({ ...rest, force: [0.3, 0, 0.4], limit: 0 }), '0.500 N');
    assert.equal(load({ ...rest, force: [1e-6, 0, 0], limit: 2e-6 }), '1.00 of 2.00 µN');
    assert.equal(load({ ...rest, grasp: 0.126, depth: 0.0004 }), '0.00 of 4.39 N, grasp 0.13 N, 400 µm deep');
});

test('bins of times begin where the engine says, and decades hold what is plotted', () => {
    const { binStart, binAt, shownBins, decades } = parts.plots;
    for (let bin = 0; bin < 40; bin++) {
        assert.ok(Math.abs(binStart(bin) - 1.024e-6 * 2 ** (bin >> 1) * (bin & 1 ? 1.5 : 1)) < 1e-18);
        assert.ok(Math.abs(binAt(binStart(bin)) - bin) < 1e-9);
    }
    assert.ok(binAt(1e-3) > 19 && binAt(1e-3) < 20);
    const bins = Array.from({ length: 40 }, (_, i) => (i === 15 ? 10 : 0));
    assert.deepEqual(shownBins(bins, binAt(1e-3)), [14, 22]);
    assert.deepEqual(decades([2e-3, 5e-5, 0]), [-5, -2]);
    assert.deepEqual(decades([1e-3, 1e-15]), [-9, -3]);
    assert.deepEqual(decades([]), [-6, -3]);
});

test('a slice reaches half a pixel beyond the centres of its outer pixels', () => {
    const corners = parts.scan.cornersOf({ corner: [1, 2, 3], across: [0.5, 0, 0], down: [0, 0, 2], width: 4, height: 3 });
    assert.deepEqual([...corners], [0.75, 2, 2, 2.75, 2, 2, 2.75, 2, 8, 0.75, 2, 8]);
    assert.throws(() => parts.protocol.readSlice(new Uint32Array(20).fill(5).buffer), /wrong length/);
});

test('a picture is named after the scene and its step', () => {
    const { fileName } = parts.capture;
    assert.equal(fileName('Uterus', 12000, 'png'), 'uterus-12000.png');
    assert.equal(fileName(' Left kidney (CT) ', 0, 'webm'), 'left-kidney-ct-0.webm');
    assert.equal(fileName('', 7, 'png'), 'lariat-7.png');
});

test('a distance is told with what it was at rest', () => {
    const { distanceText } = parts.measurecard;
    assert.equal(distanceText(0.0312, 0.03), '31.2 mm now, 30.0 mm at rest (+4.0 %)');
    assert.equal(distanceText(0.027, 0.03), '27.0 mm now, 30.0 mm at rest (−10.0 %)');
    assert.equal(distanceText(0.01, 0), '10.0 mm now, 0 m at rest (+0.0 %)');
});

test('the panel says into how many parts steps are divided', () => {
    assert.equal(parts.panel.division(1), 'none');
    assert.equal(parts.panel.division(4), 'step divided by 4');
});

test('sliders of the body: what they say is what they show, and nothing is lost on the way', () => {
    const { dampingAt, placeOfDamping, factorAt, placeOfFactor, directionOf } = parts.bodycard;
    assert.equal(dampingAt(0, 200), 0);
    assert.equal(dampingAt(1, 200), 200);
    for (const damping of [0, 0.5, 4, 33, 200]) assert.equal(dampingAt(placeOfDamping(damping, 200), 200), damping);
    assert.equal(placeOfDamping(900, 200), 1);
    assert.equal(factorAt(0, 0.1, 4), 0.1);
    assert.equal(factorAt(1, 0.1, 4), 4);
    for (const factor of [0.1, 0.25, 1, 1.5, 4]) assert.equal(factorAt(placeOfFactor(factor, 0.1, 4), 0.1, 4), factor);
    assert.equal(factorAt(placeOfFactor(1.02, 0.1, 4), 0.1, 4), 1, 'near 1 is 1');
    assert.equal(directionOf([0, 0, -3], [0, 0, -9.81]), '-z');
    assert.equal(directionOf([0, 2, 0], [0, 0, -9.81]), '+y');
    assert.equal(directionOf([0, 0, 0], [0, 0, -9.81]), 'off');
    assert.equal(directionOf([1, 0, -1], [2, 0, -2]), 'scene');
    assert.equal(directionOf([1, 0, -1], [0, 0, -2]), 'other');
    assert.equal(directionOf([1, 0, -1], [0, 0, 0]), 'other');
});

test('a comma is a decimal point, and what may be two numbers is none', () => {
    const { decimal } = parts.dom;
    for (const [text, value] of [['1,5', 1.5], ['1.5', 1.5], [' 12 ', 12], ['-0,25', -0.25], [',5', 0.5], ['0,125', 0.125], ['1e-3', 1e-3], ['1.250', 1.25], ['2000000', 2e6], ['1,2500', 1.25]])
        assert.equal(decimal(text), value, text);
    for (const text of ['', '1,250', '-12,500', '1.000,5', '1,2,3', '1 5', 'five', '0x10', 'Infinity', '1e400', '.', ','])
        assert.ok(Number.isNaN(decimal(text)), text);
});

test('sizes of tools fit the body, and what is no size is said', () => {
    const { usual, fault, longestEdge, namedSize } = parts.addtool;
    assert.deepEqual(usual('sphere', 0.2, 0.005), { radius: 0.006, length: 0 });
    assert.deepEqual(usual('capsule', 0.2, 0.005), { radius: 0.004, length: 0.1 });
    assert.deepEqual(usual('grasper', 0.2, 0.005), { radius: 0.002, length: 0.02 });
    // Large faces would not feel what is thinner than a part of their edges, and half the body is too thick.
    for (const shape of ['sphere', 'capsule', 'grasper'])
        for (const [size, edge] of [[0.2, 0.1], [1.73, 1], [0.02, 0.0133], [69e-6, 4e-5]]) {
            const { radius } = usual(shape, size, edge);
            assert.ok(radius > (1.1 * edge * Math.SQRT1_2) / 6 && radius < 0.5 * size, `${shape} in ${size}: ${radius}`);
        }
    const { x, quads } = cube(4, false);
    assert.ok(Math.abs(longestEdge({ rest: x, faces: quads }) - 0.5) < 1e-6);
    assert.deepEqual(namedSize('a radius of 0.2 mm is too thin: large faces of this body would not feel the tool everywhere; give it 1.24 mm or more'),
        { what: 'radius', size: 1.24 / 1000 });
    assert.deepEqual(namedSize('a length of 2000 mm is too large for a body that is 200 mm across; give the tool 990 mm at most'),
        { what: 'length', size: 0.99 });
    assert.equal(namedSize('no place is left'), null);
    assert.equal(fault('radius', 0.1, 'mm'), '');
    assert.match(fault('radius', 0, 'mm'), /more than zero/);
    assert.match(fault('length', -1, 'mm'), /length must be more/);
    assert.match(fault('length', NaN, 'µm'), /in µm/);
});
