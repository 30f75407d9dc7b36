// SPDX-License-Identifier: GPL-3.0-or-later
// Promises in milliseconds of the wall clock. `make test-long` holds the product to them, on a machine with nothing else to do;
// elsewhere they are only printed, since whatever else the machine does delays the product as much.
import assert from 'node:assert/strict';

// Why a case that waits for half a minute and more is skipped by `make test`, or false in `make test-long`.
export const long = process.env.PLANTCAST_LONG === '1' ? false : 'make test-long runs it';

const isHeld = process.env.PLANTCAST_TIMES === '1';

// Prints how long `what` took, and fails where promises are held and that was mostMs or more.
export function promise(t, what, ms, mostMs) {
    const text = `${what}: ${Math.round(ms)} ms, promised ${mostMs} ms`;
    t.diagnostic(text);
    assert.ok(!isHeld || ms < mostMs, text);
}
