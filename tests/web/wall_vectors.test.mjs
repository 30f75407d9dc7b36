// SPDX-License-Identifier: GPL-3.0-or-later
// The rules by which walls choose what they show, tested by the cases of protocol/vectors/wall.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { readAddress } from '../../clients/web/core/address.js';
import { AlarmCall } from '../../clients/web/core/alarm_call.js';
import { cameraMessage } from '../../clients/web/core/camera.js';
import { brightness, burnShift, wallFit } from '../../clients/web/core/wall.js';

const cases = (name) => JSON.parse(readFileSync(new URL(`../../protocol/vectors/wall/${name}.json`, import.meta.url)));
const NOW_US = 1e15;

test('the test vectors choose the same alarm to replace a view', () => {
    for (const { name, alarms, steps } of cases('alarm_calls')) {
        const list = alarms.map(({ id, priority, ago_s: ago, waiting, gone, place }) => ({
            tag: { index: id, asset: place ? 'E-1' : null, position: place ? [0, 0, 0] : null }, kind: 'H', priority, waiting,
            state: gone ? 'returned' : 'unacknowledged', raisedUs: NOW_US - ago * 1e6 }));
        const call = new AlarmCall();
        for (const [ms, expected] of steps)
            assert.equal(call.next(list, ms, NOW_US)?.tag.index ?? null, expected, `${name}, ${ms} ms`);
    }
});

test('the test vectors of addresses give the same parameters and camera', () => {
    for (const { text, params, camera } of cases('addresses')) {
        const read = readAddress(text);
        if (read.params.baseline)
            read.params.baseline = read.params.baseline.name; // the server gets only the name of the baseline
        assert.deepEqual(read.params, params, text);
        assert.deepEqual(read.camera && cameraMessage(read.camera), camera, text);
    }
});

test('the test vectors give the same letter sizes and display brightness', () => {
    const { sizes, dimming } = cases('letters');
    for (const { inches, metres, display, window, unit } of sizes) {
        const [width, height] = display, room = { width: window[0], height: window[1] };
        const { scale } = wallFit({ inches, metres }, { width, height }, room, { width: 560, height: 315 });
        assert.ok(Math.abs(scale - unit) < 1e-9, `letter scale for ${inches} inches: ${scale}`);
    }
    for (const { minute, calls, light, ...dim } of dimming)
        assert.equal(brightness(dim, minute, calls), light, JSON.stringify({ ...dim, minute }));
});

test('the test vectors give the same burn-in shift of the picture', () => {
    for (const { us, shift } of cases('shifts'))
        assert.deepEqual(burnShift(us), shift, `shift at ${us} µs`);
});
