// SPDX-License-Identifier: GPL-3.0-or-later
// A renderer keeps no history: it gets trends, gaps, the journal, pictures and sessions of the past, and differences from past
// values from its core.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { isDeepStrictEqual } from 'node:util';
import { openPage, settle, shoot, travel, waitForHealth, waitForPicture } from './support/browser.mjs';
import { missingClocks, withClockOff } from './support/clocks.mjs';
import { Node, Nodes, sleep, until } from './support/nodes.mjs';
import { FLAG, PlainClient } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram } from './support/tiny_plant.mjs';

const options = { skip: notBuilt() || (missingClocks() ?? false), timeout: 240000 };
const BEGIN_S = Math.floor(Date.now() / 1000) - 7200;
const at = (s) => (BEGIN_S + s) * 1e6, iso = (s) => new Date((BEGIN_S + s) * 1000).toISOString();
let nodes, core, renderer;

// TI-1 is a wave for an hour; TI-2 is bad from minute 10 to 20; then nothing is recorded. One tag has every sample.
function series() {
    const lines = ['Tag,Time,Value,Quality'];
    for (let s = 0; s <= 3600; s++)
        lines.push(`TI-1,${BEGIN_S + s},${(50 + 40 * Math.sin(s / 3)).toFixed(2)},Good`);
    for (let s = 0; s <= 3600; s += 10)
        lines.push(s >= 600 && s < 1200 ? `TI-2,${BEGIN_S + s},,0x80050000` : `TI-2,${BEGIN_S + s},${30 + s / 100},Good`);
    return `${lines.join('\n')}\n`;
}

