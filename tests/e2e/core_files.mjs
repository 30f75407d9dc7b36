// SPDX-License-Identifier: GPL-3.0-or-later
// A tag list that an engineer saves on the leading core reaches the standby and the renderers, each of which has its own plant
// folder. Where it cannot, both logs, the metrics and the engineer's page say why, and nothing is half-written.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { appendFileSync, copyFileSync, cpSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { Nodes } from './support/nodes.mjs';
import { notBuilt, runProgram } from './support/tiny_plant.mjs';
import { kill, missingTwoCores, TwoCores, until } from './support/two_cores.mjs';

const skip = missingTwoCores(), options = { skip, timeout: 240000 };
const TAKEN = /tag list \S+ was saved by the core; the previous list is kept as/, PADDING = `${' '.repeat(99)}\n`.repeat(20000);
let two, seq = 0;

// Copies a plant into a folder of its own, as on a machine of its own. Returns the path of the copy's plant file.
function copyPlant(file, folder) {
    mkdirSync(folder, { recursive: true });
    copyFileSync(file, join(folder, 'plant.yaml'));
    cpSync(file.replace('.yaml', '.prepared'), join(folder, 'plant.prepared'), { recursive: true });
    for (const name of readdirSync(dirname(file)).filter((name) => ['tags.csv', 'box.gltf', 'login'].includes(name)))
        copyFileSync(join(dirname(file), name), join(folder, name));
    return join(folder, 'plant.yaml');
}

const tagsOf = (core) => join(dirname(core.file), 'tags.csv');
const list = (core) => readFileSync(tagsOf(core), 'utf8');
// Returns the results of the attempts to get the leader's files that are in this core's audit trail.
const attempts = (core) => readFileSync(core.trail, 'utf8').split('\n').slice(0, -1).map((line) => JSON.parse(line))
    .filter(({ event, who }) => event === 'reload' && who === 'the core').map(({ result, what, why }) => ({ result, what, why }));
const files = (core) => readdirSync(dirname(core.file)).sort();
// Loads the core's files, prepared again, as an administrator would after copying them.
function reload(core) {
    assert.equal(runProgram('plantcast-prep', [core.file]).code, 0);
    core.program.child.kill('SIGHUP');
}

before(async () => {
    two = skip ? null : await TwoCores.running((made) => {
        for (const core of Object.values(made.cores)) {
            core.file = copyPlant(made.file, join(made.plant.folder, core.name, 'plant'));
            const folder = dirname(core.file);
            core.trail = join(made.plant.folder, core.name, 'audit.log');
            core.args = ['--audit', core.trail, '--log-level', 'debug']; // repeated refusals are logged at this level
            core.before = ['sh', '-c', `mount --bind ${folder} ${folder} && exec "$@"`, 'sh']; // so that a test can make it read-only
        }
    });
});
after(() => two?.destroy());

// Places TI-1 as an engineer of this node and applies the new tag list.
async function save(node, z) {
    const engineer = await node.client();
    engineer.say({ type: 'place', seq: ++seq, moves: [{ tag: 'TI-1', asset: 'E-101', position: [0.5, 0, z] }] });
    await engineer.text('placed');
    engineer.say({ type: 'save_tags', seq: ++seq });
    const { hash } = await engineer.text('tags_diff');
    engineer.say({ type: 'save_tags', seq: ++seq, confirm: hash });
    const saved = await engineer.text('tags_saved', 60000);
    assert.equal(saved.saved, true, JSON.stringify(saved));
    engineer.close();
}

// Waits until an engineer's page learns about the standby what `good` accepts.
async function learns(core, good) {
    const engineer = await core.node.client();
    for (let standby = null; ;) {
        if (standby && good(standby))
            return engineer.close() ?? standby;
        ({ standby } = await engineer.text('status', 200000));
    }
}
const isSame = ({ connected, files: differing, why }) => connected && differing.length === 0 && !why;
const positionOf = async (node) => {
    const client = await node.client(), { position } = client.welcome.tags.find(({ name }) => name === 'TI-1');
    client.close();
    return position;
};

