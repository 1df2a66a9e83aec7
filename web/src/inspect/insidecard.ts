/* Looking inside: organs that are faded or hidden, and a cut. Only this page's picture changes. */
import { element, withUnit, write } from '../dom';
import { css, organColour } from '../picture/palette';
import type { Seen } from '../picture/organ';
import type { Hello } from '../link/protocol';
import type { View } from '../picture/view';
import type { Across } from './cut';

const NEXT: Record<Seen, Seen> = { shown: 'faded', faded: 'hidden', hidden: 'shown' };
const DIRECTIONS: Across[] = ['x', 'y', 'z', 'eye'];

export class InsideCard {
    private names: string[] = [];
    private seen: Seen[] = [];
    private readonly card = element<HTMLDetailsElement>('inside');
    private readonly list = element('organs');
    private readonly all = element<HTMLButtonElement>('organs-all');
    private readonly on = element<HTMLInputElement>('cut');
    private readonly across = element<HTMLSelectElement>('cut-across');
    private readonly place = element<HTMLInputElement>('cut-place');
    private readonly other = element<HTMLInputElement>('cut-other');

    constructor(
        private readonly view: View,
        private readonly say: (text: string) => void,
    ) {
        this.on.addEventListener('change', () => this.renew());
        this.place.addEventListener('input', () => this.renew());
        this.other.addEventListener('change', () => this.renew());
        this.across.addEventListener('change', () => this.turn(this.across.value as Across));
        this.all.onclick = () => this.showAll();
    }

    setHello(hello: Hello): void {
        const names = hello.materials.map((material, i) => material.name || `organ ${i + 1}`);
        if (names.join() !== this.names.join()) this.seen = names.map(() => 'shown');
        this.names = names;
        this.list.replaceChildren(...names.map((name, i) => this.entry(name, i)));
        element('organs-part').hidden = names.length < 2;
        this.apply();
    }

    /* Fades the organ in the middle of the picture, then hides it. */
    fadeMiddle(): void {
        const hit = this.view.middle(true);
        if (!hit) return this.say('Nothing in the middle of the picture.');
        const region = this.view.regionOf(hit);
        this.next(region);
        this.say(`${this.names[region]}: ${this.seen[region]}`);
    }

    showAll(): void {
        this.seen.fill('shown');
        this.apply();
    }

    toggleCut(): void {
        this.on.checked = !this.on.checked;
        if (this.on.checked) this.card.open = true;
        this.renew();
    }

    nextDirection(): void {
        this.turn(DIRECTIONS[(DIRECTIONS.indexOf(this.view.cut.across) + 1) % DIRECTIONS.length]!);
    }

    moveCut(by: number): void {
        if (!this.on.checked) return this.say('There is no cut: K makes one.');
        this.place.value = String(this.place.valueAsNumber + by);
        this.renew();
    }

    private turn(across: Across): void {
        const { camera } = this.view.endoscope;
        const eye = camera.getWorldDirection(camera.position.clone()).negate();
        this.view.cut.choose(across, eye);
        this.across.value = across;
        this.renew();
    }

    private renew(): void {
        const { cut } = this.view;
        cut.on = this.on.checked;
        cut.share = this.place.valueAsNumber;
        cut.other = this.other.checked;
        cut.renew();
        element('cut-part').hidden = !cut.on;
        const of = cut.across === 'eye' ? 'towards the eye' : cut.across;
        write(element('cut-text'), `${of} ${cut.other ? 'above' : 'below'} ${withUnit(cut.place, 'm')}`);
        this.view.changed();
    }

    private entry(name: string, region: number): HTMLElement {
        const button = document.createElement('button');
        button.type = 'button';
        button.className = 'choice organ';
        const patch = document.createElement('canvas');
        patch.style.background = css(organColour(name, region));
        const state = document.createElement('span');
        button.append(patch, name, state);
        button.addEventListener('click', () => this.next(region));
        return button;
    }

    private next(region: number): void {
        this.seen[region] = NEXT[this.seen[region]!];
        this.apply();
    }

    private apply(): void {
        [...this.list.children].forEach((entry, i) => {
            write(entry.querySelector('span')!, this.seen[i]!);
            entry.setAttribute('aria-label', `${this.names[i]}: ${this.seen[i]}`);
            entry.classList.toggle('dim', this.seen[i] !== 'shown');
        });
        this.all.disabled = this.seen.every((seen) => seen === 'shown');
        this.view.see((region) => this.seen[region] ?? 'shown');
    }
}
