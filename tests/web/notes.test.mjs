// SPDX-License-Identifier: GPL-3.0-or-later
// Notes: their positions in the plant, and until when they are shown.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { inForce, isOfPlant, placeOf, whereOf } from '../../clients/web/core/notes.js';
import { wrapped } from '../../clients/web/app/picture/snapshot_notes.js';
import { makeSession, vector } from './fixtures.mjs';

const { connection, session, sockets } = makeSession();
connection.start();
sockets[0].accept();
sockets[0].say(vector('server/welcome.json'));

test('a note is placed at a point, a tag or an asset, or nowhere if that is missing', () => {
    const { model } = session, [tag] = model.tags, [asset] = model.assets;
    assert.deepEqual(placeOf(model, { position: [1, 2, 3] }), [1, 2, 3]);
    assert.deepEqual(placeOf(model, { tag: tag.name }), tag.position);
    const [x, , z] = placeOf(model, { asset: asset.id });
    assert.ok(x >= asset.bounds.min[0] && x <= asset.bounds.max[0] && z === asset.bounds.max[2]);
    assert.deepEqual([placeOf(model, { tag: 'gone' }), placeOf(model, { asset: 'gone' })], [null, null]);
    const where = [{ position: [1, 2, 3] }, { tag: 'T' }, { asset: 'gone' }].map((note) => whereOf(model, note));
    assert.deepEqual(where, [null, 'T', 'gone']);
    assert.equal(placeOf(model, { text: 'of the whole plant' }), null);
    assert.deepEqual([{ text: 'x' }, { position: [0, 0, 0] }, { tag: 'T' }, { asset: 'A' }].map(isOfPlant), [true, false, false, false]);
});

test('an expired note is not shown, even if the server still lists it', () => {
    const notes = [{ id: 'a', until_us: 0 }, { id: 'b', until_us: 50 }];
    assert.deepEqual(inForce(notes, 49).map(({ id }) => id), ['a', 'b']);
    assert.deepEqual(inForce(notes, 50).map(({ id }) => id), ['a']);
    assert.equal(inForce(notes, null).length, 2);
});

test('a picture of the past shows the notes of its instant', () => {
    const notes = [{ id: 'later', time_us: 60, until_us: 0, ended_us: 0 }, { id: 'over', time_us: 10, until_us: 40, ended_us: 0 },
        { id: 'removed', time_us: 10, until_us: 0, ended_us: 50 }];
    const then = (atUs) => inForce(notes, 100, atUs).map(({ id }) => id);
    assert.deepEqual([9, 10, 39, 40, 50, 60].map(then), [[], ['over', 'removed'], ['over', 'removed'], ['removed'], [], ['later']]);
});

test('a saved picture cuts nothing off a note: lines break at blanks, and inside words longer than a line', () => {
    const pen = { measureText: (text) => ({ width: [...text].length }) };
    const cases = [['permit 4711 open', ['permit', '4711 open']], ['', ['']],
        ['see abcdefghijklmnopqrstu now', ['see', 'abcdefghij', 'klmnopqrst', 'u now']],
        ['배관누설주의작업허가서확인', ['배관누설주의작업허가', '서확인']]];
    for (const [text, lines] of cases)
        assert.deepEqual(wrapped(pen, text, 10), lines);
});

test('notes, sent views and pointers are received, and removed with the plant', () => {
    for (const name of ['notes', 'walls', 'pointed'])
        sockets[0].say(vector(`server/${name}.json`));
    const { notes, walls, pointed } = session;
    assert.deepEqual([notes, walls.list, walls.displays, pointed].map(({ length }) => length), [1, 1, 1, 1]);
    sockets[0].say(vector('server/welcome.json'));
    assert.deepEqual([session.notes, session.walls, session.pointed], [[], null, []]);
});
