// SPDX-License-Identifier: GPL-3.0-or-later
// Controls a control room's video wall from a user's desk: sends the current view to a pane (an area) of the wall, makes the
// pane keep a view until further notice, and points at a position in the plant.
import { timeOrDay, zoneClock } from '../../core/format.js';
import { askInTime, loaderOf } from '../../core/http.js';
import { quantityText } from '../../core/model.js';
import { textOf, viewOf } from '../../core/named_views.js';
import { refusalText } from '../../core/refusals.js';
import { askPick, Repeater } from '../../core/requests.js';
import { say } from '../../core/words.js';
import { Devices } from './devices.js';
import { fillSelect } from '../common/choices.js';
import { byId, make, setText } from '../common/dom.js';
import { store, stored } from '../common/storage.js';

const MAY = ['operator', 'engineer'], POINT_MS = 250, AGAIN_MS = 2000, LONGEST = 30, SAME_M = 0.01;
const isFrom = (a, b) => ['eye', 'target'].every((name) => a[name].every((m, i) => Math.abs(m - b[name][i]) < SAME_M));
const nameOf = ({ wall, display, area }) => `${wall}/${display}/${area}`;

export class Remote {
    constructor(page) {
        const { session, tell, selection, viewport } = page;
        Object.assign(this, { page, session, selection, viewport, panes: [], pointing: false, unread: null, seenSeq: session.pickSeq });
        this.repeater = new Repeater();
        const button = (name, onclick) => make('button', { type: 'button', id: `remote-${name}`, onclick }, say(`remote.${name}`));
        this.pane = make('select', { id: 'remote-pane', 'aria-label': say('remote.pane'), onchange: () => this.show() });
        this.desk = make('input', { id: 'remote-desk', maxlength: LONGEST, placeholder: say('remote.desk'),
            'aria-label': say('remote.desk'), value: stored('desk') ?? '', oninput: () => store('desk', this.desk.value.trim()) });
        this.points = make('input', { type: 'checkbox', id: 'remote-points', onchange: () => this.setPointing(this.points.checked) });
        this.said = make('p', { class: 'note', id: 'remote-said' });
        this.element = make('fieldset', { id: 'remote' }, make('legend', {}, say('remote.legend')),
            make('div', { class: 'line' }, this.pane, this.desk), this.said,
            make('div', { class: 'buttons' }, button('send', () => this.send({ view: textOf(session, selection.tag), title: this.title })),
                button('hold', () => this.send({ ...this.sentView, held: true })), button('back', () => this.send({}))),
            make('label', { class: 'line' }, make('span', {}, say('remote.point')), this.points));
        byId('views').append(this.element);
        this.devices = new Devices(page);
        // Loads the list of video walls; a reload of the plant may have changed it.
        this.learn = loaderOf(session, () => askInTime('api/v1/walls', {}, session.token), (answer, error) => this.take(answer, error));
        session.on('walls', () => this.show());
        session.on('welcome', () => { this.repeater.reset(); this.learn(); });
        session.on('sent_to_wall', ({ kept, why, refusal }) => kept || tell(refusalText(why, refusal)));
        session.on('picked', (picked) => this.onPicked(picked));
        setInterval(() => this.pointing && this.ask(), POINT_MS);
        this.learn();
    }

    // Stores the list of video walls. If the request failed, keeps the previous list and shows the error.
    take(answer, error) {
        this.unread = error?.message ?? null;
        this.panes = error ? this.panes : answer.walls.flatMap(({ id: wall, displays }) => displays.flatMap(({ panes }, index) =>
            panes.filter(({ kind, tile }) => kind === 'views' && !(tile?.number > 1))
                .map(({ area, title }) => ({ wall, display: index + 1, area, title }))));
        const before = this.pane.value;
        fillSelect(this.pane, this.panes.map((pane) => [nameOf(pane), say('remote.where', { ...pane, area: pane.title ?? pane.area })]),
            this.panes.some((pane) => nameOf(pane) === before) ? before : nameOf(this.panes[0] ?? {}));
        this.show();
    }

    get chosen() {
        return this.panes.find((pane) => nameOf(pane) === this.pane.value) ?? null;
    }

    get order() {
        return this.session.walls?.list.find(({ id }) => id === this.pane.value) ?? null;
    }

    get sentView() {
        const { view = '', title = '' } = this.order ?? {};
        return { view, title };
    }

    // Title for the pane: that of the open saved view, else the selection's name, else the quantity's.
    get title() {
        const { session } = this, { params, model, group } = session, opened = this.page.modules.there('namedViews')?.opened;
        const named = session.views.find(({ id, view }) => id === opened && isFrom(viewOf(session, view).camera, session.camera))?.title;
        return named ?? (model.asset(params.selected)?.tag || this.selection.tag || (group ? quantityText(group) : ''));
    }

    send(what) {
        const { session, chosen } = this;
        if (chosen)
            session.post({ type: 'send_to_wall', seq: ++session.toldSeq, ...this.address, ...what });
    }

    get address() {
        const { wall, display, area } = this.chosen;
        return { wall, display, area, desk: this.desk.value.trim() };
    }

    show() {
        const { session, chosen, order } = this;
        this.element.hidden = (this.panes.length === 0 && !this.unread) || !MAY.includes(session.role);
        const unread = this.unread && say('remote.unread', { why: this.unread });
        if (!chosen || !session.model) {
            setText(this.said, unread ?? '');
            return;
        }
        const there = session.walls?.displays.some(({ wall, display }) => wall === chosen.wall && display === chosen.display);
        const texts = [say(there ? 'remote.there' : 'remote.gone')];
        if (order) {
            const time = timeOrDay(zoneClock(session.model.plant.time_zone), order.time_us / 1000, session.clockUs() / 1000, 5);
            const who = [order.desk, order.by].filter(Boolean).join(', ');
            texts.push(say(order.held ? 'remote.held' : 'remote.sent', { title: order.title, who, time }));
        }
        setText(this.said, [unread, ...texts].filter(Boolean).join(' · '));
        byId('remote-back').disabled = !order;
        byId('remote-hold').disabled = Boolean(order?.held);
    }

    // --- pointing at a position of the plant, which works whatever camera the wall has

    setPointing(on) {
        this.pointing = on;
        this.place = null;
        if (!on && this.chosen)
            this.session.post({ type: 'point', ...this.address });
    }

    ask() {
        const { pointed } = this.page, now = performance.now(), place = pointed && `${pointed.x} ${pointed.y}`;
        if (!place || !this.chosen || this.waits(now) || (place === this.place && now - this.askedAt < AGAIN_MS))
            return;
        this.place = place;
        this.askedAt = now;
        askPick(this.session, this.viewport.pixelOf(pointed.x, pointed.y), 'point');
        this.note(now);
    }

    // Notes a pick request of this or another module.
    note(now) {
        if (this.session.pickSeq !== this.seenSeq)
            this.repeater.sent(now);
        this.seenSeq = this.session.pickSeq;
    }

    // Returns true if the next pick request must wait for the answer to the previous one: the server answers only the latest
    // request, and a pick by the user's click takes precedence.
    waits(now) {
        this.note(now);
        return this.repeater.waits(now);
    }

    onPicked({ seq, purpose, asset, position }) {
        this.seenSeq = seq;
        this.repeater.reset();
        if (this.pointing && purpose === 'point' && this.chosen)
            this.session.post({ type: 'point', ...this.address, ...(asset === null ? {} : { position }) });
    }
}
