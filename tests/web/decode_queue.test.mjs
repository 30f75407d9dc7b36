// SPDX-License-Identifier: GPL-3.0-or-later
// The queue between network and video decoder: it holds at most one frame, the newest.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { DecodeQueue } from '../../clients/web/core/decode_queue.js';

const whole = (seq) => ({ seq, key: true, x: 0, y: 0, width: 64, height: 36, fullWidth: 64, fullHeight: 36 });
const part = (seq) => ({ ...whole(seq), key: false, y: 18, height: 18 });
const settle = () => new Promise((resolve) => setImmediate(resolve));

// Returns a queue with a fake decoder that finishes a frame only when the test says so.
function bench() {
    const started = [], shown = [], failed = [], closed = [];
    let now = 0;
    const slot = new DecodeQueue({
        decode: (frame) => new Promise((resolve, reject) => started.push({ seq: frame.seq, resolve, reject })),
        ready: (frame, picture, decodeMs) => shown.push([frame.seq, picture.of, decodeMs]),
        failed: (frame, error) => failed.push([frame.seq, error.message]),
        now: () => now,
    });
    const finish = async (seq, ms = 5) => {
        now += ms;
        started.find((job) => job.seq === seq).resolve({ of: seq, close: () => closed.push(seq) });
        await settle();
    };
    return { slot, started, shown, failed, closed, finish };
}
const seqs = (jobs) => jobs.map((job) => job.seq);

test('while one frame is decoded, only the newest of the others is kept', async () => {
    const { slot, started, shown, finish } = bench();
    for (const seq of [1, 2, 3, 4])
        slot.push(whole(seq));
    assert.deepEqual(seqs(started), [1]);
    await finish(1);
    assert.deepEqual(seqs(started), [1, 4]);
    await finish(4, 7);
    assert.deepEqual(shown, [[1, 1, 5], [4, 4, 7]]);
    assert.equal(slot.dropped, 2);
});

test('the last frame is always decoded', async () => {
    const { slot, started, shown, finish } = bench();
    slot.push(whole(1));
    await finish(1);
    await settle();
    slot.push(whole(2));
    assert.deepEqual(seqs(started), [1, 2]);
    await finish(2);
    assert.deepEqual(shown.map(([seq]) => seq), [1, 2]);
});

test('parts of a picture are never skipped, unless a complete picture comes after them', async () => {
    const { slot, started, shown, finish } = bench();
    slot.push(whole(1));
    slot.push(part(2));
    slot.push(part(3));
    await finish(1);
    await finish(2);
    assert.deepEqual(seqs(started), [1, 2, 3]);
    slot.push(part(4));
    slot.push(whole(5));
    slot.push(part(6));
    await finish(3);
    await finish(5);
    await finish(6);
    assert.deepEqual(shown.map(([seq]) => seq), [1, 2, 3, 5, 6]);
});

test('a broken frame is reported, and decoding continues with the next one', async () => {
    const { slot, started, shown, failed, finish } = bench();
    slot.push(whole(1));
    slot.push(whole(2));
    started[0].reject(new Error('not a JPEG'));
    await settle();
    await finish(2);
    assert.deepEqual(failed, [[1, 'not a JPEG']]);
    assert.deepEqual(shown.map(([seq]) => seq), [2]);
});

test('after clear, the frame being decoded is closed and never shown', async () => {
    const { slot, shown, closed, finish } = bench();
    slot.push(whole(1));
    slot.push(whole(2));
    slot.clear();
    slot.push(whole(3));
    await finish(1);
    await finish(3);
    assert.deepEqual(closed, [1]);
    assert.deepEqual(shown.map(([seq]) => seq), [3]);
});
