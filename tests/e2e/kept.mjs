// SPDX-License-Identifier: GPL-3.0-or-later
// Users' actions must not be lost. Each is answered either once it is stored on disk or with `not kept`. Tested for each kind
// of action: one answered as done survives a kill -9 at that moment; if the disk is full, programs and the page say that it is
// not kept.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { appendFileSync, chmodSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statfsSync, truncateSync,
    writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { openPage, shoot, waitForPicture } from './support/browser.mjs';
import { linesOf } from './support/lines.mjs';
import { until } from './support/nodes.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { setUp } from './support/set_up.mjs';
import { sweep } from './support/sweep.mjs';
import { missing, runProgram, TinyPlant } from './support/tiny_plant.mjs';

const absent = missing();
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : process.getuid() === 0 ? false : 'only root may mount a small disk';
const options = { skip, timeout: 240000 };
const FULL = /the server’s disk is full|No space left on device/;
const SECRET = `pc_${'7'.repeat(64)}`;
const WALL = `views: [{ id: whole, title: Whole unit, view: "group=temperature" }]
walls: [{ id: room, displays: [{ grid: [main], panes: [{ area: main, views: whole }] }] }]
`;
let plant, port, engineer, mounted, shared = 0;

const path = (name) => join(plant.folder, name);

setUp(skip, async () => {
    plant = await TinyPlant.create();
    plant.addAlarms();
    const tags = readFileSync(path('tags.csv'), 'utf8'); // changes the tag list so that PI-1's alarm stays until it is reset
    writeFileSync(path('tags.csv'), tags.replace('Stale s,H', 'Stale s,H,Latch').replace(/,1,90$/gm, ',600,90,')
        .replace(/^(PI-1.*,)$/m, '$11'));
    plant.giveDeviceTime();
    appendFileSync(plant.file, WALL);
    assert.equal(plant.prepare().code, 0);
    engineer = runProgram('plantcast', ['token', 'add', path('tokens'), '--role', 'engineer', '--name', 'eve']).out.trim();
    chmodSync(path('tokens'), 0o600);
    // Everything, including the plant file, is on a 24 MB disk.
    const aside = `${plant.folder}.aside`;
    cpSync(plant.folder, aside, { recursive: true });
    mounted = spawnSync('mount', ['-t', 'tmpfs', '-o', 'size=24m', 'tmpfs', plant.folder]).status === 0;
    cpSync(aside, plant.folder, { recursive: true });
    rmSync(aside, { recursive: true });
    await plant.startSim();
    await plant.set({ 'TI-1': 95.5, 'TI-2': 20, 'PI-1': 5 });
    port = await freePort();
    await start();
    await until('the alarm', async () => (await alarm())?.state === 'unacknowledged');
});
after(async () => {
    const folder = plant?.folder;
    await plant?.daemon?.stop('SIGKILL');
    if (mounted)
        spawnSync('umount', ['-l', folder]);
    await plant?.destroy();
});

const start = () => plant.startDaemon('--port', String(port), '--tokens', path('tokens'), '--trust-local', '--history', path('history'),
    '--audit', path('audit.log'), '--import');
async function killed() {
    plant.daemon.stopped = true;
    await plant.daemon.stop('SIGKILL');
    await start();
}
const ask = (where) => fetch(`http://127.0.0.1:${port}${where}`, { headers: { authorization: `Bearer ${engineer}` } });
const fetched = async (where) => (await ask(where)).json();
const alarm = async (of = 'TI-1') => (await fetched('/api/v1/alarms')).alarms.find(({ tag, kind }) => tag === of && kind === 'H');
const inForce = async () => (await fetched('/api/v1/notes')).list.filter(({ ended_us: ended }) => !ended);
const listed = async (where) => (await ask(where)).text();
const trail = () => linesOf(path('audit.log')).map((line) => JSON.parse(line));

// Fills the disk completely, as another program might do; free() removes the file again.
const fill = () => assert.notEqual(spawnSync('dd', ['if=/dev/zero', `of=${path('full')}`, 'bs=4k']).status, 0);
const free = () => rmSync(path('full'), { force: true });

