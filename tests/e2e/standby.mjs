// SPDX-License-Identifier: GPL-3.0-or-later
// Two cores and a database: the leading core polls the devices and owns the alarms, and the standby takes over within 5 s after
// a kill -9. Whichever connection or program fails, the two must never poll at the same time, lose an operator action or send a
// notification twice.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { linkSync, readdirSync, renameSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { PlainClient } from './support/plain_client.mjs';
import { PostgresServer } from './support/postgres_server.mjs';
import { promise } from './support/promise.mjs';
import { long } from './support/promise.mjs';
import { HookServer } from './support/receivers.mjs';
import { setUp } from './support/set_up.mjs';
import { runProgram } from './support/tiny_plant.mjs';
import { kill, missingTwoCores, sleep, TAKE_OVER_MS, terms, TwoCores, until } from './support/two_cores.mjs';
import { becomes } from './support/until.mjs';

// A lease is valid for 3 s (LEASE_NS): numbers of renewals, every 0.5 s, and of polls, every 0.1 s, that take longer.
const LEASE_RENEWALS = 7, LEASE_POLLS = 35;
const skip = missingTwoCores(), options = { skip, timeout: 240000 };
let server, hook, two, renderer, feeding, from, cutAt, killedAt, pausedMs;

setUp(skip, async () => {
    server = await PostgresServer.start();
    server.makeDatabase('plants');
    hook = new HookServer();
    await hook.listen();
    two = await TwoCores.create(server, `notify:
  gather_s: 0
  pause_s: 0
  recipients: [{ id: hook, webhook: "http://127.0.0.1:${hook.port}/" }]
  rules: [{ id: all, to: hook }]
`);
    await two.plant.set({ 'TI-1': 50, 'TI-2': 20, 'PI-1': 5 });
});
after(async () => {
    await feeding?.();
    await two?.destroy();
    await hook?.close();
    await server?.destroy();
});

const CUT_POINTS = 8; // points of TI-2 that the leader records while it is cut off from the standby
// Returns the qualities of the first points of TI-2 in the database after the time `us`.
const pointsAfter = (us) => server.ask(`SELECT s.q FROM plantcast.sample s JOIN plantcast.tag g ON g.id = s.tag WHERE g.name = 'TI-2'
    AND s.t > to_timestamp(${us / 1e6}) ORDER BY s.t LIMIT ${CUT_POINTS}`).flat();
const begin = () => Math.floor(Date.now() / 1000) * 1e6;
// Changes TI-2 every 40 ms until feeding() is called, so that the history must record each sample.
function feed() {
    let going = true;
    const done = (async () => {
        for (let i = 0; going; i++) {
            await two.plant.tell(`set TI-2 ${20 + (i % 2) * 10 + i % 7}`);
            await sleep(40);
        }
    })().catch(() => {}); // the plant has ended
    feeding = async () => { going = false; await done; feeding = null; };
}

test('of two cores one leads, the other follows and is not ready; a renderer finds the leader', options, async (t) => {
    await Promise.all([two.start('one'), two.start('two')]);
    const core = await two.leader();
    renderer = await two.renderer('r');
    await two.followed(core);
    await until('readings at the renderer', async () => (await renderer.tags())['TI-1'].value === 50);
    const answer = await two.other(core).node.fetch('/readyz');
    assert.equal(answer.status, 503);
    assert.match(await answer.text(), /this core is the standby/);
    assert.equal((await two.other(core).node.fetch('/healthz')).status, 200);
    assert.equal(await core.node.metric('plantcast_core_active'), 1);
    assert.equal(await two.other(core).node.metric('plantcast_core_active'), 0);
    const link = ({ toOther }) => `plantcast_core_up{core="ws://127.0.0.1:${toOther.port}"}`, here = 'plantcast_core_up{core="this"}';
    assert.deepEqual([await core.node.metric(here), await core.node.metric(link(core))], [1, 0]);
    assert.deepEqual([await two.other(core).node.metric(here), await two.other(core).node.metric(link(two.other(core)))], [0, 1]);
    assert.equal(await core.node.metric('plantcast_renderers'), 1, 'the standby does not count as a renderer');
    assert.deepEqual(await two.network.overlaps(), []);
    assert.equal(terms(two.other(core)), 0);
    await core.program.line(/history: read \d+ points from PostgreSQL/);
    const months = readdirSync(join(two.plant.folder, core.name, 'history')).filter((name) => /^history-[\d-]+\.sqlite$/.test(name));
    // the core has one month file, or two if a month has just begun: it reads only months with points from the database and
    // creates no files for the others
    assert.ok(months.length < 3, `months without points are not queried: ${months}`);
    t.diagnostic(`${core.name} leads`);
});

