/* The list of tools: the hand and the scene's instruments. */
import { check, radios } from './colours';
import { element } from './dom';
import type { Instrument } from './instrument';
import type { Hello, Status } from './protocol';

export class ToolCard {
    private tools: number[] = []; // behind each entry; -1: the hand
    private readonly list = element('tool-list');
    private readonly opening = element<HTMLInputElement>('opening');

    constructor(private readonly instrument: Instrument) {
        this.opening.addEventListener('input', () => instrument.open(this.opening.valueAsNumber));
    }

    setHello(hello: Hello): void {
        const instruments = hello.tools.map((_, i) => i).filter((i) => !hello.hands.includes(i));
        this.tools = [-1, ...instruments];
        element('tools').hidden = instruments.length === 0;
        const names = this.tools.map((i) => (i < 0 ? 'hand' : hello.tools[i]!.name));
        radios(this.list, names, (i) => this.instrument.choose(this.tools[i]!));
    }

    show(tool: number): void {
        check(this.list, this.tools.indexOf(tool));
        element('opening-row').hidden = this.instrument.info?.shape !== 'grasper';
    }

    update(status: Status): void {
        const tool = status.tools[this.instrument.chosen];
        if (tool && document.activeElement !== this.opening)
            this.opening.value = String(tool.opening);
    }
}
