// SPDX-License-Identifier: GPL-3.0-or-later
// Two cores whose connections to each other and to the database are cut, frozen and restarted: one cut changes nothing, two
// cuts end the leader before the other core begins, and the two never poll at the same time.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { otherVersion } from './support/other_version.mjs';
import { promise } from './support/promise.mjs';
import { kill, missingTwoCores, sleep, TAKE_OVER_MS, terms, TwoCores, until } from './support/two_cores.mjs';

const skip = missingTwoCores(), options = { skip, timeout: 240000 };
let two;

before(async () => { two = skip ? null : await TwoCores.running((cores) => cores.plant.tell('set TI-1 50')); });
after(() => two?.destroy());

test('a single cut, between the cores or to the database, changes nothing; nor does a restart of the database', options, async (t) => {
    const core = await two.leader(), other = two.other(core);
    await two.followed(core);
    for (const [what, link] of [['between the cores', other.toOther], ['leader and database', core.toDatabase],
        ['standby and database', other.toDatabase]])
        for (const how of ['cut', 'freeze']) {
            await link[how]();
            await two.goesOn(t, core, 4.5).catch((error) => { throw new Error(`${what}, ${how}: ${error.message}`); });
            await link.mend();
            await until(`it is as before (${what}, ${how})`, async () => await core.node.metric('plantcast_core_lease_database_up') === 1 &&
                await other.node.metric('plantcast_core_lease_database_up') === 1, 30);
            await two.followed(core);
        }
    await two.server.restart();
    await two.goesOn(t, core, 5);
    two.server.freeze();
    await two.goesOn(t, core, 8);
    two.server.thaw();
    await two.followed(core);
});

