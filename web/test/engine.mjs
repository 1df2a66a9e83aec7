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
    writeFileSync(torn, `${text}\nload: [ { nodes: fundus, force: [0, 0, 40], over: 4 } ]\n`);
    return torn;
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
