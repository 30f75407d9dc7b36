// SPDX-License-Identifier: GPL-3.0-or-later
// Waiting for what a program does.
import { setTimeout as sleep } from 'node:timers/promises';

// Asks until the answer is true, and returns it. Fails after that many seconds, naming what was waited for, the last answer and, if given,
// the text of more(), such as the log of a program.
export async function until(what, ask, seconds = 90, more = () => '') {
    for (const end = performance.now() + seconds * 1000; ; await sleep(50)) {
        const found = await ask();
        if (found)
            return found;
        if (performance.now() > end)
            throw new Error(`waited ${seconds} s for ${what}; the last answer: ${JSON.stringify(found)}\n${more()}`);
    }
}
