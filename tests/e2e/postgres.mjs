// SPDX-License-Identifier: GPL-3.0-or-later
// History in Debian's PostgreSQL: the database gets every point exactly once with its quality, despite failures of the server,
// the connection and the daemon. A replacement machine restores its history from the database.
import assert from 'node:assert/strict';
import { chmodSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { afterEach, test } from 'node:test';
import { median } from './support/crowd.mjs';
import { CuttableLink, missingPostgres, PostgresServer } from './support/postgres_server.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { sweep } from './support/sweep.mjs';
import { notBuilt, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until as waitFor } from './support/until.mjs';

const skip = notBuilt() || (missingPostgres() ?? false);
const AWAY_MS = sweep(600000, 0); // milliseconds for which the test additionally stops the database in long runs
const options = { skip, timeout: 240000 + AWAY_MS };
const TAGS = ['TI-1', 'TI-2', 'PI-1'];
let server, plant, link, feeding, plain, databases = 0;

setUp(skip, async (own) => {
    server = own(await PostgresServer.start());
    plant = own(await TinyPlant.create());
    plain = readFileSync(plant.file, 'utf8');
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
});
afterEach(async () => {
    await stopFeeding();
    await plant?.daemon?.stop();
    link?.close();
    link = null;
});

// Changes all readings every 50 ms, so that the history must record each sample. Runs until stopFeeding().
function feed() {
    let going = true;
    const done = (async () => {
        for (let i = 0; going; i++) {
            await plant.tell(`set TI-1 ${50 + 40 * Math.sin(i / 3)}`);
            await plant.tell(`set TI-2 ${i % 2 ? 20 : 30}`);
            await plant.tell(`set PI-1 ${(i * 7) % 10}`);
            await sleep(50);
        }
    })();
    feeding = async () => { going = false; await done; };
}
async function stopFeeding() {
    await feeding?.();
    feeding = null;
}

const historyOf = (name) => join(plant.folder, `${name}.history`);
// Writes the plant file with a new database and a new history folder. keep: the database of the previous call is used again.
function configure({ port, more = '', space = '', folder = `h${databases}`, keep = false } = {}) {
    if (!keep)
        server.makeDatabase(`d${++databases}`, space);
    writeFileSync(join(plant.folder, 'login'), server.login);
    chmodSync(join(plant.folder, 'login'), 0o600);
    writeFileSync(plant.file, `${plain}history:
  folder: ${historyOf(folder)}
  deadband_percent: 0
  postgres: { url: "${server.url(port)}", login: login${more} }
`);
}

const metric = (name) => plant.metric(`plantcast_${name}`);
const until = (what, ask, seconds = 60) => waitFor(what, ask, seconds, () => plant.daemon.said.slice(-3000));
const settled = () => until('nothing waits', async () => await metric('postgres_up') === 1 && await metric('postgres_waiting_points') === 0
    && await metric('history_waiting_points') === 0);

const sent = (count) => until(`${count} points are sent`, async () => await metric('postgres_points_total') >= count);
const waiting = (count) => until(`${count} points wait`, async () => await metric('postgres_waiting_points') >= count);

// Asserts that the database and the API have the same points from `from` until three seconds ago, each exactly once.
async function assertSame(from) {
    await stopFeeding();
    await settled();
    const to = Math.floor(Date.now() / 1000 - 3) * 1e6;
    const lacks = (all, of) => [...all.keys()].filter((key) => !of.has(key));
    const keyed = (rows) => new Map(rows.map(([tag, us, value, quality]) => [`${tag} ${us} ${quality}`, value]));
    let api, sql, here, there;
    const isSame = async () => { // compared repeatedly, because the database and the history files are written at different times
        api = [];
        for (const tag of TAGS) {
            const url = `http://127.0.0.1:${plant.port}/api/v1/history?tags=${tag}&from=${from / 1e6}&to=${to / 1e6}&points=20000`;
            const { series } = await (await fetch(url)).json();
            for (const [us, value, quality] of series[0].points)
                if (us >= from && us <= to)
                    api.push([tag, String(us), value === null ? '' : String(value), String(quality)]);
        }
        sql = server.ask(`SELECT g.name, (extract(epoch FROM s.t) * 1000000)::bigint, s.v, s.q FROM plantcast.sample s`
            + ` JOIN plantcast.tag g ON g.id = s.tag WHERE s.t BETWEEN to_timestamp(${from / 1e6}) AND to_timestamp(${to / 1e6})`);
        [there, here] = [keyed(sql), keyed(api)];
        return lacks(here, there).length === 0 && lacks(there, here).length === 0;
    };
    for (let tries = 0; !await isSame() && tries < 60; tries++)
        await sleep(500);
    assert.deepEqual([lacks(there, here), lacks(here, there)], [[], []], 'points only in the database; points only in the local history');
    assert.deepEqual([there.size, here.size], [sql.length, api.length], 'no point is stored twice');
    for (const [key, value] of there) // the API prints ten digits
        assert.ok(value === here.get(key) || Math.abs(value - here.get(key)) <= 1e-9 * Math.abs(value), `the value at ${key} is ${value}`);
    return sql.length;
}

const begin = () => Math.floor(Date.now() / 1000) * 1e6;
// Starts a daemon and changing readings, and waits until 20 points have been sent to the database. Returns the time before the
// start in microseconds.
async function startSending() {
    const from = begin();
    await plant.startDaemon();
    feed();
    await sent(20);
    return from;
}

test('the database has each recorded point once, with its quality', options, async () => {
    configure();
    const from = begin();
    await plant.startDaemon();
    feed();
    await sent(60);
    await plant.tell('fail PI-1');
    await until('Bad is there', () => server.ask("SELECT 1 FROM plantcast.history WHERE tag = 'PI-1' AND NOT good").length > 0);
    await plant.tell('release PI-1');
    await sent(200);
    assert.ok(await assertSame(from) > 20);
    assert.ok(server.ask("SELECT 1 FROM plantcast.history WHERE tag = 'PI-1' AND NOT good AND value IS NULL").length > 0,
        'the Bad reading is in the database');
    const [[name, unit, value, quality, good]] = server.ask(`SELECT plant, unit, value, quality, good FROM plantcast.history
        WHERE tag = 'TI-2' AND good ORDER BY time DESC LIMIT 1`);
    assert.deepEqual([name, unit, quality, good], ['Two boxes', '°C', '0x00000000', 't']);
    assert.ok([20, 30].includes(Number(value)), value);
    assert.ok(await metric('postgres_points_total') > 100);
});

test('the database has an import\'s gap and Bad sample, and a later import removes a gap that is filled', options, async () => {
    configure();
    const file = join(plant.folder, 'gap.csv'), from = Math.floor(Date.now() / 1000) - 3 * 86400;
    writeFileSync(file, `Time,TI-1\n${[[0, 10], [10, 10], [20, 'Bad'], [30, 10], [40, 10], [86400, 90], [86410, 90]]
        .map(([s, value]) => `${from + s},${value}`).join('\n')}\n`);
    const bring = (...more) => {
        const imported = runProgram('plantcast', ['history', 'import', plant.file, file, ...more]);
        assert.equal(imported.code, 0, imported.err);
    };
    const sql = `SELECT extract(epoch FROM time)::numeric(20, 6) - ${from}, value, quality FROM plantcast.history
        WHERE tag = 'TI-1' AND time < to_timestamp(${from + 86400 + 60}) ORDER BY time`;
    const rows = () => server.ask(sql).map(([s, value, quality]) => [Number(s), value, quality]);
    bring();
    await plant.startDaemon();
    await until('the import is sent', async () => await metric('postgres_points_total') >= 9 && rows().length >= 9);
    const none = '0x80310000', good = '0x00000000';
    assert.deepEqual(rows(), [[0, '10', good], [10, '10', good], [20, '', '0x80000000'], [30, '10', good], [40, '10', good],
        [40.000001, '', none], [86400, '90', good], [86410, '90', good], [86410.000001, '', none]]);
    bring('--longest-gap', '2d');
    await until('the gap is gone', async () => rows().some(([s, value]) => s === 40.000001 && value === '10'));
    assert.deepEqual(rows().filter(([, , quality]) => quality === none), [[86410.000001, '', none]]);

    // TI-2 has a `Stale s` of 1 s, so the 3.5 s between the samples at 4.5 s and 8 s count as no data.
    writeFileSync(file, `Time,TI-2\n${Array.from({ length: 20 }, (_, i) => `${from + i / 2 + (i > 9 ? 3 : 0)},50`).join('\n')}\n`);
    bring();
    const without = () => server.ask(`SELECT extract(epoch FROM time)::numeric(20, 6) - ${from} FROM plantcast.history
        WHERE tag = 'TI-2' AND time < to_timestamp(${from + 60}) AND quality = '${none}' ORDER BY time`).map(([s]) => Number(s));
    await until('the end of the series is sent', async () => without().includes(12.500001));
    assert.deepEqual(without(), [4.500001, 12.500001]);
});

// Returns a dashboard's SQL query with Grafana's macros and variables replaced, as Grafana does for the selected plants, tags
// and units (`chosen`).
function expanded(sql, from, chosen) {
    const time = (at) => `${at} BETWEEN to_timestamp(${from / 1e6}) AND now()`;
    const text = (name) => [chosen[name]].flat().map((one) => `'${one.replaceAll("'", "''")}'`).join(',');
    return sql.replaceAll(/\$__timeFilter\(([\w.]+)\)/g, (_, at) => time(at)).replaceAll(/\$\{(\w+):sqlstring\}/g, (_, name) => text(name));
}

test('every panel and variable of the trend dashboard gets data, and readings that are not good are not drawn', options, async () => {
    configure();
    const from = begin();
    await plant.startDaemon();
    feed();
    await sent(80);
    await stopFeeding();
    await plant.tell('pause');
    const lost = `SELECT tag FROM (SELECT DISTINCT ON (tag) tag, good FROM plantcast.history ORDER BY tag, time DESC) newest
        WHERE NOT good`;
    await until('the last point of each tag is not good', () => server.ask(lost).length === TAGS.length);
    await settled();
    const { panels, templating } = JSON.parse(readFileSync('deploy/grafana/trends.json', 'utf8')), chosen = {};
    for (const { name, type, query } of templating.list)
        if (type === 'query') {
            const rows = server.ask(expanded(query, from, chosen)).map(([first]) => first);
            assert.ok(rows.length > 0, name);
            chosen[name] = name === 'plant' ? rows[0] : rows;
        }
    assert.deepEqual(chosen, { plant: 'Two boxes', tag: [...TAGS].sort(), unit: ['bar', '°C'] });
    for (const { title, targets } of panels)
        for (const { rawSql } of targets) {
            const rows = server.ask(expanded(rawSql, from, chosen));
            assert.ok(rows.length > 0 || title === 'Events', `${title}: nothing for ${rawSql}`);
            if (title === 'Newest')
                assert.deepEqual(rows.map(([tag, value]) => [tag, value]), [...TAGS].sort().map((tag) => [tag, '']),
                    'a reading that is not good has no value');
            if (title === '$unit')
                assert.ok(rows.some(([, , value]) => value !== '') && rows.some(([, , value]) => value === ''), 'the drawn line has gaps');
        }
    await plant.tell('resume');
});

test('no point is lost while the server is killed or frozen; live readings do not wait', options, async (t) => {
    configure();
    const from = await startSending();
    await server.kill();
    await until('it is said', async () => await metric('postgres_up') === 0);
    await plant.daemon.line(/PostgreSQL does not accept recorded points \(.*refused.*\); the points are queued in .*, at most 20000000/);
    await waiting(50);
    await sleep(AWAY_MS);
    const waited = await metric('postgres_waiting_points');
    await server.restart();
    await plant.daemon.line(/PostgreSQL accepts recorded points again/, 60000);
    server.freeze();
    const age = async () => Math.max(...(await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/tags?count=10`)).json()).tags
        .map((tag) => tag.age_ms));
    const ages = [], value = async () => (await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/tags?count=10`)).json()).tags
        .find(({ name }) => name === 'TI-1').value;
    for (let i = 0, last; i < 20; i++) { // the readings go on
        last = await until('another value', async () => { const now = await value(); return now !== last && now; });
        ages.push(await age());
    }
    promise(t, 'age of readings meanwhile, median', median(ages), 1000);
    assert.equal(await metric('history_good'), 1);
    server.thaw();
    const points = await assertSame(from);
    assert.ok(waited >= 50 && points > waited, `${waited} points waited, ${points} arrived`);
    t.diagnostic(`${waited} points waited, ${points} are there and in the files`);
    assert.equal(await metric('postgres_lost_total'), 0);
});

