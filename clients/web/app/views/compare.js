// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the plant at two times side by side: the right half of the window embeds this page without its controls, at another instant.
// Both halves have the same camera and parameters.
import { addressOf } from '../../core/address.js';
import { same } from '../../core/camera.js';
import { fieldInstant, fieldText } from '../../core/instant.js';
import { travel } from '../../core/requests.js';
import { PARAMS, sendable } from '../../core/session.js';
import { say } from '../../core/words.js';
import { fillSelect } from '../common/choices.js';
import { byId, icon, make, setText } from '../common/dom.js';
import { keepPanelsAbove } from './bar_top.js';

const AGO_S = [3600, 8 * 3600, 86400, 7 * 86400], FIRST_S = 86400, TICK_MS = 250, HOUR_S = 3600;
const SAME_US = 60e6; // largest deviation from the chosen span between the halves' instants
// names of the parameters that the right half gets
const SENT = [...PARAMS.filter((name) => !['split', 'backdrop'].includes(name)), 'sensor', 'sensors', 'baseline'];
const COLOUR_PARAMS = ['colormap', 'ramp_interval', 'range', 'scale', 'breaks', 'isolines'];
const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);

// Replaces differences from an unnamed baseline by values in default colours: such a baseline exists only in the left half's session.
function withoutUnnamedBaseline(params) {
    if (params.show !== 'difference' || params.baseline?.name)
        return params;
    const others = Object.entries(params).filter(([name]) => !COLOUR_PARAMS.includes(name));
    return { ...Object.fromEntries(others), show: 'value', baseline: null };
}

// Returns the parameters to send to the right half: all of SENT that the user's role may set; null: removed.
function paramsForRight(params, role) {
    const may = sendable({ ...withoutUnnamedBaseline(params), baseline: params.baseline?.name ?? null }, role);
    return Object.fromEntries(SENT.filter((name) => name in may).map((name) => [name, may[name] ?? null]));
}

// Returns the changed factors of single sensors; a sensor whose factors were removed has null.
const changedSensors = (now, sent) => Object.fromEntries([...new Set(Object.keys({ ...sent, ...now }))]
    .filter((tag) => !isSame(now?.[tag], sent?.[tag])).map((tag) => [tag, now?.[tag] ?? null]));

export class Compare {
    constructor(page) {
        Object.assign(this, { page, session: page.session, frame: null, atUs: null });
        const { session } = this;
        this.date = make('input', { type: 'datetime-local', step: 1, id: 'compare-date', 'aria-label': say('compare.at'),
            onchange: () => this.go(fieldInstant(this.date.value, this.zone)) });
        this.ago = make('select', { id: 'compare-ago', 'aria-label': say('compare.ago'), onchange: () => this.choose() });
        this.said = make('b', {});
        this.bar = make('section', { class: 'compare-bar', id: 'compare-bar', 'aria-label': say('compare.title') },
            make('span', {}, say('compare.right')), this.ago, this.date, this.said,
            make('button', { type: 'button', class: 'icon small', 'aria-label': say('compare.end'), title: say('compare.end'),
                onclick: () => this.toggle() }, icon('i-close')));
        keepPanelsAbove(this.bar);
        session.on('camera', () => this.tellCamera());
        session.on('params', () => this.tellParams());
        setInterval(() => this.tick(), TICK_MS);
    }

    get zone() {
        return this.session.model.plant.time_zone;
    }

    // The session of the page in the right half of the window; null until its first picture.
    get other() {
        const page = this.frame?.contentWindow?.plantcast;
        return page?.session.welcomed && page.session.picture ? page.session : null;
    }

    toggle() {
        if (this.frame)
            this.close();
        else
            this.open();
    }

