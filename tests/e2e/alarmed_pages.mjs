// SPDX-License-Identifier: GPL-3.0-or-later
// Subjects of the page on one plant with an alarm, by one browser: what there is to see and to open is seen by everybody.
import { describe } from 'node:test';
import './support/browser.mjs'; // whose browser ends with the program, not with the first subject
import './alarmed_pages/alarmed.mjs';

describe('alarmed_pages', { concurrency: 2 }, () => {
    for (const subject of ['accessible', 'room', 'words', 'walls'])
        describe(subject, { concurrency: 1 }, () => import(`./alarmed_pages/${subject}.mjs`));
});
