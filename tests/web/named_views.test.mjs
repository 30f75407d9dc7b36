// SPDX-License-Identifier: GPL-3.0-or-later
// Named views: a session switches to a named view whatever it showed before, and ids are made from titles.
import assert from 'node:assert/strict';
import { mock, test } from 'node:test';
import { NamedViews } from '../../clients/web/app/views/named_views.js';
import { readAddress, writeAddress } from '../../clients/web/core/address.js';
import { idFor, isEngineers, newView, regained, textOf, viewOf } from '../../clients/web/core/named_views.js';
import { makeSession, silent, vector, withServer } from './fixtures.mjs';

const welcome = vector('server/welcome.json');
function greeted(role) {
    const { connection, session, sockets } = makeSession();
    connection.start();
    sockets[0].accept();
    sockets[0].say({ ...welcome, role });
    return { session, say: (message) => sockets[0].say(message) };
}

test('parameters missing from a saved view are those of its group, or of the plant', () => {
    const { session: one } = greeted('engineer'), [group, other] = one.model.groups;
    one.setParams({ clip: { planes: [[0, 0, 1, 0]] }, strength: 2, hidden: ['x'], light: [0, 0, 1], group: other.id });
    const { params, camera } = viewOf(one, `group=${group.id}&look=flat`);
    assert.equal(params.look, 'flat');
    const { clip, split, selected, range, sensors, light } = params;
    assert.deepEqual([clip, split, selected, range, sensors, light], [null, null, null, null, null, null]);
    assert.equal(params.strength, 1);
    assert.deepEqual(params.hidden, one.model.start.hidden);
    assert.deepEqual(params.isolines, group.isolines);
    assert.equal(params.interpolation, group.interpolation);
    assert.ok(camera.eye.every(Number.isFinite), 'without a camera the view uses the home camera');
});

test('a view has colour bands only if its text has them, because new views have continuous colours', () => {
    const { session } = greeted('engineer'), [group] = session.model.groups;
    group.breaks = [20, 50];
    assert.equal(viewOf(session, `group=${group.id}`).params.breaks, null);
    for (const breaks of [null, [20, 50]]) {
        session.setParams({ group: group.id, breaks });
        assert.deepEqual(viewOf(session, textOf(session)).params.breaks, breaks);
        assert.deepEqual(newView(session, { group: group.id }).breaks, null);
    }
});

test('a view that names no interpolation gets the one that the server selects for its quantity', () => {
    const { session } = greeted('viewer'), [group] = session.model.groups, { id } = group;
    const chosen = (text) => viewOf(session, `group=${id}&${text}`).params.interpolation;
    const cases = [['shepard', ['gp'], 'gp', 'shepard'], ['shepard', undefined, 'shepard', 'shepard'], ['fin', ['fin'], 'fin', 'shepard'],
        ['fin', ['fin', 'harmonic'], 'fin', 'harmonic']];
    for (const [interpolation, prepared, uncertainty, operator] of cases) {
        Object.assign(group, { interpolation, prepared });
        session.model.plant.show = 'value';
        assert.deepEqual([chosen(''), chosen('show=uncertainty'), chosen('show=operator'), chosen('show=operator&interpolation=paper')],
            [interpolation, uncertainty, operator, 'paper']);
        session.model.plant.show = 'operator';
        assert.equal(newView(session, { group: id }).interpolation, operator, 'the picture of an alarm');
    }
});

test('a view without group, colour map or environment has those of a new view, whatever was shown before', () => {
    const { session } = greeted('viewer'), { model } = session, [first, other] = model.groups;
    session.setParams({ group: other.id, colormap: 'viridis', environment: 'sky' });
    const shown = ({ group, colormap, environment }) => [group, colormap, environment];
    assert.deepEqual(shown(viewOf(session, 'look=flat').params), [first.id, model.colormaps[0].name, 'sky']);
    model.environments = ['sky', 'hall'];
    assert.deepEqual(shown(viewOf(session, `group=${other.id}`).params), [other.id, model.colormaps[0].name, 'hall']);
    assert.deepEqual(shown(newView(session, { group: null })), [other.id, model.colormaps[0].name, 'hall'], 'no group: the shown one');
    assert.equal(viewOf(session, 'show=difference&baseline=b').params.colormap, 'diverging');
});

test('a viewer\'s new view has no engineer-only parameters of the view before it', () => {
    const { session } = greeted('viewer'), { id } = session.group;
    session.params = { ...session.params, reach_m: 0.1 };
    const { named, reach_m: reach, group } = newView(session, { group: id });
    assert.deepEqual([named, reach, group], [null, undefined, id], 'named: null asks the server for the values of a new view');
    session.role = 'engineer';
    const engineers = newView(session, { group: id });
    assert.deepEqual([engineers.named, engineers.reach_m], [undefined, null]);
});

