// SPDX-License-Identifier: GPL-3.0-or-later
// How much of a large set a test tries: all of it if PLANTCAST_LONG=1 (`make test-long`), as in tests/support/sweep.h.
const isWhole = process.env.PLANTCAST_LONG === '1';

// Returns `whole` in a long run, otherwise `part`.
export const sweep = (whole, part) => (isWhole ? whole : part);

// Returns whether item i of a row is tested: in a long run every item, otherwise every nth, with a different offset in each
// row, so that n rows together cover each item.
export const takes = (row, i, n) => isWhole || i % n === row % n;

// Seed of random numbers: PLANTCAST_SEED if set; otherwise a new one in each long run, and always the same in other runs.
export const seed = Number(process.env.PLANTCAST_SEED ?? sweep(Date.now() % 1e9, 1));
