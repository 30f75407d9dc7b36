// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the screen on, if the browser allows it.

export function keepScreenOn() {
    const ask = () => !document.hidden && navigator.wakeLock?.request('screen').catch(() => {});
    document.addEventListener('visibilitychange', ask);
    ask();
}
