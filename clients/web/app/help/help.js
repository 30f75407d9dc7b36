// SPDX-License-Identifier: GPL-3.0-or-later
// The help dialog: pointer and keyboard controls, and the meaning of the markers. Built when it is first opened.
import { say } from '../../core/words.js';
import { byId, make, makeSvg } from '../common/dom.js';
import { closeButton } from '../common/widgets.js';

// Rows of the table of controls: name, then the words or keys of each column; '' for an empty cell.
const ROWS = [
    ['help.turn', 'help.turn.mouse', 'help.turn.touch', '[←] [→] [↑] [↓]'],
    ['help.move', 'help.move.mouse', 'help.move.touch', '[W] [A] [S] [D]'],
    ['help.look', 'help.look.mouse', 'help.look.touch', ''],
    ['help.zoom', 'help.zoom.mouse', 'help.zoom.touch', '[+] [−]'],
    ['help.fit', 'help.fit.mouse', 'help.fit.touch', '[F]'],
    ['help.home', '', '', '[H]'],
    ['help.back', '', '', '[⌫]'],
    ['help.from', '', '', 'help.from.keys'],
    ['help.what', 'help.what.mouse', 'help.what.touch', ''],
    ['help.selected', '', '', 'help.selected.keys'],
    ['bar.quantity', '', '', 'help.quantity.keys'],
    ['assets.title', '', '', 'help.equipment.keys'],
    ['alarms.title', '', '', '[E]'],
    ['time.title', '', '', 'help.history.keys'],
    ['timings', '', '', '[M]'],
    ['bar.hold', '', '', '[␣]'],
    ['bar.split', '', '', '[J]'],
    ['bar.measure', '', '', '[R]'],
    ['bar.snapshot', '', '', '[C]'],
    ['bar.share', '', '', '[K]'],
    ['bar.theme', '', '', '[Z]'],
];
const MARKS = [
    ['help.mark.good', 'circle', { class: 'mark', r: 4.5 }],
    ['help.mark.uncertain', 'path', { class: 'mark', d: 'M0-6 6 0 0 6-6 0z' }],
    ['help.mark.bad', 'path', { class: 'mark', d: 'M-5-5h10v10h-10zM-2.5-2.5l5 5M2.5-2.5l-5 5' }],
    ['help.mark.behind', 'circle', { class: 'mark hidden-mark', r: 2.5 }],
    ['help.mark.alarm', 'circle', { class: 'ring p1', r: 9 }],
    ['help.mark.acknowledged', 'circle', { class: 'ring p1 thin', r: 9 }],
    ['help.mark.returned', 'path', { class: 'ring p1 thin', d: 'M0-10.5A10.5 10.5 0 1 0 .1-10.5zM0-7A7 7 0 1 0 .1-7z' }],
];

// Turns a text into nodes, with each [key] as a key symbol.
const withKeys = (text) => text.split(/(\[[^\]]+\])/).filter(Boolean).map((part) =>
    (/^\[.+\]$/.test(part) ? make('kbd', {}, part.slice(1, -1)) : part));
const cell = (text) => make('td', {}, ...withKeys(/^(help|bar)\./.test(text) ? say(text) : text));

function build(dialog) {
    const head = ['help.mouse', 'help.touch', 'help.keys'].map((key) => make('th', { scope: 'col' }, say(key)));
    const rows = ROWS.map(([name, ...cells]) => make('tr', {}, make('th', { scope: 'row' }, say(name)), ...cells.map(cell)));
    const marks = MARKS.map(([key, shape, attributes]) => {
        const side = attributes.class.startsWith('ring') ? 12 : 8, viewBox = `${-side} ${-side} ${2 * side} ${2 * side}`;
        return make('li', {}, makeSvg('svg', { viewBox, 'aria-hidden': 'true' }, makeSvg(shape, attributes)), say(key));
    });
    dialog.append(
        make('h2', { id: 'help-title' }, say('help.title')),
        closeButton('help.close', () => dialog.close()),
        make('table', {}, make('thead', {}, make('tr', {}, make('td'), ...head)), make('tbody', {}, ...rows)),
        make('h2', {}, say('help.markers')), make('ul', { class: 'marks' }, ...marks),
        make('p', { class: 'note' }, say('help.crowd')));
}

export class Help {
    constructor() {
        const dialog = byId('help');
        build(dialog);
        dialog.addEventListener('click', (event) => event.target === dialog && dialog.close());
    }

    open() {
        byId('help').showModal();
    }
}
