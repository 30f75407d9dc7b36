// SPDX-License-Identifier: GPL-3.0-or-later
// One daemon (the core) reads the devices, and two others (renderers) draw: readings, alarms and operators' actions are passed
// between the daemons, and the renderers report the loss of the core.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { join } from 'node:path';
import { test } from 'node:test';
import { makeCertificate } from './support/certificate.mjs';
import { Node, Nodes, until } from './support/nodes.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { otherVersion } from './support/other_version.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, Program, runProgram } from './support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 300000 };
let nodes, core, a, b, setAt;

setUp(options.skip, async (own) => {
    nodes = own(await Nodes.create({ slowDevice: true }));
    core = await nodes.core();
    [a, b] = await Promise.all([nodes.renderer('a', core), nodes.renderer('b', core)]);
    await nodes.plant.set({ 'TI-1': 80.25, 'TI-2': 20, 'PI-1': 5 });
    setAt = performance.now();
});

const alarm = async (node, state, name = 'TI-1') => {
    const { alarms } = await (await node.fetch('/api/v1/alarms')).json();
    return alarms.find((one) => one.tag === name && one.state === state);
};
const all = (question) => until('all nodes', async () => (await Promise.all([core, a, b].map(question))).every(Boolean));
const ack = (seq, tag = 'TI-1') => ({ type: 'alarm', seq, action: 'acknowledge', alarms: [[tag, 'H']] });

test('renderers show the core\'s values, qualities and source times; the device sees one poller', options, async () => {
    await all(async (node) => (await node.tags())['TI-1'].value === 80.25);
    await nodes.plant.tell('fail PI-1');
    const bad = await until('Bad', async () => {
        const { quality_name } = (await core.tags())['PI-1'];
        return !quality_name.startsWith('Good') && quality_name.startsWith('Bad') && quality_name;
    });
    await all(async (node) => (await node.tags())['PI-1'].quality_name === bad);
    await nodes.plant.tell('release PI-1');
    await all(async (node) => (await node.tags())['PI-1'].quality_name === 'Good');
    // the value was set more than 1 s ago, after which a reading becomes stale; unchanged readings must stay Good
    await until('its stale time', () => performance.now() - setAt > 1100);
    await until('a steady value that is not stale', async () => (await a.tags())['TI-2'].quality_name === 'Good');
    await nodes.onePoller();
    await until('two renderers', async () => await core.metric('plantcast_renderers') === 2);
});

test('two renderers draw byte-identical pictures of one view', options, async () => {
    const picture = async (node) => Buffer.from(await (await node.fetch('/snapshot.png?width=240&height=160&fit=E-101')).arrayBuffer());
    // the comparison is repeated, because for a moment one daemon may still draw an older reading
    await until('equal pictures', async () => {
        const [one, two, three] = await Promise.all([core, a, b].map(picture));
        assert.equal(one.subarray(1, 4).toString(), 'PNG');
        return one.equals(two) && two.equals(three);
    });
});

test('an acknowledgement at one renderer is done by the core with the user\'s name, and reaches all nodes', options, async () => {
    await nodes.plant.tell('set TI-1 95.5');
    await all((node) => alarm(node, 'unacknowledged'));
    const viewer = await a.client({}, { token: nodes.tokens.viewer });
    viewer.say(ack(1));
    assert.equal((await viewer.text('error')).code, 'not_allowed');
    viewer.close();
    const anna = await a.client({}, { token: nodes.tokens.operator });
    anna.say(ack(2));
    const { seq, done } = await anna.text('alarmed');
    assert.deepEqual([seq, done], [2, 1]);
    await all(async (node) => (await alarm(node, 'acknowledged'))?.who === 'anna');
    const shelve = async (seq, seconds) => {
        anna.say({ type: 'alarm', seq, action: 'shelve', alarms: [['TI-1', 'H']], for_s: seconds, reason: 'is looked at' });
        await anna.text('alarmed');
    };
    await shelve(3, 3600);
    await all(async (node) => (await alarm(node, 'shelved'))?.reason === 'is looked at');
    await shelve(4, 1);
    // once the shelving time of 1 s is over, the core tells the renderers that the alarm is no longer shelved
    await all(async (node) => !await alarm(node, 'shelved'));
    const { rows } = await (await core.fetch('/api/v1/alarms/journal')).json();
    assert.deepEqual([...new Set(rows.filter(({ who }) => who === 'anna').map(({ event }) => event))].sort(), ['acknowledge', 'shelve']);
    anna.close();
});

