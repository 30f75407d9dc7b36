// SPDX-License-Identifier: GPL-3.0-or-later
// The server that all tests in this folder share, not running at first, and a plant that uses it as a source.
import { after, afterEach, before } from 'node:test';
import { OpcuaServer } from '../support/opcua.mjs';
import { PublishedPlant } from '../support/published_plant.mjs';

let making;
after(async () => {
    const { server, plant } = await making ?? {};
    await plant?.destroy();
    await server?.destroy();
});

async function make() {
    const server = await OpcuaServer.create();
    return { server, plant: await PublishedPlant.create(server) };
}

// Sets up a group of tests that share one OPC UA server: calls take(server, plant) before the first test. Each test starts its
// own daemon.
export function shareOpcua(options, take) {
    let plant;
    before(async () => {
        if (options.skip)
            return;
        making ??= make();
        const made = await making;
        plant = made.plant;
        made.server.trust('server');
        if (made.server.runs)
            await made.server.restart({});
        take(made.server, plant);
    });
    afterEach(() => plant?.daemon?.stop());
}