    // Opens the right half at one day before the left half, or at the present if the left half shows the past.
    open() {
        const { session } = this, { atUs, fromUs } = session.time, now = session.clockUs();
        session.setParams({ split: null });
        this.atUs = atUs === null ? Math.max(now - FIRST_S * 1e6, fromUs ?? 0) : null;
        const choices = [['', say('compare.chosen')], ['now', say('time.now')], ...AGO_S.map((s) => [String(s),
            say('compare.earlier', { span: say(s < 86400 ? 'age.h' : 'age.d', { n: s / (s < 86400 ? HOUR_S : 86400) }) })])];
        fillSelect(this.ago, choices, this.atUs === null ? 'now' : '');
        const time = { atUs: this.atUs }, { camera, ownParams, named } = session, params = withoutUnnamedBaseline(session.params);
        const query = new URLSearchParams(location.search);
        query.set('theme', document.documentElement.dataset.theme);
        query.set('pane', 'compare');
        this.frame = make('iframe', { class: 'compare', src: `./?${query}${addressOf({ camera, params, time, ownParams, named }, null)}`,
            title: say('compare.title'), onload: () => this.furnish() });
        byId('viewport').after(make('div', { class: 'compare-half', id: 'compare-half' }, this.frame, this.bar));
        document.querySelector('.stage').classList.add('compares');
        byId('time-compare')?.setAttribute('aria-pressed', 'true');
        this.show();
    }

    close() {
        this.frame = null;
        byId('compare-half').remove();
        document.querySelector('.stage').classList.remove('compares');
        byId('time-compare')?.setAttribute('aria-pressed', 'false');
    }

    // Removes the controls of the embedded page.
    furnish() {
        const { contentDocument: inner } = this.frame;
        inner.body.classList.add('compared');
        inner.head.append(inner.importNode(make('link', { rel: 'stylesheet', href: new URL('compared.css', import.meta.url).href })));
    }

    // Connects the embedded page once it shows a picture. Its camera moves also move this page's camera; its keyboard commands
    // are carried out by this page.
    connect(page) {
        this.connected = page;
        page.session.on('camera', () => this.frame && this.session.setCamera(page.session.camera));
        // this page states refusals, because the embedded page has no room for messages
        page.session.on('error', (message) => this.frame && this.session.emit('error', message));
        Object.assign(page.handlers, { command: this.page.handlers.command, group: this.page.handlers.group });
        this.sentParams = null;
        this.tellCamera();
        this.tellParams();
    }

    tick() {
        const page = this.frame?.contentWindow?.plantcast;
        if (this.other && this.connected !== page)
            this.connect(page);
        if (this.frame)
            this.show();
    }

    tellCamera() {
        if (this.other && this.connected && !same(this.other.camera, this.session.camera))
            this.other.setCamera(this.session.camera);
    }

    // Sends the left half's changed parameters to the page in the right half.
    tellParams() {
        if (!this.other || !this.connected)
            return;
        if (this.session.params.split)
            return void this.close();
        const { params, role } = this.session, { show, baseline } = params;
        if (show === 'difference' && baseline && !baseline.time_us)
            return; // the server has not confirmed yet which readings the left half is compared with
        const now = paramsForRight(params, role), sent = this.sentParams ?? paramsForRight(this.other.params, role);
        const changed = Object.entries(now).filter(([name, value]) => !isSame(value, sent[name]));
        this.sentParams = now;
        if (changed.length > 0)
            this.other.setParams(Object.fromEntries(changed.map(([name, value]) =>
                [name, name === 'sensors' ? changedSensors(value, sent.sensors) : value])));
    }

    choose() {
        const now = this.session.clockUs(), left = this.session.time.atUs ?? now;
        if (this.ago.value)
            this.go(this.ago.value === 'now' ? null : left - Number(this.ago.value) * 1e6, this.ago.value);
    }

    // us: the instant that the right half of the window shows; null: the present.
    go(us, chosen = '') {
        this.atUs = us;
        this.ago.value = chosen;
        if (this.other)
            travel(this.other, us);
        this.show();
    }

    // Shows the right half's instant. Deselects a chosen span, such as "1 day earlier", once the left half has moved.
    show() {
        const leftUs = this.session.time.atUs ?? this.session.clockUs(), agoUs = Number(this.ago.value) * 1e6;
        if (agoUs > 0 && Math.abs(leftUs - agoUs - this.atUs) > SAME_US)
            this.ago.value = '';
        if (document.activeElement !== this.date)
            this.date.value = this.atUs === null ? '' : fieldText(this.atUs, this.zone);
        setText(this.said, this.atUs === null ? say('time.now') : '');
    }
}
