// SPDX-License-Identifier: GPL-3.0-or-later
// The list of equipment: its rows, search results, which rows are in view, and links that are made from templates.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { linkUrl } from '../../clients/web/core/references.js';
import { search } from '../../clients/web/core/search.js';
import { Tree } from '../../clients/web/core/asset_tree.js';
import { scrollTo } from '../../clients/web/core/scroll.js';
import { rowAt, rowsInSight, stack } from '../../clients/web/core/list_window.js';

function plant() {
    const tags = [['TI-1', 'inlet', 'E-1'], ['TI-2', 'outlet', 'E-1'], ['PI-9', 'inlet', 'P-2'], ['XI-1', 'spare', null]]
        .map(([name, description, asset], index) => ({ name, description, asset, index }));
    const assets = [['E-1', 'Unit 10', 'feed exchanger'], ['P-2', 'Unit 9', 'pump'], ['V-3', 'Unit 10', 'drum'], ['Z-4', '', 'rack']]
        .map(([id, area, description]) => ({ id, tag: id, area, description, tags: tags.filter((tag) => tag.asset === id) }));
    return { tags, assets };
}
const shown = (rows) => rows.map(({ kind, level, id, text, item }) => `${level} ${kind} ${text ?? item.name ?? item.tag ?? id}`);

test('areas are in numeric order, then equipment without area, then tags without equipment', () => {
    const tree = new Tree(plant(), 'Loose');
    assert.deepEqual(shown(tree.rows()), ['1 area Unit 9', '2 asset P-2', '1 area Unit 10', '2 asset E-1', '2 asset V-3', '1 asset Z-4',
        '1 asset Loose']);
    tree.toggle(tree.rows()[3]);
    assert.deepEqual(shown(tree.rows()).slice(3, 6), ['2 asset E-1', '3 tag TI-1', '3 tag TI-2']);
    tree.toggle(tree.rows()[2]);
    assert.deepEqual(shown(tree.rows()).slice(2, 4), ['1 area Unit 10', '1 asset Z-4']);
    tree.unfold(plant().assets[2]);
    assert.ok(shown(tree.rows()).includes('2 asset V-3'), 'unfolding an asset shows its row');
    tree.toggle(tree.rows().find(({ id }) => id === 'E-1'));
    assert.ok(!shown(tree.rows()).includes('3 tag TI-1'), 'a second toggle closes the asset');
    assert.deepEqual(tree.rows()[0].open, true);
});

test('a search finds assets by all their texts, and tags, and opens their parents', () => {
    const tree = new Tree(plant(), 'Loose');
    assert.deepEqual(shown(tree.rows(search('DRUM'))), ['1 area Unit 10', '2 asset V-3']);
    const both = ['1 area Unit 9', '2 asset P-2', '3 tag PI-9', '1 area Unit 10', '2 asset E-1', '3 tag TI-1'];
    assert.deepEqual(shown(tree.rows(search('inlet'))), both);
    assert.deepEqual(shown(tree.rows(search('exchanger outlet'))), ['1 area Unit 10', '2 asset E-1', '3 tag TI-2'],
        'both words are searched, in asset and tag');
    assert.deepEqual(shown(tree.rows(search('xi spare'))), ['1 asset Loose', '2 tag XI-1']);
    assert.deepEqual(tree.rows(search('nothing of that name')), []);
    assert.equal(search(' '), null);
});

test('with rows of unequal height, the visible rows and the scroll position are right', () => {
    const tops = stack([10, 20, 30, 40]);
    assert.deepEqual([...tops], [0, 10, 30, 60, 100]);
    assert.deepEqual([0, 9, 10, 29.5, 60, 99, 1000, -5].map((y) => rowAt(tops, y)), [0, 0, 1, 1, 3, 3, 3, 0]);
    assert.deepEqual(rowsInSight(tops, 10, 25, 0), [1, 3]);
    assert.deepEqual(rowsInSight(tops, 10, 25, 5), [0, 4]);
    assert.deepEqual(rowsInSight(stack([]), 0, 100, 3), [0, 0]);
    assert.deepEqual([[0, 20], [1, 0], [3, 0], [2, 30]].map(([row, at]) => scrollTo(tops, row, at, 50)), [0, 0, 50, 30]);
});

test('values in link templates are escaped, and only web links are allowed', () => {
    const asset = { id: 'E-1/a', tag: 'E 1&2', area: 'Ü' };
    const made = linkUrl({ of: 'asset', url: 'https://a.example/{id}?t={tag}#{area}' }, asset);
    assert.equal(made, 'https://a.example/E-1%2Fa?t=E%201%262#%C3%9C');
    const tag = { name: 'TI"1', asset: null, group: 'g' };
    assert.equal(linkUrl({ of: 'tag', url: 'http://a.example/{name}/{asset}/{group}' }, tag), 'http://a.example/TI%221//g');
    assert.deepEqual(['javascript:alert(1)//{id}', 'data:text/html,{id}', '{id}', '//x/{id}', 'file:///{id}']
        .map((url) => linkUrl({ of: 'asset', url }, asset)), [null, null, null, null, null]);
});
