/* Pictures and videos of what is seen, as files that the browser saves. A picture has a line below that says
 * what, when, and the legend of its colours; a video is the picture alone. */
import { element } from '../dom';
import type { Session } from '../link/session';
import type { View } from '../picture/view';

const KINDS = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm', 'video/mp4'];
const RATE = 30; // pictures per second
const LONGEST = 600; // s: a video lies in memory until it ends
const FOOT = 34; // pixels of a line below, where the picture is 640 high
const FONT = '14px system-ui, "DejaVu Sans", sans-serif';
const MARGIN = 12;
const MAP = 140; // pixels of the legend's colours where there is room

/* A name for a file: uterus-12000.png. */
export function fileName(title: string, step: number, ending: string): string {
    const stem = title.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '') || 'lariat';
    return `${stem}-${step}.${ending}`;
}

function save(data: Blob, name: string): void {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(data);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export class Capture {
    private recorder: MediaRecorder | null = null;
    private readonly video = element<HTMLButtonElement>('video');

    constructor(
        private readonly session: Session,
        private readonly view: View,
        private readonly say: (text: string) => void,
    ) {
        element('snapshot').onclick = () => this.takePicture();
        this.video.onclick = () => this.filmOrEnd();
    }

    get filming(): boolean {
        return this.recorder !== null;
    }

    takePicture(): void {
        const name = this.name('png');
        this.withFoot().toBlob((data) => {
            if (!data) return this.say('The browser gives no picture; make the window smaller.');
            save(data, name);
            this.say(`Picture: ${name}`);
        }, 'image/png');
    }

    filmOrEnd(): void {
        if (this.recorder) return this.recorder.stop();
        const kind = KINDS.find((one) => window.MediaRecorder?.isTypeSupported(one));
        if (!kind) return this.say('This browser makes no videos; Firefox and Chromium do.');
        const parts: Blob[] = [];
        const name = this.name(kind.includes('mp4') ? 'mp4' : 'webm');
        const recorder = new MediaRecorder(this.view.canvas.captureStream(RATE), { mimeType: kind, videoBitsPerSecond: 8e6 });
        const end = setTimeout(() => recorder.stop(), LONGEST * 1000);
        recorder.ondataavailable = (event) => parts.push(event.data);
        recorder.onstop = () => {
            clearTimeout(end);
            recorder.stream.getTracks().forEach((track) => track.stop());
            this.show(null);
            save(new Blob(parts, { type: kind }), name);
            this.say(`Video: ${name}`);
        };
        recorder.start(1000);
        this.view.changed();
        this.show(recorder);
    }

    private show(recorder: MediaRecorder | null): void {
        this.recorder = recorder;
        this.video.setAttribute('aria-pressed', String(recorder !== null));
        this.video.textContent = recorder ? 'End video' : 'Video';
        element('filming').hidden = recorder === null;
    }

    private name(ending: string): string {
        return fileName(this.session.hello?.title ?? '', this.session.frame.step, ending);
    }

    /* The picture as it is drawn now, and below it one line, or two where the legend has no room beside the rest. */
    private withFoot(): HTMLCanvasElement {
        const { canvas } = this.view;
        this.view.changed();
        this.view.draw(0); // what was drawn before is gone by now
        const scale = Math.max(1, canvas.height / 640);
        const width = canvas.width / scale;
        const out = document.createElement('canvas');
        const pen = out.getContext('2d')!;
        pen.font = FONT;
        const what = this.what(pen, width - 2 * MARGIN);
        const legend = this.legend(pen, width - 2 * MARGIN);
        const apart = legend !== null && pen.measureText(what).width + legend.width + 4 * MARGIN > width;
        out.width = canvas.width;
        out.height = canvas.height + (apart ? 2 : 1) * FOOT * scale;
        pen.fillStyle = '#07080a';
        pen.fillRect(0, 0, out.width, out.height);
        pen.drawImage(canvas, 0, 0);
        pen.setTransform(scale, 0, 0, scale, 0, canvas.height);
        pen.font = FONT;
        pen.textBaseline = 'middle';
        pen.fillStyle = '#e9ecef';
        pen.fillText(what, MARGIN, FOOT / 2);
        if (legend) drawLegend(pen, legend, width - MARGIN, apart ? 1.4 * FOOT : FOOT / 2);
        return out;
    }

    /* Scene, time and step; of a long title as much as there is room for. */
    private what(pen: CanvasRenderingContext2D, room: number): string {
        const { hello, frame } = this.session;
        const when = `, ${frame.time.toFixed(3)} s, step ${frame.step}`;
        let title = hello?.title || 'Lariat';
        if (pen.measureText(title + when).width <= room) return title + when;
        while (title && pen.measureText(`${title}…${when}`).width > room) title = title.slice(0, -1);
        return `${title}…${when}`;
    }

    private legend(pen: CanvasRenderingContext2D, room: number): Legend | null {
        if (element('legend').hidden) return null;
        const { hello, frame } = this.session;
        const field = hello?.fields.find((one) => one.number === frame.field)?.title ?? '';
        const [min, max] = ['legend-least', 'legend-most'].map((id) => element(id).textContent ?? '');
        const before = `${field}  ${min}`;
        const words = pen.measureText(before).width + 16 + pen.measureText(max!).width;
        const colours = Math.max(20, Math.min(MAP, room - words));
        return { before, after: max!, colours, width: words + colours };
    }
}

interface Legend {
    before: string; // field and least value, left of the colours
    after: string; // largest value, right of them
    colours: number; // pixels of them
    width: number;
}

function drawLegend(pen: CanvasRenderingContext2D, legend: Legend, right: number, middle: number): void {
    pen.textAlign = 'right';
    pen.fillText(legend.after, right, middle);
    const map = right - 8 - pen.measureText(legend.after).width;
    pen.drawImage(element<HTMLCanvasElement>('legend-map'), map - legend.colours, middle - 6, legend.colours, 12);
    pen.fillText(legend.before, map - legend.colours - 8, middle);
}
