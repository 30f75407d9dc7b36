// SPDX-License-Identifier: GPL-3.0-or-later
// Short subjects of the page, each with a plant of its own, by one browser: it and what drives it cost more to start than most of these.
import { describe } from 'node:test';
import './support/browser.mjs'; // whose browser ends with the program, not with the first subject

describe('pages', { concurrency: 2 }, () => {
    for (const subject of ['tour', 'start', 'clip_gizmo', 'roles', 'named_views', 'arrows', 'crowd', 'drift', 'singles', 'handover'])
        describe(subject, { concurrency: 1 }, () => import(`./pages/${subject}.mjs`));
});
