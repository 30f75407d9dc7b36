// SPDX-License-Identifier: GPL-3.0-or-later
// Short tests of the page, each with its own plant, in one browser, because starting a browser costs more than most of these
// tests.
import { describe } from 'node:test';
// imported by this file, so that the browser is closed after the last group of tests and not after the first
import './support/browser.mjs';

describe('pages', { concurrency: 2 }, () => {
    for (const subject of ['tour', 'start', 'roles', 'named_views', 'arrows', 'crowd', 'drift', 'singles', 'handover',
        'first_tasks'])
        describe(subject, { concurrency: 1 }, () => import(`./pages/${subject}.mjs`));
});
