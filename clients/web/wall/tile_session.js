// SPDX-License-Identifier: GPL-3.0-or-later
// The session of one tile of a picture across many displays: it holds decoded frames back until the instant, set by the server,
// at which all tiles show them.
import { DecodeQueue } from '../core/decode_queue.js';
import { Session } from '../core/session.js';

// EARLY_MS: how many milliseconds before its instant a picture may be shown: at the screen's next refresh, about 17 ms later,
// it would be later than its instant by more than that
const PING_MS = 2000, CLOCK_MS = 60000, EARLY_MS = 4;

export class TileSession extends Session {
    // tile: { wall, display, columns, rows }. canvases: two, of which the one with the class `front` is visible. Further events: tiles
    // (which displays are connected), presented ({ frame, number (of the picture), us (server's time) }).
    constructor({ tile, canvases, decoding, ...rest }) {
        super(rest);
        Object.assign(this, { tile, canvases: [...canvases], decoding }); // canvases: the visible one first
        this.tiles = { leads: false, part: null, missing: [], late: [] };
        this.pongs = [];    // answers to pings of the last minute: { at, us (server's clock minus ours), roundTripMs }
        this.places = null; // marker positions of the frame on the screen: [tag, x, y, occluded, ...]
        this.reset();
        this.queue = new DecodeQueue({
            decode: (frame) => decoding.decode(frame),
            ready: (frame, picture, decodeMs) => this.keep(frame, picture, decodeMs),
            failed: (frame) => this.passedOver(frame),
            now: () => performance.now(),
        });
        decoding.onLost = () => this.askKeyFrame();
        decoding.onCodecs = (codecs) => this.setCodecs(codecs);
        this.on('frame', (frame) => this.queue.push(frame));
        this.on('hello', () => {
            this.queue.clear();
            this.reset();
        });
        setInterval(() => this.post({ type: 'ping', t: this.now() }), PING_MS);
    }

    // Drops the frames that were held back, because their connection is lost.
    reset() {
        for (const { picture } of this.kept ?? [])
            picture.close?.();
        this.kept = [];       // frames held back, in order: { frame, picture, decodeMs }
        this.order = null;    // the server's order which picture to show next: { seq, picture, at_us }; null: none
        this.drawnLast = null; // { frame, decodeMs } of the picture drawn on the hidden canvas; null: none
        this.markerRows = []; // { seq, rows }
    }

    proofs() {
        const { wall, display } = this.tile;
        return { ...(this.token ? { token: this.token } : {}), tile: { wall, display } };
    }

    // Returns the home camera, which shows the whole plant in the whole picture; this display shows a part of that picture.
    homeIn(width, height) {
        return super.homeIn(width * this.tile.columns, height * this.tile.rows);
    }

    heard(message) {
        if (message.type === 'present')
            this.present(message);
        else if (message.type === 'tiles')
            this.tellTiles(message);
        else
            super.heard(message);
        if (message.type === 'pong')
            this.takeTime(message);
        if (message.type === 'markers' && message.markers)
            this.markerRows.push({ seq: message.seq, rows: message.markers });
    }

    tellTiles(message) {
        this.tiles = message;
        this.emit('tiles');
    }

    takeTime({ t, time_us: us }) {
        const now = this.now(), roundTripMs = now - t;
        this.pongs = this.pongs.filter(({ at }) => now - at < CLOCK_MS);
        this.pongs.push({ at: now, roundTripMs, us: us - (now - roundTripMs / 2) * 1000 });
    }

    // The server's time, from the shortest round trip of the last minute: older measurements are wrong because clocks drift,
    // and longer round trips because queues add delay.
    get serverUs() {
        const best = this.pongs.reduce((a, b) => (!a || b.roundTripMs < a.roundTripMs ? b : a), null);
        return best ? best.us + this.now() * 1000 : this.clockUs();
    }

    keep(frame, picture, decodeMs) {
        this.kept.push({ frame, picture, decodeMs });
        if (!frame.more) // acknowledges the frame that completes a picture, which can now be shown at its instant
            this.connection.send({ type: 'ack', seq: frame.seq, decode_ms: Math.round(decodeMs * 100) / 100 });
    }

    present(message) {
        const waits = this.order !== null;
        this.order = message;
        this.prepare(message.seq);
        if (waits)
            return;
        const look = () => {
            if (this.order && this.serverUs + EARLY_MS * 1000 >= this.order.at_us)
                this.show(this.order);
            if (this.order)
                requestAnimationFrame(look);
        };
        requestAnimationFrame(look);
    }

    // Draws the next picture on the hidden canvas, so that only the canvases need to be swapped at the picture's instant.
    prepare(seq) {
        const parts = this.kept.filter(({ frame }) => frame.seq <= seq), [front, back] = this.canvases;
        this.kept = this.kept.filter(({ frame }) => frame.seq > seq);
        if (parts.length === 0)
            return;
        const [{ frame: { fullWidth, fullHeight, width, height } }] = parts, context = back.getContext('2d', { alpha: false });
        if (back.width !== fullWidth || back.height !== fullHeight)
            Object.assign(back, { width: fullWidth, height: fullHeight });
        if (!this.drawnLast && (width < fullWidth || height < fullHeight) && front.width === fullWidth && front.height === fullHeight)
            context.drawImage(front, 0, 0);
        for (const { frame, picture } of parts) {
            context.drawImage(picture, 0, 0, frame.width, frame.height, frame.x, frame.y, frame.width, frame.height);
            picture.close?.();
        }
        this.drawnLast = parts.at(-1);
    }

    show({ seq, picture: number }) {
        const last = this.drawnLast;
        this.order = this.drawnLast = null;
        if (!last)
            return;
        this.canvases.reverse();
        this.canvases.forEach((canvas, i) => canvas.classList.toggle('front', i === 0));
        const known = this.markerRows.findLastIndex((one) => one.seq <= seq);
        this.places = known < 0 ? this.places : this.markerRows[known].rows;
        this.markerRows = this.markerRows.slice(known + 1);
        this.drawn(last.frame, last.decodeMs);
        this.emit('presented', { frame: last.frame, number, us: this.serverUs });
    }
}
