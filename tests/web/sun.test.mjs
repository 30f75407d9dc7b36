// SPDX-License-Identifier: GPL-3.0-or-later
// The sun's position: conversion between the page's controls and the server's parameters, in both directions.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { sunOf, sunText, towardsSun } from '../../clients/web/core/sun.js';
import { learnWords } from '../../clients/web/core/words.js';

test('a sun position written as parameters is read back unchanged, with Z up and with Y up', () => {
    for (const isYUp of [false, true]) {
        for (const sun of [{ turn: 0, height: 5 }, { turn: 225, height: 45 }, { turn: 359, height: 89 }])
            assert.deepEqual(sunOf(towardsSun(sun, isYUp), isYUp), sun);
    }
});

test('north is y, or -z where y is up; east is x', () => {
    const near = (a, b) => a.forEach((n, i) => assert.ok(Math.abs(n - b[i]) < 1e-9, `${a} for ${b}`));
    near(towardsSun({ turn: 0, height: 0 }, false), [0, 1, 0]);
    near(towardsSun({ turn: 90, height: 0 }, false), [1, 0, 0]);
    near(towardsSun({ turn: 0, height: 0 }, true), [0, 0, -1]);
    near(towardsSun({ turn: 180, height: 90 }, true), [0, 1, 0]);
});

test('the sun\'s position is written as direction and elevation', async () => {
    await learnWords();
    assert.equal(sunText({ turn: 225, height: 45 }), 'from SW, 45° elevation');
    assert.equal(sunText({ turn: 350, height: 5 }), 'from N, 5° elevation');
});