test('the daemon is killed while the server is away and restarted: each point is stored exactly once', options, async () => {
    configure();
    const from = await startSending();
    await sent(100);
    await server.kill();
    await waiting(30);
    await plant.daemon.stop('SIGKILL');
    await plant.startDaemon();
    await waiting(60);
    await server.restart();
    assert.ok(await assertSame(from) > 20);
    assert.deepEqual(server.ask('SELECT kind, count(*) FROM plantcast.event GROUP BY 1'), [['gap', '1']]);
    const gaps = server.ask('SELECT 1 FROM plantcast.sample WHERE v IS NULL AND q = 2150694912');
    assert.ok(gaps.length >= TAGS.length, 'the gaps include the time without a daemon');
});

test('a connection cut in the middle of a batch loses and repeats no point', options, async () => {
    link = await CuttableLink.open(server.port);
    configure({ port: link.port });
    const from = begin();
    link.cutAfter = 8000;
    await plant.startDaemon();
    feed();
    for (let cut = 1; cut <= 3; cut++) {
        await until(`cut ${cut} times`, () => link.cuts === cut);
        await until('it is said', async () => await metric('postgres_up') === 0);
        link.cutAfter = 9000 + 2000 * cut;
        link.mend();
    }
    link.cutAfter = 0;
    link.mend();
    assert.ok(await assertSame(from) > 20);
});

