// SPDX-License-Identifier: GPL-3.0-or-later
// Tests alarm notifications by e-mail over TLS, webhook and Alertmanager, with all servers on loopback. An alarm flood makes a
// single message, failed deliveries are retried, and a kill must not make the daemon send an e-mail twice.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { makeCertificate } from './support/certificate.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { promise } from './support/promise.mjs';
import { HookServer, MailServer } from './support/receivers.mjs';
import { notBuilt, Program, runProgram, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const options = { skip: notBuilt(), timeout: 240000 };

// Makes a plant of two boxes and three tags; extra: number of additional tags. Values above 50 raise an alarm.
async function createPlant(notify, extra = 0) {
    const plant = await TinyPlant.create(), tags = join(plant.folder, 'tags.csv');
    const place = '"more, of it",temperature,E-101,0.5,0,0,600';
    const rows = Array.from({ length: extra }, (_, i) => `X-${i},${410001 + 2 * i},Float,°C,${place}\n`);
    // keeps readings good on a busy machine: a reading that is Bad for a moment would end its alarm and raise it again, and
    // both would be notified
    plant.keepFresh();
    const text = (readFileSync(tags, 'utf8') + rows.join('')).trim().split('\n');
    writeFileSync(tags, `${[`${text[0]},H,HH`, ...text.slice(1).map((row) => `${row},50,60`)].join('\n')}\n`);
    makeCertificate(plant.folder, 'mail');
    writeFileSync(join(plant.folder, 'password'), 'öpen sesame\n', { mode: 0o600 });
    writeFileSync(plant.file, `${readFileSync(plant.file, 'utf8').replace('E-101, model', 'E-101, area: Tank farm, model')}${notify}`);
    const { code, err } = plant.prepare();
    assert.equal(code, 0, err);
    await plant.startSim();
    return plant;
}
const limits = { calm: 20, high: 55, veryHigh: 70 };
const set = (plant, tag, value) => plant.tell(`set ${tag} ${value}`);
async function calm(plant, extra = 0) {
    for (const tag of ['TI-1', 'TI-2', 'PI-1', ...Array.from({ length: extra }, (_, i) => `X-${i}`)])
        await set(plant, tag, limits.calm);
}
// Sets the additional tags above their limits while the daemon is stopped, so that the daemon then reads all of them in one poll.
async function raiseAtOnce(plant, extra) {
    plant.daemon.child.kill('SIGSTOP');
    for (let i = 0; i < extra; i++)
        await set(plant, `X-${i}`, limits.high);
    plant.daemon.child.kill('SIGCONT');
}
const isCalm = (plant) => until('calm readings', async () => {
    const { tags } = await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/tags?count=1000`)).json();
    return tags.every(({ value }) => value === limits.calm);
});
async function acknowledge(plant, tag, kinds) {
    const client = await PlainClient.open(plant.port);
    await client.hello({});
    await client.text('alarms');
    client.say({ type: 'alarm', seq: 1, action: 'acknowledge', alarms: kinds.map((kind) => [tag, kind]), name: 'Kim' });
    assert.equal((await client.text('alarmed')).done, kinds.length);
    client.close();
}

for (const starttls of [false, true]) {
    test(`an e-mail is sent by ${starttls ? 'STARTTLS' : 'TLS'} with user and password, and only once despite a kill`,
        options, async () => {
        const port = await freePort();
        const plant = await createPlant(`alarms: local
notify:
  gather_s: 1
  pause_s: 1
  link: https://p.example/
  mail: { server: "${starttls ? 'smtp' : 'smtps'}://localhost:${port}", from: plant@p.example, user: plant, password_file: password,
          ca_file: mail.pem }
  recipients: [{ id: ops, email: [ops@p.example, gone@p.example, night@p.example] }]
  rules: [{ id: tanks, areas: "Tank*", to: ops }]
`), mail = new MailServer(plant.folder, { starttls, user: 'plant', password: 'öpen sesame' });
        try {
            await mail.listen(port);
            await calm(plant);
            await plant.startDaemon();
            await set(plant, 'PI-1', limits.high); // PI-1 is in another area
            await set(plant, 'TI-1', limits.high);
            const [first] = await until('a mail', () => mail.mails.length > 0 && mail.mails);
            assert.deepEqual(first.to, ['ops@p.example', 'night@p.example']);
            assert.ok(first.secure);
            assert.equal(first.subject, '[Two boxes] P3 TI-1 high, left');
            assert.match(first.body, /^P3 {2}[\d-]+ [\d:]+ {2}TI-1 high, left: raised at 55 °C \(limit 50 °C\); E-101, Tank farm\r$/m);
            assert.match(first.body, /https:\/\/p\.example\//);
            await plant.daemon.line(/warn +notify: ops: the mail server refused <gone@p\.example>: 550 5\.1\.1 no such mailbox/);
            await until('the refusal is counted', async () =>
                await plant.metric('plantcast_notify_mailboxes_refused_total{recipient="ops"}') === 1);
            await until('it is counted', async () => await plant.metric('plantcast_notify_sent_total{recipient="ops"}') === 1);
            await plant.daemon.stop('SIGKILL');
            await plant.startDaemon();
            await set(plant, 'TI-2', 12345678);
            await until('the next mail', () => mail.mails.length > 1);
            assert.match(mail.mails[1].body, /TI-2 .*: raised at 12345678 °C/, 'the value is written with all digits');
            assert.doesNotMatch(mail.mails[1].body, /TI-1/, 'the other alarm, already sent, is not sent again');
            assert.notEqual(mail.mails[1].headers['message-id'], first.headers['message-id']);
        } finally {
            await mail.close();
            await plant.destroy();
        }
    });
}

test('a mail server with an untrusted certificate gets no mail and no password', options, async () => {
    const plant = await createPlant(''), mail = new MailServer(plant.folder, { user: 'plant', password: 'x' });
    await mail.listen();
    writeFileSync(plant.file, `${readFileSync(plant.file, 'utf8')}notify:
  gather_s: 0
  mail: { server: "smtps://localhost:${mail.port}", from: plant@p.example, user: plant, password_file: password }
  recipients: [{ id: ops, email: ops@p.example }]
  rules: [{ id: all, to: ops }]
`);
    try {
        await calm(plant);
        await set(plant, 'TI-1', limits.high);
        await plant.startDaemon();
        await until('it fails', async () => await plant.metric('plantcast_notify_failed_total{recipient="ops"}') >= 1);
        await plant.daemon.line(/ops cannot be reached: .*certificate/i);
        assert.equal(mail.mails.length, 0);
        assert.ok(!plant.daemon.said.includes('sesame'));
    } finally {
        await mail.close();
        await plant.destroy();
    }
});

test('500 alarms in one second make one message, while a mail server hangs and a webhook fails', options, async (t) => {
    const hook = new HookServer(), EXTRA = 500;
    await hook.listen();
    const port = await freePort();
    const plant = await createPlant(`alarms: local
notify:
  gather_s: 3
  timeout_s: 2
  mail: { server: "smtps://localhost:${port}", from: plant@p.example, ca_file: mail.pem }
  recipients:
    - { id: ops, email: ops@p.example }
    - { id: hook, webhook: "http://127.0.0.1:${hook.port}/plant?x=1", token_file: password }
  rules: [{ id: all, to: [ops, hook] }]
`, EXTRA), mail = new MailServer(plant.folder);
    mail.mode = 'hang';
    try {
        await mail.listen(port);
        await calm(plant, EXTRA);
        await plant.startDaemon();
        await isCalm(plant);
        await raiseAtOnce(plant, EXTRA);
        const [post] = await until('a post', () => hook.posts.length > 0 && hook.posts);
        assert.equal(post.url, '/plant?x=1');
        assert.equal(post.headers.authorization, `Bearer ${Buffer.from('öpen sesame').toString('latin1')}`);
        assert.equal(post.body.version, 1);
        assert.equal(new Set(post.body.alarms.map(({ tag }) => tag)).size, EXTRA);
        const { tag, ...alarm } = post.body.alarms[0];
        assert.match(tag, /^X-\d+$/);
        assert.match(alarm.raised, /^\d{4}-\d\d-\d\dT/);
        assert.deepEqual({ ...alarm, raised: '' }, { kind: 'H', priority: 3, state: 'unacknowledged', escalation: 0, raised: '', value: 55,
            limit: 50, unit: '°C', description: 'more, of it', asset: 'E-101', area: 'Tank farm' });
        await until('the other one has given up', async () => await plant.metric('plantcast_notify_failed_total{recipient="ops"}') >= 2);
        assert.equal(await plant.metric('plantcast_notify_waiting{recipient="ops"}'), EXTRA);
        const took_ms = [];
        for (let i = 0; i < 5; i++) { // measures five requests and takes the fastest, because other load may delay single ones
            const asked = performance.now();
            await fetch(`http://127.0.0.1:${plant.port}/api/v1/alarms?limit=1`);
            took_ms.push(performance.now() - asked);
        }
        promise(t, 'a question beside the slow recipient', Math.min(...took_ms), 1000);
        const stopping = performance.now(), { code } = await plant.daemon.stop();
        assert.equal(code, 0);
        promise(t, 'until the daemon has ended', performance.now() - stopping, 10000);
        mail.mode = 'take';
        await plant.startDaemon();
        const [{ subject, body }] = await until('after the outage', () => mail.mails.length > 0 && mail.mails);
        assert.equal(subject, `[Two boxes] ${EXTRA} alarms, ${EXTRA} of priority 3`);
        assert.match(body, /\.\.\. and 450 more/);
        await until('nothing more to send', async () => await plant.metric('plantcast_notify_waiting{recipient="ops"}') === 0 &&
            await plant.metric('plantcast_notify_waiting{recipient="hook"}') === 0);
        assert.equal(mail.mails.length, 1);
        assert.equal(hook.posts.length, 1);
    } finally {
        await mail.close();
        await hook.close();
        await plant.destroy();
    }
});

