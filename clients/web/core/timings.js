// SPDX-License-Identifier: GPL-3.0-or-later
// Where the time of each picture went, stage by stage, over the last seconds.

export const STAGES = ['wait', 'field', 'render', 'encode', 'network', 'decode'];

const rank = (sorted, share) => sorted[Math.min(sorted.length - 1, Math.ceil(share * sorted.length) - 1)];

export class Timings {
    constructor(keepMs = 5000) {
        this.keepMs = keepMs;
        this.samples = []; // { at, bytes, data, [stage]: ms }
    }

    // hereUs: the server's clock when the frame was decoded; null: not known.
    add(frame, decodeMs, at, hereUs) {
        const network = hereUs === null ? null : Math.max(0, (hereUs - frame.sentTimeUs) / 1000 - decodeMs);
        this.samples.push({
            at, bytes: frame.payload?.length ?? 0, data: frame.data === true, network, decode: decodeMs,
            wait: frame.waitUs / 1000, field: frame.fieldUs / 1000, render: frame.renderUs / 1000, encode: frame.encodeUs / 1000,
        });
        while (at - this.samples[0].at > this.keepMs)
            this.samples.shift();
    }

    // { p50, p95 } of a stage, or of `sensor`: from a reading that changed to the picture that was made for it; null: none.
    of(name) {
        const whole = (s) => (s.data ? STAGES.reduce((sum, stage) => sum + (s[stage] ?? 0), 0) : null);
        const known = this.samples.map((s) => (name === 'sensor' ? whole(s) : s[name])).filter((ms) => ms !== null);
        known.sort((a, b) => a - b);
        return known.length > 0 ? { p50: rank(known, 0.5), p95: rank(known, 0.95) } : null;
    }

    kbitPerS(now) {
        const recent = this.samples.filter((s) => now - s.at <= this.keepMs);
        return (recent.reduce((sum, s) => sum + s.bytes, 0) * 8) / this.keepMs;
    }

    clear() {
        this.samples = [];
    }
}
