// SPDX-License-Identifier: GPL-3.0-or-later
// The demo plant that all subjects of this folder look at, each by pages of its own. Its readings stay frozen once a subject froze them.
import { after } from 'node:test';
import { startPlant } from '../support/plant.mjs';

let plant;
after(async () => (await plant)?.stop());

// Started by who asks first.
export function demo() {
    plant ??= startPlant();
    return plant;
}
