// SPDX-License-Identifier: GPL-3.0-or-later
// The table next to the trend charts: for each tag its value at the crosshair, its present or shown value, and minimum, mean and maximum
// of the shown period.
import { numberText } from '../../core/format.js';
import { statistics, valueAt, withNewest } from '../../core/trend_values.js';
import { say } from '../../core/words.js';
import { byId, make, setText, setVariable } from '../common/dom.js';

const COLUMNS = ['at', 'now', 'min', 'mean', 'max'], FULL = 0.995;

export class TrendTable {
    // view: the trends (trends.js), with the members that Plot uses (plot.js), and remove(tag) and setFocus(tag).
    constructor(view) {
        this.view = view;
        this.rows = new Map(); // rows of the table: tag -> { cells by column }
        this.stats = new Map();
        this.head = byId('trend-tags').querySelector('thead');
        this.body = byId('trend-tags').querySelector('tbody');
    }

    // Builds the table's rows, one for each tag of the trend.
    build() {
        const { view } = this, head = (name) => make('th', { class: name, scope: 'col' });
        const heads = Object.fromEntries([...COLUMNS, 'known'].map((name) => [name, head(name)]));
        this.heads = heads;
        this.head.replaceChildren(make('tr', {}, make('th', { scope: 'col' }, say('trends.tag')), ...Object.values(heads),
            make('td')));
        this.rows.clear();
        this.body.replaceChildren(...view.tags.map((tag, i) => this.rowOf(tag, i)));
        this.fill();
    }

    rowOf(tag, i) {
        const { view } = this, unit = view.unitOf(tag), title = say('trends.remove', { tag: tag.name });
        const cells = Object.fromEntries([...COLUMNS, 'known'].map((name) => [name, make('td', { class: name })]));
        this.rows.set(tag, cells);
        const badge = make('span', { class: 'badge', 'aria-hidden': 'true' }, String(i + 1));
        setVariable(badge, '--colour', view.colourOf(tag));
        const name = make('button', { type: 'button', class: 'name', 'aria-pressed': String(view.focus === tag), title: say('trends.focus'),
            onclick: () => view.setFocus(tag) }, badge, make('b', {}, tag.name), unit ? ` [${unit}]` : '');
        return make('tr', {}, make('th', { scope: 'row', title: tag.description ?? '' }, name, make('small', {}, tag.description ?? '')),
            ...Object.values(cells), make('td', {}, make('button', { type: 'button', class: 'drop', 'aria-label': title, title,
                onclick: () => view.remove(tag) }, '×')));
    }

    // Computes the statistics of the shown period. series: Map from a tag's name to its series.
    count(series, [from, to]) {
        this.stats = new Map(this.view.tags.map((tag) => [tag, series.has(tag.name) ? statistics(series.get(tag.name), from, to) : null]));
        this.fill();
    }

    fill() {
        const { view } = this, { session } = view, isPast = session.time.atUs !== null;
        const isOld = !isPast && !view.page.overlay.fresh; // true: no messages arrive from the server, so present values are unknown
        for (const name of COLUMNS)
            setText(this.heads[name], say(`trends.${name === 'now' && isPast ? 'then' : name}`));
        setText(this.heads.known, say('trends.known'));
        const lacks = [...this.stats.values()].some((one) => one && one.known < FULL);
        byId('trend-tags').classList.toggle('lacks', lacks);
        for (const [tag, cells] of this.rows) {
            const { value, quality } = session.model.readings[tag.index];
            // counts the present reading, too, because the recorded series ends some seconds before it
            if (!isPast && !isOld && view.isLive && quality !== 'bad' && value !== null)
                this.stats.set(tag, withNewest(this.stats.get(tag), value));
            const stats = this.stats.get(tag), text = (number) => view.numberText(tag, number);
            setText(cells.now, isOld ? '–' : quality === 'bad' ? say('novalue') : text(value));
            for (const name of ['min', 'mean', 'max'])
                setText(cells[name], text(stats?.[name]));
            setText(cells.known, `${numberText(Math.floor(100 * (stats?.known ?? 0)), 0)} %`);
        }
    }

    // Shows in the table the values at the instant `us` of the crosshair; null: there is no crosshair, so the cells become empty.
    point(us, series) {
        for (const tag of this.view.tags) {
            const cell = this.rows.get(tag)?.at, one = series.get(tag.name);
            if (cell)
                setText(cell, this.view.numberText(tag, us === null || !one ? null : valueAt(one, us)));
        }
    }
}
