// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the page in one browser while something is missing: one of the page's own parts, or the way to its server.
import { describe } from 'node:test';
// imported by this file, so that the browser is closed after the last group of tests and not after the first
import './support/browser.mjs';

describe('lost_pages', { concurrency: 2 }, () => {
    for (const subject of ['weight', 'proxy'])
        describe(subject, { concurrency: 1 }, () => import(`./lost_pages/${subject}.mjs`));
});
