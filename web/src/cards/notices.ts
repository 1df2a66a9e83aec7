/* Words for the user: hints of the first minute, short notes, and trouble with what to do about it. */
import { element, write } from '../dom';

const NOTE_MS = 4500;

export function note(text: string, ms = NOTE_MS): void {
    const list = element('notes');
    if (list.lastElementChild?.textContent === text) return;
    const line = document.createElement('p');
    line.textContent = text;
    list.append(line);
    while (list.children.length > 3) list.firstElementChild!.remove();
    setTimeout(() => line.remove(), ms);
}

/* One after the other, each until the user has done it. */
export class Hints {
    private readonly done = new Set<string>();
    private silent = true;
    private readonly touch = matchMedia('(pointer: coarse)').matches;
    private readonly steps: [what: string, text: string][] = [
        ['pull', this.touch ? 'Put a finger on the organ and pull' : 'Press on the organ and drag to pull it'],
        ['look', this.touch ? 'Swipe beside it to look around, pinch to zoom' : 'Drag beside it to look around, wheel to zoom'],
    ];

    /* `watches`: who may only watch is not told to pull. */
    start(watches: boolean): void {
        if (watches) this.steps.splice(0, 2, ['look', this.touch ? 'Swipe to look around, pinch to zoom' : 'Drag to look around, wheel to zoom']);
        this.silent = false;
        this.show();
    }

    /* While a recording is played nobody can pull. */
    silence(silent: boolean): void {
        if (silent === this.silent) return;
        this.silent = silent;
        this.show();
    }

    used(what: string): void {
        if (this.done.has(what)) return;
        this.done.add(what);
        // The words stay for as long as the first pull lasts.
        setTimeout(() => this.show(), what === 'pull' ? 1500 : 0);
    }

    private show(): void {
        const next = this.silent ? undefined : this.steps.find(([what]) => !this.done.has(what));
        write(element('hint'), next ? next[1] : '');
    }
}

export interface Way {
    text: string;
    do(): void;
}

/* A panel in the middle, over a greyed picture: what is wrong, why, what to do. */
export class Trouble {
    private readonly panel = element('trouble');
    private readonly picture = element('picture');
    private readonly buttons = [element<HTMLButtonElement>('trouble-do'), element<HTMLButtonElement>('trouble-also')];

    get shown(): boolean {
        return !this.panel.hidden;
    }

    show(title: string, text: string, what: string, ...ways: Way[]): void {
        write(element('trouble-title'), title);
        write(element('trouble-text'), text);
        write(element('trouble-what'), what);
        this.buttons.forEach((button, i) => {
            const way = ways[i];
            button.hidden = !way;
            button.onclick = way ? () => way.do() : null;
            if (way) write(button, way.text);
        });
        const before = this.panel.hidden;
        this.panel.hidden = false;
        this.picture.classList.add('gone');
        if (before && ways.length) this.buttons[0]!.focus({ preventScroll: true });
    }

    hide(): void {
        this.panel.hidden = true;
        this.picture.classList.remove('gone');
    }
}