test('notes, views and short links of one renderer appear at the others', options, async () => {
    const anna = await a.client({}, { token: nodes.tokens.operator });
    anna.say({ type: 'note', seq: 1, text: 'leaks a little', asset: 'E-101' });
    await anna.text('noted');
    anna.say({ type: 'save_view', seq: 2, id: 'pump', title: 'The pump', view: 'asset=P-101A' });
    await anna.text('view_saved');
    anna.say({ type: 'share_view', seq: 3, view: 'asset=P-101A' });
    const { id, kept } = await anna.text('view_shared');
    assert.deepEqual([id, kept], ['vyj5ny9g', true]);
    await all(async (node) => (await (await node.fetch('/api/v1/notes')).text()).includes('leaks a little'));
    await all(async (node) => (await (await node.fetch('/api/v1/views')).text()).includes('The pump'));
    await all(async (node) => (await (await node.fetch(`/api/v1/link?id=${id}`)).text()) === '{"view":"asset=P-101A"}');
    anna.close();
});

test('a loop check at the core marks tags at the renderers, which make no checks themselves', options, async () => {
    const engineer = await core.client(), viewer = await a.client({}, { token: nodes.tokens.viewer });
    const { all: whole, begun, tags } = await viewer.text('proofs');
    assert.deepEqual([whole, begun, tags], [true, false, []]);
    const prove = { type: 'prove', seq: 1, tag: 'TI-2', expected: 20, tolerance: 0.5, remark: 'by hand' };
    engineer.say({ ...prove, fail: true });
    assert.equal((await engineer.text('proved')).kept, true);
    const first = await viewer.text('proofs'), [[index, ...row]] = first.tags;
    assert.deepEqual([first.begun, viewer.welcome.tags[index].name, row[0], ...row.slice(2)],
        [true, 'TI-2', 'fail', 20, 20, 0.5, 'local', 'by hand']);
    engineer.say({ ...prove, seq: 2 });
    assert.equal((await viewer.text('proofs')).tags[0][1], 'pass');
    const late = await nodes.renderer('later', core), newcomer = await late.client({}, { token: nodes.tokens.viewer });
    await newcomer.until('the check', ({ texts }) => texts.some(({ type, begun, tags }) =>
        type === 'proofs' && begun && tags.some(([, result]) => result === 'pass')));
    const local = await a.client();
    local.say({ ...prove, seq: 3 });
    const { code, refusal } = await local.text('error'), list = await a.fetch('/api/v1/proofs');
    assert.deepEqual([code, refusal.code, list.status], ['no_history', 'core_checks', 404]);
    assert.match(await list.text(), /page of the core/);
    for (const client of [engineer, viewer, newcomer, local])
        client.close();
    await late.stop();
});

test('when a core is killed, all readings are Bad within 3 s, actions are refused, and both recover with it', options, async (t) => {
    const client = await a.client({}, { token: nodes.tokens.operator });
    const { port } = core;
    await core.stop('SIGKILL');
    const began = performance.now();
    await until('Bad', async () => Object.values(await a.tags()).every(({ quality_name }) => quality_name.startsWith('Bad')));
    await client.until('it being said', ({ texts }) => texts.some(({ type, links, live }) => type === 'status' && !live &&
        links.some(({ source, up }) => source === 'core' && !up)));
    promise(t, 'until all is Bad, and said', performance.now() - began, 3000);
    client.say(ack(7));
    assert.equal((await client.text('error')).code, 'core_lost');
    client.say({ type: 'share_view', seq: 8, view: 'asset=P-101A' });
    const { code, about } = await client.text('error');
    assert.deepEqual([code, about], ['core_lost', 'share_view']);
    const link = async (node, id) => (await node.fetch(`/api/v1/link?id=${id}`)).status;
    const late = await nodes.renderer('late', { url: `ws://127.0.0.1:${port}` });
    assert.deepEqual([await link(a, 'vyj5ny9g'), await link(a, 'unknown1'), await link(late, 'vyj5ny9g')], [200, 503, 503]);
    core = await nodes.core(port);
    await until('the links', async () => await link(late, 'vyj5ny9g') === 200 && await link(late, 'unknown1') === 404);
    await late.stop();
    await all(async (node) => (await node.tags())['TI-1'].quality_name === 'Good');
    const standing = async (node) => (await (await node.fetch('/api/v1/alarms')).json()).alarms
        .map(({ tag, kind, state, who }) => `${tag} ${kind} ${state} ${who}`).sort().join('; ');
    await until('alarms that are the core\'s', async () => {
        const [own, ...others] = await Promise.all([core, a, b].map(standing));
        return own.includes('TI-1 H') && others.every((other) => other === own);
    });
    await all(async (node) => (await (await node.fetch('/api/v1/notes')).text()).includes('leaks a little'));
    await nodes.onePoller();
    client.close();
});

