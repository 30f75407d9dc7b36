// SPDX-License-Identifier: GPL-3.0-or-later
// Root runs `plantcast backup`, `restore` and `token` in a folder in which the daemon's user may write, with owners as in
// deploy/pages/SERVICE.md. Symlinks and files of that user must not make root write elsewhere, and other users must not be able
// to read the results.
import assert from 'node:assert/strict';
import {
    chmodSync, chownSync, existsSync, linkSync, lstatSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, renameSync, rmSync,
    symlinkSync, unlinkSync, writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { setUp } from './support/set_up.mjs';
import { missing, runProgram, TinyPlant } from './support/tiny_plant.mjs';

const NOBODY = 65534, absent = missing();
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : process.getuid() !== 0 ? 'only root can be led astray' : false;
let plant, root, state, history, secret;

// The plant file is in a folder owned by root; tag list and history are in one owned by the daemon's user.
setUp(skip, async () => {
    plant = await TinyPlant.create();
    root = mkdtempSync(join(tmpdir(), 'plantcast-root-'));
    state = join(root, 'state');
    history = join(state, 'history');
    mkdirSync(state);
    renameSync(join(plant.folder, 'tags.csv'), join(state, 'tags.csv'));
    writeFileSync(plant.file, `${readFileSync(plant.file, 'utf8').replace('tags: tags.csv', `tags: ${join(state, 'tags.csv')}`)}`
        + `history:\n  folder: ${history}\n`);
    const now = Math.floor(Date.now() / 1000);
    writeFileSync(join(root, 'series.csv'), `Tag,Time,Value\nTI-1,${now - 60},1\nTI-1,${now - 30},2\n`);
    const imported = runProgram('plantcast', ['history', 'import', plant.file, join(root, 'series.csv')]);
    assert.equal(imported.code, 0, imported.err);
    writeFileSync(join(history, 'proofs.csv'), 'Time,Tag Name\n');
    for (const name of ['.', ...readdirSync(state, { recursive: true })])
        chownSync(join(state, name), NOBODY, NOBODY);
    secret = join(root, 'secret');
    writeFileSync(secret, 'root only\n', { mode: 0o600 });
});
after(async () => {
    if (root)
        rmSync(root, { recursive: true, force: true });
    await plant?.destroy();
});

const rights = (path) => (lstatSync(path).mode & 0o7777).toString(8);
const backUp = (name) => runProgram('plantcast', ['backup', plant.file, '-o', join(root, name)]);

test('only the user who made a backup can read it, including a tag list stored elsewhere', { skip }, () => {
    const made = backUp('one');
    assert.equal(made.code, 0, made.err);
    assert.equal(rights(join(root, 'one')), '700');
    const names = readdirSync(join(root, 'one'));
    assert.ok(['backup.json', 'plant.yaml', 'proofs.csv', 'tags.csv'].every((name) => names.includes(name)), names.join(' '));
    for (const name of names)
        assert.equal(rights(join(root, 'one', name)), '600', name);
});

test('backup refuses symlinks, hard links, folders and files of other owners in place of its files', { skip }, () => {
    const names = ['proofs.csv', readdirSync(history).find((name) => /^history-.*sqlite$/.test(name)), '../tags.csv'];
    const ways = [[(path) => symlinkSync(secret, path), /symbolic link/],
        [(path) => linkSync(secret, path), /another hard link/],
        [(path) => { writeFileSync(path, 'x'); chownSync(path, 1, 1); }, /owner differs from the owner of its folder/],
        [(path) => mkdirSync(path), /not a regular file/]];
    for (const name of names) {
        const path = join(history, name);
        for (const [put, why] of ways) {
            renameSync(path, `${path}.kept`);
            put(path);
            const made = backUp('two');
            assert.equal(made.code, 1, `${name} ${why}`);
            // without a regular tag list, the plant file cannot be read, so backup fails earlier with another message
            if (name !== '../tags.csv')
                assert.match(made.err, why, name);
            assert.ok(!existsSync(join(root, 'two')) && !existsSync(join(root, 'two.part')), name);
            rmSync(path, { recursive: true });
            renameSync(`${path}.kept`, path);
        }
    }
    assert.equal(backUp('two').code, 0);
});

test('restored files belong to the owner of their folder, and nothing is written through a symlink', { skip }, () => {
    renameSync(state, `${state}.was`);
    renameSync(plant.file, `${plant.file}.was`);
    mkdirSync(state);
    chownSync(state, NOBODY, NOBODY);
    symlinkSync(join(root, 'made-by-root'), join(state, 'tags.csv'));
    const restore = () => runProgram('plantcast', ['restore', join(root, 'one'), plant.file]);
    assert.match(restore().err, /exists already/);
    unlinkSync(join(state, 'tags.csv'));
    mkdirSync(join(root, 'elsewhere'));
    symlinkSync(join(root, 'elsewhere'), history);
    assert.match(restore().err, /a file or symbolic link with its name exists/);
    assert.deepEqual(readdirSync(join(root, 'elsewhere')), []);
    unlinkSync(history);
    const restored = restore();
    assert.equal(restored.code, 0, restored.err);
    for (const name of ['tags.csv', 'history', 'history/proofs.csv']) {
        assert.equal(lstatSync(join(state, name)).uid, NOBODY, name);
        assert.match(rights(join(state, name)), /^(6[04]0|750)$/, name);
    }
    assert.equal(lstatSync(plant.file).uid, 0);
    assert.ok(!existsSync(join(root, 'made-by-root')));
});

test('plantcast token refuses symlinks and folders of other users', { skip }, () => {
    const token = (...args) => runProgram('plantcast', ['token', ...args]), who = ['--role', 'viewer', '--name', 'wall'];
    const folder = join(root, 'config'), file = join(folder, 'tokens');
    mkdirSync(folder);
    symlinkSync(secret, file);
    for (const args of [['add', file, ...who], ['list', file], ['revoke', file, 'wall']]) {
        const answer = token(...args);
        assert.deepEqual([answer.code, /symbolic link/.test(answer.err)], [1, true], args[0]);
    }
    unlinkSync(file);
    assert.equal(token('add', file, ...who).code, 0);
    assert.equal(rights(file), '600');
    chownSync(file, NOBODY, NOBODY);
    assert.match(token('list', file).err, /neither root nor you/);
    chownSync(file, 0, 0);
    chownSync(folder, NOBODY, NOBODY);
    assert.match(token('revoke', file, 'wall').err, /of this token file belongs to another user/);
    chownSync(folder, 0, 0);
    chmodSync(folder, 0o777);
    assert.match(token('revoke', file, 'wall').err, /every user can write to the folder/);
    assert.equal(readFileSync(secret, 'utf8'), 'root only\n');
});
