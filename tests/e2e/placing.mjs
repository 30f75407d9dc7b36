// SPDX-License-Identifier: GPL-3.0-or-later
// Placing sensors and checking loops, using only the protocol: one engineer's trial is invisible to others, a saved list takes
// effect while the previous one is kept, and loop checks survive a restart of the daemon.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { appendFileSync, existsSync, readdirSync, readFileSync, renameSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { PlainClient } from './support/plain_client.mjs';
import { promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
const options = { skip, timeout: 240000 };
let plant, tagsFile, seq = 0;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    tagsFile = join(plant.folder, 'tags.csv');
    plant.keepFresh();
    // Gives the tag list what saving must keep or fill in: a tag without a position, an unknown column with a comment, and
    // numbers such as 0.500.
    const list = readFileSync(tagsFile, 'utf8').replace('Stale s\n', 'Stale s,Remark\n');
    writeFileSync(tagsFile, list.replace('0.5,0,0,600\n', '0.500,0.00,0,600,"# by Kim; ""new"""\n')
        + 'TI-9,400007,Float,°C,spare,temperature,,,,,600,\n');
    assert.equal(plant.prepare().code, 0);
    await plant.startSim();
    await plant.set({ 'TI-1': 80, 'TI-2': 20, 'TI-9': 50 });
    await plant.startDaemon();
    await until('readings', async () => (await readings()).every(({ quality }) => quality === 'good'));
});

