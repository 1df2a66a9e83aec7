/* Pulling at the surface. What was pressed is moved in a plane through it that is parallel to the
 * screen; the engine finds a hand that takes hold there, of the mesh: where an embedded surface is drawn, at
 * the nearest point of the mesh's. The pulling is told at most 100 times a second. */
import * as THREE from 'three';
import { follow, nearestNode, type Hit } from './pick';
import { TOOL_WORDS, type HandNews } from '../link/protocol';
import type { Session } from '../link/session';
import type { View } from '../picture/view';

const PULL_MS = 1000 / 100;
const PLAYED = 'A recording is being played; leave it (X) to pull and to move instruments.';

export class Hand {
    state: 'free' | 'asked' | 'holding' = 'free';
    tool = -1; // that the engine has given this hand, also after letting go
    readonly target = new THREE.Vector3();
    readonly grip = new THREE.Vector3();
    private readonly aside = new THREE.Vector3(); // from what was pressed to what is held, of the mesh
    private readonly plane = new THREE.Plane();
    private readonly normal = new THREE.Vector3();
    private readonly force = new THREE.Vector3();
    private hit: Hit | null = null;
    private moved = false;
    private nextPull = 0;

    constructor(
        private readonly session: Session,
        private readonly view: View,
        private readonly say: (text: string) => void,
    ) {}

    get busy(): boolean {
        return this.state !== 'free';
    }

    /* Whether this page may pull at all. */
    get allowed(): boolean {
        return !this.session.watches;
    }

    /* While a recording is played nothing can be taken hold of: that is said, and nothing else. */
    prevented(): boolean {
        const played = Boolean(this.session.status?.replay);
        if (played) this.say(PLAYED);
        return played;
    }

    grab(hit: Hit): void {
        this.state = 'asked';
        this.hit = hit;
        this.target.set(...hit.point);
        this.grip.copy(this.target);
        const held = this.view.holdAt(hit.point);
        this.aside.set(...held).sub(this.target);
        this.moved = false;
        this.setPlane();
        this.session.send({ do: 'grab', hand: 0, point: held });
        if (this.session.status?.state === 'paused') this.say('Paused: press play to pull.');
    }

    /* To where a ray meets the plane. */
    pullTo(ray: THREE.Ray): void {
        if (!this.busy || !ray.intersectPlane(this.plane, this.target)) return;
        this.moved = true;
        this.view.changed();
    }

    /* By steps along the picture's axes, in metres: right, up, towards the viewer. */
    pullBy(right: number, up: number, near: number): void {
        if (!this.busy) return;
        this.view.endoscope.shift(this.target, right, up, near);
        this.setPlane();
        this.moved = true;
        this.view.changed();
    }

    release(): void {
        if (!this.busy) return;
        this.state = 'free';
        this.session.send({ do: 'release', hand: 0 });
        this.view.changed();
    }

    /* Another surface is drawn: what is held goes on at its nearest node. */
    surfaceChanged(): void {
        if (this.busy && this.view.surface) this.hit = nearestNode(this.view.surface, this.grip);
    }

    /* The line is cut, or another engine has taken over. */
    forget(): void {
        this.state = 'free';
        this.tool = -1;
        this.view.pull.hide();
    }

    news(news: HandNews): void {
        if (news.state === 'holding' && news.tool !== null) {
            this.tool = news.tool;
            if (this.state === 'asked') this.state = 'holding';
            return;
        }
        if (!this.busy) return;
        this.state = 'free';
        this.view.changed();
        const played = Boolean(this.session.status?.replay); // which the engine has said itself
        if (news.state === 'missed' && !played) this.say('Nothing there to take hold of.');
        if (news.state === 'refused') this.say('Other viewers have all hands. Wait until one lets go.');
        if (news.state === 'lost') this.say('The hand has lost its hold.');
    }

    /* Once per animation frame: tells the engine, and moves the picture of the pull. `range` is
     * that of the force bar [N]. */
    update(now: number, range: number): void {
        if (this.busy && this.moved && now >= this.nextPull) {
            this.moved = false;
            this.nextPull = now + PULL_MS - 2;
            const { target, aside } = this;
            this.session.send({
                do: 'pull', hand: 0, to: [target.x + aside.x, target.y + aside.y, target.z + aside.z],
            });
        }
        if (!this.busy || !this.hit) return this.view.pull.hide();
        if (this.view.surface) follow(this.view.surface, this.hit, this.grip);
        this.readForce();
        const share = this.force.length() / range;
        this.view.pull.show(this.grip, this.target, this.force, share, this.view.endoscope.camera);
    }

    /* What the hand does to the tissue: the opposite of what frames tell. */
    private readForce(): void {
        const tools = this.session.frame.tools;
        const at = this.tool * TOOL_WORDS + 8;
        if (this.state !== 'holding' || at < 0 || at + 3 > tools.length) this.force.set(0, 0, 0);
        // Paused, no tick has a force: the last one stays, as in bar and graph.
        else if (this.session.status?.state !== 'paused') this.force.set(-tools[at]!, -tools[at + 1]!, -tools[at + 2]!);
    }

    private setPlane(): void {
        this.view.endoscope.camera.getWorldDirection(this.normal);
        this.plane.setFromNormalAndCoplanarPoint(this.normal, this.target);
    }
}
