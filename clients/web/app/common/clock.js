// SPDX-License-Identifier: GPL-3.0-or-later
// The page's one clock: monotonic, and it goes on while the device sleeps.
import { Wake } from '../../core/wake.js';

let sleptMs = 0;
export const clock = {
    now: () => performance.now() + sleptMs,
    of: (timeStamp) => timeStamp + sleptMs, // of an event
    setTimeout: (f, ms) => setTimeout(f, ms),
    clearTimeout: (id) => clearTimeout(id),
};

// Where the browser lets us.
export function keepScreenOn() {
    const ask = () => !document.hidden && navigator.wakeLock?.request('screen').catch(() => {});
    document.addEventListener('visibilitychange', ask);
    ask();
}

// onWake(): what was known before is old.
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