const readings = async () => (await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/tags`)).json()).tags;

async function enter(more = {}) {
    const client = await PlainClient.open(plant.port);
    client.welcome = await client.hello({ params: { seq: 1, group: 'temperature' }, ...more });
    return client;
}

const place = (client, moves) => client.say({ type: 'place', seq: ++seq, moves });
const probe = (client) => {
    client.say({ type: 'pick', seq: ++seq, x: 160, y: 90, camera: { eye: [2, 0.1, 0.1], target: [0.5, 0.1, 0.1] } });
    return client.text('picked');
};

// Waits until the server has computed the distances along the surface for all sensors that this client has placed. Returns its
// answer.
async function placed(client) {
    for (;;) {
        const message = await client.text('placed');
        if (message.sensors.every(({ along }) => along !== 'waiting'))
            return message;
    }
}

test('an engineer sees the field of a trial position, and nobody else does', options, async () => {
    const engineer = await enter(), other = await enter();
    const before = await probe(other);
    place(engineer, [{ tag: 'TI-9', asset: 'E-101', position: [0.5, 0.05, 0.05] }]);
    const { sensors: [sensor] } = await placed(engineer);
    assert.equal(sensor.along, 'ready');
    assert.ok(sensor.distance_m < 1e-3 && sensor.distance_m < sensor.limit_m, JSON.stringify(sensor));
    const mine = await probe(engineer), theirs = await probe(other);
    assert.equal(mine.nearest[0].tag, 'TI-9');
    assert.ok(theirs.nearest.every(({ tag }) => tag !== 'TI-9'));
    assert.ok(Math.abs(theirs.value - before.value) < 1);
    assert.ok(Math.abs(mine.value - theirs.value) > 2, `the engineer picks ${mine.value}, the viewer ${theirs.value}`);

    place(engineer, []);
    assert.deepEqual((await placed(engineer)).sensors, []);
    assert.ok((await probe(engineer)).nearest.every(({ tag }) => tag !== 'TI-9'));
    engineer.close();
    other.close();
});

test('a follower of an engineer sees the plant without the trial', options, async () => {
    const engineer = await enter(), other = await enter();
    place(engineer, [{ tag: 'TI-9', asset: 'E-101', position: [0.5, 0, 0] }]);
    await placed(engineer);
    other.say({ type: 'follow', session: engineer.welcome.session });
    await other.text('following');
    assert.ok((await probe(other)).nearest.every(({ tag }) => tag !== 'TI-9'));
    engineer.close();
    other.close();
});

test('an impossible position is refused with the reason, and nothing moves', options, async () => {
    const engineer = await enter();
    const wrong = async (moves, pattern) => {
        place(engineer, moves);
        const { code, about, text } = await engineer.text('error');
        assert.deepEqual([code, about], ['bad_field', 'place']);
        assert.match(text, pattern);
    };
    await wrong([{ tag: 'XX', asset: 'E-101', position: [0, 0, 0] }], /no tag “XX”/);
    await wrong([{ tag: 'TI-1', asset: 'XX', position: [0, 0, 0] }], /no equipment “XX”/);
    await wrong([{ tag: 'TI-1', asset: 'E-101', position: [50, 0, 0] }], /TI-1: this location is too far from E-101/);
    await wrong([{ tag: 'TI-1', asset: 'E-101', position: [0, 0, 'a'] }], /position/);
    await wrong([1, 2].map((z) => ({ tag: 'TI-1', asset: 'E-101', position: [0, 0, z / 4] })), /TI-1 is moved twice/);
    engineer.say({ type: 'save_tags', seq: ++seq });
    assert.match((await engineer.text('error')).text, /no sensor has been moved/);
    place(engineer, [{ tag: 'TI-1', asset: 'E-101', position: [1, 0, 0] }]);
    const { sensors: [far] } = await placed(engineer);
    assert.ok(far.distance_m > far.limit_m, 'a position off the surface is reported, and permitted');
    engineer.close();
});

test('coverage gaps list areas far from every sensor, and areas without data', options, async () => {
    const engineer = await enter();
    engineer.say({ type: 'gaps', seq: ++seq, far_m: 0.5 });
    const before = await engineer.text('gaps');
    assert.equal(before.seq, seq);
    assert.deepEqual(before.assets.map(({ asset, sensors }) => [asset, sensors]), [['E-101', 2]]);
    assert.deepEqual(before.far, []);
    const [box] = before.assets;
    assert.ok(box.far_share > 0.2 && box.far_share <= 1 && box.lost_share === 0, JSON.stringify(box));
    assert.ok(Math.abs(box.next_m - 2) < 0.1, 'the distance is measured around the box\'s edge'); // path along the surface: 0.5 + 1 + 0.5 m
    assert.deepEqual(box.next.sort(), ['TI-1', 'TI-2']);

    place(engineer, [{ tag: 'TI-9', asset: 'E-101', position: [0, 0.8, 0] }]);
    await placed(engineer);
    engineer.say({ type: 'gaps', seq: ++seq, far_m: 0.5 });
    const after = await engineer.text('gaps');
    assert.equal(after.assets[0].sensors, 3);
    assert.ok(after.assets[0].far_share < box.far_share);
    assert.deepEqual(after.far.map(([tag, asset]) => [tag, asset]), [['TI-9', 'E-101']]);
    engineer.close();
});

test('saving a list first shows the difference; then the list is active for all, and the old one is kept', options, async () => {
    const engineer = await enter(), other = await enter(), old = readFileSync(tagsFile, 'utf8');
    place(engineer, [{ tag: 'TI-9', asset: 'E-101', position: [0, 0.5, 0.12345] },
        { tag: 'TI-2', asset: 'E-101', position: [-0.5, 0.25, 0] }]);
    await placed(engineer);
    engineer.say({ type: 'save_tags', seq: ++seq });
    const diff = await engineer.text('tags_diff');
    assert.equal(diff.conflict, false);
    assert.deepEqual(diff.lines, [
        [3, 'TI-2,400003,Float,°C,right,temperature,E-101,-0.5,0,0,600', 'TI-2,400003,Float,°C,right,temperature,E-101,-0.5,0.25,0,600'],
        [5, 'TI-9,400007,Float,°C,spare,temperature,,,,,600,', 'TI-9,400007,Float,°C,spare,temperature,E-101,0,0.5,0.123,600,'],
    ]);
    assert.equal(readFileSync(tagsFile, 'utf8'), old, 'nothing is written before it is confirmed');

    // must be refused: the hash of the confirmed change is not that of this change
    engineer.say({ type: 'save_tags', seq: ++seq, confirm: '0123456789abcdef' });
    await engineer.text('tags_diff');
    assert.equal(readFileSync(tagsFile, 'utf8'), old);

    // cork() makes both messages arrive together, so that the second is received while the first list is still being applied
    engineer.socket.cork();
    engineer.say({ type: 'save_tags', seq: ++seq, confirm: diff.hash });
    engineer.say({ type: 'save_tags', seq: ++seq, confirm: diff.hash });
    engineer.socket.uncork();
    const answers = [await engineer.text('tags_saved', 60000), await engineer.text('tags_saved', 60000)];
    const saved = answers.find((answer) => answer.saved), refused = answers.find((answer) => !answer.saved);
    assert.match(refused.errors.join(), /another list is being applied/);
    assert.equal(saved.kept, 'tags.csv.1', JSON.stringify(saved));
    assert.deepEqual(saved.changes.sort(), ['tag TI-2 changed: place', 'tag TI-9 changed: asset, place']);
    assert.equal(readFileSync(`${tagsFile}.1`, 'utf8'), old);
    assert.equal(readFileSync(tagsFile, 'utf8'), diff.lines.reduce((text, [, from, to]) => text.replace(from, to), old));

    for (const client of [engineer, other]) {
        const again = await client.text('welcome', 60000);
        assert.equal(again.plant.configuration, saved.configuration);
        assert.deepEqual(again.tags.find(({ name }) => name === 'TI-9').position.map((x) => Math.round(x * 1000)), [0, 500, 123]);
    }
    // picks repeatedly until the sensor is among the nearest: a sensor without a reading does not count, and the first reading
    // of TI-9 takes a poll
    let nearest = [];
    while (nearest.length === 0) {
        other.say({ type: 'pick', seq: ++seq, x: 160, y: 90, camera: { eye: [0.1, 4, 0.15], target: [0, 0, 0.1] } });
        ({ nearest } = await other.text('picked'));
    }
    assert.equal(nearest[0].tag, 'TI-9');
    engineer.close();
    other.close();
});

test('a list that somebody else changed meanwhile is not overwritten: the other changes are shown', options, async () => {
    const engineer = await enter(), good = readFileSync(tagsFile, 'utf8');
    place(engineer, [{ tag: 'TI-1', asset: 'E-101', position: [0.5, 0.25, 0] }]);
    await placed(engineer);
    engineer.say({ type: 'save_tags', seq: ++seq });
    const { hash } = await engineer.text('tags_diff');
    appendFileSync(tagsFile, 'TI-10,400009,Float,°C,theirs,temperature,,,,,1,\n');
    const theirs = readFileSync(tagsFile, 'utf8');
    engineer.say({ type: 'save_tags', seq: ++seq, confirm: hash });
    const { conflict, lines } = await engineer.text('tags_diff');
    assert.equal(conflict, true);
    assert.deepEqual(lines, [[6, null, 'TI-10,400009,Float,°C,theirs,temperature,,,,,1,']]);
    assert.equal(readFileSync(tagsFile, 'utf8'), theirs);
    writeFileSync(tagsFile, good);
    engineer.close();
});

// If the tag list is a symlink, saving replaces the file to which it points and keeps earlier versions next to that file:
// restoring must look for them there.
test('restoring accepts the version name that saving reported, also when the tag list is a symlink', options, async () => {
    const engineer = await enter(), now = readFileSync(tagsFile, 'utf8'), real = join(plant.folder, 'lists-v1.csv');
    const before = now.replace('TI-9', 'TI-8');
    renameSync(tagsFile, real);
    symlinkSync('lists-v1.csv', tagsFile);
    writeFileSync(`${real}.1`, before);
    engineer.say({ type: 'restore_tags', seq: ++seq, kept: 'lists-v1.csv.1' });
    const { lines, conflict } = await engineer.text('tags_diff');
    assert.equal(conflict, false);
    assert.equal(lines.length, 1, JSON.stringify(lines));
    assert.match(lines[0][2], /^TI-8,/);
    rmSync(`${real}.1`);
    rmSync(tagsFile);
    renameSync(real, tagsFile);
    engineer.close();
});

test('a list that cannot be prepared is rolled back', options, async () => {
    const engineer = await enter(), good = readFileSync(tagsFile, 'utf8'), model = join(plant.folder, 'box.gltf');
    const box = readFileSync(model), files = readdirSync(plant.folder).sort();
    place(engineer, [{ tag: 'TI-1', asset: 'E-101', position: [0.5, 0.25, 0] }]);
    await placed(engineer);
    engineer.say({ type: 'save_tags', seq: ++seq });
    const { hash } = await engineer.text('tags_diff');
    writeFileSync(model, 'not a model');
    engineer.say({ type: 'save_tags', seq: ++seq, confirm: hash });
    const answer = await engineer.text('tags_saved', 60000);
    writeFileSync(model, box);
    assert.equal(answer.saved, false);
    assert.match(answer.errors.join(), /plantcast-prep/);
    assert.equal(readFileSync(tagsFile, 'utf8'), good);
    assert.deepEqual(readdirSync(plant.folder).sort(), files);
    assert.equal((await probe(engineer)).nearest[0].tag, 'TI-1', 'the trial continues');
    engineer.close();
});

test('while another program is at work in the plant\'s folder, a list is not saved, and frames continue', options, async (t) => {
    const engineer = await enter(), good = readFileSync(tagsFile, 'utf8'), files = readdirSync(plant.folder).sort();
    place(engineer, [{ tag: 'TI-9', asset: 'E-101', position: [0, 0.5, 0.25] }]);
    await placed(engineer);
    engineer.say({ type: 'save_tags', seq: ++seq });
    const { hash } = await engineer.text('tags_diff');
    let held;
    const hold = () => {
        held = spawn('flock', [plant.folder, 'sh', '-c', 'echo held; read line'], { stdio: ['pipe', 'pipe', 'ignore'] });
        return once(held.stdout, 'data');
    };
    t.after(() => held.stdin.end());
    await hold();
    engineer.say({ type: 'save_tags', seq: ++seq, confirm: hash });
    const began = performance.now();
    await probe(engineer);
    promise(t, 'until the loop, which does not wait, answers', performance.now() - began, 2000);
    const refused = await engineer.text('tags_saved', 60000);
    assert.equal(refused.saved, false);
    assert.match(refused.errors.join(), new RegExp('^the plant\'s folder .* cannot be locked: (flock|sh) \\(process \\d+\\) is using ' +
        'the plant\'s folder; try again'));
    assert.equal(readFileSync(tagsFile, 'utf8'), good);
    assert.deepEqual(readdirSync(plant.folder).sort(), files);
    // While another program holds the folder's lock for a short time, saving waits and then succeeds. On a busy machine the
    // program may hold it longer than saving waits, so this tries again.
    await until('a list that is saved', async () => {
        engineer.say({ type: 'save_tags', seq: ++seq, confirm: hash });
        await new Promise((done) => setTimeout(done, 300));
        held.stdin.end();
        const { saved } = await engineer.text('tags_saved', 60000);
        if (!saved)
            await hold();
        return saved;
    });
    engineer.close();
});

test('a save that is refused does not answer a reload that waits behind the save', options, async (t) => {
    const engineer = await enter();
    place(engineer, [{ tag: 'TI-9', asset: 'E-101', position: [0, 0.5, 0.3] }]);
    await placed(engineer);
    engineer.say({ type: 'save_tags', seq: ++seq });
    const { hash } = await engineer.text('tags_diff');
    let held;
    t.after(() => held?.stdin.end());
    // On a busy machine, this test may release the folder's lock later than the reload waits for it, so this tries again.
    await until('a reload that is done', async () => {
        held = spawn('flock', [plant.folder, 'sh', '-c', 'echo held; read line'], { stdio: ['pipe', 'pipe', 'ignore'] });
        await once(held.stdout, 'data');
        engineer.say({ type: 'save_tags', seq: ++seq, confirm: hash });
        await probe(engineer);
        const reload = fetch(`http://127.0.0.1:${plant.port}/api/v1/reload`, { method: 'POST' });
        assert.equal((await engineer.text('tags_saved', 60000)).saved, false);
        held.stdin.end();
        const answer = await reload, { reloaded } = await answer.json();
        assert.equal(reloaded, answer.status === 200);
        return reloaded;
    });
    engineer.close();
});

