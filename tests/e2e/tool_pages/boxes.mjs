// SPDX-License-Identifier: GPL-3.0-or-later
// Starts the plant of two boxes that the tests of tools and of sections share. These groups run one after another. The tests of
// tools set TI-1's value, and write notes and remove them.
import { after } from 'node:test';
import { TinyPlant } from '../support/tiny_plant.mjs';

let plant;
after(async () => (await plant)?.destroy());

// Returns a promise of the plant. The first call starts it.
export function boxes() {
    plant ??= TinyPlant.running({ fresh: true });
    return plant;
}
