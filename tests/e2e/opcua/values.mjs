// SPDX-License-Identifier: GPL-3.0-or-later
// Tests sources of type opcua with node-opcua's server: values, status codes and timestamps arrive bit by bit. While the server
// is gone, all tags are Bad; when it returns, all are read again, even if namespaces have other indices. Also tests deadbands
// and browsing.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { shareOpcua } from './server.mjs';
import { opcuaOptions } from '../support/opcua.mjs';
import { long, promise } from '../support/promise.mjs';
import { PublishedPlant } from '../support/published_plant.mjs';
import { sweep } from '../support/sweep.mjs';
import { BIN, runProgram, sleep } from '../support/tiny_plant.mjs';

const options = opcuaOptions(180000);
const NODE = 'nsu=urn:test:plant%3B1;s=';
const ROWS = [`TI-1,${NODE}TI-1,,°C,temperature,E-101,0.5,0,0,,,,,,`, `TI-2,${NODE}TI-2,,°C,temperature,E-101,-0.5,0,0,,,,,,`,
    `PI-1,${NODE}PI-1,,bar,pressure,P-101A,3,0,0.5,,Linear,0,27648,0,10`, `XS-1,${NODE}XS-1,bool,,,,,,,,,,,,`];
const ROW3 = `ROW-3,${NODE}Row[3],,,,,,,,,,,,,`, TEXT = `TEXT,${NODE}Text,,,,,,,,,,,,,`;
const TEMPS = [0, 2, 5].map((i) => `T-${i},[${i}]${NODE}Temps,,,,,,,,,,,,,`);
const good = { quality_name: 'Good' };
const MANY = sweep(5000, 1200), PATIENCE_MS = 120000;
let server, plant;

shareOpcua(options, (...made) => { [server, plant] = made; });
const until = (...args) => plant.until(...args);
const said = (...args) => plant.said(...args);
const start = (keys, rows = ROWS) => plant.start(keys, rows);
const browse = (url, ...more) => runProgram('plantcast', ['tags', '--browse', url, ...more], PATIENCE_MS);

