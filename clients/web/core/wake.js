// SPDX-License-Identifier: GPL-3.0-or-later
// Notices that the device slept. The monotonic clock of many devices stands still meanwhile: what it says of ages is then too young.

const SLEPT_MS = 3000;

export class Wake {
    // now: the monotonic clock; date: the calendar's, which somebody may set: only how far the two went apart counts.
    constructor({ now, date, onWake }) {
        Object.assign(this, { now, date, onWake });
        this.apart = date() - now();
    }

    // Now and then. A clock that was set looks like a sleep, and costs one more greeting.
    check() {
        const apart = this.date() - this.now(), slept = apart - this.apart;
        this.apart = apart;
        if (slept > SLEPT_MS)
            this.onWake(slept);
    }
}
