// SPDX-License-Identifier: GPL-3.0-or-later
// The report of an import: lists of model elements that were lost or left out, errors, and a question for each unit that the server
// guessed.
import { shortNumberText } from '../../core/format.js';
import { timesOf } from '../../core/matches.js';
import { say } from '../../core/words.js';
import { make } from '../common/dom.js';
import { fill } from '../common/widgets.js';

const UNITS = ['mm', 'cm', 'm', 'in', 'ft'];
const metres = (length, unit) => shortNumberText(length * timesOf('m', unit), length * timesOf('m', unit) < 10 ? 4 : 1);

// Makes a collapsed list that is filled when it is first opened, because it may have thousands of lines.
function fold(key, count, lines) {
    const list = make('ul', {});
    const details = make('details', { 'data-kind': key }, make('summary', {}, say(`import.report.${key}`, { count })), list);
    details.addEventListener('toggle', () => list.append(...lines().map((parts) => make('li', {}, ...parts))), { once: true });
    return details;
}

export class Report {
    // answer(unit) is called with the unit that the user chooses for model files that state none.
    constructor({ answer }) {
        this.answer = answer;
        this.element = make('section', { class: 'report', hidden: true });
        this.set([]);
    }

    set(models) {
        const all = (key) => models.flatMap((model) => model[key].map((found) => [model.file, found]));
        const lost = all('lost'), leftOut = all('left_out'), unread = models.filter(({ failed }) => failed);
        const errors = [...unread.map(({ file, failed }) => [file, { count: 1, text: failed }]), ...all('errors')];
        const sum = (counts) => counts.reduce((a, b) => a + b, 0);
        const lists = [
            ['lost', sum(models.map(({ lost_count: count }) => count)), () => lost.map(([file, { id, name, class: kind, guid, why }]) =>
                [make('b', {}, name || id), ` ${[name && id, kind, guid, file].filter(Boolean).join(' · ')}`, make('i', {}, why)])],
            ['errors', sum(errors.map(([, { count }]) => count)), () => errors.map(([file, { count, text }]) =>
                [make('b', {}, file), count > 1 ? ` × ${count}` : '', make('i', {}, text)])],
            ['left', leftOut.length, () => leftOut.map(([file, text]) => [make('b', {}, file), make('i', {}, text)])],
        ].filter(([, count]) => count > 0);
        const asked = models.filter(({ unit }) => unit);
        fill(this.element, ...asked.length > 0 ? [this.question(asked)] : [], ...lists.map((list) => fold(...list)));
        this.element.hidden = this.element.childElementCount === 0;
    }

    question(asked) {
        const lengths = (unit) => asked.map((model) => say('import.unit.length', { length: metres(model.unit.length, unit) })).join(', ');
        return make('div', { class: 'unit', role: 'group', 'aria-label': say('import.units') },
            ...asked.map(({ file, unit: { taken, length } }) => make('p', {},
                say('import.unit.ask', { file, unit: say(`import.units.${taken}`),
                length: metres(length, taken) }))),
            ...asked.length > 1 ? [make('p', { class: 'quiet' }, say('import.unit.all'))] : [],
            make('div', { class: 'line' }, ...UNITS.map((unit) => make('button', { type: 'button', title: lengths(unit),
                'data-unit': unit, onclick: () => this.answer(unit) }, say(`import.units.${unit}`)))));
    }
}