test('kill -9 of each leader: the other core polls within 5 s, operators\' actions survive, no notification is repeated',
    options, async (t) => {
    feed();
    from = begin();
    let core = await two.leader();
    for (let round = 0; round < 4; round++) {
        const high = round % 2 === 0;
        await two.plant.tell(`set TI-1 ${high ? 95 : 50}`);
        await until('the alarm', async () => Boolean(await renderer.alarm()) === high);
        const anna = await renderer.client({}, { token: two.nodes.tokens.operator });
        if (high) {
            anna.say({ type: 'alarm', seq: 1 + round, action: 'acknowledge', alarms: [['TI-1', 'H']] });
            await anna.text('alarmed');
        }
        anna.say({ type: 'note', seq: 50 + round, text: `round ${round}`, asset: 'E-101' });
        await anna.text('noted');
        anna.close();
        // In the last round, the connection to the standby is cut before the leader is killed, so that the standby lacks the last
        // points and must read them from the database.
        const cut = round === 3 ? two.other(core).toOther : null;
        if (cut) {
            await cut.cut();
            cutAt = (Date.now() + 100) * 1000;
            await until('points after the cut', () => pointsAfter(cutAt).length >= CUT_POINTS);
            await feeding();
            await until('all points in the database', async () => await core.node.metric('plantcast_history_waiting_points') === 0 &&
                await core.node.metric('plantcast_postgres_waiting_points') === 0);
            killedAt = Date.now() * 1000;
        }
        const { leads, pause_ms } = await two.takeOver(t, core, kill(core, 'SIGKILL'));
        pausedMs = pause_ms;
        t.diagnostic(`${pause_ms.toFixed(0)} ms without a poller`);
        if (high) {
            const { state, who } = await leads.node.alarm();
            assert.deepEqual([state, who], ['acknowledged', 'anna']);
        }
        const notes = await (await leads.node.fetch('/api/v1/notes')).text();
        for (let i = 0; i <= round; i++)
            assert.match(notes, new RegExp(`round ${i}`));
        await until('the renderer is there', async () => (await renderer.tags())['TI-1'].quality_name === 'Good');
        await cut?.mend();
        await two.restart(core);
        await two.followed(leads);
        if (cut)
            feed();
        core = leads;
    }
    t.diagnostic(JSON.stringify(hook.taken.map(({ alarms, ...more }) => [more.id, alarms.map(({ tag, state }) => `${tag} ${state}`)])));
});

// Returns whether a point that the database lacks follows from its points, because it lies on the line between the neighbours
// or repeats the last value. A core begins a line with the first sample that it gets, so it may have such points. The database
// also lacks the last unchanged sample of a killed leader.
function isOnLine(points, us, value, quality) {
    const all = [...points].map(([at, text]) => [Number(at), ...text.split(' ')]).filter((one) => one[2] === quality);
    const next = all.findIndex(([at]) => at > Number(us)), [a, b] = [all[next - 1], all[next]];
    if (!a || !b)
        return false;
    if (b[0] - us > 1.5e6)
        return Number(a[1]) === Number(value);
    return Math.abs(a[1] - value + (b[1] - a[1]) * (us - a[0]) / (b[0] - a[0])) < 1e-9;
}

// Returns whether a point that only the database has lies between two points with its own value and quality. A core records no
// such points, but the core that returned has sent its first point to the database.
function isOfRest(points, us, value, quality) {
    const all = [...points].map(([at, text]) => [Number(at), ...text.split(' ')]), next = all.findIndex(([at]) => at > Number(us));
    return [all[next - 1], all[next]].every((one) => one && one[1] === value && one[2] === quality);
}

// maximum number of points waiting to be written at which files and database count as up to date; some always wait while values
// change
const FEW = 50;