test('values, status codes and times arrive unchanged, and nothing is ever written', options, async () => {
    await server.reset();
    await plant.run(server.security(), [...ROWS, ROW3, TEXT, ...TEMPS, `GONE,${NODE}Gone,,,,,,,,,,,,,`]);
    await until('TI-1', { ...good, value: 20 });
    await until('TI-2', { ...good, value: 21.5 });
    const first = Date.now();
    await until('PI-1', { ...good, value: 5 });
    await until('XS-1', { ...good, value: 1 });
    await until('ROW-3', { ...good, value: 7 });
    await until('T-0', { ...good, value: 1 });
    await until('T-2', { ...good, value: 3 });
    await until('T-5', { quality_name: 'Bad' });
    await until('TEXT', { quality_name: 'Bad_ConfigurationError' });
    await until('GONE', { quality_name: 'Bad' });
    await said(/refuses to read node nsu=urn:test:plant;1;s=Gone: BadNodeIdUnknown/);
    await said(/s=Text: the type of the node's value is not a number/);
    for (const [status, name] of [[0x40930000, 'Uncertain_SensorNotAccurate'], [0x00960000, 'Good'], [0x808c0000, 'Bad_SensorFailure'],
        [0x408f0000, 'Uncertain_NoCommunicationLastUsableValue'], [0x80310000, 'Bad_NoCommunication']]) {
        await server.set('TI-1', 42, { status });
        await until('TI-1', { quality_name: name, value: status >= 0x80000000 ? null : 42 });
    }
    const since = Date.now() - first; // dates the next value back, but not before the tag's last one: that would be ignored
    await server.set('TI-2', 43, { at: first });
    const old = await until('TI-2', { ...good, value: 43 });
    assert.ok(since > 100 && old.age_ms >= since && old.age_ms <= Date.now() - first, `the reading is ${old.age_ms} ms old`);
    await server.set('Temps', [4, 5, 6]);
    await until('T-2', { ...good, value: 6 });
    assert.equal(await plant.metric('up{source="plc"}'), 1);
    assert.equal(await plant.metric('connects_total{source="plc"}'), 1);
    assert.equal(await plant.metric('nodes_refused{source="plc"}'), 1);
    const { write, call, sessions } = await server.tell({});
    assert.deepEqual({ write, call, sessions }, { write: 0, call: 0, sessions: 1 });
    await plant.daemon.stop();
    assert.equal((await server.tell({})).sessions, 0, 'the session was closed');
});

test('all tags are Bad when the server is gone; on return all are subscribed again, whatever the namespace index', options, async (t) => {
    await server.reset();
    await plant.run(server.security(), ROWS);
    await until('TI-1', { ...good, value: 20 });
    await server.kill();
    const killed = performance.now();
    await until('TI-1', { quality_name: 'Bad_CommunicationError', value: null });
    await until('PI-1', { quality_name: 'Bad_CommunicationError' });
    promise(t, 'until all is Bad, at once', performance.now() - killed, 2000);
    assert.equal(await plant.metric('up{source="plc"}'), 0);
    await server.restart({ shifted: 3 });
    await until('TI-1', { ...good, value: 20 }, 40);
    await server.set('TI-1', 25);
    await until('TI-1', { ...good, value: 25 });
    server.freeze();
    await until('TI-1', { quality_name: 'Bad_CommunicationError' }, 40);
    server.thaw();
    await until('TI-1', { ...good, value: 25 }, 60);
    await said(/no readings[^]*reading[^]*no readings[^]*reading/);
});

test('a node whose namespace the server adds later is read in the same session', { ...options, skip: options.skip || long }, async () => {
    await server.restart({});
    await plant.run(server.security(), [...ROWS, 'LATE,nsu=urn:test:late;s=Late,,,,,,,,,,,,,']);
    await said(/refuses to read node nsu=urn:test:late;s=Late: BadNodeIdUnknown/);
    await until('TI-1', { ...good, value: 20 });
    await server.tell({ addLate: true });
    await until('LATE', { ...good, value: 7 }, 60);
    await until('TI-1', { ...good, value: 20 });
    assert.equal(await plant.metric('connects_total{source="plc"}'), 1);
});

test('a lost notification is noticed, and all nodes are read', options, async () => {
    await server.reset({ readsPerCall: 3 }); // the server accepts at most 3 nodes per read request, fewer than the plant has
    await plant.run(server.security(), ROWS);
    await until('TI-1', { ...good, value: 20 });
    await until('TI-2', { ...good, value: 21.5 });
    await server.tell({ lose: true });
    // the server drops the notification of this change, and maybe also that of the next one if both are in one notification
    await server.set('TI-1', 61);
    await server.set('TI-2', 62);
    await until('TI-2', { ...good, value: 62 });
    await until('TI-1', { ...good, value: 61 });
    await said(/source plc: notifications from the OPC UA server were lost, so all nodes are read again/);
    assert.equal(await plant.metric('connects_total{source="plc"}'), 1);
});

test('the server applies deadbands; a node that cannot have a deadband is read without', options, async () => {
    await server.reset();
    await plant.run(`${server.security()}, deadband_percent: 10`, [...ROWS, `B,${NODE}Bounded,,,,,,,,,,,,,`]);
    await until('B', { ...good, value: 50 });
    await server.set('Bounded', 55);
    await server.set('XS-1', false);
    await until('XS-1', { ...good, value: 0 }); // reported after the change of Bounded would be
    assert.equal((await plant.tags()).B.value, 50, 'a change within 10 % of the range 0 to 100 is not reported');
    await server.set('Bounded', 65);
    await until('B', { ...good, value: 65 });
});

test('a tag may have its own deadband; a deadband that the server refuses is logged', options, async () => {
    await server.reset();
    const rows = ROWS.map((row) => `${row},${{ 'TI-1': '5', 'TI-2': '10%', 'PI-1': '0' }[row.split(',')[0]] ?? ''}`);
    await plant.run(`${server.security()}, deadband: 20`, [...rows, `B,${NODE}Bounded,,,,,,,,,,,,,,20 %`], ',OPC Deadband');
    // a deadband in percent needs the property EURange, which the node TI-2 lacks
    await said(/s=TI-2: the server refuses the OPC Deadband 10% \(Bad\w+\) and reports every change/);
    assert.doesNotMatch(plant.daemon.said, /s=XS-1: the server refuses/, 'the deadband of the source is for nodes that support it');
    await until('B', { ...good, value: 50 });
    await until('TI-1', { ...good, value: 20 });
    await server.set('TI-1', 24);
    await server.set('Bounded', 68);
    await server.set('TI-2', 22);
    await until('TI-2', { ...good, value: 22 });
    await server.set('PI-1', 13834);
    while ((await plant.tags())['PI-1'].value === 5)
        await sleep(20);
    const tags = await plant.tags();
    assert.deepEqual([tags['TI-1'].value, tags.B.value], [20, 50], 'changes within the deadband are not reported');
    await server.set('TI-1', 26);
    await until('TI-1', { ...good, value: 26 });
    await server.set('Bounded', 71);
    await until('B', { ...good, value: 71 });
});

test('a server without free sessions is retried until it has one', options, async (t) => {
    await server.reset({ sessions: 1 });
    await plant.run(server.security(), ROWS);
    const other = await PublishedPlant.create(server);
    t.after(() => other.destroy());
    other.write(server.security(), ROWS);
    other.plant.prepare();
    await other.plant.startDaemon();
    await other.daemon.line(/no readings \(BadTooManySessions/);
    await plant.daemon.stop();
    await other.until('TI-1', { ...good, value: 20 }, 40);
});

test(`changes of ${MANY} nodes at once all arrive`, options, async () => {
    const rows = Array.from({ length: MANY }, (_, i) => `N${i},${NODE}N${i},,,,,,,,,,,,,`);
    await server.reset({ many: MANY });
    await plant.run(server.security(), rows);
    // Sets all values three times. Each time waits until the daemon has all of them before the next change, because the server
    // stores only the newest unsent value of each node.
    for (const each of [0, 1e6, 2e6]) {
        if (each > 0)
            await server.tell({ each });
        const sent = performance.now();
        for (const end = sent + 30000; ; await sleep(200)) {
            const tags = await plant.tags();
            if (rows.every((_, i) => tags[`N${i}`].value === each + i))
                break;
            assert.ok(performance.now() < end, 'not all values have changed');
        }
    }
    assert.ok(await plant.metric('samples_total{source="plc"}') >= 3 * MANY);
});

test('plantcast tags --browse writes a tag list that the daemon reads unchanged', options, async () => {
    await server.reset({ many: MANY }); // gives the server more nodes than fit into one answer to a browse request
    const url = `opc.tcp://127.0.0.1:${server.port}`, at = (file) => join(server.folder, file);
    const secure = ['--certificate', at('client.crt'), '--key', at('client.key'), '--trusted', at('trusted')];
    const { code, out, err } = browse(url, ...secure);
    assert.equal(code, 0, err);
    const lines = out.trim().split('\n');
    assert.equal(lines[0], 'Tag Name,Address,Data Type,Description');
    for (const line of [`Plant.TI-1,${NODE}TI-1,,`, `Plant.XS-1,${NODE}XS-1,bool,`, `Plant.Row[3],${NODE}Row[3],,`,
        `Plant.Temps[2],[2]${NODE}Temps,,`, `Plant.N${MANY - 1},${NODE}N${MANY - 1},,`, `Plant.Bounded,${NODE}Bounded,,of 0 to 100 °C`])
        assert.ok(lines.includes(line), `the line ${line} is missing in\n${out}`);
    assert.doesNotMatch(out, /Text|EURange/);
    assert.equal(browse(url).out, out, 'browsing without security gives the same');
    plant.write('security: none', []);
    writeFileSync(join(plant.folder, 'tags.csv'), out);
    assert.equal(runProgram('plantcastd', ['--check', plant.file]).code, 0);
    server.trust('client');
    const refused = browse(url, ...secure);
    server.trust('server');
    assert.equal(refused.code, 1);
    assert.match(refused.err, /BadCertificateUntrusted/);
    assert.equal(browse('http://127.0.0.1').code, 2);
});

test('the daemon links and sends no OPC UA request that writes or calls', options, () => {
    const symbols = spawnSync('nm', [join(BIN, 'plantcastd')], { encoding: 'utf8', maxBuffer: 1 << 27 }).stdout;
    assert.match(symbols, /UA_Client_run_iterate/);
    assert.doesNotMatch(symbols, /UA_Client_(write|call)|UA_Client_\w*writeAttribute|UA_Client_(add|delete)\w*(Node|Reference)/);
    const folder = 'server/value/opcua';
    const sources = readdirSync(folder).map((name) => readFileSync(join(folder, name), 'utf8')).join('');
    const sent = new Set([...sources.matchAll(/UA_TYPES_(\w+)REQUEST\b/g)].map((match) => match[1]));
    assert.deepEqual([...sent].filter((name) => !['GETENDPOINTS', 'READ', 'BROWSE', 'BROWSENEXT'].includes(name)), []);
});

test('--check names each mistake in an OPC UA source of the plant file', options, () => {
    const refused = (keys, row = ROWS[0], more = '') => {
        plant.write(keys, [row], more);
        const { code, err } = runProgram('plantcastd', ['--check', plant.file]);
        assert.equal(code, 1, err);
        return err;
    };
    assert.match(refused('queue: 5'), /needs the key 'security'/);
    assert.match(refused('security: open'), /security: expected none, or a mapping/);
    assert.match(refused('security: none, login: x'), /not allowed with security: none, because the password would be readable/);
    assert.match(refused('security: none, deadband: 1, deadband_percent: 1'), /expected deadband or deadband_percent/);
    assert.match(refused('security: none, topic: x'), /topic: has no effect for an opcua source/);
    assert.match(refused('security: none', 'A,ns=2;s=X,,,,,,,,,,,,,'), /namespace numbers can change/);
    assert.match(refused('security: none', 'A,s=X,,,,,,,,,,,,,'), /or set the key `namespace` of the source/);
    assert.match(refused('security: none, namespace: urn:x', 'A,q=X,,,,,,,,,,,,,'),
        /tags\.csv:2:3: error: Address: 'q=X': expected nsu=URI/);
    assert.match(refused('security: none', 'A,[x]nsu=urn:x;i=5,,,,,,,,,,,,,'), /expected the number of an array element/);
    const opc = (type, deadband) => refused('security: none', `A,nsu=urn:x;s=A,${type},,,,,,,,,,,,,${deadband}`, ',OPC Deadband');
    for (const deadband of ['-1', 'x', '101%', '%', '1 bar'])
        assert.match(opc('', deadband), /tags\.csv:2:\d+: error: OPC Deadband: expected a number from 0 in the node's unit/);
    assert.match(opc('bool', '1'), /OPC Deadband: a value of Data Type bool cannot have a deadband/);
    assert.match(refused('security: none', 'A,nsu=urn:x;i=5000000000,,,,,,,,,,,,,'), /expected nsu=URI/);
});