test('a webhook that redirects or answers 400, and an Alertmanager that refuses alarms, are retried', options, async () => {
    const hook = Object.assign(new HookServer(), { status: 302 }), manager = Object.assign(new HookServer(), { status: 422 });
    await Promise.all([hook.listen(), manager.listen()]);
    const plant = await createPlant(`alarms: local
notify:
  gather_s: 1
  recipients: [{ id: hook, webhook: "http://127.0.0.1:${hook.port}/" }, { id: am, alertmanager: "http://127.0.0.1:${manager.port}" }]
  rules: [{ id: all, to: [hook, am] }]
`, 1);
    try {
        await calm(plant, 1);
        await plant.startDaemon();
        await isCalm(plant);
        await set(plant, 'X-0', limits.high);
        await until('a failure', async () => await plant.metric('plantcast_notify_failed_total{recipient="hook"}') >= 1);
        hook.status = 400;
        await until('an answer 400', () => hook.posts.some(({ status }) => status === 400));
        const failures = () => plant.metric('plantcast_notify_failed_total{recipient="hook"}');
        await until('it is counted', async () => await failures() >= hook.posts.length);
        assert.equal(await plant.metric('plantcast_notify_waiting{recipient="hook"}'), 1);
        hook.status = 200;
        await until('that it is told', () => hook.taken.length > 0);
        await until('Alertmanager is tried again', () => manager.posts.length > 1);
        assert.equal(plant.daemon.said.match(/notify: am cannot be reached/g)?.length, 1);
        assert.doesNotMatch(plant.daemon.said, /am refuses a message/);
        assert.equal(await plant.metric('plantcast_notify_lost_total'), 0);
    } finally {
        await Promise.all([hook.close(), manager.close()]);
        await plant.destroy();
    }
});

