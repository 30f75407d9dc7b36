// SPDX-License-Identifier: GPL-3.0-or-later
// The page's tools, by one browser: those of the toolbar, trends and the past, and what hands do to the picture.
import { describe } from 'node:test';
import './support/browser.mjs'; // whose browser ends with the program, not with the first subject

describe('tool_pages', { concurrency: 2 }, () => {
    for (const subject of ['tools', 'time', 'step'])
        describe(subject, { concurrency: 1 }, () => import(`./tool_pages/${subject}.mjs`));
});
