/* What the colours show: tissue, or one of the engine's fields with its map, legend, range and unit. */
import { decimal, element, withUnit, write } from '../dom';
import { STEPS, colourMap, css, organColour, processorColour, type MapName, type Rgb } from '../picture/palette';
import { floorOf, follow } from './range';
import { sizeOfBody, type FieldInfo, type Frame, type Hello } from '../link/protocol';
import type { View } from '../picture/view';

const PROCESSOR = 'processor';

export class Colours {
    private fields: FieldInfo[] = [];
    private chosen: FieldInfo | null = null;
    min = 0; // of the range
    max = 0;
    private hello: Hello | null = null;
    private readonly list = element('fields');
    private readonly legend = element('legend');
    private readonly auto = element<HTMLInputElement>('auto');
    private readonly fixedMin = element<HTMLInputElement>('fixed-least');
    private readonly fixedMax = element<HTMLInputElement>('fixed-most');

    constructor(
        private readonly view: View,
        private readonly ask: (field: string) => void,
    ) {
        this.auto.addEventListener('change', () => this.fix());
        this.fixedMin.addEventListener('input', () => this.applyFixed());
        this.fixedMax.addEventListener('input', () => this.applyFixed());
    }

    get name(): string {
        return this.chosen?.name ?? 'none';
    }

    setHello(hello: Hello): void {
        const before = this.name;
        this.hello = hello;
        this.fields = hello.fields;
        const choices = ['tissue', ...hello.fields.map((field) => field.title)];
        radios(this.list, choices, (i) => this.choose(i));
        this.choose(Math.max(0, this.fields.findIndex((field) => field.name === before) + 1));
    }

    /* 0: tissue, then the fields in their order. */
    choose(index: number): void {
        if (index > this.fields.length) return;
        this.chosen = index === 0 ? null : this.fields[index - 1]!;
        check(this.list, index);
        const processors = this.name === PROCESSOR;
        this.legend.hidden = this.chosen === null || processors;
        this.view.showProcessors(processors);
        this.colourKeys();
        if (!this.chosen) this.view.tissue.showTissue();
        if (processors) this.view.tissue.showTints();
        if (!this.legend.hidden) {
            this.min = this.max = 0;
            this.auto.checked = true;
            element('fixed').hidden = true;
            this.paintLegend();
            this.view.tissue.showValues(this.map, 0, 0);
        }
        this.ask(this.chosen && !processors ? this.chosen.name : 'none');
        this.view.changed();
    }

    /* The range follows what is shown. */
    frame(frame: Frame): void {
        if (!this.chosen || this.legend.hidden || frame.field !== this.chosen.number) return;
        if (this.auto.checked)
            Object.assign(this, follow(this, frame.min, frame.max, this.floor, this.map === 'signed'));
        this.view.tissue.showValues(this.map, this.min, this.max);
        this.labels();
    }

    private get floor(): number {
        return floorOf(this.chosen?.unit ?? '', this.hello ? sizeOfBody(this.hello) : 0);
    }

    private get map(): MapName {
        return this.chosen?.name === 'pressure' ? 'signed' : 'rising';
    }

    private fix(): void {
        element('fixed').hidden = this.auto.checked;
        this.fixedMin.value = String(Number(this.min.toPrecision(3)));
        this.fixedMax.value = String(Number(this.max.toPrecision(3)));
    }

    private applyFixed(): void {
        const min = decimal(this.fixedMin.value);
        const max = decimal(this.fixedMax.value);
        if (!(max > min)) return;
        this.min = min;
        this.max = max;
        this.view.tissue.showValues(this.map, min, max);
        this.labels();
        this.view.changed();
    }

    private labels(): void {
        const unit = this.chosen?.unit ?? '';
        write(element('legend-least'), withUnit(this.min, unit));
        write(element('legend-middle'), withUnit((this.min + this.max) / 2, unit));
        write(element('legend-most'), withUnit(this.max, unit));
    }

    private paintLegend(): void {
        const pen = element<HTMLCanvasElement>('legend-map').getContext('2d')!;
        colourMap(this.map).forEach((colour, i) => {
            pen.fillStyle = css(colour);
            pen.fillRect((i * 256) / STEPS, 0, 2, 1);
        });
        this.labels();
    }

    /* Which colour is which organ, or which processor. */
    private colourKeys(): void {
        const list = element('keys-of-colours');
        list.replaceChildren();
        if (!this.hello || (this.chosen && this.name !== PROCESSOR)) return;
        const add = (colour: Rgb, text: string): void => {
            const item = document.createElement('li');
            const patch = document.createElement('canvas');
            patch.style.background = css(colour);
            item.append(patch, text);
            list.append(item);
        };
        if (this.name === PROCESSOR)
            for (let p = 0; p < Math.min(this.hello.processors, 16); p++) add(processorColour(p), String(p));
        else if (this.hello.materials.length > 1)
            this.hello.materials.forEach((material, i) =>
                add(organColour(material.name, i), material.name || `${i + 1}: ${withUnit(material.shear_modulus, 'Pa')}`),
            );
    }
}

/* A group of which one is chosen; arrow keys go from one to the next. */
export function radios(list: HTMLElement, texts: string[], choose: (index: number) => void): void {
    list.replaceChildren(
        ...texts.map((text, i) => {
            const button = document.createElement('button');
            button.type = 'button';
            button.className = 'choice';
            button.setAttribute('role', 'radio');
            button.textContent = text;
            button.addEventListener('click', () => choose(i));
            button.addEventListener('keydown', (event) => {
                const by = { ArrowDown: 1, ArrowRight: 1, ArrowUp: -1, ArrowLeft: -1 }[event.key];
                if (!by) return;
                event.preventDefault();
                event.stopPropagation();
                const next = (i + by + texts.length) % texts.length;
                choose(next);
                (list.children[next] as HTMLElement).focus();
            });
            return button;
        }),
    );
}

export function check(list: HTMLElement, index: number): void {
    [...list.children].forEach((child, i) => {
        child.setAttribute('aria-checked', String(i === index));
        (child as HTMLElement).tabIndex = i === index ? 0 : -1;
    });
}
