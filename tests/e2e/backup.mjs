// SPDX-License-Identifier: GPL-3.0-or-later
// Backup while a daemon records, restore to another folder, and comparison of the two; damaged or conflicting files are refused
// by name.
import assert from 'node:assert/strict';
import { appendFileSync, existsSync, mkdirSync, readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { PlainClient } from './support/plain_client.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
// the recorded series begins 40 days ago, so that it spans at least two calendar months, each with its own history file
const BEGIN_S = Math.floor(Date.now() / 1000) - 40 * 86400;
let plant;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    const row = (_, i) => `TI-1,${BEGIN_S + i * 860},${(50 + 40 * Math.sin(i / 9)).toFixed(3)}`;
    const lines = ['Tag,Time,Value', ...Array.from({ length: 4000 }, row)];
    writeFileSync(join(plant.folder, 'series.csv'), `${lines.join('\n')}\n`);
    assert.equal(plant.prepare().code, 0);
    const imported = runProgram('plantcast', ['history', 'import', plant.file, join(plant.folder, 'series.csv')]);
    assert.equal(imported.code, 0, imported.err);
    await plant.startSim();
    await plant.startDaemon();
});

const folder = (name) => join(plant.folder, name);
const exported = (file, tag) => {
    const args = ['history', 'export', file, '--tags', tag, '--from', String(BEGIN_S - 10)];
    const result = runProgram('plantcast', args);
    assert.equal(result.code, 0, result.err);
    return result.out.trim().split('\n');
};

test('a restore into another folder returns the recorded history, point by point', { skip }, async () => {
    const imported = exported(plant.file, 'TI-1').length;
    await until('present values in the history', () => exported(plant.file, 'TI-1').length > imported + 1, 60);
    const engineer = await PlainClient.open(plant.port);
    await engineer.hello();
    engineer.say({ type: 'prove', seq: 1, tag: 'TI-1', expected: 1, tolerance: 0.5, fail: true });
    assert.equal((await engineer.text('proved')).kept, true);
    engineer.say({ type: 'note', seq: 2, tag: 'TI-1', text: 'permit 4711' });
    assert.equal((await engineer.text('noted')).kept, true);
    engineer.say({ type: 'share_view', seq: 3, view: 'asset=shared' });
    assert.equal((await engineer.text('view_shared')).kept, true);
    engineer.close();
    const began = Date.now();
    for (const name of ['one', 'two', 'three']) {
        const made = runProgram('plantcast', ['backup', plant.file, '-o', folder(name)]);
        assert.equal(made.code, 0, made.err);
        assert.ok(!existsSync(folder(`${name}.part`)));
    }
    const names = readdirSync(folder('one'));
    assert.ok(names.filter((name) => /^history-\d{4}-\d\d\.sqlite$/.test(name)).length >= 2, names.join(' '));
    assert.ok(names.includes('backup.json') && names.includes('plant.yaml') && names.includes('tags.csv'));
    assert.ok(!names.some((name) => /-wal|-shm|part/.test(name)), names.join(' '));
    // The backup stamps the file `last-backup`; the daemon's metrics report that file's time as the last backup.
    const stamp = statSync(join(plant.file.replace(/yaml$/, 'history'), 'last-backup')).mtimeMs;
    assert.ok(stamp > began - 1000 && stamp < Date.now() + 1000,
        `time of the backup ${stamp}, not ${began} or later`); // files have a coarser clock
    const drill = runProgram('plantcast', ['backup', '--verify', folder('one')]);
    assert.equal(drill.code, 0, drill.err);
    assert.match(drill.out, /one: readings from \S+Z to \S+Z\n.*one: verified: a trial restore of all \d+ files succeeded \(backup of /);
    assert.deepEqual(readdirSync(join(folder('one'), '..')).filter((name) => name.includes('verify')), [],
        'verify leaves no folder behind');
    mkdirSync(folder('elsewhere'));
    const other = join(folder('elsewhere'), 'other.yaml');
    const restored = runProgram('plantcast', ['restore', folder('three'), other]);
    assert.equal(restored.code, 0, restored.err);
    assert.equal(readFileSync(other, 'utf8'), readFileSync(plant.file, 'utf8'));
    const proofs = join(restored.out.trim().replace(/^.* the history is in /, ''), 'proofs.csv');
    assert.equal(readFileSync(proofs, 'utf8'), readFileSync(join(folder('three'), 'proofs.csv'), 'utf8'));
    assert.match(readFileSync(proofs, 'utf8'), /TI-1/);
    assert.match(readFileSync(proofs.replace('proofs.csv', 'notes.json'), 'utf8'), /permit 4711/);
    assert.match(readFileSync(proofs.replace('proofs.csv', 'links.json'), 'utf8'), /asset=shared/);
    // Compares exports of the restored history and of the daemon's. The last line is left out: the daemon records on after the
    // backup and may replace each tag's newest point.
    for (const tag of ['TI-1', 'TI-2', 'PI-1']) {
        const is = exported(other, tag).slice(0, -1), was = exported(plant.file, tag);
        assert.ok(is.length > (tag === 'TI-1' ? imported : 0), `${tag}: ${is.length} of ${was.length} lines`);
        assert.deepEqual(is, was.slice(0, is.length));
    }
    const again = runProgram('plantcast', ['restore', folder('three'), other]);
    assert.deepEqual([again.code, /exists already, so nothing was restored/.test(again.err)], [1, true], again.err);
});

test('a backup does not disturb the running daemon', { skip }, async () => {
    const text = await (await fetch(`http://127.0.0.1:${plant.port}/metrics`)).text();
    assert.match(text, /^plantcast_history_good 1$/m);
    assert.match(text, /^plantcast_history_lost_total 0$/m);
});

test('damaged, missing and conflicting backup files are refused by name', { skip }, () => {
    const damaged = readdirSync(folder('one')).find((name) => name.startsWith('history-'));
    appendFileSync(join(folder('one'), damaged), 'x');
    const target = join(folder('elsewhere'), 'third.yaml');
    const refused = runProgram('plantcast', ['restore', folder('one'), target]);
    const named = refused.err.includes(`${damaged}: this file was changed or damaged`);
    assert.deepEqual([refused.code, named, existsSync(target)], [1, true, false], refused.err);
    const drill = runProgram('plantcast', ['backup', '--verify', folder('one')]);
    assert.deepEqual([drill.code, drill.err.includes(`${damaged}: this file was changed or damaged`)], [1, true], drill.err);
    const none = runProgram('plantcast', ['restore', folder('nothing'), target]);
    assert.deepEqual([none.code, /backup\.json/.test(none.err)], [1, true]);
    const list = join(folder('two'), 'backup.json');
    writeFileSync(list, readFileSync(list, 'utf8').replace('tags.csv', '../tags.csv'));
    assert.equal(runProgram('plantcast', ['restore', folder('two'), target]).code, 1);
    const there = runProgram('plantcast', ['backup', plant.file, '-o', folder('three')]);
    assert.deepEqual([there.code, /exists already: choose another folder/.test(there.err)], [1, true]);
    for (const args of [['backup', plant.file], ['backup'], ['backup', '--verify', 'a', '-o', 'b'], ['restore', '--verify', 'a', 'b'],
        ['restore'], ['restore', 'a', 'b', 'c']])
        assert.equal(runProgram('plantcast', args).code, 2, args.join(' '));
    assert.match(runProgram('plantcast', ['restore', folder('three')]).err,
        /has only the plant and its history, not the files of a service: .*three PLANT\.yaml/);
});