setUp(options.skip, async (own) => {
    nodes = own(await Nodes.create());
    writeFileSync(join(nodes.plant.folder, 'series.csv'), series());
    const imported = runProgram('plantcast', ['history', 'import', nodes.plant.file, join(nodes.plant.folder, 'series.csv')]);
    assert.equal(imported.code, 0, imported.err);
    await nodes.plant.set({ 'TI-1': 95, 'TI-2': 20, 'PI-1': 5 });
    core = await nodes.core();
    renderer = await nodes.renderer('far', core);
    await until('readings', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
});

const body = async (node, path, token) => {
    const answer = await node.fetch(path, token);
    return [answer.status, answer.headers.get('content-type'), await answer.text()];
};
// Returns the answers of the core and of the renderer to the same request. Repeats until the core answers the same before and
// after the renderer: answers end with the first row after the range, and the core may record that row at any moment.
async function bothAt(path) {
    for (;;) {
        const earlier = await body(core, path), here = await body(renderer, path), there = await body(core, path);
        if (isDeepStrictEqual(earlier, there))
            return { there, here };
    }
}
const range = `from=${iso(-60)}&to=${iso(4000)}`;

test('a renderer serves the core\'s series, gaps and journal, byte for byte', options, async () => {
    await until('an alarm in the journal', async () => (await body(core, '/api/v1/alarms/journal'))[2].includes('TI-1'));
    for (const path of [`/api/v1/history?tags=TI-1&${range}&points=100`, `/api/v1/history?tags=TI-1,TI-2,PI-1&${range}`,
        `/api/v1/history?tags=TI-2,TI-1&${range}&points=20000`, `/api/v1/history?tags=PI-1,TI-1,TI-2&${range}&points=400&format=csv`,
        `/api/v1/history?tags=TI-1,TI-2&${range}&points=20000&format=csv`, `/api/v1/history/gaps?${range}`,
        `/api/v1/drift?group=temperature&to=${iso(3700)}`, `/api/v1/drift?tag=TI-1&to=${iso(3700)}`,
        `/api/v1/alarms/journal?to=${iso(7300)}`, `/api/v1/alarms/journal?format=csv&tag=TI-1&from=${iso(0)}&limit=5`]) {
        const { there, here } = await bothAt(path);
        assert.equal(there[0], 200, there[2]);
        assert.deepEqual(here, there, path);
    }
    const [status, , text] = await body(renderer, `/api/v1/history?tags=TI-2,TI-1&from=${iso(0)}&to=${iso(1200)}&points=400&format=csv`);
    assert.equal(status, 200);
    assert.match(text, /^Tag,Time,Value[^]*\r\nTag,Time,Low/, 'the export contains values and intervals');
    assert.equal((await body(renderer, '/api/v1/history?tags=NO-1'))[0], 400);
});

test('core and renderer draw byte-identical pictures of the past; past readings have their past quality', options, async () => {
    for (const s of [5, 900, 5000]) {
        const path = `/snapshot.png?width=240&height=160&fit=E-101&at=${iso(s)}`;
        const [one, other] = await Promise.all([core, renderer].map(
            async (node) => Buffer.from(await (await node.fetch(path)).arrayBuffer())));
        assert.equal(one.subarray(1, 4).toString(), 'PNG', one.toString());
        assert.ok(one.equals(other), `${s} s into the past: pictures of ${one.length} and ${other.length} bytes differ`);
    }
    const seen = async (node) => {
        const client = await PlainClient.open(node.port);
        await client.hello({ token: nodes.tokens.operator });
        const { from_us } = await client.until('a beginning', () => client.texts.find((m) => m.type === 'time' && m.from_us));
        client.say({ type: 'time', at_us: at(900), speed: 0 });
        await client.frameWhere('of then', (p) => p.flags & FLAG.past && p.data_time_us === at(900));
        const tags = await client.until('tags of then', () => client.texts.find((m) => m.type === 'tags' && m.time_us === at(900)));
        client.say({ type: 'params', seq: 7, show: 'difference', baseline: { set: 'then' } });
        const { baseline } = await client.until('a baseline of then', () => client.texts.find((m) => m.type === 'params' && m.seq === 7));
        client.say({ type: 'time', at_us: at(1000), speed: 60 });
        await client.frameWhere('a minute later', (p) => p.flags & FLAG.past && p.data_time_us > at(1060));
        client.close();
        return { from_us, values: tags.values, baseline };
    };
    const [there, here] = [await seen(core), await seen(renderer)];
    assert.equal(there.from_us, at(0));
    assert.deepEqual(here, there);
    assert.equal(here.values[1][3], 'Bad_CommunicationError');
    assert.deepEqual(here.baseline, { name: 'then', time_us: at(900) });
});

test('the page of a renderer shows trends and the past', options, async () => {
    const { page, errors, close } = await openPage(`http://127.0.0.1:${renderer.port}/`, { viewport: { width: 1440, height: 900 } });
    await waitForPicture(page);
    await waitForHealth(page, 'live');
    await page.evaluate(() => globalThis.plantcast.selectTag(globalThis.plantcast.session.model.tag('TI-1')));
    // Clicks by script: if the card moves between press and release of the mouse button, the browser sends no click.
    await page.locator('#card .trend').evaluate((button) => button.click());
    await page.locator('#trend-chart canvas').waitFor();
    await page.locator('#trend-tags', { hasText: /TI-1.*°C/ }).waitFor();
    await travel(page, at(900));
    await page.waitForFunction((us) => globalThis.plantcast.session.time.atUs === us, at(900));
    await settle(page);
    await page.locator('#trend-span label', { hasText: '1 h' }).click();
    // waits until the chart shows the whole hour (a reading per second), more than 100 points
    await page.waitForFunction(() => globalThis.plantcast.trends.chart.data[0].length > 100);
    await page.locator('#clock-name', { hasText: /^Time shown/ }).waitFor();
    await shoot(page, 'core-history');
    assert.deepEqual(errors, []);
    await close();
});

test('users at the renderer need their own token for history, the renderer its own, valid for nothing else', options, async () => {
    const path = `/api/v1/history?tags=TI-1&${range}`, proxy = ['--behind-proxy', '--host', '127.0.0.1'];
    const args = ['--role', 'core', '--port', '0', '--tokens', nodes.tokenFile, ...proxy];
    const strict = new Node(nodes.plant, [...args, '--history', join(nodes.plant.folder, 'strict')]);
    nodes.all.push(strict);
    await strict.ready();
    const far = await nodes.renderer('strict', strict, ...proxy);
    await until('readings', async () => (await far.tags(nodes.tokens.viewer))['TI-1'].quality_name === 'Good');
    assert.equal((await body(far, path))[0], 401);
    assert.equal((await body(far, path, nodes.tokens.viewer))[0], 200);
    assert.equal((await body(far, path, nodes.tokens.renderer))[0], 200);
    for (const [asked, token, status] of [[path, 'renderer', 200], ['/api/v1/tags', 'renderer', 403], ['/metrics', 'renderer', 403],
        ['/snapshot.png', 'renderer', 403], ['/core/instant?at_us=1', 'viewer', 403], ['/core/instant?at_us=1', 'operator', 403],
        ['/core/instant?at_us=1', 'renderer', 200], ['/core/instant?at_us=-1', 'renderer', 400],
        ['/core/instant?at_us=1e3', 'renderer', 400], ['/core/instant', 'renderer', 400],
        ['/core/tags', 'operator', 403], ['/core/tags', 'renderer', 200]])
        assert.equal((await body(strict, asked, nodes.tokens[token]))[0], status, `${asked} with the token of ${token}`);
    await far.stop();
    await strict.stop();
});

test('"an hour ago" follows the core\'s clock, even if the renderer\'s clock is an hour wrong', options, async () => {
    const args = ['--role', 'render', '--port', '0', '--trust-local', '--core', core.url, '--core-token-file', nodes.rendererFile];
    const off = new Node(nodes.plant, args, nodes.plant.file, withClockOff(-3600));
    nodes.all.push(off);
    await off.ready();
    await until('readings', async () => (await off.tags())['TI-1'].quality_name === 'Good');
    const askedUs = Date.now() * 1000;
    const { from_us, to_us } = JSON.parse((await body(off, '/api/v1/history?tags=TI-1&from=-1h'))[2]);
    assert.ok(to_us > askedUs - 5e6 && to_us < Date.now() * 1000 + 5e6, `${to_us}, asked at ${askedUs}`);
    assert.equal(to_us - from_us, 3600e6);
    await off.stop();
});

// Returns the recorded points within the range. The answer also has the first point after the range, which the core may record
// at any moment, so it is left out.
const recorded = async (path) => {
    const { series, to_us: end } = JSON.parse((await body(renderer, path))[2]);
    return series.map(({ points }) => points.filter(([us]) => us <= end));
};

test('without its core a renderer logs once that it has no history; history returns with the core', options, async () => {
    const path = `/api/v1/history?tags=TI-1&${range}&points=20000`, before_ = await recorded(path), { port } = core;
    const picture = `/snapshot.png?width=240&height=160&at=${iso(77)}`;
    await core.stop('SIGKILL');
    await until('its loss', async () => await renderer.metric(`plantcast_core_up{core="${core.url}"}`) === 0);
    for (const one of [path, path, path, picture, `/api/v1/history/gaps?${range}`, '/api/v1/alarms/journal']) {
        const answer = await renderer.fetch(one);
        assert.deepEqual([answer.status, Number(answer.headers.get('retry-after')) > 0], [503, true], one);
        assert.match(await answer.text(), /^unavailable: the core cannot be reached; try again\n$/, one);
    }
    const lost = /history: cannot read from the core: \/api\/v1\/history: not connected to the core/g;
    await renderer.program.line(lost);
    assert.ok(renderer.program.said.match(lost).length <= 2);
    core = await nodes.core(port);
    await until('readings', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
    assert.deepEqual(await recorded(path), before_);
    assert.equal((await renderer.fetch(picture)).status, 200);
    core.program.child.kill('SIGSTOP'); // stopped by SIGSTOP, the core's system still accepts connections, but the core does not answer
    const waits = renderer.fetch(path).catch(() => null);
    await sleep(300);
    assert.equal((await renderer.fetch('/healthz')).status, 200, 'other clients do not wait');
    core.program.child.kill('SIGCONT');
    await waits;
});