async function enter() {
    const client = await PlainClient.open(port);
    await client.hello({ token: engineer });
    return client;
}
async function told(type) {
    const client = await enter(), text = JSON.stringify(await client.text(type));
    client.close();
    return text;
}
const shelve = { action: 'shelve', for_s: 3600, reason: 'is looked at' };
const onAlarm = (more) => ({ type: 'alarm', alarms: [['TI-1', 'H']], ...more });
const device = (at = port) => fetch(`http://127.0.0.1:${at}/api/v1/pair?wall=room&display=1`,
    { headers: { Authorization: `Pairing ${SECRET}` } });

// Each row: name of the action; message, or a function that sends or returns it; type of the answer; event in the audit trail;
// check that asks the daemon whether the action took effect.
const ACTIONS = [
    ['acknowledge', onAlarm({ action: 'acknowledge' }), 'alarmed', 'alarm', async () => (await alarm()).state === 'acknowledged'],
    ['shelve', onAlarm(shelve), 'alarmed', 'alarm', async () => (await alarm()).state === 'shelved'],
    ['unshelve', onAlarm({ action: 'unshelve' }), 'alarmed', 'alarm', async () => (await alarm()).state !== 'shelved'],
    ['suppress', onAlarm({ action: 'out_of_service', reason: 'gone' }), 'alarmed', 'alarm',
        async () => (await alarm()).state === 'out_of_service'],
    ['put back', onAlarm({ action: 'in_service' }), 'alarmed', 'alarm', async () => (await alarm()).state !== 'out_of_service'],
    ['reset', async (client) => {
        await plant.tell('set PI-1 95');
        await until('the alarm of PI-1', async () => (await alarm('PI-1'))?.state === 'unacknowledged');
        await plant.tell('set PI-1 5');
        client.say({ type: 'alarm', action: 'acknowledge', alarms: [['PI-1', 'H']], seq: 901 });
        await until('that it is latched', async () => (await alarm('PI-1'))?.state === 'latched');
        return { type: 'alarm', action: 'reset', alarms: [['PI-1', 'H']] };
    }, 'alarmed', 'alarm', async () => !await alarm('PI-1')],
    ['note', { type: 'note', text: 'leaks a little', asset: 'E-101' }, 'noted', 'note',
        async () => (await listed('/api/v1/notes')).includes('leaks a little')],
    ['remove a note', async () => ({ type: 'remove_note', id: (await inForce())[0].id }), 'noted', 'note',
        async () => (await inForce()).length === 0],
    ['save a view', { type: 'save_view', id: 'pump', title: 'The pump', view: 'asset=P-101A' }, 'view_saved', 'view',
        async () => (await listed('/api/v1/views')).includes('The pump')],
    ['remove a view', { type: 'remove_view', id: 'pump' }, 'view_saved', 'view',
        async () => !(await listed('/api/v1/views')).includes('The pump')],
    ['share a view', () => ({ type: 'share_view', view: `asset=P-101A&range=0,${++shared}` }), 'view_shared', 'view',
        async ({ id }) => (await listed(`/api/v1/link?id=${id}`)).includes('asset=P-101A')],
    ['send to a wall', { type: 'send_to_wall', wall: 'room', display: 1, area: 'main', view: 'group=pressure', title: 'Look here' },
        'sent_to_wall', 'wall', async () => (await told('walls')).includes('Look here')],
    ['check a loop', { type: 'prove', tag: 'TI-2', expected: 20, tolerance: 1, remark: 'by hand' }, 'proved', 'proof',
        async () => (await listed('/api/v1/proofs')).includes('by hand')],
    ['pair a display', async () => ({ type: 'pair', digits: await until('digits', async () => (await (await device()).json()).digits) }),
        'paired', 'device', async () => (await listed('/api/v1/devices')).includes('room.1.1')],
    ['revoke a display', { type: 'unpair', id: 'room.1.1' }, 'paired', 'device',
        async () => !(await listed('/api/v1/devices')).includes('room.1.1')],
    ['place a sensor', async (client) => {
        client.say({ type: 'place', seq: 900, moves: [{ tag: 'TI-2', asset: 'E-101', position: [-0.5, 0.25, 0] }] });
        client.say({ type: 'save_tags', seq: 901 });
        return { type: 'save_tags', confirm: (await client.text('tags_diff')).hash };
    }, 'tags_saved', 'reload', () => readFileSync(path('tags.csv'), 'utf8').includes(',-0.5,0.25,0,')],
];

