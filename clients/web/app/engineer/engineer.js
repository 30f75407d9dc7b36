// SPDX-License-Identifier: GPL-3.0-or-later
// The engineering panel: placing sensors, loop checks (finding the tag whose transmitter a technician forces), and settings of
// the interpolation between sensors. Loaded when it is first opened.
import { say } from '../../core/words.js';
import { ACCENT } from '../viewport/overlay.js';
import { byId, make } from '../common/dom.js';
import { Method } from './field_settings.js';
import { closeButton } from '../common/widgets.js';
import { Placing } from './placing.js';
import { LoopCheck } from './loop_check.js';

export class Engineer {
    constructor(page) {
        this.page = page;
        this.button = byId('engineer-toggle');
        this.parts = { place: new Placing(page), prove: new LoopCheck(page), method: new Method(page) };
        const choice = (name) => make('label', {},
            make('input', { type: 'radio', name: 'engineer-part', value: name, checked: name === 'place',
                onchange: () => this.choose(name) }),
            make('span', {}, say(`eng.${name}`)));
        this.element = make('section', { class: 'engineer', id: 'engineer', hidden: true, 'aria-label': say('eng.title') },
            make('header', {}, make('h2', {}, say('eng.title')), closeButton('eng.close', () => this.toggle())),
            make('fieldset', { class: 'segments' }, make('legend', {}, say('eng.what')), choice('place'), choice('prove'),
                choice('method')),
            ...Object.values(this.parts).map(({ element }) => element));
        byId('viewport').parentElement.append(this.element);
        this.choose('place');
        page.overlay.drawTried = (tag) => this.mark(tag);
        page.overlay.isMarked = (tag) => this.isMarked(tag);
        page.session.on('welcome', () => page.session.role !== 'engineer' && this.close());
    }

    get open() {
        return !this.element.hidden;
    }

    close() {
        if (this.open)
            this.toggle();
    }

    toggle() {
        const [alarms, imports] = ['alarms', 'import'].map((name) => this.page.modules.there(name));
        if (!this.open && alarms?.open)
            alarms.setOpen(false); // closes the alarm list, which shares this panel's space
        if (!this.open)
            imports?.close();
        this.element.hidden = this.open;
        this.button.setAttribute('aria-expanded', this.open);
        (this.open ? this.element.querySelector('input') : this.button).focus();
        this.parts[this.part].show();
        this.page.refresh();
    }

    // Opens the tab named `part`, as if the user had pressed its button.
    take(part) {
        this.element.querySelector(`input[value="${part}"]`).click();
    }

    choose(part) {
        this.part = part;
        for (const [name, { element }] of Object.entries(this.parts))
            element.hidden = name !== part;
        this.parts[part].show();
        this.page.refresh();
    }

    // Called when the selection changes.
    onSelection() {
        if (this.part === 'method')
            this.parts.method.show();
    }

    takesClick(x, y) {
        return this.open && this.part === 'place' && this.parts.place.takesClick(x, y);
    }

    isAt(part, name, tag) {
        return this.open && this.part === part && this.parts[part][name] === tag.name;
    }

    // Returns true if the form that confirms the assumed positions of many sensors (accepting.js) is open and its filter
    // selects the tag.
    isAccepted(tag) {
        return this.open && this.part === 'place' && this.parts.place.accepting.names.has(tag.name);
    }

    // Returns true if mark() draws rings around the tag's marker. Such a marker is drawn even where many markers overlap.
    isMarked(tag) {
        return this.page.session.model.placed.has(tag.name) || this.isAccepted(tag) || this.isAt('place', 'tag', tag) ||
            this.isAt('prove', 'stirred', tag);
    }

    // Draws rings around a tag's marker: dashed if its position is an unsaved draft, blue if the form accepting.js would
    // confirm its assumed position, solid if the tag is selected, double if its reading changed during a loop check.
    mark(tag) {
        const c = this.page.overlay.context, moved = this.page.session.model.placed.has(tag.name);
        const stirred = this.isAt('prove', 'stirred', tag);
        const ring = (radius, dash, width, colour = '#1d252d') => {
            c.beginPath();
            c.arc(0, 0, radius, 0, 2 * Math.PI);
            c.lineWidth = width;
            c.setLineDash(dash);
            c.strokeStyle = colour;
            c.stroke();
            c.setLineDash([]);
        };
        if (this.isAccepted(tag))
            ring(8, [], 2.5, ACCENT);
        if (moved)
            ring(13, [4, 3], 2);
        if (this.isAt('place', 'tag', tag))
            ring(9, [], 2.5);
        if (stirred)
            [12, 16].forEach((radius) => ring(radius, [], 2.5));
    }
}
