/* What was saved: states to go on from, and recordings to play. They outlive the session. */
import { showCards } from './desk';
import { element } from '../dom';
import type { Session } from '../link/session';
import type { Hello, Status } from '../link/protocol';

export class SavedCard {
    private readonly card = element<HTMLDetailsElement>('saved');
    private readonly states = element('saved-states');
    private readonly recordings = element('saved-recordings');
    private shown = '';

    constructor(private readonly session: Session) {}

    setHello(hello: Hello): void {
        this.shown = '';
        this.card.hidden = !hello.saves;
    }

    update(status: Status): void {
        const now = JSON.stringify([status.saved, status.recordings, status.replay?.name]);
        if (now === this.shown) return;
        this.shown = now;
        this.list(this.states, status.saved, 'Go on from', '', (name) => this.session.send({ do: 'load', name }));
        this.list(this.recordings, status.recordings, 'Play', status.replay?.name ?? '', (name) =>
            this.session.send({ do: 'replay', name }),
        );
        element('saved-none').hidden = status.saved.length + status.recordings.length > 0;
    }

    toggle(): void {
        this.card.open = !this.card.open;
        if (this.card.open) showCards();
        if (this.card.open) this.card.querySelector<HTMLElement>('button, summary')?.focus();
    }

    /* The newest first. */
    private list(where: HTMLElement, names: string[], act: string, chosen: string, go: (name: string) => void): void {
        where.replaceChildren(
            ...[...names].reverse().map((name) => {
                const button = document.createElement('button');
                button.type = 'button';
                button.className = 'choice';
                button.textContent = name;
                button.title = `${act} ${name}`;
                button.setAttribute('aria-label', button.title);
                button.disabled = this.session.watches;
                if (name === chosen) button.setAttribute('aria-current', 'true');
                button.addEventListener('click', () => go(name));
                return button;
            }),
        );
        where.hidden = names.length === 0;
    }
}