// Connects as an engineer and sends one action. Returns the answer and the client.
async function act(message, type, seq) {
    const client = await enter();
    client.say({ ...(typeof message === 'function' ? await message(client) : message), seq });
    const isAnswer = (one) => (one.type === type && one.seq === seq) || one.type === 'error';
    const answer = await client.until(type, ({ texts }) => texts.find(isAnswer));
    return { answer, client };
}
const upload = (name, body) => fetch(`http://127.0.0.1:${port}/api/v1/import/upload?name=${name}`,
    { method: 'POST', body, headers: { authorization: `Bearer ${engineer}` } });
const isDone = ({ done, kept, saved, passed }) => (done ?? 0) > 0 || kept === true || saved === true || (passed && kept !== false);
const whyNot = ({ why, refused = [], errors = [] }) => [why, ...errors, ...refused.flat()].filter(Boolean).join('; ');

test('on a full disk each action is answered "not kept" with the reason; once there is space, it is kept', options, async (t) => {
    if (!mounted)
        return t.skip('this user may not mount a file system');
    t.after(free);
    const unkept = [], unaudited = [];
    for (const [i, [name, message, type]] of ACTIONS.entries()) {
        // skips actions that undo an earlier one of this list: the earlier one could not be kept, so there is nothing to undo
        if (/^(remove|revoke|unshelve|put back)/.test(name))
            continue;
        fill();
        const { answer, client } = await act(message, type, i + 1);
        client.close();
        if (isDone(answer))
            continue; // the disk still had room for this action, which was therefore kept as usual
        unkept.push(name);
        assert.match(whyNot(answer), FULL, `${name}: ${JSON.stringify(answer)}`);
        if (answer.unaudited)
            unaudited.push(name);
        if (type === 'alarmed')
            assert.deepEqual([answer.done, answer.not_kept], [0, 1], 'the action has taken effect, but is not kept');
    }
    const refused = await upload('full.obj', 'v 0 0 0\n'.repeat(100000));
    assert.equal(refused.status, 507, await refused.text());
    console.log(`# not kept, and said so: ${unkept.join(', ')}; also not in the trail: ${unaudited.join(', ')}`);
    assert.ok(unkept.length >= 7, unkept.join());
    const { bavail, bsize } = statfsSync(plant.folder);
    await until('that free space is measured', async () => Math.abs(
        Number(/^plantcast_history_free_bytes (\d+)$/m.exec(await (await ask('/metrics')).text())[1]) - bavail * bsize) < 1 << 18);
    free();
    await until('that the journal is written again',
        () => /writing the alarm journal works again(?![^]*the alarm journal cannot be written)/.test(plant.daemon.said));
    await killed();
    const { state } = await until('the alarm', () => alarm());
    assert.notEqual(state, 'unacknowledged', 'a change that could not be kept is kept once there is space');
});

test('an action answered as done survives a kill -9 at that moment, and is in the audit trail',
    { ...options, timeout: 300000 }, async (t) => {
    if (!mounted)
        return t.skip('this user may not mount a file system');
    await plant.tell('set TI-1 20');
    const client = await enter();
    for (const action of ['unshelve', 'in_service'])
        client.say({ ...onAlarm({ action }), seq: 1 });
    await until('no alarm', async () => ['returned', undefined].includes((await alarm())?.state));
    client.say({ ...onAlarm({ action: 'acknowledge' }), seq: 2 });
    await until('quiet', async () => !await alarm());
    client.close();
    await plant.tell('set TI-1 95.5');
    await until('the alarm', async () => (await alarm())?.state === 'unacknowledged');
    for (const [i, [name, message, type, event, there]] of ACTIONS.entries()) {
        const lines = trail().length, { answer } = await act(message, type, 100 + i);
        await killed();
        assert.ok(isDone(answer), `${name}: ${JSON.stringify(answer)}`);
        assert.equal(answer.unaudited, undefined, name);
        assert.ok(await there(answer), `${name} was answered ${JSON.stringify(answer)}, but its result is lost`);
        const line = trail().slice(lines).find((one) => one.event === event && one.result === 'done');
        assert.ok(line, `${name} is not in the audit trail`);
    }
    // kills the daemon right after the answer; the upload's line in the audit trail may come up to a second later and is not
    // checked
    const { status } = await upload('part.obj', 'v 0 0 0\n');
    await killed();
    assert.equal(status, 200);
    assert.deepEqual((await fetched('/api/v1/import')).files.map(({ name, bytes }) => [name, bytes]), [['part.obj', 8]]);
    console.log(`# ${ACTIONS.length + 1} kinds of action are there after a kill -9: ${
        ACTIONS.map(([name]) => name).join(', ')}, upload an export`);
});