const prove = (client, tag, expected, more = {}) => {
    client.say({ type: 'prove', seq: ++seq, tag, expected, tolerance: 0.5, ...more });
    return client.text('proved');
};

async function forced(tag, value) {
    await plant.tell(`set ${tag} ${value}`);
    await until(`${tag} ${value}`, async () => Math.abs((await readings()).find(({ name }) => name === tag).value - value) < 0.01);
}

test('a forced value passes a tag\'s loop check for all to see; a value beyond the tolerance does not', options, async () => {
    const engineer = await enter(), other = await enter();
    const { all, begun, tags } = await other.text('proofs');
    assert.deepEqual([all, begun, tags], [true, false, []]);
    await forced('TI-1', 42);
    const passed = await prove(engineer, 'TI-1', 42.3, { remark: 'calibrator 7' });
    assert.deepEqual([passed.kept, passed.passed, passed.value], [true, true, 42]);
    const { all: again, begun: now, tags: [[index, result, time, value, expected, tolerance, who, remark]] } = await other.text('proofs');
    assert.deepEqual([again, now, index, result, value, expected, tolerance, who, remark],
        [false, true, 0, 'pass', 42, 42.3, 0.5, 'local', 'calibrator 7']);
    assert.ok(Math.abs(time / 1000 - Date.now()) < 60000);
    const failed = await prove(engineer, 'TI-2', 90);
    assert.deepEqual([failed.passed, failed.why], [false, 'the value is beyond the tolerance']);
    assert.equal((await prove(engineer, 'TI-9', 50, { fail: true })).passed, false);
    await plant.tell('fail PI-1');
    await until('a failure', async () => (await readings()).find(({ name }) => name === 'PI-1').quality !== 'good');
    assert.equal((await prove(engineer, 'PI-1', 5)).why, 'the reading is not good');
    engineer.say({ type: 'prove', seq: ++seq, tag: 'TI-1', expected: 1 });
    assert.match((await engineer.text('error')).text, /tolerance/);
    engineer.close();
    other.close();
});

