// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the page on one demo plant, in one browser: starting a demo daemon takes two seconds of processor time. They run one
// after another; each freezes the plant's readings and releases them.
import { describe } from 'node:test';
import './support/browser.mjs'; // imported here, so that the browser ends with the program and not with the first group of tests
import './demo_pages/demo.mjs';

for (const subject of ['screens', 'views', 'codecs', 'rings'])
    describe(subject, () => import(`./demo_pages/${subject}.mjs`));