test('creating a short link is recorded in the audit trail with the link\'s id; using the link is not', options, async () => {
    const begun = trail().length, share = { type: 'share_view', view: 'group=pressure' };
    for (const seq of [1, 2]) {
        const { answer, client } = await act(share, 'view_shared', seq);
        client.close();
        assert.equal(answer.kept, true, JSON.stringify(answer));
    }
    const { client } = await act({ type: 'note', text: 'recorded after them', asset: 'E-101' }, 'noted', 3);
    client.close();
    const { id } = JSON.parse(readFileSync(path('history/links.json'), 'utf8')).links.find(({ view }) => view === share.view);
    assert.deepEqual(trail().slice(begun).filter(({ event }) => event === 'view').map(({ result, what }) => [result, what]),
        [['done', `share ${id}`]]);
});

// A frozen file system accepts no writes and reports no errors, like a hanging disk or network share.
function freezable(folder) {
    const image = join(folder, 'image'), disk = join(folder, 'disk');
    const run = (...command) => spawnSync(command[0], command.slice(1)).status === 0;
    writeFileSync(image, '');
    truncateSync(image, 32 << 20);
    mkdirSync(disk);
    return run('mkfs.ext4', '-q', image) && run('mount', '-o', 'loop', image, disk)
        ? { disk, freeze: () => run('fsfreeze', '-f', disk), thaw: () => run('fsfreeze', '-u', disk),
            end: () => run('umount', '-l', disk) }
        : null;
}

// For each kind of action stored in a file: a message, and the type of its answer.
const inFiles = async (at) => [
    [{ type: 'note', text: 'leaks a little', asset: 'E-101' }, 'noted'],
    [{ type: 'save_view', id: 'pump', title: 'The pump', view: 'asset=P-101A' }, 'view_saved'],
    [{ type: 'share_view', view: 'asset=P-101A' }, 'view_shared'],
    [{ type: 'send_to_wall', wall: 'room', display: 1, area: 'main', view: 'group=pressure', title: 'Look here' }, 'sent_to_wall'],
    [{ type: 'prove', tag: 'TI-1', expected: 95.5, tolerance: 1, remark: 'by hand' }, 'proved'],
    [{ type: 'pair', digits: (await (await device(at)).json()).digits }, 'paired'],
];

