// SPDX-License-Identifier: GPL-3.0-or-later
// Subjects of the page on one demo plant, by one browser: a daemon of the demo takes two seconds of a processor to its first picture.
// One after the other: they hold its readings, and let them go.
import { describe } from 'node:test';
import './support/browser.mjs'; // whose browser ends with the program, not with the first subject
import './demo_pages/demo.mjs';

for (const subject of ['screens', 'views', 'codecs', 'rings'])
    describe(subject, () => import(`./demo_pages/${subject}.mjs`));
