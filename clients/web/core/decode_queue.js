// SPDX-License-Identifier: GPL-3.0-or-later
// Queue of frames to decode. One frame is being decoded. Of the waiting frames, only the newest key frame and the frames after it are kept,
// so that a slow decoder lowers the picture rate without adding delay.

export class DecodeQueue {
    // decode(frame) returns a promise of a picture. ready(frame, picture, decodeMs) is called in the order of the frames, failed(frame,
    // error) after a failure. now() returns milliseconds.
    constructor({ decode, ready, failed, now }) {
        Object.assign(this, { decode, ready, failed, now });
        this.waiting = [];
        this.busy = false;
        this.dropped = 0;
        this.generation = 0;
    }

    push(frame) {
        if (frame.key) {
            this.dropped += this.waiting.length;
            this.waiting = [];
        }
        this.waiting.push(frame);
        if (!this.busy)
            this.run();
    }

    // Drops all frames, also the one being decoded, because their connection is closed.
    clear() {
        this.waiting = [];
        this.generation++;
    }

    async run() {
        this.busy = true;
        while (this.waiting.length > 0) {
            const frame = this.waiting.shift(), generation = this.generation, start = this.now();
            let picture;
            try {
                picture = await this.decode(frame);
            } catch (error) {
                this.failed(frame, error);
                continue;
            }
            if (generation === this.generation)
                this.ready(frame, picture, this.now() - start);
            else
                picture.close?.();
        }
        this.busy = false;
    }
}