test('a message that a receiver refuses for good is shortened, and later alarms reach the receiver', options, async () => {
    const hook = Object.assign(new HookServer(), { most: 16000 }), EXTRA = 100;
    await hook.listen();
    const plant = await createPlant(`alarms: local
notify:
  gather_s: 3
  pause_s: 0
  recipients: [{ id: hook, webhook: "http://127.0.0.1:${hook.port}/" }]
  rules: [{ id: all, to: hook }]
`, EXTRA);
    try {
        await calm(plant, EXTRA);
        await plant.startDaemon();
        await isCalm(plant);
        await raiseAtOnce(plant, EXTRA);
        const [short] = await until('the shortened message', () => hook.taken.length > 0 && hook.taken);
        assert.deepEqual([short.alarms.length, short.left_out, hook.posts[0].status], [50, EXTRA - 50, 413]);
        assert.notEqual(short.id, hook.posts[0].body.id);
        hook.most = 10; // even the shortest message is too large
        await set(plant, 'TI-1', limits.high);
        await until('it is refused', async () => await plant.metric('plantcast_notify_lost_total') === EXTRA - 50 + 1);
        hook.most = 16000;
        await set(plant, 'TI-2', limits.high);
        await until('a later alarm', () => hook.taken.length > 1);
        assert.deepEqual(hook.taken[1].alarms.map(({ tag }) => tag), ['TI-2']);
        assert.equal(hook.taken[1].left_out, 1);
    } finally {
        await hook.close();
        await plant.destroy();
    }
});

