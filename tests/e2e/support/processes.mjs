// SPDX-License-Identifier: GPL-3.0-or-later
// Processor time, shared memory and descendants of a process.
import { readdirSync, readFileSync } from 'node:fs';

// Returns the processor time of all threads in milliseconds, with a resolution of 10 ms.
export function cpuMs(pid) {
    const [, user, system] = readFileSync(`/proc/${pid}/stat`, 'utf8').match(/\) .(?: \S+){10} (\d+) (\d+)/);
    return 10 * (Number(user) + Number(system));
}

// Returns the process and all its descendants.
export function family(pid) {
    const children = new Map();
    for (const name of readdirSync('/proc').filter((one) => /^\d+$/.test(one))) {
        try {
            const parent = Number(readFileSync(`/proc/${name}/stat`, 'utf8').match(/\) . (\d+)/)[1]);
            children.set(parent, [...(children.get(parent) ?? []), Number(name)]);
        } catch { // the process has ended
        }
    }
    const out = [pid];
    for (let i = 0; i < out.length; i++)
        out.push(...(children.get(out[i]) ?? []));
    return out;
}

// Returns the resident shared memory of the processes in MB. Memory that several of the processes map is counted once for each.
export const sharedMb = (pids) => pids.reduce((sum, pid) => {
    try {
        return sum + Number(readFileSync(`/proc/${pid}/status`, 'utf8').match(/^RssShmem:\s+(\d+)/m)[1]) / 1024;
    } catch {
        return sum; // the process has ended
    }
}, 0);
