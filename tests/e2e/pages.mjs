// SPDX-License-Identifier: GPL-3.0-or-later
// Short subjects of the page, each with a plant of its own, by one browser: it and what drives it cost more to start than most of these.
import { describe } from 'node:test';
import './support/browser.mjs'; // whose browser ends with the program, not with the first subject

for (const subject of ['start', 'singles', 'roles', 'clip_gizmo', 'handover', 'tour'])
    describe(subject, () => import(`./pages/${subject}.mjs`));