test('while the disk hangs, each action is answered "not kept", and other clients are served meanwhile', options, async (t) => {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-frozen-')), small = freezable(folder);
    t.after(() => rmSync(folder, { recursive: true, force: true }));
    if (!small)
        return t.skip('this user may not mount an image of a disk');
    const own = await TinyPlant.create();
    try {
        own.addAlarms();
        own.giveDeviceTime();
        appendFileSync(own.file, WALL);
        assert.equal(own.prepare().code, 0);
        await own.startSim();
        await own.tell('set TI-1 95.5');
        writeFileSync(join(own.folder, 'tokens'), '', { mode: 0o600 });
        await own.startDaemon('--history', join(small.disk, 'history'), '--audit', join(small.disk, 'audit.log'), '--import',
            '--tokens', join(own.folder, 'tokens'), '--trust-local');
        const client = await PlainClient.open(own.port), at = `http://127.0.0.1:${own.port}/api/v1/alarms`;
        await client.hello();
        const leaver = await PlainClient.open(own.port);
        await leaver.hello();
        await until('the alarm', async () => (await (await fetch(at)).json()).alarms.some(({ tag }) => tag === 'TI-1'));
        const files = await inFiles(own.port);
        assert.ok(small.freeze());
        let answered = false, served = 0;
        const begun = performance.now(), longest = { ms: 0 };
        const answer = [0, 1, 2].reduce((before, seq) => before.then(async () => {
            client.say({ ...onAlarm({ action: 'acknowledge' }), seq: 10 + seq });
            return client.until('alarmed', ({ texts }) => texts.find((one) => one.type === 'alarmed' && one.seq === 10 + seq));
        }), Promise.resolve()).finally(() => { answered = true; });
        while (!answered) {
            const asked = performance.now();
            await (await fetch(at)).text();
            longest.ms = Math.max(longest.ms, performance.now() - asked);
            served++;
        }
        const last = await answer, ms = performance.now() - begun;
        console.log(`# three actions in ${ms.toFixed(0)} ms on a disk that hangs; ${served} requests were served meanwhile, the slowest in `
            + `${longest.ms.toFixed(0)} ms`);
        const first = client.texts.find(({ type, seq }) => type === 'alarmed' && seq === 10);
        assert.deepEqual([first.done, first.not_kept], [0, 1], JSON.stringify(first));
        assert.match(first.why, /the server’s disk does not answer/);
        assert.match(first.unaudited, /the server’s disk does not answer/);
        assert.equal(last.done, 0);
        // While the disk hangs, requests that store nothing must still be answered. If they waited for the disk, too, there
        // would be only one answer per action.
        assert.ok(served > 6, `${served} requests answered in ${ms} ms`);
        for (const [i, [message, type]] of files.entries()) {
            client.say({ ...message, seq: 40 + i });
            const said = await client.until(type, ({ texts }) => texts.find((one) => one.type === type && one.seq === 40 + i));
            assert.deepEqual([said.kept, said.passed ?? false], [false, false], JSON.stringify(said));
            assert.match(said.why, /the server’s disk does not answer/);
            assert.match(said.unaudited, /the server’s disk does not answer/);
        }
        assert.equal((await (await fetch(`http://127.0.0.1:${own.port}/api/v1/notes`)).json()).list.length, 0, 'the note is not on disk');
        const sent = await fetch(`http://127.0.0.1:${own.port}/api/v1/import/upload?name=part.obj`, { method: 'POST', body: 'v 0 0 0' });
        assert.deepEqual([sent.status, /does not answer/.test((await sent.json()).unaudited)], [200, true],
            'the upload is stored, but has no line in the trail');
        // A client sends an action and disconnects at once: the audit trail must still say later that the action was not kept.
        leaver.say({ ...onAlarm({ ...shelve, reason: 'leaves at once' }), seq: 1 });
        leaver.close();
        const answerTo = (seq) => client.until('alarmed', ({ texts }) => texts.find((one) => one.type === 'alarmed' && one.seq === seq));
        client.say({ ...onAlarm({ action: 'acknowledge' }), seq: 20 });
        await answerTo(20);
        // An action that waits for the disk during shutdown is answered before the connection closes.
        client.say({ ...onAlarm({ action: 'unshelve' }), seq: 30 });
        client.say({ type: 'ping', t: 30 });
        await client.until('pong', ({ texts }) => texts.find(({ type, t: of }) => type === 'pong' && of === 30));
        const ended = own.daemon.stop('SIGTERM');
        assert.deepEqual([(await answerTo(30)).done, (await answerTo(30)).not_kept], [0, 1]);
        small.thaw();
        await ended;
        const lines = readFileSync(join(small.disk, 'audit.log'), 'utf8').trim().split('\n').map((line) => JSON.parse(line));
        assert.deepEqual(lines.filter(({ what }) => /leaves at once/.test(what)).map(({ result }) => result), ['done', 'failed']);
        client.close();
    } finally {
        small.thaw();
        await own.destroy();
        small.end();
    }
});

test('the page says that an action was not saved because the disk is full', options, async (t) => {
    if (!mounted)
        return t.skip('this user may not mount a file system');
    const toasts = [
        ['de', /nach einem Neustart des Servers verloren \(nicht gespeichert: der Datenträger des Servers ist voll\)/],
        ['en', /Applied, but lost if the server restarts \(not saved: the server’s disk is full\)/],
        ['ko', /서버를 다시 시작하면 사라집니다 \(저장되지 않음: 서버 디스크가 가득 찼습니다\)/]];
    for (const [lang, words] of toasts.slice(0, sweep(3, 1))) {
        const browser = await openPage(`http://127.0.0.1:${port}/?lang=${lang}`, { viewport: { width: 1280, height: 800 } });
        const { page } = browser;
        try {
            await waitForPicture(page);
            fill();
            await page.evaluate((message) => globalThis.plantcast.session.post(message), { ...onAlarm(shelve), seq: 1 });
            await page.waitForFunction((text) => new RegExp(text).test(document.getElementById('toast').textContent), words.source);
            await shoot(page, `not-kept-${lang}`);
            assert.deepEqual(browser.errors, []);
        } finally {
            await browser.close();
            free();
        }
        const client = await enter();
        client.say({ ...onAlarm({ action: 'unshelve' }), seq: 2 });
        await client.text('alarmed');
        client.close();
    }
});
