// SPDX-License-Identifier: GPL-3.0-or-later
// The plant with an alarm that all tests in this folder share, each with its own pages. None of them changes the plant.
import { after } from 'node:test';
import { startAlarmed } from '../support/panels.mjs';

let plant;
after(async () => (await plant)?.[0].destroy());

// Returns [plant, url]; the first caller starts the plant.
export function alarmed() {
    plant ??= startAlarmed();
    return plant;
}
