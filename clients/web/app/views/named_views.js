// SPDX-License-Identifier: GPL-3.0-or-later
// The list of saved views: opening a view and, for users with the right role, saving, reordering and restoring earlier
// versions.
import { askInTime } from '../../core/http.js';
import { engineersOf, idFor, isEngineers, regained, textOf, viewOf } from '../../core/named_views.js';
import { dateTime, zoneClock } from '../../core/format.js';
import { refusalText } from '../../core/refusals.js';
import { maySendAll } from '../../core/session.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';

const PICTURE = { width: 160, height: 90 }, PICTURES_MS = 60000, MOST_PICTURES = 24;
const MAY = ['operator', 'engineer'];

export class NamedViews {
    constructor({ session, selection, modules, tell }) {
        Object.assign(this, { session, selection, modules, tell, pictures: new Map(), opened: null });
        this.list = make('ul', { id: 'named-list' });
        this.title = make('input', { id: 'named-title', maxlength: 60, placeholder: say('named.title'), 'aria-label': say('named.title') });
        this.save = make('form', { class: 'line', id: 'named-save', onsubmit: (event) => this.onSave(event) }, this.title,
            make('button', { type: 'submit' }, say('named.save')));
        this.element = make('fieldset', { id: 'named' }, make('legend', {}, say('named.legend')), this.list, this.save);
        byId('views').prepend(this.element);
        session.on('views', () => {
            this.show();
            if (this.isNew && session.named && this.own && this.own !== engineersOf(session))
                // the server has lost this session: requests the saved view's engineer-only parameters again
                this.regain(session.named);
            this.isNew = false;
        });
        session.on('welcome', () => {
            this.isNew = true; // true: the server has not yet sent the list of views since its newest `welcome`
            this.show();
        });
        session.on('params', () => this.watch());
        session.on('view_saved', ({ kept, why, refusal }) => (kept ? this.onKept() : tell(refusalText(why, refusal))));
        this.show();
    }

    get may() {
        return MAY.includes(this.session.role);
    }

    // --- opening

    // Opens a view. fly true: the camera flies there; false: it jumps.
    open(id, fly = true) {
        const view = this.session.views.find((one) => one.id === id);
        if (!view) {
            this.tell(say('named.unknown', { id }));
            return;
        }
        this.look(view.view, fly, id);
        if (view.wrong)
            this.tell(say('named.wrong', { why: refusalText(view.wrong, view.refusal) }));
        this.opened = id;
        this.mark();
    }

    // Requests the engineer-only parameters of a saved view, after a reload or a reconnect: this session may not send them
    // itself.
    regain(id) {
        const { session } = this;
        if (!session.views.some((view) => view.id === id)) {
            this.remember(null);
            this.tell(say('named.unknown', { id }));
            return;
        }
        this.remember(id);
        session.setParams(regained(session, id));
    }

    // id: the saved view that supplies the session's engineer-only parameters; null: none.
    remember(id) {
        this.session.named = id;
        this.own = null; // the engineer-only parameters as text, once the server has applied those of the saved view; null before that
    }

    // Forgets the saved view when its engineer-only parameters change, for example because the user shows another sensor group.
    watch() {
        const { session } = this;
        if (!session.named || this.isNew || session.params !== session.confirmed)
            return;
        const own = engineersOf(session);
        this.own ??= own;
        if (!own || own !== this.own)
            this.remember(null);
    }

    look(text, fly = true, id = undefined) {
        const { session, modules } = this, { camera, params, tag } = viewOf(session, text, id), found = session.model.tag(tag);
        this.remember(id && !maySendAll(session.role) && isEngineers(text) ? id : null);
        session.setParams(params);
        if (!fly) {
            modules.there('cameraController')?.land(); // ends a running flight
            session.setCamera(camera);
        }
        modules.use('commands', (commands) => {
            commands.selectTag(found);
            if (fly)
                modules.use('cameraController', (controller) => controller.flyTo(camera));
            else if (modules.awaited.has('cameraController'))
                // A flight begun earlier may still wait for the camera controller to load; land() ends that flight. The camera
                // stays, because the user may have moved it since.
                modules.use('cameraController', (controller) => controller.land());
        });
    }

    // --- saving

