// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers with a printed seed: the same in each run, except that PLANTCAST_SEED sets another one and `make test-long`
// uses a new one each time.
import { seed } from '../e2e/support/sweep.mjs';

console.log(`# PLANTCAST_SEED=${seed}`);
export { seed };

// Returns a function random(low, high) with a state of its own, so that one file's numbers do not depend on other files.
export function randomNumbers() {
    let state = seed;
    return (low, high) => {
        state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
        return low + (high - low) * (state / 2 ** 32);
    };
}
