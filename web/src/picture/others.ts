/* The hands of other viewers, each where it holds, with the arrow of its pull. */
import * as THREE from 'three';
import { OTHERS, PullPicture } from './arrow';
import { TOOL_WORDS, type Frame, type Status } from '../link/protocol';

const HELD = 15; // word of a tool in a frame: what it holds

export class Others {
    readonly group = new THREE.Group();
    private readonly pulls: PullPicture[] = [];
    private readonly grip = new THREE.Vector3();
    private readonly force = new THREE.Vector3();
    private size = 1;
    shown = 0; // hands that are drawn

    setSize(size: number): void {
        this.size = size;
        for (const pull of this.pulls) pull.setSize(size);
    }

    /* `hands`: tools that are hands; `range` of the force bar [N]. */
    update(frame: Frame, status: Status | null, hands: number[], range: number, camera: THREE.Camera): void {
        this.shown = 0;
        for (const tool of hands) {
            const at = tool * TOOL_WORDS;
            const mine = status?.tools[tool]?.by !== 'other';
            if (mine || at + TOOL_WORDS > frame.tools.length || frame.counts[at + HELD] === 0) continue;
            const t = frame.tools;
            this.grip.set(t[at]!, t[at + 1]!, t[at + 2]!);
            this.force.set(-t[at + 8]!, -t[at + 9]!, -t[at + 10]!);
            this.next().show(this.grip, null, this.force, this.force.length() / range, camera);
        }
        for (let i = this.shown; i < this.pulls.length; i++) this.pulls[i]!.hide();
    }

    private next(): PullPicture {
        let pull = this.pulls[this.shown];
        if (!pull) {
            pull = new PullPicture(OTHERS);
            pull.setSize(this.size);
            this.pulls.push(pull);
            this.group.add(pull.group);
        }
        this.shown++;
        return pull;
    }
}
