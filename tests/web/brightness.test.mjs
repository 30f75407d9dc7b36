// SPDX-License-Identifier: GPL-3.0-or-later
// Brightness of a wall: dimmed during its hours, even across midnight, but never while an alarm is shown.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { brightness } from '../../clients/web/core/wall.js';

test('a wall is dimmed during its hours, except while an alarm is shown', () => {
    const night = { from_min: 1320, to_min: 360, percent: 60 }, day = { from_min: 540, to_min: 600, percent: 30 };
    assert.deepEqual([1319, 1320, 0, 359, 360].map((minute) => brightness(night, minute, false)), [1, 0.6, 0.6, 0.6, 1]);
    assert.deepEqual([539, 540, 599, 600].map((minute) => brightness(day, minute, false)), [1, 0.3, 0.3, 1]);
    assert.equal(brightness(night, 0, true), 1);
    assert.equal(brightness(undefined, 0, false), 1);
});
