// SPDX-License-Identifier: GPL-3.0-or-later
// Starts the plant of two boxes that the tests of tools and of sections share. Each test opens its own pages, and none changes the
// plant, except TI-1's value.
import { after } from 'node:test';
import { TinyPlant } from '../support/tiny_plant.mjs';

let plant;
after(async () => (await plant)?.destroy());

// Returns a promise of the plant. The first call starts it.
export function boxes() {
    plant ??= TinyPlant.running({ fresh: true });
    return plant;
}