// Only `make test-long` runs this test: its result depends on how two cores, a device and a database happen to be timed.
// historian_test covers the cases that depend on time with a simulated clock.
const inLong = { ...options, skip: skip || long };
test('history is complete: database and API agree, and only the take-overs are gaps', inLong, async () => {
    await sleep(5000);
    await feeding();
    await sleep(3000);
    const core = await two.leader();
    await two.followed(core);
    for (const node of [core, two.other(core)].map((one) => one.node))
        await until('the files are up to date', async () => await node.metric('plantcast_history_waiting_points') < FEW, 30);
    await until('the database is up to date', async () => await core.node.metric('plantcast_postgres_waiting_points') < FEW, 30);
    // [core, how often it must have read the points of another core's lead]: twice for the core whose standby was cut off and
    // came back, once for the other
    for (const [one, often] of [[core, 2], [two.other(core), 1]])
        await until('what it lacked is read', () => one.program.said.split('now polls devices and evaluates').pop()
            .match(/read \d+ points from PostgreSQL, covering the \d+ s in which another core led/g)?.length >= often, 60);
    const to = Math.floor(Date.now() / 1000 - 3) * 1e6;
    const all = new Map(server.ask(`SELECT (extract(epoch FROM s.t) * 1000000)::bigint, s.v, s.q FROM plantcast.sample s
        JOIN plantcast.tag g ON g.id = s.tag WHERE g.name = 'TI-2'
        AND s.t BETWEEN to_timestamp(${from / 1e6 - 300}) AND to_timestamp(${to / 1e6}) ORDER BY s.t`)
        .map(([us, value, quality]) => [us, `${value === '' ? '' : Number(value)} ${quality}`]));
    const sql = new Map([...all].filter(([us]) => us >= from));
    for (const one of [core, two.other(core)]) {
        const url = `/api/v1/history?tags=TI-2&from=${from / 1e6}&to=${to / 1e6}&points=20000`;
        const { series } = await (await one.node.fetch(url)).json();
        const here = new Map(series[0].points.filter(([us]) => us >= from && us <= to)
            .map(([us, value, quality]) => [String(us), `${value ?? ''} ${quality}`]));
        const lacks = (all, of) => [...all.keys()].filter((key) => of.get(key) !== all.get(key)).map((key) => `${key} ${all.get(key)}`);
        const extra = lacks(here, sql).filter((text) => !isOnLine(all, ...text.split(' ')));
        const lacking = lacks(sql, here).filter((text) => !isOfRest(here, ...text.split(' ')));
        assert.deepEqual([lacking.slice(0, 5), extra.slice(0, 5)], [[], []],
            `${one.name}: points only in the database; points only in the API`);
    }
    const good = [...sql].filter(([, text]) => text.endsWith(' 0')).map(([us]) => Number(us));
    assert.ok(good.length > 10 * two.takeOvers, `only ${good.length} good points`);
    assert.deepEqual(pointsAfter(cutAt), Array(CUT_POINTS).fill('0'), 'points after the cut are good');
    const next = [...sql].findIndex(([us, text]) => us > killedAt && text.endsWith(' 0'));
    assert.ok([...sql][next][0] - killedAt < (Math.max(TAKE_OVER_MS, pausedMs) + 500) * 1000);
    assert.match([...sql][next - 1][1], /^ [1-9]/, 'the line ends where the leader was killed');
});

test('no alarm was notified twice, and each alarm change is in both cores\' journals once', options, async () => {
    // one message per id, because a sender that was killed before it noted the success may send the message again with the same
    // id
    const messages = [...new Map(hook.taken.map((one) => [one.id, one])).values()];
    const told = messages.flatMap(({ alarms }) => alarms.map(({ tag, state, raised }) => `${tag} ${state} ${raised}`));
    assert.deepEqual(told.filter((one, i) => told.indexOf(one) !== i), []);
    const core = await two.leader(), cores = [core, two.other(core)];
    const journals = () => Promise.all(cores.map(async ({ node }) => (await (await node.fetch('/api/v1/alarms/journal')).json()).rows));
    // the standby gets a row a moment after the leader has written it
    await becomes(async () => {
        const [first, second] = (await journals()).map((list) => list.map((row) => JSON.stringify({ ...row, id: 0 })));
        return [...first.filter((row) => !second.includes(row)), ...second.filter((row) => !first.includes(row))];
    }, [], 'rows that only one journal has');
    const rows = await journals();
    for (const one of rows) {
        const changes = one.map(({ time_us, tag, kind, event, state, who }) => `${time_us} ${tag} ${kind} ${event} ${state} ${who}`);
        assert.deepEqual(changes.filter((row, i) => changes.indexOf(row) !== i), []);
    }
    const acknowledged = rows[0].filter(({ tag, kind, event }) => tag === 'TI-1' && kind === 'H' && event === 'acknowledge');
    assert.deepEqual(acknowledged.map(({ unit }) => unit), ['°C', '°C']);
});

test('the kernel ends a frozen leader, and the leader polls not one block more', options, async (t) => {
    const core = await two.leader();
    await two.followed(core);
    const { pause_ms } = await two.takeOver(t, core, kill(core, 'SIGSTOP'));
    const { signal } = await core.program.ended;
    assert.equal(signal, 'SIGKILL');
    assert.deepEqual(await two.network.overlaps(), []);
    t.diagnostic(`${pause_ms.toFixed(0)} ms without a poller`);
    await two.restart(core);
});

