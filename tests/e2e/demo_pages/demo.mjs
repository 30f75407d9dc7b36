// SPDX-License-Identifier: GPL-3.0-or-later
// The demo plant that all subjects of this folder look at, each by pages of its own. Its readings stand still but for what a subject
// sets: else each page has pictures drawn all the time.
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

// Started by who asks first.
export function demo() {
    plant ??= start();
    return plant;
}
