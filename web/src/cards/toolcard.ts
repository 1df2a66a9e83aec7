/* The list of tools: the hand, the scene's instruments, and those that were added. */
import { check, radios } from './colours';
import { element, scaleFor, withUnit, write } from '../dom';
import type { Instrument } from '../hands/instrument';
import type { Hello, Status, ToolInfo, ToolStatus } from '../link/protocol';

/* What a tool bears: its force of its limit, how hard its jaws grasp, and how deep the tissue is in
 * it. */
export function load(tool: Pick<ToolStatus, 'force' | 'limit' | 'depth' | 'limited' | 'grasp'>): string {
    const force = Math.hypot(...tool.force);
    const { text, unit } = scaleFor(tool.limit || force, 'N');
    const words = [tool.limit > 0 ? `${text(force)} of ${text(tool.limit)} ${unit}` : `${text(force)} ${unit}`];
    if (tool.grasp > 0) words.push(`grasp ${text(tool.grasp)} ${unit}`);
    if (tool.depth > 0) words.push(`${withUnit(tool.depth, 'm')} deep`);
    if (tool.limited) words.push('limit reached');
    return words.join(', ');
}

const LIMIT =
    'Force on the tool and the most that it may bear; what both jaws grasp with; how deep tissue ' +
    'is in it. Once the limit is ' +
    'reached the tool stays behind its hand, until the hand comes back.';

function addLoad(entry: Element): HTMLElement {
    const load = document.createElement('span');
    load.className = 'load';
    (entry as HTMLElement).title = LIMIT;
    entry.setAttribute('aria-label', entry.textContent ?? ''); // it does not change ten times a second
    entry.append(load);
    return load;
}

export class ToolCard {
    private hello: Hello | null = null;
    private tools: number[] = []; // behind each entry; -1: the hand
    private readonly list = element('tool-list');
    private loads: (HTMLElement | null)[] = []; // one in each entry; null: the hand's
    private readonly opening = element<HTMLInputElement>('opening');

    constructor(private readonly instrument: Instrument) {
        this.opening.addEventListener('input', () => instrument.open(this.opening.valueAsNumber));
    }

    setHello(hello: Hello): void {
        this.opening.disabled = hello.watches;
        this.hello = hello;
        this.setTools(hello.tools);
    }

    setTools(tools: readonly ToolInfo[]): void {
        const { hands, spares, watches } = this.hello!;
        const focused = this.list.contains(document.activeElement);
        const instruments = tools.map((_, i) => i).filter((i) => !hands.includes(i) && tools[i]!.shape !== 'none');
        this.tools = [-1, ...instruments];
        element('tools').hidden = instruments.length === 0 && (!spares?.length || watches);
        const names = this.tools.map((i) => (i < 0 ? 'hand' : tools[i]!.name));
        radios(this.list, names, (i) => this.instrument.choose(this.tools[i]!));
        this.loads = [...this.list.children].map((entry, i) => (this.tools[i]! < 0 ? null : addLoad(entry)));
        this.show(this.instrument.chosen);
        if (focused) this.list.querySelector<HTMLElement>('[aria-checked="true"]')?.focus();
    }

    show(tool: number): void {
        check(this.list, this.tools.indexOf(tool));
        element('opening-row').hidden = this.instrument.info?.shape !== 'grasper';
    }

    update(status: Status): void {
        this.loads.forEach((where, i) => {
            const tool = status.tools[this.tools[i]!];
            if (!where || !tool) return;
            write(where, load(tool));
            where.classList.toggle('bad', tool.limited);
        });
        const tool = status.tools[this.instrument.chosen];
        if (tool && document.activeElement !== this.opening)
            this.opening.value = String(tool.opening);
    }
}