test('a frozen core counts as lost after 2 s; a frozen renderer delays no other', options, async (t) => {
    let began = performance.now();
    core.program.child.kill('SIGSTOP');
    await until('Bad', async () => (await a.tags())['TI-1'].quality_name.startsWith('Bad'));
    promise(t, 'until it is lost', performance.now() - began, 3000);
    core.program.child.kill('SIGCONT');
    await all(async (node) => (await node.tags())['TI-1'].quality_name === 'Good');
    b.program.child.kill('SIGSTOP');
    began = performance.now();
    await nodes.plant.tell('set TI-2 33');
    await until('the other one', async () => (await a.tags())['TI-2'].value === 33);
    promise(t, 'until the other one has it', performance.now() - began, 3000);
    b.program.child.kill('SIGCONT');
    await all(async (node) => (await node.tags())['TI-2'].value === 33);
});

test('errors name a core of another plant or configuration, a wrong token, and a daemon that is no core', options, async () => {
    const other = join(nodes.plant.folder, 'other.yaml');
    writeFileSync(other, readFileSync(nodes.plant.file, 'utf8').replace('max: 10', 'max: 11'));
    const prepared = join(nodes.plant.folder, 'plant.prepared');
    assert.equal(runProgram('plantcast-prep', [other]).code, 0, prepared);
    const args = ['--role', 'render', '--port', '0', '--core', core.url];
    const start = (file, ...more) => {
        const program = new Program('plantcastd', [file, ...args, ...more]);
        nodes.all.push({ program });
        return program;
    };
    const wrong = [
        [start(other, '--core-token-file', nodes.rendererFile), /no readings: configuration: the renderer has \w{16}, this node \w{16}/],
        [start(nodes.plant.file, '--core-token-file', nodes.viewerFile), /no readings: .*this node's token has the role renderer/],
    ];
    const alone = await nodes.start(['--port', '0', '--role', 'all', '--history', join(nodes.plant.folder, 'h2')]);
    wrong.push([new Program('plantcastd', [nodes.plant.file, '--role', 'render', '--port', '0', '--core', alone.url]),
        /no readings: .*check that the core runs with --role core/]);
    nodes.all.push({ program: wrong[2][0] });
    for (const [program, said] of wrong) {
        await program.line(said);
        await program.stop();
    }
    await alone.stop();
    await core.program.line(/renderer .*: refused: configuration: the renderer has/);
    for (const [bad, said] of [[['--role', 'renderer'], /--role: expected all, core or render/],
        [['--role', 'render'], /--role render requires --core URL/],
        [['--core', 'ws://x:1'], /--core URL requires --role render/], [['--role', 'render', '--core', 'ftp://x'], /--core: expected wss/]])
        assert.match(runProgram('plantcastd', [nodes.plant.file, ...bad]).err, said);
});

test('a core of another version or plant with the same tags is named by both nodes; its readings are not used', options, async () => {
    const { program, version, other } = otherVersion(nodes.plant.folder), path = (name) => join(nodes.plant.folder, name);
    const said = spawnSync(program, ['--version'], { encoding: 'utf8' }).stdout;
    assert.match(said, new RegExp(`^plantcastd ${other.replaceAll('.', '\\.')}`));
    const named = path('named.yaml');
    writeFileSync(named, readFileSync(nodes.plant.file, 'utf8').replace('name: Two boxes', 'name: Another plant'));
    assert.equal(runProgram('plantcast-prep', [named]).code, 0);
    for (const [name, file, before_, theirs, ours] of [['newer', nodes.plant.file, ['sh', '-c', `shift; exec ${program} "$@"`, 'sh'],
        `version: the renderer has ${other}, this node ${version}`, `version: the renderer has ${other}, this node ${version}`],
    ['elsewhere', named, [], 'plant: the renderer has Another plant, this node Two boxes', 'plant: the renderer has Another plant']]) {
        const renderer = new Node(nodes.plant, ['--role', 'render', '--port', '0', '--trust-local', '--core', core.url, '--node', name,
            '--core-token-file', nodes.rendererFile], file, before_);
        nodes.all.push(renderer);
        await renderer.ready();
        await renderer.program.line(new RegExp(`no readings: .*${ours}`));
        await until('its refusal', () => core.program.said.includes(`renderer ${name}: refused: ${theirs}`));
        await until('more tries', async () => await renderer.metric('plantcast_core_refused_total') >= 3);
        assert.equal(core.program.said.split(`renderer ${name}: refused`).length, 2, 'the refusal is logged once');
        assert.ok(Object.values(await renderer.tags()).every(({ value }) => value === null));
        assert.equal(await renderer.metric(`plantcast_core_up{core="${core.url}"}`), 0);
        await renderer.stop();
    }
    await until('the others, which go on', async () => (await a.tags())['TI-1'].quality_name === 'Good');
});

test('a renderer\'s token opens no user\'s stream; malformed messages at /core end the connection', options, async () => {
    const core_ = { path: '/core', protocol: 'plantcast.core.v1', headers: [`Authorization: Bearer ${nodes.tokens.renderer}`] };
    await assert.rejects(PlainClient.open(core.port, { headers: core_.headers }), /403/);
    await assert.rejects(PlainClient.open(core.port, { ...core_, headers: [`Authorization: Bearer ${nodes.tokens.operator}`] }), /403/);
    await assert.rejects(PlainClient.open(core.port, { path: '/stream', protocol: 'plantcast.core.v1' }), /400/);
    const client = await PlainClient.open(core.port);
    client.say({ type: 'hello', width: 320, height: 180, codecs: ['jpeg'], token: nodes.tokens.renderer });
    assert.equal((await client.text('error')).code, 'not_allowed');
    for (const words of ['no JSON', '{"type":"act","id":1}', `{"type":"renderer","x":"${'y'.repeat(300000)}"}`, '[]']) {
        const stranger = await PlainClient.open(core.port, core_);
        stranger.say(words);
        await stranger.until('the end', ({ closed }) => closed);
    }
    await until('good readings', async () => (await core.tags())['TI-1'].quality_name === 'Good');
});

test('an action that the core cannot parse does not end the link; revoking the renderer\'s token does', options, async () => {
    const connects = await a.metric('plantcast_core_connects_total');
    const client = await a.client({}, { token: nodes.tokens.operator });
    const point = (more) => `{"type":"point","wall":"w","display":1,"x":${more}}`;
    client.say(point('['.repeat(2040) + ']'.repeat(2040)));
    client.say(point(`[${Array(14000).fill('1.1').join()}]`));
    // The core answers messages in the order in which it receives them, so the answer to this note shows that
    // the core has processed the messages above.
    client.say({ type: 'note', seq: 1, text: 'sent after them', asset: 'E-101' });
    await client.text('noted');
    assert.equal(await a.metric('plantcast_core_connects_total'), connects);
    await until('good readings', async () => (await a.tags())['TI-1'].quality_name === 'Good');
    client.close();
    const lines = readFileSync(nodes.tokenFile, 'utf8');
    writeFileSync(nodes.tokenFile, lines.split('\n').filter((line) => !line.startsWith('renderer')).join('\n'));
    await until('Bad', async () => (await a.tags())['TI-1'].quality_name.startsWith('Bad'));
    writeFileSync(nodes.tokenFile, lines);
    await all(async (node) => (await node.tags())['TI-1'].quality_name === 'Good');
});

test('`plantcast drain` sends a daemon\'s sessions to another node, and signals no other program', options, async (t) => {
    const c = await nodes.renderer('c', core), client = await c.client({}, { token: nodes.tokens.operator });
    const stranger = runProgram('plantcast', ['drain', String(process.pid)]);
    assert.deepEqual([stranger.code, stranger.err], [1, `plantcast: no plantcastd has the process ID ${process.pid}\n`]);
    assert.equal(runProgram('plantcast', ['drain', 'c']).code, 2);
    const pid = String(c.program.child.pid), began = performance.now();
    assert.equal(runProgram('plantcast', ['drain', pid, '--wait', '0']).code, 0);
    promise(t, 'until `plantcast drain` returns', performance.now() - began, 5000);
    await client.until('its end', ({ closed }) => closed);
    await c.program.line(/drain \(SIGUSR1\): moving 1 sessions to other daemons/);
    await c.stop();
    assert.equal(runProgram('plantcast', ['drain', pid]).code, 1);
});

const canMount = process.getuid() === 0 && spawnSync('unshare', ['--mount', 'true']).status === 0;
const alone = { ...options, skip: options.skip || (canMount ? false : 'nothing can be mounted here') };

test('each address of a core\'s host name is tried, and each failure is logged once', alone, async (t) => {
    const hosts = join(nodes.plant.folder, 'hosts'), said = /no readings/g;
    writeFileSync(hosts, '127.0.0.9 core.test\n127.0.0.1 core.test\n');
    let tries = 0;
    const stranger = createServer((socket) => { tries++; socket.destroy(); });
    await new Promise((done) => stranger.listen(0, '127.0.0.1', done));
    t.after(() => stranger.close());
    const start = (...urls) => {
        const program = new Program('plantcastd', [nodes.plant.file, '--role', 'render', '--port', '0', '--core-token-file',
            nodes.rendererFile, ...urls.flatMap((url) => ['--core', url])], {},
        ['unshare', '--mount', 'sh', '-c', `mount --bind ${hosts} /etc/hosts && exec "$@"`, 'sh']);
        nodes.all.push({ program });
        return program;
    };
    const host = await nodes.core(0, '--history', join(nodes.plant.folder, 'h4'), '--host', 'core.test');
    const good = start(`ws://core.test:${host.port}`);
    await good.line(/receiving readings/);
    await good.stop();
    await host.stop();
    const bad = start('ws://core.test:9', `ws://127.0.0.1:${stranger.address().port}`, `ws://core.test:${nodes.plant.modbusPort}`);
    await bad.line(/ready http/);
    await until('each to be named', () => (bad.said.match(said)?.length ?? 0) >= 3, 90, () => bad.said);
    await until('more tries', () => tries >= 3);
    assert.ok(bad.said.match(said).length <= 5, bad.said);
    await bad.stop();
});

test('over TLS, a core with an untrusted certificate is refused by name; a trusted core delivers readings', options, async () => {
    const path = (name) => join(nodes.plant.folder, name);
    for (const name of ['core', 'stranger'])
        makeCertificate(nodes.plant.folder, name, ['localhost']);
    const secure = await nodes.core(0, '--history', path('h3'), '--tls-cert', path('core.pem'), '--tls-key', path('core.key'));
    const renderer = (ca, host) => {
        const program = new Program('plantcastd', [nodes.plant.file, '--role', 'render', '--port', '0', '--core-token-file',
            nodes.rendererFile, '--core', `wss://${host}:${secure.port}`, '--core-ca', path(ca)]);
        nodes.all.push({ program });
        return program;
    };
    const wrong = [[renderer('stranger.pem', 'localhost'), /error core: .*no readings: .*check that the core's certificate is trusted/],
        [renderer('core.pem', '127.0.0.1'), /error core: .*no readings: .*check that the core's certificate is trusted/]];
    for (const [program, said] of wrong) {
        await program.line(said);
        assert.doesNotMatch(program.said, /receiving readings/);
        await program.stop();
    }
    const trusted = renderer('core.pem', 'localhost');
    await trusted.line(/receiving readings/);
    await trusted.stop();
    await secure.stop();
});
