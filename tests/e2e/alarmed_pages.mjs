// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the page in one browser, on one plant with an alarm: everything that every user can see and open.
import { describe } from 'node:test';
import './support/browser.mjs'; // imported here, so that the browser ends with the program and not with the first group of tests
import './alarmed_pages/alarmed.mjs';

describe('alarmed_pages', { concurrency: 2 }, () => {
    for (const subject of ['accessible', 'room', 'words', 'walls'])
        describe(subject, { concurrency: 1 }, () => import(`./alarmed_pages/${subject}.mjs`));
});
