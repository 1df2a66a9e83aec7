/* window.lariat: what tests and curious people may read (docs/viewer.md). It changes nothing. */
import type { ForceCard } from './cards/forcecard';
import type { Hand } from './hands/hand';
import type { Session } from './link/session';
import type { Scan } from './inspect/scan';
import type { MeasureCard } from './inspect/measurecard';
import type { View } from './picture/view';

export function publish(session: Session, view: View, hand: Hand, force: ForceCard, measure: MeasureCard, scan: Scan): void {
    const state = {
        get connected() { return session.connected; },
        get connections() { return session.connections; },
        get state() { return session.status?.state ?? 'unknown'; },
        get step() { return session.frame.step; },
        get hash() { return session.frame.hash; },
        get checksum() { return session.frame.checksum; },
        get frames() { return session.frames; },
        get torn() { return session.torn; },
        get pictures() { return view.pictures; },
        get field() { return session.frame.field; },
        get watches() { return session.watches; },
        get hand() { return hand.state; },
        get force() { return force.history.ago(0); },
        get forces() { return force.history.count; },
        get peak() { return force.history.peak(); },
        get displacement() { return view.displacement(); },
        get tools() { return session.status?.tools.map((tool) => [...tool.position, tool.opening]) ?? []; },
        get names() { return session.tools.map((tool) => tool.name); },
        get press() { return measure.press; },
        get reading() { return { node: measure.node, element: measure.elementNumber }; },
        get measured() { return measure.distance; },
        get scan() { return scan.shown; },
        get body() { return session.status?.body ?? null; },
        get distance() { return view.endoscope.distance; },
        get fit() { return view.endoscope.fit; },
        get surface() { return view.finer ? 'fine' : 'mesh'; },
        get fibres() { return view.fibreLines; },
        get others() { return view.others.shown; },
        get nodes() { return view.surface?.nodes ?? 0; },
    };
    Object.defineProperty(window, 'lariat', { value: Object.freeze(state) });
}
