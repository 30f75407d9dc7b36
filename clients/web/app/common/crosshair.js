// SPDX-License-Identifier: GPL-3.0-or-later
// The instant under the pointer, which all trend charts and the time slider mark.

let shownUs = null;
const listeners = new Set();

// Registers f(us, from), which is called when the instant under the pointer changes. us: the instant in microseconds; null: the pointer
// points at no instant. from: the object that called pointAtInstant().
export const onCrosshair = (f) => listeners.add(f);

export function pointAtInstant(us, from) {
    if (us === shownUs)
        return;
    shownUs = us;
    listeners.forEach((f) => f(us, from));
}
