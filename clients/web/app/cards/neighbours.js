// SPDX-License-Identifier: GPL-3.0-or-later
// A sensor's value as predicted from its neighbours (leave-one-out) by the daemon: a line on the sensor's card, and a list of
// the largest deviations.
import { unitText, valueText } from '../../core/format.js';
import { askInTime } from '../../core/http.js';
import { say } from '../../core/words.js';
import { make } from '../common/dom.js';
import { driftOf, driftText } from './drift.js';

const AGAIN_MS = 3000, LISTED = 5;

const sensors = (query, token) => askInTime('api/v1/neighbours', query, token).then((rows) => rows.sensors)
    .catch(() => []); // after a failed request no prediction is shown, because an old one would mislead

// Returns the prediction as text, such as 81.3 °C ± 2.0, with the reading's deviation from it; null if there is no prediction.
export function neighbourText(row, group) {
    if (!row || row.predicted === null)
        return null;
    const number = (value) => valueText(group, value), unit = unitText(group.unit);
    const predicted = `${number(row.predicted)} ${unit}${row.deviation === null ? '' : ` ± ${number(row.deviation)}`}`;
    if (row.residual === null)
        return predicted;
    return say(row.residual < 0 ? 'neighbours.below' : 'neighbours.above', { predicted, by: `${number(Math.abs(row.residual))} ${unit}` });
}

// Requests predictions for sensors from their neighbours at intervals, while isSeen() returns true and the present is shown:
// the daemon does not predict the past. onRows(rows) is called with each answer.
export class Neighbours {
    constructor(session, isSeen, onRows) {
        Object.assign(this, { session, isSeen, onRows, query: null });
    }

    async show(query) {
        const isLive = query && this.session.time.atUs === null;
        if (!isLive)
            this.onRows([]);
        if (query === this.query)
            return;
        this.query = query;
        clearTimeout(this.timer);
        if (!query)
            return;
        if (isLive && this.isSeen()) {
            const rows = await sensors(query, this.session.token);
            if (this.query !== query)
                return;
            this.onRows(this.session.time.atUs === null ? rows : []);
        }
        this.timer = setTimeout(() => {
            this.query = null;
            this.show(query);
        }, AGAIN_MS);
    }
}

// Lists the sensors of the shown group that deviate most from their neighbours' prediction.
export class Disagreeing {
    constructor({ session, selectTag }) {
        Object.assign(this, { session, selectTag });
        this.list = make('div');
        this.drifting = make('div', { id: 'drifting', hidden: true });
        this.element = make('fieldset', { id: 'disagreeing' }, make('legend', {}, say('neighbours.title')), this.list,
            make('p', { class: 'note' }, say('neighbours.why')), this.drifting);
        const isSeen = () => this.element.closest('.open') !== null;
        this.neighbours = new Neighbours(session, isSeen, (rows) => {
            this.fill(rows);
            if (isSeen())
                this.fillDrifting(session.params.group);
        });
        session.on('params', () => this.update());
    }

    update() {
        const { params } = this.session;
        if (!params)
            return;
        // clears the list when another sensor group is shown: rows of another quantity would mislead until the answer arrives
        if (params.group !== this.group) {
            this.group = params.group;
            this.fill([]);
            this.drifting.hidden = true;
        }
        this.neighbours.show(`group=${encodeURIComponent(params.group)}`);
    }

    line(row, text) {
        const group = this.session.model.group(this.session.model.tag(row.tag).group);
        return make('div', { class: 'line' }, make('button', { type: 'button', onclick: () => this.selectTag(row.tag) }, row.tag),
            make('span', {}, text(row, group)));
    }

    fill(rows) {
        const known = rows.filter(({ off }) => off !== null).slice(0, LISTED);
        this.list.replaceChildren(...known.map((row) => this.line(row, neighbourText)));
        this.element.hidden = known.length === 0;
    }

    async fillDrifting(group) {
        const found = (await driftOf(this.session, { group })).filter(({ verdict }) => verdict === 'found');
        if (this.session.params.group !== group)
            return;
        found.sort((a, b) => Math.abs(b.change / b.scatter) - Math.abs(a.change / a.scatter));
        this.drifting.hidden = found.length === 0;
        this.drifting.replaceChildren(make('p', { class: 'note' }, say('drift.week')),
            ...found.slice(0, LISTED).map((row) => this.line(row, driftText)), make('p', { class: 'note' }, say('drift.why')));
    }
}
