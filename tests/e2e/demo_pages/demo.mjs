// SPDX-License-Identifier: GPL-3.0-or-later
// Starts the demo plant that all groups of tests in this folder share. The groups run one after another; first_light kills and
// restarts the daemon. Readings change only when a test sets them, so that pages do not request pictures all the time.
import { after } from 'node:test';
import { startPlant } from '../support/plant.mjs';

let plant;
after(async () => (await plant)?.stop());

async function start() {
    const started = await startPlant();
    const { tags } = await (await fetch(`${started.url}api/v1/tags`)).json();
    await started.freeze(tags.map(({ name }) => name));
    return started;
}

// Returns a promise of the plant. The first call starts it.
export function demo() {
    plant ??= start();
    return plant;
}
