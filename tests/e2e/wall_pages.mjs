// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the pages of video walls, each with its own plant, in one browser, because starting a browser takes two seconds of
// processor time.
import { describe } from 'node:test';
// imported by this file, so that the browser is closed after the last group of tests and not after the first
import './support/browser.mjs';
import { isHeld } from './support/promise.mjs';

// Where the limits of promise() are enforced, no other group takes processor time.
describe('wall_pages', { concurrency: isHeld ? 1 : 2 }, () => {
    for (const subject of ['displays', 'faults', 'seam', 'tile_marks', 'losses'])
        describe(subject, { concurrency: 1 }, () => import(`./wall_pages/${subject}.mjs`));
});