test('a leader that reaches neither standby nor database ends before the other core begins', options, async (t) => {
    for (const how of ['cut', 'freeze']) {
        const core = await two.leader(), other = two.other(core);
        await two.followed(core);
        const { pause_ms } = await two.takeOver(t, core, () => Promise.all([core.toDatabase[how](), other.toOther[how]()]));
        t.diagnostic(`${how}: ${pause_ms.toFixed(0)} ms without a poller`);
        await core.program.ended;
        assert.match(core.program.said, /lease: this core lost the lead \(neither/);
        await core.toDatabase.mend();
        await other.toOther.mend();
        await two.restart(core);
    }
});

test('without database and standby the leader stops; the first core that reaches the database leads', options, async (t) => {
    const core = await two.leader(), other = two.other(core);
    await two.followed(core);
    for (const one of [core, other])
        one.program.stopped = true;
    await core.toDatabase.cut();
    await other.toDatabase.cut();
    await two.goesOn(t, core, 4);
    other.program.child.kill('SIGKILL');
    await core.program.ended;
    const polled = await two.network.pollerCount();
    await two.start(core.name);
    await sleep(5000);
    assert.ok(!await two.ready(core));
    assert.equal(await two.network.pollerCount(), polled);
    await core.toDatabase.mend();
    await other.toDatabase.mend();
    await two.start(other.name);
    await two.leader();
    assert.deepEqual(await two.network.overlaps(), []);
});


test('a reloaded leader goes on with the lease confirmed by a standby that has not reloaded', options, async (t) => {
    const core = await two.leader(), other = two.other(core), text = readFileSync(two.file, 'utf8');
    await two.followed(core);
    for (const one of [core, other])
        await one.toDatabase.cut();
    writeFileSync(two.file, text.replace('deadband_percent: 0', 'deadband_percent: 0.5'));
    core.program.child.kill('SIGHUP');
    await core.program.line(/reload: configuration/);
    await other.program.line(/configuration: the renderer has .*only confirms the leader's lease/);
    await two.goesOn(t, core, 5);
    assert.match(core.program.said, /standby .*: refused: configuration: .*; the standby cannot take over, but still confirms/);
    other.program.child.kill('SIGHUP');
    await other.program.line(/reload: configuration/);
    for (const one of [core, other])
        await one.toDatabase.mend();
    await two.followed(core);
    await two.goesOn(t, core, 1);
});

test('a leader\'s reload succeeds while the database does not answer and its standby keeps asking', options, async (t) => {
    const core = await two.leader();
    await two.followed(core);
    await core.toDatabase.freeze();
    const since = two.network.now();
    core.program.said = '';
    core.program.child.kill('SIGHUP');
    await core.program.line(/reload: configuration/);
    await two.goesOn(t, core, 3);
    const pause_ms = await two.network.longestPause(since);
    t.diagnostic(`${pause_ms.toFixed(0)} ms without a poller`);
    promise(t, 'without a poller', pause_ms, TAKE_OVER_MS);
    await core.toDatabase.mend();
    await two.followed(core);
});

test('extra cores with the names of both are refused and take no place while the leader is cut off from the database',
    options, async (t) => {
    const core = await two.leader(), other = two.other(core);
    await two.followed(core);
    const more = [['three', '127.0.0.4', core, /the leading core has the same name as this core/],
        ['four', '127.0.0.5', other, /is already the standby/]];
    const started = await Promise.all(more.map(async ([name, host, as, says]) => {
        const one = await two.makeCore(name, host);
        one.toOther = await two.network.link(core.port);
        await two.startCore(one, as.name);
        await one.program.line(says);
        return one;
    }));
    await core.toDatabase.cut();
    await two.goesOn(t, core, 6);
    assert.deepEqual(started.map(terms), [0, 0]);
    await core.toDatabase.mend();
    await Promise.all(started.map((one) => one.program.stop()));
    await two.followed(core);
});

test('of two simultaneous bids for the lease in the database, exactly one wins', options, async (t) => {
    for (const core of Object.values(two.cores))
        await core.program.stop();
    const row = () => two.server.ask('SELECT epoch, leader FROM plantcast.lease')[0], [before_] = row();
    const release = await two.server.lock('SELECT 1 FROM plantcast.lease');
    const waiting = () =>
        two.server.ask("SELECT 1 FROM pg_stat_activity WHERE wait_event_type = 'Lock' AND query LIKE 'UPDATE lease%'").length;
    try {
        await Promise.all([two.start('one'), two.start('two')]);
        await sleep(4000); // waits 4 s for both cores' requests for the lease, which hang at the locked row, and for their repetitions
        await until('bids that wait', () => waiting() >= 4);
        t.diagnostic(`${waiting()} bids wait`);
    } finally {
        await release();
    }
    const core = await two.leader();
    const [epoch, leader] = row();
    assert.equal(Number(epoch), Number(before_) + 1);
    assert.ok(leader.startsWith(`${core.name} `), leader);
    assert.equal(terms(two.other(core)), 0);
    assert.deepEqual(await two.network.overlaps(), []);
    await two.followed(core);
});

test('a standby of another version is named, shows nothing, votes and takes over, so that both cores can be updated',
    options, async (t) => {
    const core = await two.leader(), other = two.other(core), newer = otherVersion(two.plant.folder);
    await two.followed(core);
    const begin = async (one) => {
        one.before = ['sh', '-c', `shift; exec ${newer.program} "$@"`, 'sh'];
        await two.start(one.name);
    };
    await other.program.stop('SIGKILL');
    await begin(other);
    await other.program.line(new RegExp(`version: the renderer has ${newer.other}, this node ${newer.version}.*only confirms`));
    const noStandby = `refused: version: the renderer has ${newer.other}, .*; the standby can take over, and confirms`;
    assert.match(core.program.said, new RegExp(noStandby));
    assert.ok(Object.values(await other.node.tags()).every(({ value }) => value === null));
    await until('its promise', async () => await core.node.metric('plantcast_core_standby_differs') === 1);
    assert.equal(await core.node.metric('plantcast_core_standby'), 0, 'a core of another version does not count as a standby');
    assert.equal(await (await core.node.fetch('/readyz')).text(),
        'ok; the standby has another version: it gets no data, but can take over\n');
    // cuts the leader from the database: it may only go on because the standby, connected to it, has promised not to take over
    await core.toDatabase.cut();
    await two.goesOn(t, core, 4);
    await core.toDatabase.mend();
    const { leads } = await two.takeOver(t, core, kill(core, 'SIGTERM'));
    assert.equal(leads, other);
    await core.program.ended;
    await begin(core);
    await two.followed(other);
    await two.goesOn(t, other, 1);
});
