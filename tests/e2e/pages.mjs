// SPDX-License-Identifier: GPL-3.0-or-later
// Short tests of the page, each with its own plant, in one browser, because starting a browser costs more than most of these
// tests.
import { describe } from 'node:test';
import './support/browser.mjs'; // imported here, so that the browser ends with the program and not with the first group of tests

describe('pages', { concurrency: 2 }, () => {
    for (const subject of ['tour', 'start', 'clip_gizmo', 'roles', 'named_views', 'arrows', 'crowd', 'drift', 'singles', 'handover',
        'first_tasks'])
        describe(subject, { concurrency: 1 }, () => import(`./pages/${subject}.mjs`));
});