test('a full disk of the server loses no point', options, async (t) => {
    const disk = server.smallDisk(24);
    if (!disk) {
        t.skip('no disk can be mounted here');
        return;
    }
    configure({ space: 'TABLESPACE small' });
    const from = await startSending();
    server.ask('CREATE TABLE filler AS SELECT repeat(md5(i::text), 20) FROM generate_series(1, 3000) i');
    try {
        for (;;)
            writeFileSync(join(disk, 'filler'), Buffer.alloc(8192), { flag: 'a' });
    } catch (error) {
        assert.equal(error.code, 'ENOSPC');
    }
    await plant.daemon.line(/PostgreSQL does not accept recorded points \(.*No space left on device\)/, 90000);
    await until('it is counted', async () => await metric('postgres_up') === 0);
    rmSync(join(disk, 'filler'));
    await plant.daemon.line(/PostgreSQL accepts recorded points again/, 60000);
    await sent(200);
    assert.ok(await assertSame(from) > 20);
    await plant.daemon.stop();
    server.database = 'postgres';
});

test('with too many waiting points, the oldest are dropped and reported; the local files have them', options, async () => {
    configure({ more: ', spool_points: 1000' });
    const from = Math.floor(Date.now() / 1000) - 20000, rows = ['Tag,Time,Value'];
    for (let i = 0; i < 3000; i++)
        rows.push(`TI-1,${from + i * 2},${i % 2 ? 10 : 90}`);
    const csv = join(plant.folder, 'series.csv');
    writeFileSync(csv, `${rows.join('\n')}\n`);
    await server.kill();
    const imported = runProgram('plantcast', ['history', 'import', plant.file, csv]);
    assert.equal(imported.code, 0, imported.err);
    await plant.startDaemon();
    await plant.daemon.line(/the queue for PostgreSQL is full: \d+ points remain only in the local files/);
    await until('the rest waits', async () => await metric('postgres_lost_total') >= 2000
        && await metric('postgres_waiting_points') <= 1000);
    const url = `http://127.0.0.1:${plant.port}/api/v1/history?tags=TI-1&from=${from}&to=${from + 5990}&points=20000`;
    const kept = await (await fetch(url)).json();
    assert.equal(kept.series[0].points.length, 2997);
    await server.restart();
    await settled();
    const [[count, last]] = server.ask(`SELECT count(*), max(v) FROM plantcast.sample WHERE t < to_timestamp(${from + 6000})`);
    assert.ok(Number(count) > 500 && Number(count) <= 1000, count);
    assert.equal(last, '90');
});

