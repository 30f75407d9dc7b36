// SPDX-License-Identifier: GPL-3.0-or-later
// Tests sources of type mqtt with Debian's broker mosquitto. Numbers and JSON must arrive with their true age and quality, and
// invalid payloads must be refused. All tags must be Bad while the broker is down, and recover afterwards.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { connect, createServer } from 'node:net';
import { join } from 'node:path';
import packets from 'mqtt-packet';
import { afterEach, test } from 'node:test';
import { Broker, missingBroker } from './support/broker.mjs';
import { promise } from './support/promise.mjs';
import { PublishedPlant } from './support/published_plant.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram, sleep } from './support/tiny_plant.mjs';

const options = { skip: notBuilt() || (missingBroker() ?? false), timeout: 240000 };
const TAGS = {
    number: ['TI-1,plant/ti1,,°C,temperature,E-101,0.5,0,0,600,,,,,', 'TI-2,,,°C,temperature,E-101,-0.5,0,0,600,,,,,',
        'PI-1,,,bar,pressure,P-101A,3,0,0.5,600,Linear,0,27648,0,10', 'XS-1,plant/xs1,bool,,,,,,,600,,,,,'],
    json: ['TI-1,line/temps#left.v[1],,°C,temperature,E-101,0.5,0,0,600,,,,,',
        'TI-2,line/temps#right,,°C,temperature,E-101,-0.5,0,0,600,,,,,',
        'PI-1,,,bar,pressure,P-101A,3,0,0.5,600,,,,,'],
};
let broker, plant, publisher;

setUp(options.skip, async (own) => {
    broker = own(await Broker.start());
    plant = own(await PublishedPlant.create(broker));
});
afterEach(async () => {
    await plant?.daemon?.stop();
    publisher?.end(true);
    publisher = null;
    await broker?.restart();
});

const good = { quality_name: 'Good' };
const until = (...args) => plant.until(...args), metric = (name) => plant.metric(name), run = (...args) => plant.run(...args);

test('numbers reach the tags of their topics, scaled, and with their true age', options, async () => {
    await run('topic: "plant/{asset}/{tag}"', [...TAGS.number, 'OLD,plant/ti1,,,,,,,,2,,,,,']);
    publisher = await broker.client();
    await publisher.tell('plant/ti1', '21.5');
    await publisher.tell('plant/E-101/TI-2', ' -3e1\n', { qos: 0 });
    await publisher.tell('plant/P-101A/PI-1', 13824);
    await publisher.tell('plant/xs1', 'true');
    await until('TI-1', { ...good, value: 21.5 });
    await until('TI-2', { ...good, value: -30 });
    await until('PI-1', { ...good, value: 5 });
    await until('XS-1', { ...good, value: 1 });
    // OLD has the same topic as TI-1 but becomes stale after 2 s. This quality means a stale value; a tag without any value has
    // another quality.
    await until('OLD', { quality_name: 'Bad_CommunicationError' });
    await until('TI-1', good);
    const counts = [['messages_total{source="broker",result="ok"}', 4], ['messages_total{source="broker",result="refused"}', 0],
        ['samples_total{source="broker"}', 5], ['connects_total{source="broker"}', 1], ['up{source="broker"}', 1]];
    for (const [name, value] of counts)
        assert.equal(await metric(name), value, name);
    // The connection of a reloaded daemon is a new one, which may have missed messages.
    await plant.reload();
    await until('TI-1', { quality_name: 'Uncertain_LastUsableValue', value: 21.5 });
    await publisher.tell('plant/ti1', '21.5');
    await until('TI-1', { ...good, value: 21.5 });
});

test('a retained value is never shown as fresh', options, async () => {
    publisher = await broker.client();
    await publisher.tell('plant/ti1', '21.5', { retain: true });
    await run('topic: "plant/{asset}/{tag}", protocol: 3.1.1', TAGS.number);
    await until('TI-1', { quality_name: 'Uncertain_LastUsableValue', value: 21.5 });
    await publisher.tell('plant/ti1', '21.5', { retain: true });
    await until('TI-1', { ...good, value: 21.5 });
    await publisher.tell('plant/ti1', '', { retain: true });
    await until('TI-1', { quality_name: 'Bad_ConfigurationError' });
});

