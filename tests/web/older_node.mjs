// SPDX-License-Identifier: GPL-3.0-or-later
// Makes tests run in the node of Debian 12 (18.20) too, which lacks the decompression format 'deflate-raw' and has an older
// mock.timers.
import { mock } from 'node:test';
import { Duplex } from 'node:stream';
import { createInflateRaw } from 'node:zlib';

const isOlder = process.versions.node.startsWith('18.'), { DecompressionStream: own } = globalThis;

if (isOlder)
    globalThis.DecompressionStream = function decompression(format) {
        return format === 'deflate-raw' ? Duplex.toWeb(createInflateRaw()) : new own(format);
    };

// Replaces setTimeout(), so that timers run only when the test calls mock.timers.tick().
export function mockTimeouts() {
    const apis = ['setTimeout'];
    mock.timers.enable(isOlder ? apis : { apis });
}
