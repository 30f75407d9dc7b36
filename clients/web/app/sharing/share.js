// SPDX-License-Identifier: GPL-3.0-or-later
// The share dialog: links to the current view, with a QR code. It also lists the sessions that follow this one, with buttons
// that hand the lead to one of the listed sessions.
import { shareLinks, SHARERS, shortLink } from '../../core/links.js';
import { followerNames, leaderName } from '../../core/people.js';
import { giveLead } from '../../core/requests.js';
import { say } from '../../core/words.js';
import { byId, make, makeSvg, setText } from '../common/dom.js';
import { fillSegments, markSegment } from '../common/choices.js';
import { closeButton } from '../common/widgets.js';

const QUIET_MODULES = 4; // width of the white margin around a QR code, in modules (dots), as scanners expect
let library; // QR code library, loaded on first use

export class Share {
    constructor({ session, selection }) {
        Object.assign(this, { session, selection, kind: 'view', asked: null });
        this.build();
        for (const name of ['followers', 'welcome'])
            session.on(name, () => this.count());
        this.count();
        session.on('view_shared', ({ seq, id, kept }) => kept && seq === this.asked && this.showView(shortLink(location, id)));
        for (const name of ['followers', 'following', 'params', 'camera', 'welcome', 'time'])
            session.on(name, () => this.dialog.open && this.show());
    }

    build() {
        this.kinds = make('fieldset', { class: 'segments', id: 'share-kind' }, make('legend', {}, say('share.what')));
        this.link = make('input', { id: 'share-link', readonly: true, 'aria-label': say('share.link'), onfocus: () => this.link.select() });
        this.copied = make('button', { type: 'button', id: 'share-copy', onclick: () => this.copy() }, say('share.copy'));
        this.code = make('div', { class: 'code', id: 'share-code' });
        this.note = make('p', { class: 'note', id: 'share-note' });
        this.people = make('section', { id: 'share-people', 'aria-label': say('share.people') });
        this.dialog = make('dialog', { class: 'help ask share', id: 'share', 'aria-labelledby': 'share-title' },
            make('h2', { id: 'share-title' }, say('share.title')), closeButton('close', () => this.dialog.close()), this.kinds,
            make('div', { class: 'line' }, this.link, this.copied), this.code, this.note, this.people);
        this.dialog.addEventListener('click', (event) => event.target === this.dialog && this.dialog.close());
        document.body.append(this.dialog);
    }

    // Shows the number of followers on the button that opens the dialog.
    count() {
        const { count } = this.session.followers;
        byId('share-open').toggleAttribute('data-count', count > 0);
        if (count > 0)
            byId('share-open').dataset.count = count;
    }

    open() {
        const { model } = this.session;
        if (!model)
            return;
        this.kind = this.selection.tag ? 'tag' : 'view';
        this.dialog.showModal();
        const { view } = shareLinks({ location, session: this.session, tag: this.selection.tag });
        this.asked = null;
        this.showView(view);
    }

    // Requests a short link to the view each time the user opens the dialog. Until the answer arrives, or without one, the long
    // link is shown.
    shorten() {
        if (this.asked !== null || !SHARERS.includes(this.session.role))
            return;
        this.asked = ++this.session.toldSeq;
        this.session.post({ type: 'share_view', seq: this.asked, view: new URL(this.view).hash.slice(1) });
    }

    // Shows a link to the view that was on the screen when the dialog was opened.
    showView(link) {
        this.view = link;
        this.show();
    }

    show() {
        const links = { ...shareLinks({ location, session: this.session, tag: this.selection.tag }), view: this.view };
        const kinds = Object.keys(links);
        if (!links[this.kind])
            this.kind = 'view';
        fillSegments(this.kinds, 'share-kind', kinds.map((kind) => [kind, say(`share.${kind}`), say(`share.${kind}.why`)]), (kind) => {
            this.kind = kind;
            this.show();
        });
        markSegment(this.kinds, this.kind);
        this.showLink(links[this.kind]);
        if (this.kind === 'view')
            this.shorten();
        this.showPeople();
    }

    showLink(link) {
        if (this.link.value === link)
            return;
        this.link.value = link;
        setText(this.copied, say('share.copy'));
        this.drawCode(link);
        const here = ['localhost', '127.0.0.1', '[::1]'].includes(location.hostname);
        setText(this.note, here ? say('share.local') : say(`share.${this.kind}.why`));
    }

    async drawCode(link) {
        library ??= await import('../../vendor/uqr.js').catch(() => null);
        const encode = library?.encode;
        if (this.link.value === link)
            this.code.replaceChildren(encode ? codeOf(encode, link) : say('share.nocode'));
    }

    async copy() {
        this.link.select();
        try {
            await navigator.clipboard.writeText(this.link.value);
        } catch {
            document.execCommand('copy'); // the clipboard API needs https
        }
        setText(this.copied, say('share.copied'));
    }

    showPeople() {
        const { followers, following } = this.session, names = followerNames(followers);
        const lead = (session) => () => giveLead(this.session, session);
        const button = (session, i) => make('button', { type: 'button', 'data-session': session, onclick: lead(session) },
            say('share.lead', { who: names[i] }));
        const words = following ? say('following.title', { who: leaderName(following) })
            : say(followers.count > 0 ? 'share.followers' : 'share.alone', { count: followers.count });
        this.people.replaceChildren(make('h3', {}, say('share.people')), make('p', {}, words),
            make('div', { class: 'leads' }, ...(following ? [make('button', { type: 'button', onclick: () => this.session.follow(null) },
                say('following.own'))] : followers.sessions.map(button))));
    }
}

function codeOf(encode, link) {
    const { data, size } = encode(link, { ecc: 'L', border: QUIET_MODULES });
    const path = data.flatMap((row, y) => row.map((dark, x) => (dark ? `M${x} ${y}h1v1h-1z` : ''))).join('');
    return makeSvg('svg', { viewBox: `0 0 ${size} ${size}`, role: 'img', 'aria-label': say('share.code'), 'shape-rendering': 'crispEdges' },
        makeSvg('rect', { width: size, height: size, fill: '#fff' }), makeSvg('path', { d: path, fill: '#000' }));
}
