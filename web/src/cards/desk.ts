/* What of the page covers the picture; and, in narrow windows, the button that all cards are folded into. */
import { element } from '../dom';
import type { Box } from '../picture/freepart';

const COVERING = ['transport', 'force']; // and the title, and the column of cards

/* Boxes of what is always there, in pixels. The column of cards counts down to its end, also while cards are
 * folded: the picture stays where it is when one is unfolded. */
export function covers(): Box[] {
    const boxes = COVERING.map((id) => element(id).getBoundingClientRect());
    const title = document.querySelector('header')!.getBoundingClientRect();
    const column = element('looks').getBoundingClientRect();
    const shown = column.width > 0 && !isNarrow();
    return [
        ...boxes,
        { left: 0, top: 0, right: title.right, bottom: title.bottom },
        ...(shown ? [{ left: column.left, top: 0, right: innerWidth, bottom: boxes[0]!.top }] : []),
    ].filter((box) => box.right > box.left && box.bottom > box.top);
}

/* In windows that are no wider the cards are behind one button: it is shown there. */
const isNarrow = (): boolean => element('cards').offsetWidth > 0;

/* In a narrow window cards are shown when one is asked for by a key or a press; in others they are there. */
export function showCards(yes = true): void {
    if (!isNarrow()) return;
    element('desk').classList.toggle('unfolded', yes);
    element('cards').setAttribute('aria-expanded', String(yes));
}

export class Desk {
    /* `changed`: what covers the picture does so otherwise. */
    constructor(changed: () => void) {
        element('cards').onclick = () => showCards(!this.shown);
        element('looks').addEventListener('toggle', (event) => this.toggled(event.target as HTMLDetailsElement), true);
        const observer = new ResizeObserver(changed);
        for (const id of [...COVERING, 'looks']) observer.observe(element(id));
        observer.observe(document.querySelector('header')!);
    }

    private get shown(): boolean {
        return element('desk').classList.contains('unfolded');
    }

    /* A key that unfolds a card shows it. */
    private toggled(card: HTMLDetailsElement): void {
        if (!card.open || this.shown || performance.now() < FIRST_MS) return;
        showCards();
        card.scrollIntoView({ block: 'nearest' });
    }
}

const FIRST_MS = 1000; // cards that are open to begin with say so, too
