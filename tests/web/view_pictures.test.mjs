// SPDX-License-Identifier: GPL-3.0-or-later
// The query for a small picture of a named view, also of one without a camera.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { pictureQuery } from '../../clients/web/core/named_views.js';

const SIZE = { width: 160, height: 90 };

test('a view without a camera has a picture, from where the server looks', () => {
    assert.deepEqual(pictureQuery('group=temperature', SIZE), { width: 160, height: 90, group: 'temperature' });
});

test('one with a camera is seen from there', () => {
    assert.equal(pictureQuery('group=t&camera=8,2,30,8,6,0,0,0,1,45', SIZE).camera, '8,2,30,8,6,0,45');
});
