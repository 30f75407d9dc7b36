// SPDX-License-Identifier: GPL-3.0-or-later
// Waits for conditions that another program makes true, by checking them repeatedly.
import assert from 'node:assert/strict';
import { setTimeout as sleep } from 'node:timers/promises';
import { isDeepStrictEqual } from 'node:util';

// Calls ask() repeatedly until its answer is truthy, and returns the answer. Fails after that many seconds with the condition's
// name `what`, the last answer and, if given, the text of more(), such as a program's log.
export async function until(what, ask, seconds = 90, more = () => '') {
    for (const end = performance.now() + seconds * 1000; ; await sleep(50)) {
        const found = await ask();
        if (found)
            return found;
        if (performance.now() > end)
            throw new Error(`waited ${seconds} s for ${what}; the last answer: ${JSON.stringify(found)}\n${more()}`);
    }
}

// Calls ask() repeatedly until its answer equals `wanted`; after that many seconds, fails with the difference. Use it for
// results that follow an event after an unknown time, such as the layout of a page.
export async function becomes(ask, wanted, what, seconds = 90) {
    for (const end = performance.now() + seconds * 1000; ; await sleep(50)) {
        const found = await ask();
        if (isDeepStrictEqual(found, wanted))
            return;
        if (performance.now() > end)
            assert.deepEqual(found, wanted, what);
    }
}