test('tables of another version are refused by name, and left alone', options, async () => {
    configure();
    server.ask(`CREATE SCHEMA plantcast AUTHORIZATION plantcast; SET ROLE plantcast; CREATE TABLE plantcast.version(version int);
        INSERT INTO plantcast.version VALUES (0)`);
    await plant.startDaemon();
    await plant.daemon.line(
        /the tables in schema plantcast have version 0, which is older than version 1 of this program; the tables are not used/);
    assert.equal(await metric('postgres_up'), 0);
    server.ask('UPDATE plantcast.version SET version = 2');
    await plant.daemon.line(/the tables in schema plantcast have version 2, which is newer than version 1 of this program/, 30000);
    assert.deepEqual(server.ask("SELECT tablename FROM pg_tables WHERE schemaname = 'plantcast'"), [['version']]);
    server.ask('DROP SCHEMA plantcast CASCADE');
    await settled();
});

test('of two daemons that write for one plant, the second is refused, and takes over when the first has gone', options, async () => {
    configure();
    const from = begin();
    await plant.startDaemon();
    await settled();
    const first = plant.daemon, port = plant.port;
    configure({ keep: true, folder: 'other' });
    await plant.startDaemon();
    await plant.daemon.line(/another daemon already writes plant 'Two boxes'/);
    assert.equal(await metric('postgres_up'), 0);
    assert.ok(port !== plant.port);
    await first.stop();
    await settled();
    assert.ok(from > 0);
});

