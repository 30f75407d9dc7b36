// SPDX-License-Identifier: GPL-3.0-or-later
// The demo plant that all tests of this folder use, each with pages of its own. Its readings change only when a test sets them; otherwise
// each page would have pictures drawn all the time.
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

// Returns the plant; the first caller starts it.
export function demo() {
    plant ??= start();
    return plant;
}
