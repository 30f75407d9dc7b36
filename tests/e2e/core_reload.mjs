// SPDX-License-Identifier: GPL-3.0-or-later
// A core that is reloaded takes its renderers along: they load the same files at the same time and switch when the core does.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { Nodes, until } from './support/nodes.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt } from './support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
const BLIND_MS = 10000;
let nodes, core, renderer;

setUp(options.skip, async (own) => {
    nodes = own(await Nodes.create({ slowDevice: true }));
    await nodes.plant.set({ 'TI-1': 50, 'TI-2': 20, 'PI-1': 5 });
    core = await nodes.core();
    renderer = await nodes.renderer('r', core);
    await until('readings', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
});

const change = (from, to) => writeFileSync(nodes.plant.file, readFileSync(nodes.plant.file, 'utf8').replace(from, to));
const configuration = async (node) => (await (await node.fetch('/metrics')).text())
    .split('\n').find((line) => /^plantcast_configuration_info.* 1$/.test(line));
const isThere = async () => await configuration(renderer) === await configuration(core) &&
    (await renderer.tags())['TI-1'].quality_name === 'Good';

test('when the core reloads its files, its renderers load the same files at the same time', options, async (t) => {
    const before_ = await configuration(core), began = performance.now();
    change('max: 100 }', 'max: 101 }');
    core.program.child.kill('SIGHUP');
    await renderer.program.line(/reload: configuration \w+ replaced \w+ after [\d.]+ s, requested by the core/);
    await until('the new configuration at both', async () => await configuration(core) !== before_ && isThere());
    promise(t, 'from the signal to readings at the renderer', performance.now() - began, BLIND_MS);
    assert.equal(await renderer.metric('plantcast_core_refused_total'), 0, 'the renderer did not switch before the core');
});

test('files that the core refuses change nothing at the renderer', options, async () => {
    const before_ = await configuration(renderer);
    change('max: 101 }', 'max: -1 }');
    core.program.child.kill('SIGHUP');
    await Promise.all([core, renderer].map(({ program }) => program.line(/reload: refused, so the daemon keeps the configuration/)));
    assert.equal(await configuration(renderer), before_);
    await until('readings', isThere);
});

test('renderers follow a core that was restarted with other files', options, async () => {
    change('max: -1 }', 'max: 102 }');
    await core.stop();
    core = await nodes.core(core.port);
    await until('the configuration of the core at the renderer', isThere);
    assert.ok(await renderer.metric('plantcast_core_refused_total') > 0);
});
