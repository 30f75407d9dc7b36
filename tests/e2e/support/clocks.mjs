// SPDX-License-Identifier: GPL-3.0-or-later
// Runs programs with a wrong wall clock (tests/faults/clock_off.c).
import { existsSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';

const LIBRARY = resolve(process.env.PLANTCAST_OUT ?? 'build/release', 'tests/faults/clock_off.so');
export const missingClocks = () => (existsSync(LIBRARY) ? null : 'not built: clock_off.so');

const variables = (by) => ({ LD_PRELOAD: LIBRARY, ...by, ASAN_OPTIONS: 'verify_asan_link_order=0' });
const starter = (by) => ['env', ...Object.entries(variables(by)).map(([name, value]) => `${name}=${value}`)];
// Returns the command prefix that starts a program with its clock this many seconds ahead.
export const withClockOff = (seconds) => starter({ CLOCK_OFF_S: String(seconds) });

// A wrong clock whose offset the test can change while programs run with it (set(seconds)).
export class SetClock {
    constructor(file) {
        this.file = file;
        this.set(0);
    }

    set(ahead_s) {
        this.ahead_s = ahead_s;
        writeFileSync(this.file, new BigInt64Array([BigInt(ahead_s)]), { flag: existsSync(this.file) ? 'r+' : 'w' });
    }

    now() { return Date.now() + this.ahead_s * 1000; }
    variables() { return variables({ CLOCK_OFF_FILE: this.file }); }
    starter() { return starter({ CLOCK_OFF_FILE: this.file }); }
}