test('a standby that is loading its plant takes over as fast as an idle one', options, async (t) => {
    const core = await two.leader(), other = two.other(core), list = `${two.plant.folder}/tags.csv`;
    await two.followed(core);
    renameSync(list, `${list}.kept`);
    assert.equal(spawnSync('mkfifo', [`${list}.fifo`]).status, 0);
    linkSync(`${list}.fifo`, list);
    other.program.child.kill('SIGHUP');
    for (let i = 0; i < 2; i++) // the event loop handles the signal before it answers the second request
        await other.node.fetch('/healthz');
    const { pause_ms } = await two.takeOver(t, core, kill(core, 'SIGKILL'));
    assert.doesNotMatch(other.program.said, /reload:/);
    renameSync(`${list}.kept`, list);
    // writes to the FIFO on which the core's reload waits; the reload then reports that the tag list is not a regular file
    writeFileSync(`${list}.fifo`, '');
    await other.program.line(/reload:/);
    other.program.child.kill('SIGHUP');
    await other.program.line(/reload: configuration/);
    await until('readings there', async () => (await other.node.tags())['TI-1'].quality_name === 'Good');
    assert.ok(await two.ready(other));
    assert.deepEqual(await two.network.overlaps(), []);
    t.diagnostic(`${pause_ms.toFixed(0)} ms without a poller`);
    await two.restart(core);
});

test('two cores with one name, and a core without a database, are refused by name', options, async () => {
    const alone = runProgram('plantcastd', [two.plant.file, '--role', 'core', '--core', 'ws://127.0.0.1:1', '--port', '0']);
    assert.equal(alone.code, 1);
    assert.match(alone.err, /two cores \(--role core with --core\) require `postgres`/);
    const core = await two.leader(), other = two.other(core);
    await other.program.stop('SIGKILL');
    const started = await two.start(other.name, core.name);
    await started.program.line(new RegExp(`both cores have the name ${core.name}`));
    assert.ok(await two.ready(core));
    await started.program.stop();
});

test('a core of another version or configuration cannot become standby, nor can a renderer\'s token', options, async () => {
    const core = await two.leader(), other = two.other(core);
    const [, present] = /plantcast_configuration_info\{hash="(\w+)"\} 1/.exec(await (await core.node.fetch('/metrics')).text());
    const stranger = async (token, differs) => {
        const client = await PlainClient.open(core.port, { path: '/core', protocol: 'plantcast.core.v1',
            headers: [`Authorization: Bearer ${two.nodes.tokens[token]}`] });
        const [, version] = /plantcastd (\S+)/.exec(runProgram('plantcastd', ['--version']).out);
        client.say({ type: 'renderer', version, plant: 'Two boxes', configuration: present, node: 'three', standby: true, id: '12345678',
            journal: 0, ...differs });
        return client;
    };
    for (const [how, why] of [[{ version: '0.0.1' }, /0\.0\.1/], [{ plant: 'Two others' }, /Two others/]]) {
        const client = await stranger('standby', how);
        assert.match((await client.text('refused')).why, why);
        client.close();
        await client.until('its end', ({ closed }) => closed);
    }
    const voter = await stranger('standby', { configuration: '0123456789abcdef' });
    assert.equal((await voter.text('refused')).votes, true);
    await until('that it is no standby', async () => await core.node.metric('plantcast_core_standby_differs') === 1);
    const thief = await stranger('renderer', { configuration: '0123456789abcdef' });
    assert.equal((await thief.text('refused')).votes, false);
    thief.close();
    await two.start(other.name);
    await two.followed(core);
    assert.equal(await core.node.metric('plantcast_core_standby_differs'), 0);
    assert.equal(await (await core.node.fetch('/readyz')).text(), 'ok; a standby follows\n');
    await voter.until('its end', ({ closed }) => closed);
});

// Makes the database refuse every change of the lease, as one with a full disk would. Returns functions: `refused` waits until it has
// refused that many more changes, `accept` ends it.
function refuseChanges() {
    // nextval() counts also in a transaction that fails
    server.ask(`CREATE SEQUENCE refusals; CREATE FUNCTION refuse() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER
        AS $$ BEGIN PERFORM nextval('public.refusals'); RAISE 'no changes now'; END $$;
        CREATE TRIGGER refuse BEFORE UPDATE ON plantcast.lease EXECUTE FUNCTION refuse()`);
    const count = () => Number(server.ask('SELECT last_value - 1 + is_called::int FROM refusals')[0][0]);
    return { accept: () => server.ask('DROP FUNCTION refuse CASCADE; DROP SEQUENCE refusals'),
        refused: (more, from = count()) => until(`${more} refused changes`, () => count() >= from + more) };
}

