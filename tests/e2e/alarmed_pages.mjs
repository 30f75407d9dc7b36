// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the page in one browser, on one plant with an active alarm: the parts that users of every role can see and open.
import { describe } from 'node:test';
// imported by this file, so that the browser is closed after the last group of tests and not after the first
import './support/browser.mjs';
import './alarmed_pages/alarmed.mjs';

describe('alarmed_pages', { concurrency: 2 }, () => {
    for (const subject of ['accessible', 'room', 'words', 'walls', 'truth'])
        describe(subject, { concurrency: 1 }, () => import(`./alarmed_pages/${subject}.mjs`));
});
