/* Mouse, pen and fingers on the picture. What a press means depends on what lies under it:
 *
 *     an instrument      choose and move it; also a few pixels beside it
 *     the organ          take hold of it and pull
 *     nothing            look around
 *     a second finger    let go; nearer, farther, aside
 */
import type { Hand } from './hand';
import type { MeasureCard } from '../inspect/measurecard';
import type { Hit } from './pick';
import type { Instrument } from './instrument';
import type { View } from '../picture/view';

type Doing = 'nothing' | 'pulling' | 'moving' | 'turning' | 'aside' | 'pinching';

interface Place {
    x: number;
    y: number;
}

interface Finger extends Place {
    button: number; // that it came down with, as a bit of `buttons`
}

/* What lies under the pointer: where an instrument and the organ both do, what is in front. */
interface Target {
    tool: number; // -1: none
    hit: Hit | null;
}

const TURN = 0.0075; // rad per pixel
const MARGIN = { mouse: 6, touch: 14 }; // pixels beside an instrument's outline that still take it
const BITS = [1, 4, 2]; // of `buttons`, by `button`

export class Pointer {
    private doing: Doing = 'nothing';
    private readonly fingers = new Map<number, Finger>();
    private spread = 0;
    private hover: Place | null = null;

    constructor(
        private readonly view: View,
        private readonly hand: Hand,
        private readonly instrument: Instrument,
        private readonly measure: MeasureCard,
        private readonly used: (what: 'pull' | 'look' | 'move') => void,
    ) {
        const canvas = view.canvas;
        canvas.addEventListener('pointerdown', (event) => this.down(event));
        canvas.addEventListener('pointermove', (event) => this.move(event));
        canvas.addEventListener('pointerup', (event) => this.up(event));
        canvas.addEventListener('pointercancel', (event) => this.up(event));
        canvas.addEventListener('pointerleave', () => (this.hover = null));
        canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
        canvas.addEventListener('dblclick', (event) => this.twice(event));
        canvas.addEventListener('contextmenu', (event) => event.preventDefault());
        window.addEventListener('blur', () => this.end());
    }

    /* The cursor tells what a press would do; once per animation frame. */
    update(): void {
        if (!this.hover || this.doing !== 'nothing' || !this.hand.allowed) return;
        const { tool, hit } = this.target(this.hover, MARGIN.mouse);
        this.hover = null;
        const classes = this.view.canvas.classList;
        classes.toggle('over-tool', tool >= 0);
        classes.toggle('over', tool < 0 && hit !== null);
    }

    /* Lets go of an instrument only: the run was put somewhere else. */
    drop(): void {
        if (this.doing === 'moving') this.do('nothing');
    }

    /* Ends whatever the pointer does. */
    end(): void {
        if (this.doing === 'pulling') this.hand.release();
        if (this.doing === 'moving') this.instrument.drop();
        this.do('nothing');
        this.fingers.clear();
    }

    private down(event: PointerEvent): void {
        this.view.canvas.setPointerCapture(event.pointerId);
        this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY, button: BITS[event.button] ?? 0 });
        if (this.fingers.size === 2) {
            if (this.doing === 'pulling') this.hand.release();
            if (this.doing === 'moving') this.instrument.drop();
            this.spread = 0;
            return this.do('pinching');
        }
        if (this.fingers.size > 2) return;
        if (event.button !== 0 || event.shiftKey) return this.do('aside');
        const at = { x: event.clientX, y: event.clientY };
        const { tool, hit } = this.target(at, event.pointerType === 'touch' ? MARGIN.touch : MARGIN.mouse);
        if (hit && this.measure.press !== 'pull') {
            this.measure.take(hit);
            return this.do('turning');
        }
        if (!this.hand.allowed) return this.do('turning');
        if (tool >= 0) {
            if (tool !== this.instrument.chosen) this.instrument.choose(tool);
            if (this.hand.prevented()) return this.do('turning');
            this.instrument.take(this.ray(at));
            this.used('move');
            return this.do('moving');
        }
        if (hit) {
            if (this.hand.prevented()) return this.do('turning');
            this.hand.grab(hit);
            this.used('pull');
            return this.do('pulling');
        }
        this.do('turning');
    }

    private move(event: PointerEvent): void {
        const finger = this.fingers.get(event.pointerId);
        if (!finger) {
            this.hover = { x: event.clientX, y: event.clientY };
            return;
        }
        // Browsers tell `pointerup` only when the last of several buttons is up.
        if (finger.button && !(event.buttons & finger.button)) return this.up(event);
        const dx = event.clientX - finger.x;
        const dy = event.clientY - finger.y;
        finger.x = event.clientX;
        finger.y = event.clientY;
        const height = this.view.canvas.clientHeight;
        switch (this.doing) {
            case 'pulling':
                return this.hand.pullTo(this.ray(finger));
            case 'moving':
                return this.instrument.moveTo(this.ray(finger));
            case 'turning':
                if (dx || dy) this.used('look');
                return this.view.endoscope.turn(dx * TURN, dy * TURN);
            case 'aside':
                return this.view.endoscope.pan(dx / height, dy / height);
            case 'pinching':
                return this.pinch(dx / height, dy / height);
            case 'nothing':
        }
    }

    private up(event: PointerEvent): void {
        if (!this.fingers.delete(event.pointerId)) return;
        if (this.doing === 'pinching' && this.fingers.size > 0) return;
        this.end();
    }

    private pinch(dx: number, dy: number): void {
        this.view.endoscope.pan(dx / 2, dy / 2);
        const [a, b] = [...this.fingers.values()];
        if (!a || !b) return;
        const spread = Math.hypot(a.x - b.x, a.y - b.y);
        if (this.spread > 0 && spread > 0) this.view.endoscope.zoom(this.spread / spread);
        this.spread = spread;
        this.used('look');
    }

    private wheel(event: WheelEvent): void {
        event.preventDefault();
        const lines = event.deltaMode === 1 ? event.deltaY * 30 : event.deltaY;
        const by = Math.max(-240, Math.min(240, lines));
        const size = this.view.surface?.size ?? 1;
        if (this.hand.busy) return this.hand.pullBy(0, 0, by * size * 0.0005);
        if (this.instrument.held) return this.instrument.moveBy(0, 0, by * size * 0.0005);
        this.used('look');
        this.view.endoscope.zoom(Math.exp(by * 0.0012));
    }

    private twice(event: MouseEvent): void {
        const hit = this.view.hit(this.ray({ x: event.clientX, y: event.clientY }));
        if (hit) this.view.endoscope.focus(hit.point);
        else this.view.endoscope.reset();
    }

    private do(doing: Doing): void {
        this.doing = doing;
        const classes = this.view.canvas.classList;
        classes.remove('over', 'over-tool');
        classes.toggle('pulling', doing === 'pulling' || doing === 'moving');
        classes.toggle('turning', doing === 'turning' || doing === 'aside');
    }

    private target(at: Place, margin: number): Target {
        const { view } = this;
        const ray = this.ray(at);
        const hit = view.hit(ray);
        const under = view.instruments.under(ray, margin, view.endoscope.pixel(view.canvas.clientHeight));
        const tool = under && under.distance < (hit?.distance ?? Infinity) ? under.tool : -1;
        return { tool, hit };
    }

    private ray(at: Place) {
        const { clientWidth, clientHeight } = this.view.canvas;
        return this.view.endoscope.rayThrough(
            (at.x / clientWidth) * 2 - 1,
            1 - (at.y / clientHeight) * 2,
        );
    }
}