    onSave(event) {
        event.preventDefault();
        const title = this.title.value.trim();
        if (!title)
            return;
        const same = this.session.views.find((view) => view.title === title && !view.fixed);
        this.keep({ id: same?.id ?? idFor(title, this.session.views), title });
    }

    keep(fields) {
        this.session.post({ type: 'save_view', seq: ++this.session.toldSeq, view: textOf(this.session, this.selection.tag), ...fields });
    }

    onKept() {
        this.title.value = '';
        this.title.blur();
    }

    remove(id) {
        this.session.post({ type: 'remove_view', seq: ++this.session.toldSeq, id });
    }

    // --- the list

    show() {
        const { views } = this.session;
        this.save.hidden = !this.may;
        this.element.hidden = views.length === 0 && !this.may;
        const saved = views.filter(({ fixed }) => !fixed);
        this.list.replaceChildren(...views.map((view) => this.rowOf(view, saved)));
        this.mark();
        if (byId('views').classList.contains('open'))
            this.draw();
    }

    rowOf(view, saved) {
        const picture = make('img', { alt: '', width: PICTURE.width, height: PICTURE.height, loading: 'lazy' });
        const known = this.pictures.get(view.view);
        if (known)
            picture.src = known.url;
        const open = make('button', { type: 'button', class: 'named-open', onclick: () => this.open(view.id) }, picture,
            make('span', {}, view.title, view.wrong ? make('em', {}, refusalText(view.wrong, view.refusal)) : null));
        return make('li', { 'data-id': view.id }, open, !view.fixed && this.may ? this.moreOf(view, saved) : null);
    }

    moreOf(view, saved) {
        const at = saved.indexOf(view), { id, title, view: text } = view;
        const button = (name, onclick, disabled = false) => make('button', { type: 'button', onclick, disabled }, say(`named.${name}`));
        const move = (to) => () => this.keep({ id, title, view: text, at: to });
        const before = make('ol', { class: 'named-before' });
        const more = make('details', { ontoggle: () => more.open && this.showBefore(id, title, before) },
            make('summary', { 'aria-label': say('named.more', { title }) }, '…'),
            make('p', { class: 'note' }, this.when(view)),
            make('div', { class: 'buttons' }, button('update', () => this.keep({ id, title })), button('up', move(at - 1), at === 0),
                button('down', move(at + 1), at === saved.length - 1), button('remove', () => this.remove(id))), before);
        return more;
    }

    when({ by, time_us: us }) {
        return say('named.by', { who: by, time: dateTime(zoneClock(this.session.model.plant.time_zone), us / 1000) });
    }

    async showBefore(id, title, list) {
        try {
            const { list: views } = await askInTime('api/v1/views', { id }, this.session.token);
            const { before = [] } = views.find((view) => view.id === id) ?? {};
            const button = (text, onclick) => make('button', { type: 'button', onclick }, text);
            list.replaceChildren(...before.map((old) => make('li', {}, make('span', {}, this.when(old)),
                button(say('named.look'), () => this.look(old.view)),
                button(say('named.back'), () => this.keep({ id, title: old.title, view: old.view })))));
        } catch (error) {
            setText(list, error.message);
        }
    }

    mark() {
        for (const row of this.list.children)
            row.querySelector('.named-open').toggleAttribute('aria-current', row.dataset.id === this.opened);
    }

    // --- thumbnails of views, requested one after the other

    async draw() {
        if (this.drawing)
            return;
        this.drawing = true;
        for (const { view: text, id } of this.session.views.slice(0, MOST_PICTURES)) {
            const known = this.pictures.get(text);
            if (known && performance.now() - known.at < PICTURES_MS)
                continue;
            try {
                const blob = await askInTime('snapshot.png', { view: id, ...PICTURE }, this.session.token, 'blob');
                const url = URL.createObjectURL(blob);
                if (known)
                    URL.revokeObjectURL(known.url);
                this.pictures.set(text, { url, at: performance.now() });
                const image = [...this.list.children].find((row) => row.dataset.id === id)?.querySelector('img');
                if (image)
                    image.src = url;
            } catch {
                break; // stops requesting thumbnails after a failure; views without a thumbnail are still listed by title
            }
        }
        this.drawing = false;
    }
}
