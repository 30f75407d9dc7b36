// SPDX-License-Identifier: GPL-3.0-or-later
// How far tests go through what has no end. In full where PLANTCAST_LONG=1 (`make test-long`), as tests/support/sweep.h has it.
const isWhole = process.env.PLANTCAST_LONG === '1';

// `whole` in full, otherwise `part`.
export const sweep = (whole, part) => (isWhole ? whole : part);

// Whether item i of a row is tried: in full each, otherwise every n-th, another one of them in each row, so that over n rows each item
// has its turn.
export const takes = (row, i, n) => isWhole || i % n === row % n;

// Where random numbers begin: as PLANTCAST_SEED says; else by default always the same, in full another one in each run.
export const seed = Number(process.env.PLANTCAST_SEED ?? sweep(Date.now() % 1e9, 1));
