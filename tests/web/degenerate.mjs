// SPDX-License-Identifier: GPL-3.0-or-later
// Child process of degenerate.test.mjs: calls the page's pure functions with corrupted arguments: numbers that are not finite,
// zero, negative or huge, and lists that are empty, have one element or very many. Prints the number of each case before it
// runs, and a line for each function that returned a non-finite number. usage: node degenerate.mjs FIRST-CASE SEED
import { writeSync } from 'node:fs';
import { CASES } from './degenerate_cases.mjs';

const ODD = [NaN, Infinity, -Infinity, 0, -0, -1, 1e-320, 0.5, 1e15, 1e308, -1e308];
const RANDOM_CALLS = 150;
const [first, seed] = process.argv.slice(2).map(Number);
let state = seed;
const random = (below) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
};

// Returns the paths (lists of keys) of all values within `o` for which is(value) is true.
function paths(o, is, at = []) {
    const own = is(o) ? [at] : [];
    return o === null || typeof o !== 'object' || ArrayBuffer.isView(o) ? own
        : [...own, ...Object.keys(o).flatMap((key) => paths(o[key], is, [...at, key]))];
}

function changed(o, path, change) {
    if (path.length === 0)
        return change(o);
    const [first, ...rest] = path, copy = Array.isArray(o) ? [...o] : { ...o };
    copy[first] = changed(o[first], rest, change);
    return copy;
}

function* variants(args) {
    const numbers = paths(args, (v) => typeof v === 'number'), lists = paths(args, Array.isArray).slice(1);
    yield args;
    for (const path of numbers)
        for (const odd of ODD)
            yield changed(args, path, () => odd);
    for (const odd of ODD)
        yield numbers.reduce((all, path) => changed(all, path, () => odd), args);
    for (const path of lists)
        for (const change of [() => [], (list) => list.slice(0, 1), (list) => Array(25).fill(list).flat()])
            yield changed(args, path, change);
    for (let n = 0; n < RANDOM_CALLS; n++)
        yield numbers.reduce((all, path) => (random(3) === 0 ? changed(all, path, () => ODD[random(ODD.length)]) : all), args);
}

// Returns whether the function computed a non-finite number, that is, one in the result that was not copied from the arguments.
const made = (result, args) => paths(result, (v) => typeof v === 'number' && !Number.isFinite(v)).length > 0 &&
    paths(args, (v) => Object.is(v, result) || (v && typeof v === 'object' && JSON.stringify(v) === JSON.stringify(result))).length === 0;
const printed = (v, most) => JSON.stringify(v, (_, x) => (typeof x === 'number' && !Number.isFinite(x) ? String(x) : x)).slice(0, most);

for (const [index, { name, call, args, ends }] of CASES.entries()) {
    if (index < first)
        continue;
    writeSync(1, `case ${index}\n`);
    const found = new Set();
    for (const given of variants(args)) {
        let result;
        try {
            result = call(...given);
        } catch (error) {
            // TypeError and RangeError are allowed: a list is too short for the function, or a date is out of range
            if (!(error instanceof TypeError || error instanceof RangeError))
                found.add(`throws ${error}`);
            continue;
        }
        if (!ends && made(result, given) && found.size < 3)
            found.add(`gives ${printed(result, 300)} for ${printed(given, 600)}`);
    }
    for (const cause of found)
        writeSync(1, `${name} ${cause}\n`);
}
writeSync(1, `case ${CASES.length}\n`);
