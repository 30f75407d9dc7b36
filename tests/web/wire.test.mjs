// SPDX-License-Identifier: GPL-3.0-or-later
// Parses bytes of plantcast.v1, using the test vectors of the C tests.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { CODECS, decodeBase64, decodeFrame, decodeMessage, isWhole, pictureSize, WireError } from '../../clients/web/core/wire.js';

const vectors = new URL('../../protocol/vectors/', import.meta.url);
const names = (folder) => readdirSync(new URL(folder, vectors)).filter((n) => n.endsWith('.json')).map((n) => n.slice(0, -5));
const json = (path) => JSON.parse(readFileSync(new URL(path, vectors), 'utf8'));
const bytes = (path) => new Uint8Array(readFileSync(new URL(path, vectors)));

for (const name of names('frame/')) {
    const want = json(`frame/${name}.json`);
    test(`frame ${name}: ${want.what}`, () => {
        const data = bytes(`frame/${name}.bin`);
        if (!want.valid) {
            assert.throws(() => decodeFrame(data), WireError);
            return;
        }
        const frame = decodeFrame(data);
        assert.deepEqual({
            codec: frame.codec, flags: frame.flags,
            key: frame.key, still: frame.still, noLiveData: frame.noLiveData, more: frame.more, seq: frame.seq,
            cameraSeq: frame.cameraSeq, paramsSeq: frame.paramsSeq, oldestAgeMs: frame.oldestAgeMs,
            dataTimeUs: frame.dataTimeUs, sentTimeUs: frame.sentTimeUs,
            stages: [frame.waitUs, frame.fieldUs, frame.renderUs, frame.encodeUs],
            part: [frame.x, frame.y, frame.width, frame.height, frame.fullWidth, frame.fullHeight],
            camera: frame.camera, payload: frame.payload.length,
        }, {
            codec: CODECS[want.codec], flags: want.flags,
            key: (want.flags & 1) !== 0, still: (want.flags & 2) !== 0, noLiveData: (want.flags & 4) !== 0,
            more: (want.flags & 8) !== 0,
            seq: want.seq, cameraSeq: want.camera_seq, paramsSeq: want.params_seq,
            oldestAgeMs: want.oldest_age_ms === 0xffffffff ? null : want.oldest_age_ms,
            dataTimeUs: want.data_time_us, sentTimeUs: want.sent_time_us,
            stages: [want.wait_us, want.field_us, want.render_us, want.encode_us],
            part: [want.x, want.y, want.width, want.height, want.full_width, want.full_height],
            camera: {
                eye: want.eye, target: want.target, up: want.up, fov: want.fov,
                ...(want.height_m === undefined ? {} : { height_m: want.height_m }),
            },
            payload: want.payload_bytes,
        });
        assert.equal(isWhole(frame), want.width === want.full_width && want.height === want.full_height);
    });
}

test('a frame that arrives byte by byte is incomplete until its last byte', () => {
    const whole = bytes('frame/jpeg-key.bin');
    for (let n = 0; n < whole.length; n++)
        assert.throws(() => decodeFrame(whole.slice(0, n)), WireError, `a frame cut to ${n} bytes is refused`);
    assert.equal(decodeFrame(whole).seq, 1);
});

test('a frame may lie anywhere in a larger buffer', () => {
    const whole = bytes('frame/png-key.bin');
    const larger = new Uint8Array(whole.length + 14);
    larger.set(whole, 7);
    const frame = decodeFrame(larger.subarray(7, 7 + whole.length));
    assert.deepEqual([...frame.payload.subarray(0, 4)], [0x89, 0x50, 0x4e, 0x47]);
    assert.equal(decodeFrame(whole.buffer.slice(whole.byteOffset, whole.byteOffset + whole.length)).codec, 'png');
});

test('any single wrong byte of the header is refused or parsed, and never causes another error', () => {
    const whole = bytes('frame/jpeg-key.bin');
    for (let at = 0; at < 112; at++) {
        for (const value of [0, 1, 0x7f, 0x80, 0xff]) {
            const changed = whole.slice();
            changed[at] = value;
            try {
                decodeFrame(changed);
            } catch (error) {
                assert.ok(error instanceof WireError, `byte ${at} = ${value}: ${error}`);
            }
        }
    }
});

for (const name of names('server/')) {
    test(`the test vector of server message ${name} decodes to its type`,
        () => assert.equal(decodeMessage(readFileSync(new URL(`server/${name}.json`, vectors), 'utf8')).type,
        json(`server/${name}.json`).type));
}

test('a message that is not an object with a type is refused', () => {
    for (const text of ['', '{', '[]', 'null', '3', '"tags"', '{}', '{"type":3}'])
        assert.throws(() => decodeMessage(text), WireError, text);
});

test('base64 text decodes to its bytes', () => assert.deepEqual([...decodeBase64('AP8Q')], [0, 255, 16]));

test('the picture has the shape of the window, within the sizes that the server draws', () => {
    assert.deepEqual(pictureSize(1608, 996), { width: 1608, height: 996 });
    assert.deepEqual(pictureSize(3, 900), { width: 16, height: 900 });
    const wide = pictureSize(12000, 2000);
    assert.ok(wide.width <= 8192 && Math.abs(wide.width / wide.height - 6) < 0.01);
    const large = pictureSize(7680, 4320);
    assert.ok(large.width * large.height <= 16777216 && large.width * large.height > 16700000);
    assert.ok(Math.abs(large.width / large.height - 16 / 9) < 0.002);
});
