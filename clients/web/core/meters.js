// SPDX-License-Identifier: GPL-3.0-or-later
// Meters of the status bar: pictures drawn per second, and latency from an input to the picture that shows it.

export class RateMeter {
    constructor(windowMs = 1000) {
        this.windowMs = windowMs;
        this.times = [];
    }

    count(now) {
        this.times.push(now);
    }

    perSecond(now) {
        while (this.times.length > 0 && now - this.times[0] > this.windowMs)
            this.times.shift();
        return (this.times.length * 1000) / this.windowMs;
    }
}

export class LatencyMeter {
    constructor(keepMs = 3000) {
        this.keepMs = keepMs;
        this.inputs = new Map(); // camera's sequence number -> time of the input that moved the camera
        this.samples = [];       // { time, ms }
    }

    sent(seq, inputTime) {
        this.inputs.set(seq, inputTime);
    }

    // Handles a drawn picture, which answers the input of its own camera and all earlier inputs. Only the latency of its own
    // input is measured, and only once.
    drawn(seq, now) {
        const input = this.inputs.get(seq);
        if (input !== undefined)
            this.samples.push({ time: now, ms: now - input });
        for (const known of this.inputs.keys()) {
            if (known <= seq)
                this.inputs.delete(known);
        }
    }

    // Returns the age in milliseconds of the oldest input whose picture has not been drawn yet; 0: there is none.
    behindMs(now) {
        const [oldest = now] = this.inputs.values();
        return now - oldest;
    }

    clear() {
        this.inputs.clear();
    }

    // Returns the median latency of recent camera moves; null if there were none.
    median(now) {
        while (this.samples.length > 1 && now - this.samples[0].time > this.keepMs)
            this.samples.shift();
        const sorted = this.samples.map((s) => s.ms).sort((a, b) => a - b);
        return sorted.length > 0 ? sorted[sorted.length >> 1] : null;
    }
}
