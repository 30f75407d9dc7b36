// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the page's tools in one browser: the toolbar, trends and the past, and direct manipulation of the picture.
import { describe } from 'node:test';
// imported by this file, so that browser and plant end with the program and not with the first group of tests
import './support/browser.mjs';
import './tool_pages/boxes.mjs';

describe('tool_pages', { concurrency: 2 }, () => {
    for (const subjects of [['tools', 'clip_gizmo'], ['time'], ['step']])
        describe(subjects.join(), { concurrency: 1 }, () => {
            for (const subject of subjects)
                describe(subject, { concurrency: 1 }, () => import(`./tool_pages/${subject}.mjs`));
        });
});
