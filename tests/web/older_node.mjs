// SPDX-License-Identifier: GPL-3.0-or-later
// Lets tests run in Debian 12's node (18.20) too, which lacks the decompression format 'deflate-raw' and has an older
// mock.timers.
import { mock } from 'node:test';
import { Duplex } from 'node:stream';
import { createInflateRaw } from 'node:zlib';

const isOlder = process.versions.node.startsWith('18.'), { DecompressionStream: own } = globalThis;

if (isOlder)
    globalThis.DecompressionStream = function decompression(format) {
        return format === 'deflate-raw' ? Duplex.toWeb(createInflateRaw()) : new own(format);
    };

// Replaces setTimeout() by a clock that mock.timers.tick() moves.
export function mockTimeouts() {
    const apis = ['setTimeout'];
    mock.timers.enable(isOlder ? apis : { apis });
}
