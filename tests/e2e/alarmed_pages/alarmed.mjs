// SPDX-License-Identifier: GPL-3.0-or-later
// Starts the plant with an active alarm that all tests in this folder share. Each test opens its own pages, and none changes
// the plant.
import { after } from 'node:test';
import { startAlarmed } from '../support/panels.mjs';

let plant;
after(async () => (await plant)?.[0].destroy());

// Returns a promise of [plant, url]. The first call starts the plant; it is destroyed after the last test.
export function alarmed() {
    plant ??= startAlarmed();
    return plant;
}