test('loop checks are exported, survive a restart of the daemon, and end when the tag is another', options, async () => {
    const csv = await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/proofs`)).text();
    const [head, first] = csv.split('\n');
    assert.equal(head, 'Time,Tag Name,Result,Value,Unit,Expected,Tolerance,By,Remark,Fingerprint');
    assert.match(first, /^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ,"TI-1",pass,42,"°C",42\.3,0\.5,"local","calibrator 7",[0-9a-f]{16}$/);
    assert.ok(existsSync(join(plant.folder, 'plant.history', 'proofs.csv')));
    await plant.daemon.stop();
    // the last line is incomplete, as after a power failure
    appendFileSync(join(plant.folder, 'plant.history', 'proofs.csv'), '2026-01-01T00:00:00Z,"TI-1",fa');
    writeFileSync(tagsFile, readFileSync(tagsFile, 'utf8').replace('TI-2,400003', 'TI-2,400011'));
    await plant.startDaemon();
    const engineer = await enter(), { begun, tags } = await engineer.text('proofs');
    assert.equal(begun, true);
    assert.deepEqual(tags.map(([index, result]) => [index, result]), [[0, 'pass'], [1, 'changed'], [2, 'fail'], [3, 'fail']]);
    await forced('TI-9', 51);
    assert.equal((await prove(engineer, 'TI-9', 51)).passed, true, 'the file continues after the truncated line');
    assert.match(readFileSync(join(plant.folder, 'plant.history', 'proofs.csv'), 'utf8'), /,fa\n|"TI-1",fa\n[^\n]*"TI-9",pass/);
    engineer.close();
});

test('a loop check is kept that the daemon answers while a reload starts the changed plant', options, async () => {
    const engineer = await enter(), post = () => fetch(`http://127.0.0.1:${plant.port}/api/v1/reload`, { method: 'POST' });
    engineer.texts.length = 0;
    appendFileSync(plant.file, '# changed\n');
    const reload = post().then((answer) => answer.json());
    let last;
    // checks the loop again and again until the session is switched to the changed plant, which sends a new `welcome`
    while (!engineer.texts.some(({ type }) => type === 'welcome')) {
        const remark = `check ${seq}`, { kept } = await prove(engineer, 'TI-1', 42, { remark });
        last = kept && !engineer.texts.some(({ type }) => type === 'welcome') ? remark : last;
    }
    assert.equal((await reload).reloaded, true);
    const csv = await (await fetch(`http://127.0.0.1:${plant.port}/api/v1/proofs`)).text();
    const found = Number(/"TI-1",.*"check (\d+)"/.exec(csv)?.[1]);
    assert.ok(found >= Number(last.split(' ')[1]), `${found} < ${last}`);
    engineer.close();
});
