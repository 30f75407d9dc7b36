// SPDX-License-Identifier: GPL-3.0-or-later
// What a process has taken, and whom it started.
import { readdirSync, readFileSync } from 'node:fs';

// Milliseconds of a processor, all threads together, in steps of ten.
export function cpuMs(pid) {
    const [, user, system] = readFileSync(`/proc/${pid}/stat`, 'utf8').match(/\) .(?: \S+){10} (\d+) (\d+)/);
    return 10 * (Number(user) + Number(system));
}

// The process, and all that descend from it.
export function family(pid) {
    const children = new Map();
    for (const name of readdirSync('/proc').filter((one) => /^\d+$/.test(one))) {
        try {
            const parent = Number(readFileSync(`/proc/${name}/stat`, 'utf8').match(/\) . (\d+)/)[1]);
            children.set(parent, [...(children.get(parent) ?? []), Number(name)]);
        } catch { // it has ended
        }
    }
    const out = [pid];
    for (let i = 0; i < out.length; i++)
        out.push(...(children.get(out[i]) ?? []));
    return out;
}
