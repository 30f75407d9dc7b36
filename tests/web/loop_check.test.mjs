// SPDX-License-Identifier: GPL-3.0-or-later
// Loop checks: the page finds the tag whose value an engineer at the transmitter moves, among others that are noisy, and reads
// expected values from a CSV file.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { readExpected, LoopCheckSession } from '../../clients/web/core/loop_check.js';

const span = () => 100;
const noisy = (i) => [50 + 4 * Math.sin(3 * i), 20, 80 + 0.05 * Math.sin(7 * i), null];

function watched() {
    const loopCheck = new LoopCheckSession();
    for (let i = 0; i < 30; i++)
        loopCheck.observe(noisy(i));
    loopCheck.arm();
    return loopCheck;
}

test('no tag has moved while all vary as before', () => {
    const loopCheck = watched();
    for (let i = 30; i < 60; i++) {
        loopCheck.observe(noisy(i));
        assert.equal(loopCheck.stirred(span), null);
    }
});

test('the forced tag is found even if another varies more by itself', () => {
    const loopCheck = watched();
    const [a, , c] = noisy(31);
    loopCheck.observe([a, 23, c, null]);
    assert.deepEqual([loopCheck.stirred(span).index, loopCheck.stirred(span).by], [1, 3]);
    loopCheck.disarm();
    assert.equal(loopCheck.stirred(span), null);
    assert.equal(new LoopCheckSession().stirred(span), null, 'an unarmed loop check finds no tag');
});

test('steps smaller than the transmitter\'s resolution do not count', () => {
    const loopCheck = watched();
    loopCheck.observe([null, 20.1, null, 3]);
    assert.equal(loopCheck.stirred(span), null);
});

test('expected values: any separator, quotes and column order are read; cells that are no number are skipped', () => {
    const list = readExpected('\uFEFFTolerance;Remark;"Tag Name";Expected\r\n0.5;"a;""b""";TT-1;42\r\n;x;TT-2;1\r\n1;;"TT;3";-2.5\r\n');
    assert.deepEqual([...list], [['TT-1', { expected: 42, tolerance: 0.5 }], ['TT;3', { expected: -2.5, tolerance: 1 }]]);
    assert.deepEqual([...readExpected('Tag Name,Expected,Tolerance\nA,1,0\n')], [['A', { expected: 1, tolerance: 0 }]]);
    assert.deepEqual([...readExpected('Tag Name;Expected;Tolerance\nA;-50,3;0,5\n')], [['A', { expected: -50.3, tolerance: 0.5 }]]);
    assert.equal(readExpected('Tag Name,Value\nA,1\n'), null);
    assert.equal(readExpected(''), null);
});
