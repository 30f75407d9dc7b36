// SPDX-License-Identifier: GPL-3.0-or-later
// Programs whose wall clock is wrong (tests/faults/clock_off.c).
import { existsSync } from 'node:fs';
import { join, resolve } from 'node:path';

const LIBRARY = resolve(process.env.PLANTCAST_OUT ?? 'build/release', 'tests/faults/clock_off.so');
export const missingClocks = () => (existsSync(LIBRARY) ? null : 'not built: clock_off.so');

// What sets its clock so many seconds ahead, as variables.
export const clockOff = (seconds) => ({ LD_PRELOAD: LIBRARY, CLOCK_OFF_S: String(seconds), ASAN_OPTIONS: 'verify_asan_link_order=0' });
// The same, as the program that starts another.
export const withClockOff = (seconds) => ['env', ...Object.entries(clockOff(seconds)).map(([name, value]) => `${name}=${value}`)];