test('a mail whose text the mail server refuses for good does not hold up later mails', options, async () => {
    const port = await freePort();
    const plant = await createPlant(`alarms: local
notify:
  gather_s: 0
  pause_s: 0
  mail: { server: "smtps://localhost:${port}", from: plant@p.example, ca_file: mail.pem }
  recipients: [{ id: ops, email: [ops@p.example, gone@p.example] }]
  rules: [{ id: all, to: ops }]
`), mail = Object.assign(new MailServer(plant.folder), { mode: 'content' });
    const refusals = () => plant.metric('plantcast_notify_mailboxes_refused_total{recipient="ops"}');
    try {
        await mail.listen(port);
        await calm(plant);
        await plant.startDaemon();
        await isCalm(plant);
        await set(plant, 'TI-1', limits.high);
        await until('it is dropped', async () => await plant.metric('plantcast_notify_lost_total') === 1);
        mail.mode = 'later';
        await set(plant, 'TI-2', limits.high);
        const failed = await plant.metric('plantcast_notify_failed_total{recipient="ops"}');
        await until('a retry', async () => await plant.metric('plantcast_notify_failed_total{recipient="ops"}') > failed);
        assert.equal(await refusals(), 0, 'a mail that is sent again counts once, when the mail server takes it');
        mail.mode = 'take';
        await until('a later mail', () => mail.mails.length > 0);
        assert.match(mail.mails[0].body, /TI-2 high[^]*\n1 more alarms are not listed/);
        assert.doesNotMatch(mail.mails[0].body, /TI-1/);
        await until('the refused mailbox counts', async () => await refusals() === 1);
        assert.equal((await fetch(`http://127.0.0.1:${plant.port}/api/v1/reload`, { method: 'POST' })).status, 200);
        await set(plant, 'PI-1', limits.high);
        await until('the count goes on after a reload', async () => await refusals() === 2);
    } finally {
        await mail.close();
        await plant.destroy();
    }
});

