// `lariat view` as its own process, on a free port of this machine, with a scene of the demonstration.
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { OUT } from './browser.mjs';

const LARIAT = process.env.LARIAT ?? '../build/lariat';
const engines = new Set();
process.on('exit', endAll);

/* Those that a failed test has left: without this they would keep the process alive. */
export function endAll() {
    engines.forEach((child) => child.kill('SIGKILL'));
}

/* A folder of its own with the demonstration organ. */
export function demo() {
    const folder = mkdtempSync(join(OUT, 'demo-'));
    const made = spawnSync(LARIAT, ['demo-model', folder], { encoding: 'utf8' });
    if (made.status !== 0) throw new Error(made.stderr);
    return { folder, scene: join(folder, 'uterus_live.yaml'), saved: join(folder, 'saved') };
}

/* The same organ torn by a force that no tissue bears, after a second or so: what comes before can be
 * seen, also when it is reset. */
export function tornDemo({ folder, scene }) {
    const torn = join(folder, 'torn.yaml');
    const text = readFileSync(scene, 'utf8').replace(/^load:[\s\S]*?(?=^\S)/m, '');
    writeFileSync(torn, `${text}\nload: [ { nodes: fundus, force: [0, 0, 40000], over: 1 } ]\n`);
    return torn;
}

/* A coarse block with an embedded ball that stands off its faces: 4 x 4 x 4 elements of 20 mm, held
 * below, and 2 n (n - 1) triangles. */
export function rider(n = 40) {
    const folder = mkdtempSync(join(OUT, 'rider-'));
    const nodes = [];
    const elements = [];
    const node = (i, j, k) => 1 + i + 5 * (j + 5 * k);
    for (let k = 0; k < 5; k++)
        for (let j = 0; j < 5; j++)
            for (let i = 0; i < 5; i++) nodes.push([node(i, j, k), 0.02 * (i - 2), 0.02 * (j - 2), 0.02 * k].join(', '));
    for (let k = 0; k < 4; k++)
        for (let j = 0; j < 4; j++)
            for (let i = 0; i < 4; i++)
                elements.push([elements.length + 1, ...[k, k + 1].flatMap((l) =>
                    [node(i, j, l), node(i + 1, j, l), node(i + 1, j + 1, l), node(i, j + 1, l)])].join(', '));
    writeFileSync(join(folder, 'block.inp'), `*NODE\n${nodes.join('\n')}\n*ELEMENT, TYPE=C3D8\n${elements.join('\n')}\n`);
    const ball = [];
    for (let row = 1; row < n; row++)
        for (let column = 0; column < 2 * n; column++) {
            const [a, b] = [(Math.PI * row) / n, (Math.PI * column) / n];
            const p = [Math.sin(a) * Math.cos(b), Math.sin(a) * Math.sin(b), Math.cos(a)];
            ball.push(`v ${p.map((v) => (48 * v).toFixed(4)).join(' ')}`);
        }
    ball.push('v 0 0 48', 'v 0 0 -48');
    const at = (row, column) => (row - 1) * 2 * n + (column % (2 * n)) + 1;
    for (let column = 0; column < 2 * n; column++) {
        ball.push(`f ${2 * n * (n - 1) + 1} ${at(1, column)} ${at(1, column + 1)}`);
        for (let row = 1; row < n - 1; row++)
            ball.push(`f ${at(row, column)} ${at(row + 1, column)} ${at(row + 1, column + 1)} ${at(row, column + 1)}`);
        ball.push(`f ${at(n - 1, column)} ${2 * n * (n - 1) + 2} ${at(n - 1, column + 1)}`);
    }
    writeFileSync(join(folder, 'ball.obj'), `${ball.map((line) => line.replace(/^v (\S+) (\S+) (\S+)$/, (_, x, y, z) => `v ${x} ${y} ${Number(z) + 40}`)).join('\n')}\n`);
    const scene = join(folder, 'rider.yaml');
    writeFileSync(scene, [
        'lariat: 1', 'title: Rider', 'mesh: block.inp', 'surface: { file: ball.obj, scale: 0.001 }', 'damping: 20',
        'materials: [ { cells: all, law: neo-hookean, density: 1050, shear_modulus: 2.0e3, bulk_modulus: 2.0e5 } ]',
        'fix: [ { nodes: { plane: { point: [0, 0, 0], normal: [0, 0, 1] } }, axes: xyz } ]', ''].join('\n'));
    return scene;
}

/* A scan of an ellipsoid in voxels of 2 mm, and the scene that `lariat mesh` makes of it. */
export function scanned() {
    const folder = mkdtempSync(join(OUT, 'scan-'));
    const image = join(folder, 'liver.nrrd');
    const lines = ['NRRD0004', 'type: uchar', 'dimension: 3', 'space: right-anterior-superior', 'sizes: 24 20 16', 'encoding: text',
        'space directions: (2,0,0) (0,2,0) (0,0,2)', 'space origin: (-23,-19,-15)', 'Segment0_LabelValue:=1', 'Segment0_Name:=liver', ''];
    for (let k = 0; k < 16; k++)
        for (let j = 0; j < 20; j++)
            for (let i = 0; i < 24; i++)
                lines.push(((i - 11.5) / 10) ** 2 + ((j - 9.5) / 8) ** 2 + ((k - 7.5) / 6) ** 2 < 1 ? 1 : 0);
    writeFileSync(image, `${lines.join('\n')}\n`);
    const made = spawnSync(LARIAT, ['mesh', image, '--elements', '300', '--out', join(folder, 'mesh'), '--title', 'liver'], { encoding: 'utf8' });
    if (made.status !== 0) throw new Error(made.stderr);
    return { image, scene: join(folder, 'mesh', 'liver.yaml') };
}

/* Starts the engine and waits until it serves. */
export function view(scene, ...options) {
    const child = spawn(LARIAT, ['view', scene, ...options], { stdio: ['ignore', 'pipe', 'pipe'] });
    engines.add(child);
    const ended = new Promise((resolve) => child.on('exit', resolve));
    ended.then(() => engines.delete(child));
    let said = '';
    child.stderr.on('data', (data) => (said += data));
    return new Promise((resolve, reject) => {
        child.stdout.on('data', (data) => {
            said += data;
            const url = /http:\/\/\S+/.exec(said)?.[0];
            if (!url) return;
            resolve({
                url,
                port: Number(new URL(url).port),
                said: () => said,
                end: (signal = 'SIGINT') => (child.kill(signal), ended),
            });
        });
        ended.then((status) => reject(new Error(`lariat view ended with ${status}: ${said}`)));
    });
}
