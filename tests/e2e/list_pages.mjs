// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the page's lists in one browser: alarms, equipment, and the engineer's tags.
import { describe } from 'node:test';
import './support/browser.mjs'; // imported here, because this module closes the browser after the tests of the file that imports it first

describe('list_pages', { concurrency: 2 }, () => {
    for (const subject of ['alarms', 'engineer', 'accepting', 'assets', 'present', 'leaks'])
        describe(subject, { concurrency: 1 }, () => import(`./list_pages/${subject}.mjs`));
});