test('a saved view shows the quantity, isolines and directions with which it was saved', () => {
    const { session } = greeted('engineer'), [group] = session.model.groups;
    group.isolines = [50];
    for (const show of ['blind', 'uncertainty', 'value']) {
        session.setParams({ group: group.id, show, isolines: null, arrows: 'none' }); // as the toolbar sets no isolines
        const text = textOf(session);
        session.setParams({ show: 'operator', isolines: [20], arrows: 'strokes' });
        const { params } = viewOf(session, text);
        assert.deepEqual([params.show, params.isolines, params.arrows], [show, [], 'none']);
    }
    const { params } = viewOf(session, `group=${group.id}`);
    assert.deepEqual([params.show, params.isolines, params.arrows], ['value', [50], 'arrows']);
    assert.deepEqual(viewOf(session, 'show=blind').params.isolines, [], 'the isolines of the group are values');
    group.scale = 'log';
    group.breaks = [10, 20];
    for (const [show, scale] of [['operator', 'linear'], ['uncertainty', 'linear'], ['blind', 'log']]) {
        const { params: other } = viewOf(session, `group=${group.id}&show=${show}`);
        assert.deepEqual([other.scale, other.breaks], [scale, null], 'scale and breaks of the group are for values');
    }
    session.setParams({ look: 'materials' });
    assert.equal(newView(session, { group: group.id }).look, 'default', 'a new view shows readings');
    session.model.plant.show = 'operator';
    assert.equal(viewOf(session, 'look=flat').params.show, 'operator', 'the initial quantity of the plant');
});

test('a new view of a tag shows readings and the tag\'s equipment, whatever was shown before', () => {
    const { session } = greeted('viewer'), [, other] = session.model.groups;
    session.setParams({ show: 'blind', isolate: ['E-101'], clip: { planes: [[0, 0, 1, 0]] }, split: {}, range: [1, 2] });
    const { group, show, isolate, hidden, clip, split, range } = newView(session, { group: other.id });
    assert.deepEqual([group, show, isolate, hidden, clip, split, range],
        [other.id, 'value', [], session.model.start.hidden, null, null, null]);
    session.model.start = { hidden: ['E-101', 'P-101A'], isolate: [], ghost: ['E-101'] };
    const { hidden: left, ghost } = newView(session, { group: other.id, asset: 'E-101' });
    assert.deepEqual([left, ghost], [['P-101A'], []], 'equipment that new views hide is shown if it has the tag');
});

test('a viewer takes the parameters of the field from the saved view', () => {
    const { params } = viewOf(greeted('viewer').session, 'strength=2&power=3', 'own');
    assert.deepEqual([params.strength, params.power, params.sensors, params.named], [undefined, undefined, undefined, 'own']);
    assert.equal(viewOf(greeted('viewer').session, 'strength=2').params.named, null);
    for (const role of ['engineer', undefined]) // a server that sends no role permits all parameters
        assert.equal(viewOf(greeted(role).session, 'strength=2', 'own').params.strength, 2);
});

test('after a reload or a reconnect, a viewer takes the field\'s parameters from the saved view again', () => {
    const { session } = greeted('viewer'), group = session.model.groups[1];
    session.setParams({ named: 'own', group: group.id, look: 'flat', strength: 2, selected: 'E-101' });
    // the view to be restored must contain everything that differs from the named view, because the server starts from that
    // view's parameters
    const again = regained(session, 'own');
    assert.deepEqual([again.named, again.group, again.look, again.selected, again.strength], ['own', group.id, 'flat', 'E-101', undefined]);
    assert.deepEqual([again.clip, again.split], [null, null]);
    const { params, ownParams: own } = session, address = writeAddress({ params, own, named: 'own' });
    assert.match(address, /named=own/);
    assert.deepEqual([readAddress(address).params.strength, readAddress(writeAddress({ params, own })).params.strength], [undefined, 2]);
    assert.deepEqual(['strength=2', 'reach=none', 'look=flat'].map(isEngineers), [true, true, false]);
});

test('the list of views is empty after a reload into a plant without views', () => {
    const { session, say } = greeted('viewer');
    say(vector('server/views.json'));
    assert.ok(session.views.length > 0);
    say(welcome);
    assert.deepEqual(session.views, []);
});

test('an id made from a title is plain, short and unique', () => {
    assert.equal(idFor('Kessel 2, Süd', []), 'kessel-2-sud');
    assert.equal(idFor('보일러', []), 'view');
    assert.equal(idFor('A', [{ id: 'a' }, { id: 'a-2' }]), 'a-3');
    assert.ok(idFor('x'.repeat(99), []).length <= 48);
});

test('thumbnails are requested again after a request that the server never answers', async () => {
    mock.timers.enable({ apis: ['setTimeout'] });
    try {
        const views = Object.assign(Object.create(NamedViews.prototype), { session: { token: null, views: [{ id: 'a', view: '' }] },
            pictures: new Map() });
        await withServer(silent, async () => {
            const drawn = views.draw();
            assert.equal(views.drawing, true);
            mock.timers.tick(61000);
            await drawn;
            assert.equal(views.drawing, false);
        });
    } finally {
        mock.timers.reset();
    }
});