test('a database that refuses every change is logged once, and its recovery once', options, async () => {
    const core = await two.leader(), start = core.program.said.length;
    const count = (text) => core.program.said.slice(start).split(text).length - 1;
    const beat = () => server.ask('SELECT max(beat) FROM plantcast.lease')[0][0], { refused, accept } = refuseChanges();
    try {
        await until('the refusal in the log', () => count('no changes now') === 1);
        const before = beat();
        await refused(3);
        assert.equal(beat(), before, 'the database stores no change');
        assert.ok(await two.ready(core), 'the core leads with the lease confirmed by its standby');
        assert.deepEqual([count('PostgreSQL does not answer'), count('PostgreSQL answers again')], [1, 0]);
        assert.equal(await core.node.metric('plantcast_core_lease_database_up'), 0);
    } finally {
        accept();
    }
    await until('that it is well again', () => count('PostgreSQL answers again') === 1);
});

// Listens on a socket as systemd does for sd_notify(). Returns { said: the messages that the core sent, child }.
function manager(path) {
    const told = { said: '' };
    told.child = spawn('python3', ['-c', `import socket
s = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
s.bind("${path}")
print("bound", flush=True)
while True:
    print(s.recv(4096).decode(), flush=True)`]);
    told.child.stdout.on('data', (text) => { told.said += text; });
    return told;
}

test('during maintenance of the standby and without the database, the leader polls on, and no other core takes over',
    options, async (t) => {
    const core = await two.leader(), other = two.other(core), history = join(two.plant.folder, core.name, 'history');
    const standby = (word) => assert.equal(runProgram('plantcast', ['standby', word, history]).code, 0);
    const alone = (is) => two.waitsFor(`maintenance ${is}`, async () =>
        await core.node.metric('plantcast_core_standby_maintenance') === is);
    await two.followed(core);
    await other.program.stop();
    standby('maintenance');
    await alone(1);
    await core.program.line(/lease: maintenance began: this core leads alone/);
    // While the database refuses changes, the core must not leave maintenance (leading alone) although it is told to.
    const { refused, accept } = refuseChanges();
    standby('normal');
    await core.program.line(/lease: PostgreSQL does not answer \(.*no changes now/);
    const began = performance.now();
    await refused(LEASE_RENEWALS);
    await until('more time than a lease', () => performance.now() - began > 3000);
    assert.ok(await two.ready(core), 'the core continues to lead');
    accept();
    await alone(0);
    standby('maintenance');
    await alone(1);
    const since = two.network.now();
    await server.kill();
    await core.program.line(/lease: PostgreSQL does not answer/);
    await two.network.polled(LEASE_POLLS);
    assert.ok(await two.ready(core));
    const pause_ms = await two.network.longestPause(since);
    t.diagnostic(`${pause_ms.toFixed(0)} ms without a poller`);
    promise(t, 'without a poller', pause_ms, 2000);
    await server.restart();
    const told = manager(join(two.plant.folder, 'notify'));
    t.after(() => told.child.kill());
    await until('the socket of the manager', () => told.said.includes('bound'));
    other.before = ['env', `NOTIFY_SOCKET=${join(two.plant.folder, 'notify')}`];
    await two.start(other.name);
    delete other.before;
    await until('its status', () => /^STATUS=standby: follows the core that leads; 0 sessions$/m.test(told.said));
    assert.doesNotMatch(told.said, /STATUS=ready/);
    await two.waitsFor('the database', async () => await core.node.metric('plantcast_core_lease_database_up') === 1);
    await core.program.stop('SIGKILL');
    // The database row names only this core. Both cores must see the row unchanged for the same time before they may lead, and the other
    // one has seen it since before the kill: it would lead first.
    await two.start(core.name);
    await two.leader();
    assert.ok(await two.ready(core));
    assert.equal(terms(other), 0, 'the other core has never led');
    standby('normal');
    await alone(0);
    await two.followed(core);
    const { pause_ms: change_ms } = await two.takeOver(t, core, kill(core, 'SIGKILL'));
    t.diagnostic(`${change_ms.toFixed(0)} ms without a poller`);
    assert.deepEqual(await two.network.overlaps(), []);
    await two.restart(core);
});
