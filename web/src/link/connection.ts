/* The line to the engine. Opens it, and opens it again by itself when it is lost: after 0.5, 1, 2,
 * then every 4 seconds, as docs/viewer-protocol.md asks. */
import type { Request } from './protocol';

export type Loss =
    | { again: true; inSeconds: number; because: string; ours: boolean } // ours: this page was at fault
    | { again: false; because: string };

export interface Listener {
    opened(): void;
    text(message: unknown): void;
    binary(data: ArrayBuffer): void;
    lost(loss: Loss): void;
}

const DELAYS = [0.5, 1, 2, 4];
const FAULTS = [1003, 1007, 1008, 1009]; // of a message that this page has sent
const SILENCE = 5000; // ms: status comes ten times a second, so nothing for so long is a loss

export class Connection {
    private socket: WebSocket | null = null;
    private failures = 0;
    private retry = 0;
    private watch = 0;
    private heard = 0;
    private lastWord = '';
    private readonly url: string;

    constructor(private readonly listener: Listener) {
        const said = new URLSearchParams(location.hash.slice(1));
        const asked = ['token', 'watch'].filter((name) => said.get(name)).map((name) => `${name}=${said.get(name)}`);
        const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
        this.url = `${scheme}//${location.host}/socket${asked.length ? `?${asked.join('&')}` : ''}`;
    }

    get open(): boolean {
        return this.socket?.readyState === WebSocket.OPEN;
    }

    /* Connects now, without waiting for the next attempt. */
    connect(): void {
        clearTimeout(this.retry);
        this.drop();
        this.lastWord = '';
        const socket = new WebSocket(this.url, 'lariat.1');
        socket.binaryType = 'arraybuffer';
        this.socket = socket;
        this.heard = performance.now();
        socket.onopen = () => this.listener.opened();
        socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
            this.heard = performance.now();
            this.failures = 0;
            if (typeof event.data !== 'string') return this.listener.binary(event.data);
            const message = JSON.parse(event.data) as { kind?: string; text?: string };
            if (message.kind === 'error' && message.text) this.lastWord = message.text;
            this.listener.text(message);
        };
        socket.onclose = (event) => this.closed(event.code, event.reason);
        clearInterval(this.watch);
        this.watch = window.setInterval(() => {
            if (performance.now() - this.heard > SILENCE && !document.hidden)
                this.closed(1006, 'The engine has said nothing for five seconds.');
        }, 1000);
    }

    send(request: Request): void {
        if (this.open) this.socket!.send(JSON.stringify(request));
    }

    private drop(): void {
        clearInterval(this.watch);
        const socket = this.socket;
        this.socket = null;
        if (!socket) return;
        socket.onopen = socket.onmessage = socket.onclose = null;
        socket.close();
    }

    private closed(code: number, reason: string): void {
        this.drop();
        const because = this.lastWord || reason;
        if (code === 4001) return this.listener.lost({ again: false, because });
        const inSeconds = DELAYS[Math.min(this.failures, DELAYS.length - 1)]!;
        this.failures++;
        this.retry = window.setTimeout(() => this.connect(), inSeconds * 1000);
        this.listener.lost({ again: true, inSeconds, because, ours: FAULTS.includes(code) });
    }
}
