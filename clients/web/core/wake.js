// SPDX-License-Identifier: GPL-3.0-or-later
// Detects that the device slept. On many devices the monotonic clock stops meanwhile, so ages would be too small.

const SLEPT_MS = 3000;

export class Wake {
    // now: monotonic clock; date: wall clock, which may be set at any time; only the difference of the two is used.
    constructor({ now, date, onWake }) {
        Object.assign(this, { now, date, onWake });
        this.apart = date() - now();
    }

    // Call it regularly. A changed wall clock looks like a sleep, and costs one extra greeting.
    check() {
        const apart = this.date() - this.now(), slept = apart - this.apart;
        this.apart = apart;
        if (slept > SLEPT_MS)
            this.onWake(slept);
    }
}
