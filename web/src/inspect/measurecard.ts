/* What a press on the organ does: pull it, read the values there, or set one end of a distance. Values come
 * from the engine, for the node of the mesh and the element that are nearest; distances are the picture's. */
import * as THREE from 'three';
import { check, radios } from '../cards/colours';
import { showCards } from '../cards/desk';
import { element, scaleFor, withUnit, write } from '../dom';
import { follow, nearestNode, type Hit } from '../hands/pick';
import { sizeOfBody, type Hello, type Read, type Values } from '../link/protocol';
import type { Session } from '../link/session';
import type { View } from '../picture/view';

export type Press = 'pull' | 'read' | 'distance';
const PRESSES: Press[] = ['pull', 'read', 'distance'];
const TITLES = ['pull it', 'read values', 'measure a distance'];
const HOW: Record<Press, string> = {
    pull: 'A press on the organ pulls it.',
    read: 'Press on the organ to read its values there; Enter reads in the middle of the picture.',
    distance: 'Press on the organ at two places; Enter takes the middle of the picture.',
};

const PLACES_OF_SIZE = 40; // three digits of that part of the body

type Row = [name: string, value: string];

/* Values of a node or an element, as rows of a table. */
export function rowsOf(read: Read): Row[] {
    return [
        ['von Mises', read.von_mises === null ? '–' : withUnit(read.von_mises, 'Pa')],
        ['pressure', read.pressure === null ? '–' : withUnit(read.pressure, 'Pa')],
        ['energy', read.energy === null ? '–' : withUnit(read.energy, 'J/m³')],
    ];
}

/* A place in a body of that size [m]. */
export function placeText(place: readonly number[], size: number): string {
    const { text, unit } = scaleFor(size / PLACES_OF_SIZE, 'm');
    return `${place.map(text).join(', ')} ${unit}`;
}

/* A distance now, and what it was at rest. */
export function distanceText(now: number, rest: number): string {
    const change = rest > 0 ? (100 * (now - rest)) / rest : 0;
    const sign = change < 0 ? '−' : '+';
    return `${withUnit(now, 'm')} now, ${withUnit(rest, 'm')} at rest (${sign}${Math.abs(change).toFixed(1)} %)`;
}

export class MeasureCard {
    press: Press = 'pull';
    distance = 0; // between the two ends [m]; 0: there are not two
    node = -1; // that is read, and its element, by their numbers in the mesh's file
    elementNumber = -1;
    private ends: Hit[] = [];
    private marked: Press = 'read'; // which of both is marked: what was done last
    private asked: { node: number; face: number } | null = null;
    private hello: Hello | null = null;
    private readonly card = element<HTMLDetailsElement>('measure');
    private readonly list = element('press');
    private readonly rows = element('reading');
    private readonly points = [new THREE.Vector3(), new THREE.Vector3()];
    private readonly nodePlace = new THREE.Vector3();
    private nextText = 0;

    constructor(
        private readonly session: Session,
        private readonly view: View,
        private readonly say: (text: string) => void,
    ) {
        radios(this.list, TITLES, (i) => this.choose(PRESSES[i]!));
        check(this.list, 0);
        element('measure-clear').onclick = () => this.clear();
    }

    setHello(hello: Hello): void {
        this.hello = hello;
        this.clear();
    }

    /* A key: to this, or back to pulling. */
    toggle(press: Press): void {
        this.choose(this.press === press ? 'pull' : press);
        this.card.open ||= this.press !== 'pull';
    }

    choose(press: Press): void {
        this.press = press;
        check(this.list, PRESSES.indexOf(press));
        this.say(HOW[press]);
    }

    /* The middle of the picture, for the keyboard. */
    pressMiddle(): void {
        if (this.press === 'pull') return;
        const hit = this.view.middle();
        if (hit) this.take(hit);
        else this.say('Nothing in the middle of the picture.');
    }

    take(hit: Hit): void {
        showCards();
        this.card.open = true;
        this.card.scrollIntoView({ block: 'nearest' });
        this.marked = this.press;
        if (this.press === 'read') {
            this.asked = this.view.nodeAt(hit.point);
            this.session.inspected = this.asked;
        } else {
            if (this.ends.length === 2) this.ends = [];
            this.ends.push(hit);
        }
        this.nextText = 0;
    }

    clear(): void {
        this.ends = [];
        this.asked = this.session.inspected = null;
        this.node = this.elementNumber = -1;
        this.distance = 0;
        this.rows.replaceChildren();
        write(element('distance'), '');
        this.view.marks.show([]);
        this.view.changed();
    }

    /* Another surface is drawn: ends go on at its nearest nodes. */
    surfaceChanged(): void {
        const surface = this.view.surface;
        if (surface) this.ends = this.ends.map((_, i) => nearestNode(surface, this.points[i]!));
    }

    values(values: Values): void {
        const { node, element: part } = values;
        if (!this.asked || !node || !part) return;
        const material = this.hello?.materials[part.material];
        this.node = node.number;
        this.elementNumber = part.number;
        this.table([
            [`node ${node.number}`, ''],
            ...rowsOf(node),
            ['displacement', withUnit(Math.hypot(...node.displacement), 'm')],
            ['at rest', placeText(node.rest, this.hello ? sizeOfBody(this.hello) : 1)],
            [`element ${part.number}`, ''],
            ...rowsOf(part),
            ['organ', material?.name || `${part.material + 1}`],
            ['law', material?.law ?? ''],
            ['shear modulus', material ? withUnit(material.shear_modulus, 'Pa') : ''],
        ]);
    }

    /* Once per animation frame: marks stay on the tissue. */
    update(now: number): void {
        const surface = this.view.surface;
        if (!surface || (!this.ends.length && !this.asked)) return;
        const shown = this.ends.map((end, i) => {
            follow(surface, end, this.points[i]!);
            return this.points[i]!;
        });
        let marks = shown;
        if (this.marked === 'read' && this.asked) {
            this.view.placeOf(this.asked.node, this.nodePlace);
            marks = [this.nodePlace];
        }
        if (this.view.marks.show(marks)) this.view.changed();
        if (now < this.nextText) return;
        this.nextText = now + 100;
        this.distance = shown.length === 2 ? shown[0]!.distanceTo(shown[1]!) : 0;
        if (shown.length) write(element('distance'), this.distance ? distanceText(this.distance, this.atRest()) : 'One end is set.');
    }

    private atRest(): number {
        const { rest } = this.view.surface!;
        const [a, b] = this.ends.map((end) => [0, 1, 2].map((axis) =>
            end.corners.reduce((sum, corner, k) => sum + end.weights[k]! * rest[3 * corner + axis]!, 0)));
        return Math.hypot(...a!.map((x, axis) => x - b![axis]!));
    }

    private table(rows: Row[]): void {
        while (this.rows.children.length > rows.length) this.rows.lastElementChild!.remove();
        rows.forEach(([name, value], i) => {
            let row = this.rows.children[i];
            if (!row) {
                row = document.createElement('tr');
                const head = document.createElement('th');
                head.scope = 'row';
                row.append(head, document.createElement('td'));
                this.rows.append(row);
            }
            write(row.children[0]!, name);
            write(row.children[1]!, value);
            row.classList.toggle('head', value === '');
        });
    }
}
