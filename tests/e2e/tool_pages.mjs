// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the page's tools in one browser: the toolbar, trends and the past, and direct manipulation of the picture.
import { describe } from 'node:test';
import './support/browser.mjs'; // imported here, so that the browser ends with the program and not with the first group of tests

describe('tool_pages', { concurrency: 2 }, () => {
    for (const subject of ['tools', 'time', 'step'])
        describe(subject, { concurrency: 1 }, () => import(`./tool_pages/${subject}.mjs`));
});
