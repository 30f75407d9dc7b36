// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the page on one demo plant in one browser; they share the plant, because starting its daemon takes two seconds of
// processor time. The groups run one after another.
import { describe } from 'node:test';
// imported by this file, so that the browser is closed after the last group of tests and not after the first
import './support/browser.mjs';
import './demo_pages/demo.mjs';

for (const subject of ['screens', 'views', 'codecs', 'first_light', 'rings'])
    describe(subject, () => import(`./demo_pages/${subject}.mjs`));
