// SPDX-License-Identifier: GPL-3.0-or-later
// The page's monotonic clock in milliseconds, which also counts the time that the device slept.
import { Wake } from '../../core/wake.js';

let sleptMs = 0;
export const clock = {
    now: () => performance.now() + sleptMs,
    of: (timeStamp) => timeStamp + sleptMs, // converts an event's timeStamp
    setTimeout: (f, ms) => setTimeout(f, ms),
    clearTimeout: (id) => clearTimeout(id),
};

// Calls onWake() after the device has slept, because all values on the page are outdated then.
export function watchSleep(onWake) {
    const wake = new Wake({
        now: () => performance.now(), date: () => Date.now(),
        onWake(ms) {
            sleptMs += ms;
            onWake();
        },
    });
    setInterval(() => wake.check(), 500);
    document.addEventListener('visibilitychange', () => wake.check());
    window.addEventListener('pageshow', () => wake.check());
}
