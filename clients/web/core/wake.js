// SPDX-License-Identifier: GPL-3.0-or-later
// Detects that the device slept. On many devices the monotonic clock stops during sleep, so ages of readings would be too small.

const SLEPT_MS = 3000;

export class Wake {
    // now(): monotonic clock; date(): wall clock, which may be set at any time. Only changes in the difference between the
    // clocks are used.
    constructor({ now, date, onWake }) {
        Object.assign(this, { now, date, onWake });
        this.apart = date() - now();
    }

    // Calls onWake() if the device has slept since the last call; call it every few seconds. Setting the wall clock forward looks like a
    // sleep, and only costs one extra `hello` to the server.
    check() {
        const apart = this.date() - this.now(), slept = apart - this.apart;
        this.apart = apart;
        if (slept > SLEPT_MS)
            this.onWake(slept);
    }
}