test('a replacement machine gets the plant\'s history and continues it', options, async () => {
    configure();
    const from = begin();
    await plant.startDaemon();
    feed();
    await sent(200);
    const to = Date.now() / 1000;
    await assertSame(from);
    // The daemon sends the newest sample of each tag only every 5 s. Waits for that, because until then the recorded time ends
    // earlier in the database than in the API.
    const ends = `SELECT count(*) FROM plantcast.newest WHERE t > to_timestamp(${to})`;
    await until('the lines are that long there', () => Number(server.ask(ends)[0][0]) === TAGS.length);
    const url = (to) => `http://127.0.0.1:${plant.port}/api/v1/history?tags=${TAGS}&from=${from / 1e6}&to=${to}&points=20000`;
    const had = await (await fetch(url(to))).json(), killed = Date.now() / 1000;
    await plant.daemon.stop('SIGKILL');
    configure({ keep: true, folder: 'replaced' });
    await plant.startDaemon();
    await plant.daemon.line(/restored \d+ points from PostgreSQL/, 30000);
    assert.ok(await metric('postgres_restored_total') > 100);
    feed();
    const has = await (await fetch(url(to))).json(), inside = (series) => series.points.filter(([us]) => us >= from && us <= to * 1e6);
    for (const [i, series] of had.series.entries())
        assert.deepEqual(inside(has.series[i]), inside(series), series.tag);
    const gaps = await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/history/gaps?from=-1h`)).json();
    assert.equal(gaps.gaps.length, 1, JSON.stringify(gaps));
    assert.ok(Math.abs(gaps.gaps[0][0] / 1e6 - killed) < 20, 'the replacement machine knows the time without recording');
    await assertSame(from);
});

// TimescaleDB is not in Debian: a fake create_hypertable() in the database records how it is called.
test('with TimescaleDB, the points are stored in a hypertable with chunks of a week', options, async () => {
    configure();
    server.ask(`SET allow_system_table_mods = on; INSERT INTO pg_extension(oid, extname, extowner, extnamespace, extrelocatable, extversion)
        VALUES (999999, 'timescaledb', 10, 2200, false, '2.0'); CREATE TABLE asked(text text); GRANT ALL ON asked TO plantcast;
        CREATE FUNCTION create_hypertable(relation regclass, time_column_name name, chunk_time_interval interval) RETURNS void LANGUAGE sql
        AS $$ INSERT INTO public.asked VALUES (relation || ' ' || time_column_name || ' ' || chunk_time_interval) $$`);
    await plant.startDaemon();
    await settled();
    assert.deepEqual(server.ask('SELECT text FROM asked'), [['sample t 7 days']]);
});

test('a password in the plant file, and an invalid schema name, are refused', options, () => {
    configure();
    const text = readFileSync(plant.file, 'utf8'), check = () => runProgram('plantcastd', ['--check', plant.file]);
    writeFileSync(plant.file, text.replace('postgresql://', 'postgresql://me:secret@'));
    assert.match(check().err,
        /plant\.yaml:\d+:\d+: error: url: do not write a password here; write it to a file, and name the file in `login`/);
    writeFileSync(plant.file, text.replace('login: login', 'schema: "a b"'));
    assert.match(check().err, /schema: expected lower-case letters, digits and _, found 'a b'/);
    writeFileSync(plant.file, text.replace(/postgresql:/, 'mysql:'));
    assert.match(check().err, /url: expected postgresql:\/\/HOST\/DATABASE, found 'mysql:/);
    writeFileSync(plant.file, text.replace('  deadband', '  record: no\n  deadband'));
    assert.match(check().err, /`postgres` requires `record: yes`/);
});
