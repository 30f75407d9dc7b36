// SPDX-License-Identifier: GPL-3.0-or-later
// The clocks of a core, a renderer and a page differ by an hour: the shown age of readings must still be right, and all times
// must follow the core's clock.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, shoot, waitForHealth, waitForPicture } from './support/browser.mjs';
import { missingClocks, withClockOff } from './support/clocks.mjs';
import { Node, Nodes, until } from './support/nodes.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt } from './support/tiny_plant.mjs';

const HOUR_S = 3600;
const options = { skip: notBuilt() || (missingClocks() ?? false), timeout: 240000 };
let nodes;

setUp(options.skip, async (own) => {
    // slowDevice: the daemon waits longer for the device's answers. Otherwise readings would become Bad on a busy machine, and
    // a picture without any Good reading has no age.
    nodes = own(await Nodes.create({ slowDevice: true }));
    await nodes.plant.set({ 'TI-1': 20, 'TI-2': 20, 'PI-1': 5 });
});

// Makes the page's clock wrong before its scripts run.
const wrongDate = (ms) => {
    const Real = Date;
    globalThis.Date = class extends Real {
        constructor(...given) {
            super(...(given.length > 0 ? given : [Real.now() + ms]));
        }

        static now() { return Real.now() + ms; }
    };
};
const startCore = async (name, off_s) => {
    const args = ['--role', 'core', '--port', '0', '--trust-local', '--tokens', nodes.tokenFile,
        '--history', join(nodes.plant.folder, name)];
    const core = new Node(nodes.plant, args, nodes.plant.file, withClockOff(off_s));
    nodes.all.push(core);
    return core.ready();
};
// Checks that a time lies between two instants, within 5 s, which is how long an answer may take on a busy machine.
const between = (us, first_us, last_us, what) => assert.ok(us > first_us - 5e6 && us < last_us + 5e6,
    `${what}: ${(us - first_us) / 1e6} s after the request, which took ${(last_us - first_us) / 1e6} s`);
const alarmOf = async (node) => (await (await node.fetch('/api/v1/alarms')).json()).alarms
    .find(({ tag, state }) => tag === 'TI-1' && state === 'unacknowledged');

for (const off_s of [HOUR_S, -HOUR_S])
    test(`ages stay true with a core an hour ${off_s > 0 ? 'ahead of' : 'behind'} its renderer, and a page an hour beyond that`,
        options, async () => {
        await nodes.plant.tell('set TI-1 20');
        const core = await startCore(`off${off_s}`, off_s), renderer = await nodes.renderer('far', core);
        const coreUs = () => (Date.now() + off_s * 1000) * 1000;
        await renderer.program.line(new RegExp(`the core's clock is 3\\d{3}\\.\\d s ${off_s > 0 ? 'ahead of' : 'behind'} this machine's`));
        assert.ok(Math.abs(await renderer.metric('plantcast_core_clock_ahead_seconds') - off_s) < 5);
        await until('readings', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
        await nodes.plant.tell('set TI-1 95.5');
        const raised = await until('an alarm', () => alarmOf(renderer));
        assert.deepEqual(raised, await alarmOf(core));

        const client = await renderer.client({}, { token: nodes.tokens.operator });
        let asked_us = coreUs();
        client.say({ type: 'ping', t: 1 });
        between((await client.text('pong')).time_us, asked_us, coreUs(), 'the clock that clients are told');
        asked_us = coreUs();
        const { headers } = await renderer.fetch('/snapshot.png?width=320&height=200&fit=E-101');
        const [header, at_us, age_ms] = /data_time_us=(\d+), oldest_age_ms=(\d+)/.exec(headers.get('plantcast-frame'));
        between(Number(at_us), asked_us, coreUs(), 'the time in a picture');
        assert.ok(Number(age_ms) < 5000, header);
        for (const { age_ms: age, name } of Object.values(await renderer.tags()))
            assert.ok(age >= 0 && age < 5000, `${name}: age of ${age} ms`);
        const shelve = async (seconds) => {
            client.say({ type: 'alarm', seq: 2, action: 'shelve', alarms: [['TI-1', 'H']], for_s: seconds, reason: 'is looked at' });
            await client.text('alarmed');
        };
        await shelve(3600);
        await until('its shelf', async () => !(await alarmOf(renderer)));
        const shelving = performance.now();
        await shelve(4); // now until then
        await until('its return', () => alarmOf(renderer));
        assert.ok(performance.now() - shelving > 3900, 'the alarm was shelved for 4 s, not an hour less');
        client.close();

        const { page, errors, close } = await openPage(`http://127.0.0.1:${renderer.port}/`, { viewport: { width: 1280, height: 800 } },
            [wrongDate, 2 * off_s * 1000]);
        await waitForPicture(page);
        await waitForHealth(page, 'live');
        await page.locator('#alarm-strip').click();
        const since = await page.locator('#alarms-list td[data-col=since]').first().textContent();
        assert.match(since, /^\d+(\.\d)? (s|min)$/, since);
        const time = /\d\d:\d\d:\d\d/.exec(await page.locator('#clock').textContent())[0];
        const times = [...Array(20).keys()].map((s) => new Date(coreUs() / 1000 - s * 1000).toISOString().slice(11, 19));
        assert.ok(times.includes(time), `${time} is not ${times[0]}`);
        assert.match(await page.locator('#age').textContent(), /^[\d.]+ s$/);
        await shoot(page, `clocks${off_s}`);
        assert.deepEqual(errors, []);
        await close();
        await renderer.stop();
        await core.stop();
        assert.equal(renderer.program.said.match(/the core's clock is/g).length, 1, 'the clock difference is logged once');
    });
