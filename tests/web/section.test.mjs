// SPDX-License-Identifier: GPL-3.0-or-later
// Clipping, hiding and isolating: conversion to the server's parameters and back.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { AXES, boxAround, cut, readBox, readCut, showAll, showAsset } from '../../clients/web/core/section.js';

// Returns how an asset is drawn (shown, ghost or hidden), following the rule by which the server combines the three lists.
function assetLook({ hidden = [], ghost = [], isolate = [] }, id) {
    if (hidden.includes(id))
        return 'hidden';
    if (ghost.includes(id))
        return 'ghost';
    return isolate.length > 0 && !isolate.includes(id) ? 'hidden' : 'shown';
}

test('a section plane written as parameters is read back unchanged', () => {
    for (const axis of AXES) {
        for (const turned of [false, true])
            assert.deepEqual(readCut(cut(axis, 3.5, turned)), { axis, at: 3.5, turned });
    }
    assert.deepEqual(cut('y', 2, false), { planes: [[0, 1, 0, -2]] });
    assert.deepEqual(cut('z', 2, true), { planes: [[0, 0, -1, 2]] });
});

test('a section box written as parameters is read back with its size', () => {
    const bounds = { min: [0, -1, 2], max: [10, 1, 3] };
    assert.deepEqual(boxAround(bounds, 0.5), { box: { min: [2.5, -0.5, 2.25], max: [7.5, 0.5, 2.75] } });
    assert.equal(readBox(boxAround(bounds, 1.5), bounds), 1.5);
    const drawn = boxAround(bounds, 0.5);
    drawn.box.max[1] += 0.1;
    assert.equal(readBox(drawn, bounds), null, 'a box with one side moved has no size factor');
    assert.equal(readBox(cut('x', 1, false), bounds), null);
});

test('other clips are not read as a section plane', () => {
    for (const clip of [null, undefined, { box: { min: [0, 0, 0], max: [1, 1, 1] } }, { planes: [[0.6, 0.8, 0, 1]] },
        { planes: [[1, 0, 0, 0], [0, 1, 0, 0]] }])
        assert.equal(readCut(clip), null);
});

test('pressing hide or ghost on an asset sets it, and pressing again resets it', () => {
    let params = { hidden: [], ghost: ['B'], isolate: [] };
    params = { ...params, ...showAsset(params, 'hide', 'A') };
    assert.equal(assetLook(params, 'A'), 'hidden');
    assert.deepEqual(showAsset(params, 'hide', 'A'), { hidden: [] });
    params = { ...params, ...showAsset(params, 'ghost', 'A') };
    assert.deepEqual(params, { hidden: [], ghost: ['B', 'A'], isolate: [] });
    params = { ...params, ...showAsset(params, 'only', 'C') };
    assert.deepEqual([assetLook(params, 'A'), assetLook(params, 'C'), assetLook(params, 'D')], ['ghost', 'shown', 'hidden']);
    assert.deepEqual(showAll(params), { ghost: [], isolate: [] });
    assert.deepEqual(showAll({}), {});
    assert.equal(assetLook({}, 'A'), 'shown');
});