// outbox_test checks with a simulated clock that an acknowledged alarm is not escalated
test('an alarm that nobody acknowledges is sent to the next recipient; a failed message is repeated with its id', options, async () => {
    const hooks = [new HookServer(), new HookServer()];
    for (const hook of hooks)
        await hook.listen();
    const plant = await createPlant(`alarms: local
notify:
  gather_s: 0
  pause_s: 0
  recipients:
${hooks.map(({ port }, i) => `    - { id: h${i}, webhook: "http://127.0.0.1:${port}/" }`).join('\n')}
  rules: [{ id: all, to: h0, escalate: [{ after_min: 0.02, to: h1 }] }]
`);
    try {
        await calm(plant);
        await plant.startDaemon();
        hooks[0].status = 503; // the first recipient answers 503 for a while, so that the first attempts to send fail
        await set(plant, 'TI-1', limits.high);
        await until('a try', () => hooks[0].posts.length > 0);
        hooks[0].status = 200;
        await until('it is told', () => hooks[0].taken.length > 0);
        assert.equal(hooks[0].posts[0].body.id, hooks[0].taken[0].id, 'the retry has the same message id');
        const [next] = await until('the next one is told', () => hooks[1].taken.length > 0 && hooks[1].taken);
        assert.deepEqual(next.alarms.map(({ tag, escalation }) => [tag, escalation]), [['TI-1', 1]]);
    } finally {
        for (const hook of hooks)
            await hook.close();
        await plant.destroy();
    }
});

test('a reload remembers which alarms were sent, and applies new rules', options, async () => {
    const hook = new HookServer();
    await hook.listen();
    const plant = await createPlant(`alarms: local
notify:
  gather_s: 0
  pause_s: 0
  recipients: [{ id: hook, webhook: "http://127.0.0.1:${hook.port}/" }]
  rules: [{ id: boxes, areas: "Tank*", to: hook }]
`);
    try {
        await calm(plant);
        await plant.startDaemon();
        await set(plant, 'TI-1', limits.high);
        await until('it is told', () => hook.taken.length > 0);
        writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace('areas: "Tank*", ', ''));
        assert.equal((await fetch(`http://127.0.0.1:${plant.port}/api/v1/reload`, { method: 'POST' })).status, 200);
        await set(plant, 'PI-1', limits.high);
        await until('the other area is told', () => hook.taken.length > 1);
        assert.deepEqual(hook.taken.map(({ alarms }) => alarms.map(({ tag }) => tag)), [['TI-1'], ['PI-1']]);
        writeFileSync(plant.file, readFileSync(plant.file, 'utf8').replace('to: hook', 'to: nobody'));
        const checked = runProgram('plantcastd', ['--check', plant.file]);
        assert.equal(checked.code, 1);
        assert.match(checked.err, /plant\.yaml:\d+:\d+: error: to: unknown recipient 'nobody'/);
    } finally {
        await hook.close();
        await plant.destroy();
    }
});

test('--test-notify sends a marked message to every recipient and states which server did not accept it', options, async () => {
    const plant = await TinyPlant.create(), hook = new HookServer(), redirecting = new HookServer();
    const text = readFileSync(plant.file, 'utf8');
    const ask = async () => {
        const program = new Program('plantcastd', ['--test-notify', plant.file]);
        return [(await program.ended).code, program.said];
    };
    try {
        assert.match((await ask()).join(' '), /^1 plantcastd: .*plant\.yaml: the plant file has no `notify`/);
        makeCertificate(plant.folder, 'mail');
        const mail = new MailServer(plant.folder);
        await Promise.all([mail.listen(), hook.listen(), redirecting.listen()]);
        const closed = await freePort();
        redirecting.status = 302;
        const accepted = `    - { id: ops, email: [ops@p.example, gone@p.example] }
    - { id: tickets, webhook: "http://127.0.0.1:${hook.port}/" }
    - { id: am, alertmanager: "http://127.0.0.1:${hook.port}/am" }
`, refused = `    - { id: moved, webhook: "http://127.0.0.1:${redirecting.port}/" }
    - { id: away, webhook: "http://127.0.0.1:${closed}/" }
`;
        const write = (recipients) => writeFileSync(plant.file, `${text}alarms: local
notify:
  mail: { server: "smtps://localhost:${mail.port}", from: plant@p.example, ca_file: mail.pem }
  recipients:
${recipients}  rules: [{ id: nobody, areas: "No such area", to: ops }]
`);
        write(accepted + refused);
        const [code, said] = await ask(), lines = said.trim().split('\n');
        assert.equal(code, 1, said);
        for (const id of ['ops', 'tickets', 'am'])
            assert.ok(lines.includes(`${id}: the server accepted the test message`), said);
        assert.match(said, /^moved: not delivered: the server answered with HTTP status 302$/m);
        assert.match(said, /^away: not delivered: Failed to connect/m);
        assert.match(said, /the mail server refused <gone@p\.example>: 550/);
        assert.equal(mail.mails[0].subject, '[Two boxes] Test message, no alarm');
        const { body: alerts } = hook.posts.find(({ url }) => url === '/am/api/v2/alerts');
        const { body } = hook.posts.find(({ url }) => url === '/');
        assert.equal(body.test, true);
        assert.equal(body.recipient, 'tickets');
        assert.equal(alerts[0].labels.alertname, 'PlantAlarm');
        assert.equal(alerts[0].labels.severity, 'critical');
        assert.equal(alerts[0].annotations.summary, 'Test message, no alarm');
        assert.ok(Date.parse(alerts[0].endsAt) > Date.now(), 'Alertmanager would treat the test as ended at once');
        assert.match(said, /^mail servers refused 1 mailbox: the warnings name each$/m);
        write(accepted);
        assert.equal((await ask())[0], 1, 'a refused mailbox is a failure');
        write(accepted.replace(', gone@p.example', ''));
        assert.equal((await ask())[0], 0);
        await mail.close();
    } finally {
        await Promise.all([hook.close(), redirecting.close()]);
        await plant.destroy();
    }
});

