// SPDX-License-Identifier: GPL-3.0-or-later
// Time limits in milliseconds of the wall clock. `make test-long` enforces them, on a machine with nothing else to do.
// Elsewhere they are only printed, because other load delays the product just as much.
import assert from 'node:assert/strict';

// Value for the option `skip` of cases that take half a minute or more: the reason in `make test`, false (runs) in `make
// test-long`.
export const long = process.env.PLANTCAST_LONG === '1' ? false : 'make test-long runs it';

// Whether the limits are enforced.
export const isHeld = process.env.PLANTCAST_TIMES === '1';

// Reports how long `what` took. Fails if that is mostMs or more, but only where limits are enforced.
export function promise(t, what, ms, mostMs) {
    const text = `${what}: ${Math.round(ms)} ms, promised ${mostMs} ms`;
    t.diagnostic(text);
    assert.ok(!isHeld || ms < mostMs, text);
}