for (const protocol of ['5', '3.1.1'])
    test(`all tags are Bad as soon as the broker is gone, and recover with their next values (${protocol})`, options, async (t) => {
        await run(`topic: "plant/{asset}/{tag}", protocol: ${protocol}, keepalive_s: 5`, TAGS.number);
        publisher = await broker.client({ reconnectPeriod: 100 });
        await publisher.tell('plant/ti1', 20);
        await until('TI-1', { ...good, value: 20 });
        await broker.kill();
        const killed = performance.now();
        await until('TI-1', { quality_name: 'Bad_CommunicationError', value: null });
        await until('PI-1', { quality_name: 'Bad_NoCommunication' });
        promise(t, 'until all is Bad, at once', performance.now() - killed, 1000);
        assert.equal(await metric('up{source="broker"}'), 0);
        await broker.restart();
        for (const end = performance.now() + 90000; await metric('up{source="broker"}') !== 1; await sleep(100))
            assert.ok(performance.now() < end, 'the source did not connect again');
        // TI-1 stays stale after the reconnection, because a new connection to the broker does not make the old value current
        await until('TI-1', { quality_name: 'Bad_CommunicationError' }, 1);
        await publisher.tell('plant/ti1', 20);
        await until('TI-1', { ...good, value: 20 });
        broker.freeze();
        await until('TI-1', { quality_name: 'Bad_CommunicationError' });
        broker.thaw();
        await plant.daemon.line(/no readings[^]*reading[^]*no readings[^]*reading/);
    });