const alertmanager = spawnSync('prometheus-alertmanager', ['--version']).status === 0;
test('Prometheus Alertmanager knows which alarms are active and when they end', { ...options,
    skip: options.skip || (!alertmanager && 'prometheus-alertmanager is not installed') }, async () => {
    const port = await freePort(), hook = new HookServer();
    await hook.listen();
    const plant = await createPlant(`alarms: local
notify:
  gather_s: 0
  recipients: [{ id: am, alertmanager: "http://127.0.0.1:${port}" }]
  rules: [{ id: all, to: am }]
`);
    writeFileSync(join(plant.folder, 'am.yml'), `route: { receiver: hook, group_wait: 1s, group_by: [plant] }
receivers: [{ name: hook, webhook_configs: [{ url: "http://127.0.0.1:${hook.port}/" }] }]
`);
    const manager = spawn('prometheus-alertmanager', [`--config.file=${join(plant.folder, 'am.yml')}`,
        `--storage.path=${join(plant.folder, 'am')}`, `--web.listen-address=127.0.0.1:${port}`, '--cluster.listen-address='],
    { stdio: 'ignore' }), ended = new Promise((done) => manager.once('exit', done));
    const alerts = async () => (await (await fetch(`http://127.0.0.1:${port}/api/v2/alerts`)).json());
    try {
        await calm(plant);
        await plant.startDaemon();
        await set(plant, 'TI-1', limits.veryHigh);
        const known = await until('both alarms', async () => {
            const found = await alerts().catch(() => []);
            return found.length === 2 && found;
        });
        const { labels, annotations, status } = known.find((alert) => alert.labels.kind === 'HH');
        assert.deepEqual(labels, { alertname: 'PlantAlarm', plant: 'Two boxes', tag: 'TI-1', kind: 'HH', priority: '2', severity: 'error',
            asset: 'E-101', area: 'Tank farm' });
        assert.equal(annotations.summary, 'TI-1 high high, left');
        assert.equal(status.state, 'active');
        await until('it tells others', () => hook.posts.length > 0);
        assert.equal(hook.posts[0].body.status, 'firing');
        await set(plant, 'TI-1', limits.calm);
        await acknowledge(plant, 'TI-1', ['H', 'HH']);
        await until('none stands any more', async () => (await alerts()).length === 0);
    } finally {
        manager.kill();
        await ended; // waits until the daemon has ended, because until then it writes to the folder that is removed next
        await hook.close();
        await plant.destroy();
    }
});
