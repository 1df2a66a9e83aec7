/* Pictures and videos of what is seen, as files that the browser saves. A picture has a line below that says
 * what, when, and the legend of its colours; a video is the picture alone. */
import { element } from '../dom';
import type { Session } from '../link/session';
import type { View } from '../picture/view';

const KINDS = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm', 'video/mp4'];
const RATE = 30; // pictures per second
const LONGEST = 600; // s: a video lies in memory until it ends
const FOOT = 34; // pixels of the line below, where the picture is 640 high

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

    /* The picture as it is drawn now, and the line below. */
    private withFoot(): HTMLCanvasElement {
        const { canvas } = this.view;
        this.view.changed();
        this.view.draw(0); // what was drawn before is gone by now
        const scale = Math.max(1, canvas.height / 640);
        const out = document.createElement('canvas');
        out.width = canvas.width;
        out.height = canvas.height + FOOT * scale;
        const pen = out.getContext('2d')!;
        pen.fillStyle = '#07080a';
        pen.fillRect(0, 0, out.width, out.height);
        pen.drawImage(canvas, 0, 0);
        pen.setTransform(scale, 0, 0, scale, 0, canvas.height);
        this.drawFoot(pen, out.width / scale);
        return out;
    }

    private drawFoot(pen: CanvasRenderingContext2D, width: number): void {
        const { hello, frame } = this.session;
        const middle = FOOT / 2;
        pen.font = '14px system-ui, "DejaVu Sans", sans-serif';
        pen.textBaseline = 'middle';
        pen.fillStyle = '#e9ecef';
        pen.fillText(`${hello?.title || 'Lariat'}, ${frame.time.toFixed(3)} s, step ${frame.step}`, 12, middle);
        if (element('legend').hidden) return;
        const field = hello?.fields.find((one) => one.number === frame.field)?.title ?? '';
        const [min, max] = ['legend-least', 'legend-most'].map((id) => element(id).textContent ?? '');
        pen.textAlign = 'right';
        pen.fillText(max!, width - 12, middle);
        const right = width - 20 - pen.measureText(max!).width;
        pen.drawImage(element<HTMLCanvasElement>('legend-map'), right - 140, middle - 6, 140, 12);
        pen.fillText(`${field}  ${min}`, right - 148, middle);
    }
}