test('JSON values are read by path, with the time and quality in the payload', options, async () => {
    await run('payload: json, topic: "plant/{tag}", time: meta.ts, quality: meta.q', TAGS.json);
    publisher = await broker.client();
    const at = (ms, q = 0) => ({ ts: Date.now() + ms, q }), began = Date.now();
    await publisher.tell('line/temps', { left: { v: [1, 40.5] }, right: '17.25', meta: at(-3000) });
    await publisher.tell('plant/PI-1', { value: 4, meta: { ts: new Date().toISOString(), q: 'good' } });
    const left = await until('TI-1', { ...good, value: 40.5 });
    assert.ok(left.age_ms >= 3000 && left.age_ms <= 3000 + Date.now() - began + 1, `the reading is ${left.age_ms} ms old`);
    await until('TI-2', { ...good, value: 17.25 });
    await until('PI-1', { ...good, value: 4 });
    // this message contains no value for `left`, so TI-1 keeps its value
    await publisher.tell('line/temps', { right: 18, meta: at(0, 0x40930000) });
    await until('TI-2', { quality_name: 'Uncertain_SensorNotAccurate', value: 18 });
    await until('TI-1', { ...good, value: 40.5 });
    // this message has a timestamp before that of the present value, so it must be ignored
    await publisher.tell('line/temps', { right: 99, meta: at(-60000) });
    await publisher.tell('line/temps', { left: { v: [1, null] }, right: 19, meta: at(0) });
    await until('TI-1', { quality_name: 'Bad_SensorFailure' });
    await until('TI-2', { ...good, value: 19 });
    await publisher.tell('line/temps', { left: { v: [1, 5] }, right: 'broken', meta: at(0) });
    await until('TI-2', { quality_name: 'Bad_ConfigurationError' });
    await until('TI-1', { ...good, value: 5 });
    await publisher.tell('line/temps', { left: { v: [1, 5] }, right: 21 }); // this message has no timestamp
    await until('TI-1', { quality_name: 'Bad_ConfigurationError' });
    await publisher.tell('line/temps', { left: { v: [1, 5] }, right: 21, meta: at(3600000) });
    await plant.daemon.line(/line\/temps: the timestamps of the messages are \d+\.\d s ahead of this machine's clock/);
    assert.ok((await until('TI-2', { ...good, value: 21 })).age_ms <= Date.now() - began + 1);
});

// Messages as those of Kepware's IoT Gateway: an array with the tags that have changed, in any order. A tag must never get the
// value of another one.
test('a gateway that publishes only changes: no tag gets another\'s value', options, async () => {
    const paths = { A2: 'values[1].v', A3: 'values[2].v', F1: "values[?@.id=='G.A1'].v", F2: "$.values[?id=='G.A2'].v",
        F9: "values[?id=='G.A9'].v" };
    const rows = ['A1,#values[0].v,,°C,temperature,E-101,0.5,0,0,600,,,,,',
        ...Object.entries(paths).map(([name, path]) => `${name},#${path},,,,,,,,600,,,,,`)];
    await run('payload: json, topic: gateway, time: "@.t", quality: "@.q"', rows);
    publisher = await broker.client();
    const item = ([id, v, q = true]) => ({ id, v, q, t: Date.now() });
    const tell = (...items) => publisher.tell('gateway', { timestamp: 5, values: items.map(item) });
    await tell(['G.A2', 22]);
    await until('F2', { ...good, value: 22 });
    let tags = await plant.tags();
    for (const name of ['A1', 'A2', 'A3', 'F1', 'F9'])
        assert.deepEqual([tags[name].quality_name, tags[name].value], ['Bad_NoMatch', null], name);
    await tell(['G.A1', 21], ['G.A2', 23], ['G.A3', 24]); // one message with all three tags, each at a different index of the array
    for (const [name, value] of [['A3', 24], ['A1', 21], ['F1', 21], ['F2', 23]])
        await until(name, { ...good, value });
    await tell(['G.A3', 34], ['G.A1', 31, false]);
    // F1 gets the quality of the item G.A1 (false), not of the message
    await until('F1', { quality_name: 'Bad' });
    tags = await plant.tags();
    assert.equal(tags.A1.quality_name, 'Bad_NoMatch');
    assert.equal(tags.F2.value, 23); // F2 keeps its value, because no message mentioned it
    await tell(['G.A1', 41], ['G.A1', 42]);
    await until('F1', { quality_name: 'Bad_TooManyMatches', value: null });
    await tell(['G.A1', 51]);
    await until('F1', { ...good, value: 51 });
    // After a reload, the first message lacks most tags. They keep their values, because their paths matched before the reload.
    await plant.reload();
    await tell(['G.A1', 60]);
    await until('F1', { ...good, value: 60 });
    tags = await plant.tags();
    for (const [name, quality, value] of [['F2', 'Uncertain_LastUsableValue', 23], ['A3', 'Uncertain_LastUsableValue', 24],
        ['F9', 'Bad_NoMatch', null]])
        assert.deepEqual([tags[name].quality_name, tags[name].value], [quality, value], name);
    await tell(['G.A2', 61]);
    await until('F2', { ...good, value: 61 });
    await plant.daemon.line(/is named G\.A2, not the tag's name; select it by name/);
    await plant.daemon.line(/gateway: no message has had a value of tag /);
    const { out } = runProgram('plantcast', ['tags', `http://127.0.0.1:${plant.plant.port}/`]);
    assert.match(out, /F9.*NoMatch/i);
});

test('a persistent session delivers values published meanwhile, with their true age', options, async () => {
    const keys = 'payload: json, topic: "plant/{tag}", time: ts, session: persistent, client_id: plantcast-test';
    await run(keys, TAGS.json);
    publisher = await broker.client();
    await publisher.tell('plant/PI-1', { value: 1, ts: Date.now() });
    await until('PI-1', { ...good, value: 1 });
    await plant.daemon.stop();
    await publisher.tell('plant/PI-1', { value: 2, ts: Date.now() - 1500 });
    await run(keys, TAGS.json);
    assert.ok((await until('PI-1', { ...good, value: 2 })).age_ms >= 1500);
    // The broker keeps no messages that are published with QoS 0 during the reload.
    await plant.reload();
    await until('PI-1', { quality_name: 'Uncertain_LastUsableValue', value: 2 });
});

// two.test has the addresses 127.0.0.1, which never answers because the queue of connections there is full, and 127.0.0.9. The
// resolver returns them in this order.
const FULL = `import socket, sys, time
s = socket.socket()
s.bind(('127.0.0.1', 0))
s.listen(0)
waiting = [socket.socket() for _ in range(4)]
for one in waiting:
    one.setblocking(False)
    one.connect_ex(s.getsockname())
print(s.getsockname()[1], flush=True)
time.sleep(600)`;
const canMount = process.getuid() === 0 && spawnSync('unshare', ['--mount', 'true']).status === 0;
test('if the first address of a broker\'s name never answers, the next one is used', { ...options,
    skip: options.skip || !canMount && 'no right to mount' }, async () => {
    const full = spawn('/usr/bin/python3', ['-c', FULL], { stdio: ['ignore', 'pipe', 'inherit'] });
    const port = Number(await new Promise((done) => full.stdout.once('data', done)));
    const relay = createServer((socket) => {
        socket.on('error', () => {});
        socket.pipe(connect(broker.port, '127.0.0.1').on('error', () => {})).pipe(socket);
    });
    const hosts = join(plant.folder, 'hosts');
    try {
        await new Promise((done) => relay.listen(port, '127.0.0.9', done));
        writeFileSync(hosts, '127.0.0.1 localhost\n127.0.0.1 two.test\n127.0.0.9 two.test\n');
        plant.plant.before = ['unshare', '--mount', 'sh', '-c', `mount --bind ${hosts} /etc/hosts && exec "$@"`, 'sh'];
        plant.broker = { source: (keys) => `{ id: broker, type: mqtt, host: two.test, port: ${port}, ${keys} }` };
        await run('topic: "plant/{asset}/{tag}"', TAGS.number);
        await plant.said(/no readings \(Connection timed out\)[^]*reading/);
    } finally {
        plant.broker = broker;
        plant.plant.before = [];
        await plant.daemon?.stop();
        relay.close();
        full.kill();
    }
});

// A malicious broker sends messages to which the client has not subscribed, with topics of the maximum length of 64 kB, each
// before a valid reading.
test('topics of 64 kB from a malicious broker affect nothing else', options, async () => {
    await broker.kill();
    let sent = 0;
    const liar = createServer((socket) => {
        const parser = packets.parser(), say = (packet) => socket.write(packets.generate(packet));
        socket.on('error', () => {});
        socket.on('data', (bytes) => parser.parse(bytes));
        parser.on('packet', ({ cmd, messageId, subscriptions }) => {
            if (cmd === 'connect')
                say({ cmd: 'connack', returnCode: 0, sessionPresent: false });
            if (cmd === 'pingreq')
                say({ cmd: 'pingresp' });
            if (cmd !== 'subscribe')
                return;
            say({ cmd: 'suback', messageId, granted: subscriptions.map(() => 0) });
            for (const topic of ['x'.repeat(65535), 'plant/'.repeat(10922), `plant/ti1${'/'.repeat(65000)}`]) {
                say({ cmd: 'publish', topic, payload: '99', qos: 0 });
                say({ cmd: 'publish', topic: 'plant/ti1', payload: `${20 + ++sent}`, qos: 0 });
            }
        });
    });
    await new Promise((done) => liar.listen(broker.port, '127.0.0.1', done));
    try {
        await run('topic: "plant/{asset}/{tag}", protocol: 3.1.1', TAGS.number);
        await until('TI-1', { ...good, value: 23 });
        assert.equal(await metric('connects_total{source="broker"}'), 1);
        assert.equal(await metric('samples_total{source="broker"}'), 3);
        assert.ok(plant.daemon.said.length < 20000, 'the log contains no topic of 64 kB');
    } finally {
        await plant.daemon?.stop();
        liar.close();
    }
});

test('invalid payloads are refused by name, and affect nothing else', options, async () => {
    await run('topic: "plant/{asset}/{tag}", protocol: 3.1.1', TAGS.number);
    publisher = await broker.client();
    await publisher.tell('plant/xs1', 1);
    await publisher.tell('plant/ti1', 20);
    await until('TI-1', good);
    const begun = performance.now();
    const bytes = [Buffer.from([0, 1, 2, 255]), Buffer.alloc(100 << 20, '1')];
    for (const wrong of ['warm', '21.5 C', 'NaN', '1e999', '', '1'.repeat(1000), ...bytes]) {
        await publisher.tell('plant/ti1', wrong);
        await until('TI-1', { quality_name: 'Bad_ConfigurationError' }, 60);
        await publisher.tell('plant/ti1', 20);
        await until('TI-1', good);
    }
    await plant.daemon.line(/plant\/ti1: a message of 4 bytes was refused: expected one number/);
    for (let i = 0; i < 300; i++)
        await publisher.tell('plant/ti1', 'warm', { qos: i === 299 ? 1 : 0 });
    for (const end = performance.now() + 60000; await metric('messages_total{source="broker",result="refused"}') < 308; await sleep(20))
        assert.ok(performance.now() < end, 'not all refused messages are counted');
    const seconds = Math.ceil((performance.now() - begun) / 1000);
    const lines = plant.daemon.said.match(/refused/g).length;
    assert.ok(lines <= 1 + Math.floor(seconds / 60), `more than one log line a minute:\n${plant.daemon.said}`);
    await publisher.tell('plant/xs1', 0); // publishes again, because the first value may be stale by now
    await until('XS-1', { ...good, value: 0 });
});

test('plantcast-sim publishes values where the tags of MQTT sources read them', options, async () => {
    const sim = async (...args) => plant.plant.startSim('--mqtt', `127.0.0.1:${broker.port}`, ...args);
    for (const [keys, rows, values] of [['topic: "plant/{asset}/{tag}", poll_ms: 100', TAGS.number, [['PI-1', 5], ['XS-1', 1]]],
        ['payload: json, topic: "plant/{tag}", time: meta.ts, quality: meta.q, poll_ms: 100', TAGS.json, [['TI-1', 40.5], ['PI-1', 5]]]]) {
        await run(keys, rows);
        await sim();
        await until('TI-2', good);
        for (const [name, value] of values) {
            assert.equal(await plant.plant.tell(`set ${name} ${value}`), 'ok');
            await until(name, { ...good, value });
        }
        assert.match(await plant.plant.tell('fail PI-1'), /^error: tag PI-1 has no Modbus register/);
        await plant.plant.sim.stop();
        await plant.daemon.stop();
    }
});

test('--check names each mistake in an MQTT source of the plant file', options, async () => {
    const said = (keys, rows) => {
        plant.write(keys, rows);
        const { code, err } = runProgram('plantcastd', ['--check', plant.file]);
        assert.equal(code, 1, err);
        return err;
    };
    assert.match(said('payload: json, value: "a..b"', TAGS.number), /plant\.yaml:9:\d+: error: value: 'a\.\.b': descendants/);
    const refused = [['a[*].v', 'a wildcard selects'], ['a[0:2].v', 'a slice selects'], ['a..v', 'descendants'],
        ["a[?id!='x'].v", 'needs ==']];
    for (const [path, why] of refused)
        assert.match(said('payload: json, topic: a', [`TI-1,#${path},,,,,,,,,,,,,`]),
            new RegExp(`tags\\.csv:2:6: error: Address: .*${why}`), path);
    assert.match(said('time: ts', TAGS.number), /time: allowed only with payload: json/);
    assert.match(said('session: persistent', TAGS.number), /would look fresh[^]*requires client_id/);
    assert.match(said('topic: "plant/+/{tag}"', TAGS.number), /topic: 'plant\/\+\/\{tag\}': the MQTT topic has a wildcard \(\+ or #\)/);
    assert.match(said('topic: "plant/{name}"', TAGS.number), /may contain only \{tag\}, \{asset\}, \{group\} and \{address\} in braces/);
    assert.match(said('qos: 1', TAGS.number), /tags\.csv:3:6: error: Address: '': this tag has no MQTT topic: write one/);
    assert.match(said('topic: "a/{tag}"', [TAGS.json[0]]), /a path after # is not allowed with `payload: number`/);
    assert.match(said('topic: "a/{tag}", rebirth: yes', TAGS.number), /rebirth: allowed only with payload: sparkplug/);
    assert.match(said('payload: sparkplug', ['TI-1,U100#TI-1,,,,,,,,,,,,,']),
        /expected a Sparkplug address GROUP\/NODE#METRIC or GROUP\/NODE\/DEVICE#METRIC/);
    assert.match(said('baud: 9600', TAGS.number), /baud: has no effect for an mqtt source/);
});