test('a saved tag list reaches the standby, which takes over with it', options, async (t) => {
    const core = await two.leader(), other = two.other(core);
    await learns(core, isSame);
    await save(core.node, 0.25);
    await other.program.line(TAKEN);
    await two.followed(core);
    await learns(core, isSame);
    assert.equal(list(other), list(core));
    assert.match(list(other), /^TI-1,.*,0\.5,0,0\.25,/m);
    assert.equal(await core.node.metric('plantcast_core_standby_differing_files'), 0);
    await two.takeOver(t, core, kill(core, 'SIGKILL'));
    assert.deepEqual(await positionOf(other.node), [0.5, 0, 0.25]);
    // a standby waits 3 s after it last heard from a killed leader (LEASE_NS), so no shorter time can be stated
    const [, took_s] = await other.program.line(/took over the lead ([\d.]+) s after the previous leader's last sign of life/);
    assert.ok(Number(took_s) >= 3, took_s);
    await two.restart(core);
    await two.followed(other);
});

test('lists saved in quick succession reach the standby, also one equal to an earlier list', options, async () => {
    const core = await two.leader(), other = two.other(core);
    await learns(core, isSame);
    for (const z of [0.35, 0.4, 0.35, 0.25])
        await save(core.node, z);
    await until('the last list at the standby', () => list(other) === list(core));
    await two.followed(core);
    await learns(core, isSame);
});

test('a list saved while the standby is disconnected reaches it later, also after a cut in the middle of the transfer', options,
    async () => {
    const core = await two.leader(), other = two.other(core);
    appendFileSync(tagsOf(core), PADDING); // makes the transfer long enough to be cut
    reload(core);
    await until('the long list at the standby', () => list(other) === list(core));
    await two.followed(core);
    await other.toOther.cut();
    await learns(core, ({ connected }) => !connected);
    const before_ = list(other), names = files(other);
    await save(core.node, 0.3);
    await other.toOther.cutAnswers();
    await other.toOther.mend();
    await other.program.line(/core: this node has not got its core's files: the transfer from the leading core failed: /);
    assert.equal(list(other), before_);
    assert.deepEqual(files(other), names);
    await learns(core, ({ why }) => /the transfer from the leading core failed/.test(why));
    await other.toOther.passAnswers();
    await until('the list at the standby', () => list(other) === list(core));
    await two.followed(core);
    await learns(core, isSame);
});

test('a standby that cannot write says so, and gets the list once it can', options, async () => {
    const core = await two.leader(), other = two.other(core), folder = dirname(other.file), before_ = list(other), names = files(other);
    const remount = (how) => execFileSync('nsenter', ['-t', String(other.program.child.pid), '-m', 'mount', '-o', `remount,bind,${how}`,
        folder]);
    await until('a moment at which no program writes to the folder', () => {
        try {
            return !remount('ro').length;
        } catch (error) {
            assert.match(String(error.stderr), /busy/);
            return false;
        }
    });
    const recorded = attempts(other).length;
    other.program.said = '';
    await save(core.node, 0.35);
    await core.program.line(/standby \w+: has not got this core's tag list: \S+tags\.csv: .*Read-only file system/);
    const { files: differing, why } = await learns(core, (standby) => standby.why);
    assert.deepEqual(differing, ['tags']);
    assert.match(why, /Read-only file system/);
    assert.equal(await (await core.node.fetch('/readyz')).text(),
        'ok; the standby has another plant file or tag list and cannot take over: the log says why\n');
    assert.equal(await core.node.metric('plantcast_core_standby_differing_files'), 1);
    assert.equal(list(other), before_);
    assert.deepEqual(files(other), names);
    const said = () => other.program.said, refusals = () => said().match(/^.*reload: refused.*$/gm) ?? [];
    await until('a second attempt', () => refusals().some((line) => line.includes('debug')));
    assert.deepEqual(refusals().map((line) => line.match(/ (error|debug) /)?.[1]).slice(0, 2), ['error', 'debug'], said());
    remount('rw');
    await learns(core, isSame);
    assert.equal(list(other), list(core));
    await until('the record of the success', () => attempts(other).length >= recorded + 2);
    const [failed, done, ...more] = attempts(other).slice(recorded);
    assert.equal(failed.result, 'failed');
    assert.match(failed.why, /Read-only file system/);
    assert.equal(done.result, 'done');
    assert.match(done.what, /configuration \w{16} is active, after ([2-9]|\d\d) failed attempts$/);
    assert.deepEqual(more, []);
    assert.equal(refusals().filter((line) => line.includes(' error ')).length, 1, said());
    await other.program.line(/core: this node has got its core's files, after ([2-9]|\d\d) failed attempts/);
});

test('a list that was edited on the standby is not overwritten', options, async () => {
    const core = await two.leader(), other = two.other(core);
    await two.followed(core);
    appendFileSync(tagsOf(other), '\n');
    const edited = list(other);
    await save(core.node, 0.4);
    await other.program.line(/this node has not got its core's files: \S+tags\.csv on node \w+ was edited there, .* so it is not replaced/);
    await learns(core, ({ why }) => /tags\.csv on node \w+ was edited there/.test(why));
    assert.equal(list(other), edited);
    await until('the metric', async () => await core.node.metric('plantcast_core_standby_differs') === 1);
    writeFileSync(tagsOf(other), list(core));
    reload(other);
    await learns(core, isSame);
    await two.followed(core);
});

test('a standby with another plant file or other models says so, and replaces neither', options, async () => {
    const core = await two.leader(), other = two.other(core), before_ = readFileSync(other.file, 'utf8');
    writeFileSync(core.file, readFileSync(core.file, 'utf8').replace('max: 100 }', 'max: 101 }'));
    core.program.child.kill('SIGHUP');
    await other.program.line(/not got its core's files: the core has another plant file than \S+plant\.yaml on node \w+: copy/);
    await core.program.line(/standby \w+: refused: configuration: .*\(different: plant file\)/);
    await learns(core, ({ files: differing, why }) => differing.join() === 'plant' && /copy the core's plant file/.test(why));
    assert.equal(readFileSync(other.file, 'utf8'), before_);
    copyFileSync(core.file, other.file);
    reload(other);
    await learns(core, isSame);
    await two.followed(core);

    appendFileSync(join(dirname(other.file), 'box.gltf'), '\n');
    reload(other);
    await core.program.line(/standby \w+: its models differ from this core's/);
    await learns(core, ({ files: differing, why }) => differing.join() === 'models' && /copy the models/.test(why));
    assert.equal(await (await core.node.fetch('/readyz')).text(), 'ok; a standby follows, but its models differ: the log says why\n');
    copyFileSync(join(dirname(core.file), 'box.gltf'), join(dirname(other.file), 'box.gltf'));
    reload(other);
    await learns(core, isSame);
});

test('a standby with another buffer beside its model says so', options, async () => {
    const core = await two.leader(), other = two.other(core), bin = (one) => join(dirname(one.file), 'box.bin');
    const model = JSON.parse(readFileSync(join(dirname(core.file), 'box.gltf'))), [buffer] = model.buffers;
    const bytes = Buffer.from(buffer.uri.replace(/^.*,/, ''), 'base64');
    buffer.uri = 'box.bin';
    for (const one of [other, core]) {
        writeFileSync(bin(one), bytes);
        writeFileSync(join(dirname(one.file), 'box.gltf'), JSON.stringify(model));
        one.program.said = '';
        reload(one);
        await one.program.line(/reload: configuration/);
    }
    await learns(core, isSame);
    core.program.said = '';
    writeFileSync(bin(other), Buffer.concat([bytes, Buffer.alloc(4)])); // a model may leave bytes of its buffer unused
    reload(other);
    await core.program.line(/standby \w+: its models differ from this core's/);
    await learns(core, ({ files: differing }) => differing.join() === 'models');
    writeFileSync(bin(other), bytes);
    reload(other);
    await learns(core, isSame);
});

test('a standby that is refused for its token is named, with the reason', options, async (t) => {
    const core = await two.leader(), other = two.other(core), good = two.nodes.standbyFile;
    t.after(() => { other.standbyFile = good; });
    const ready = async () =>
        await (await core.node.fetch('/readyz')).text();
    await two.followed(core);
    const unknown = join(two.plant.folder, 'unknown.token');
    writeFileSync(unknown, `${'x'.repeat(43)}\n`);
    for (const [file, says] of [[two.nodes.rendererFile, /the token r has the role renderer, but a standby needs/], [unknown, /token/]]) {
        await other.program.stop();
        core.program.said = '';
        await until('none', async () => await ready() === 'ok; no standby is connected\n');
        other.standbyFile = file;
        await two.start(other.name);
        const { connected, why } = await learns(core, ({ why: reason }) => reason);
        assert.equal(connected, false);
        assert.match(why, says);
        assert.equal(await ready(), 'ok; no standby is connected; this core refuses a node: the log says why\n');
        await core.program.line(file === unknown ? /core: the connection of \S+ to this core is refused: .*token/
            : /standby \w+: refused: the token r has the role renderer/);
        if (file === unknown) { // the throttle, which then checks no further token of this address, does not replace the reason
            for (let i = 0; i < 10; i++)
                await core.node.fetch('/metrics', 'y'.repeat(43));
            const held = () => core.node.metric('plantcast_logins_held_total'), sent = await held();
            await until('an attempt of the standby whose token is not checked', async () => await held() > sent);
            assert.equal((await learns(core, ({ why: reason }) => reason)).why, why);
        }
    }
    await other.program.line(/this node's token has the role standby/);
    await other.program.stop();
    other.standbyFile = good;
    await two.start(other.name);
    await two.followed(core);
    await learns(core, isSame);
});

test('a saved tag list reaches a renderer', { skip: notBuilt(), timeout: 240000 }, async (t) => {
    const nodes = await Nodes.create({ slowDevice: true });
    t.after(() => nodes.destroy());
    const core = await nodes.core();
    const file = copyPlant(nodes.plant.file, join(nodes.plant.folder, 'r'));
    const renderer = await nodes.start(['--role', 'render', '--core', core.url, '--core-token-file', nodes.rendererFile, '--node', 'r',
        '--port', '0'], file);
    const isThere = async () => await renderer.metric(`plantcast_core_up{core="${core.url}"}`) === 1;
    await until('readings', isThere);
    await save(core, 0.25);
    await renderer.program.line(TAKEN);
    await until('readings again', isThere);
    await renderer.program.line(/reload: configuration \S+ replaced/);
    assert.equal(renderer.program.said.match(/reload: configuration \S+ replaced/g).length, 1, 'the renderer loads once');
    assert.equal(list({ file }), list(nodes.plant));
    assert.deepEqual(await positionOf(renderer), [0.5, 0, 0.25]);
    appendFileSync(tagsOf({ file }), PADDING);
    const edited = list({ file });
    await save(core, 0.3);
    await renderer.program.line(/tags\.csv on node r was edited there, or never was equal to the core's list/);
    assert.equal(list({ file }), edited);
});
