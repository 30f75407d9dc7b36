// SPDX-License-Identifier: GPL-3.0-or-later
// Loop checks, tag by tag and device by device: shows which reading changed when a technician forced a transmitter, and whether
// the reading has the expected value.
import { decimalsOf, numberText, unitText } from '../../core/format.js';
import { readExpected, LoopCheckSession } from '../../core/loop_check.js';
import { ask } from '../../core/http.js';
import { refusalText } from '../../core/refusals.js';
import { tellAsEngineer } from '../../core/requests.js';
import { say } from '../../core/words.js';
import { make, setText } from '../common/dom.js';
import { fill } from '../common/widgets.js';

export class LoopCheck {
    constructor({ session, showTag, refresh }) {
        Object.assign(this, { session, showTag, refresh });
        this.loopCheck = new LoopCheckSession();
        this.tag = null;             // name of the tag that is being checked; null: none
        this.stirred = null;         // name of the tag whose reading changed most since the check started; null: none
        this.expected = new Map();   // tag -> expected value, read from the user's CSV file
        this.build();
        session.on('tags', () => this.onTags());
        session.on('proofs', () => this.show());
        session.on('proved', (message) => this.onProved(message));
        session.on('welcome', () => {
            this.loopCheck = new LoopCheckSession();
            this.stirred = null;
            this.show();
        });
    }

    build() {
        const button = (key, onclick) => make('button', { type: 'button', onclick }, say(key));
        const field = (key, attributes) => {
            const input = make('input', attributes);
            return [input, make('label', {}, say(key), input)];
        };
        this.device = make('select', { 'aria-label': say('eng.device'), onchange: () => this.show() });
        this.count = make('p', { class: 'count', role: 'status' });
        this.list = make('ul', { class: 'tags' });
        const [wanted, wantedLabel] = field('eng.expected', { type: 'text', inputmode: 'decimal', size: 8 });
        const [tolerance, toleranceLabel] = field('eng.tolerance', { type: 'text', inputmode: 'decimal', size: 6 });
        const [remark, remarkLabel] = field('eng.remark', { type: 'text', maxlength: 60 });
        Object.assign(this, { wanted, tolerance, remark });
        this.now = make('output');
        this.watch = button('eng.watch', () => this.arm());
        this.words = make('p', { class: 'note', role: 'status' });
        this.result = make('p', { class: 'note', role: 'status' });
        this.judge = make('div', { class: 'judge' }, this.title = make('h3'), this.now, make('div', { class: 'line' }, this.watch),
            this.words,
            make('div', { class: 'line' }, wantedLabel, toleranceLabel), remarkLabel,
            make('div', { class: 'line' }, button('eng.compare', () => this.send(false)), button('eng.fails', () => this.send(true))));
        this.file = make('input', { type: 'file', accept: '.csv,text/csv', hidden: true, onchange: () => this.readFile() });
        this.element = make('div', { class: 'part' }, make('label', { class: 'device' }, say('eng.device'), this.device),
            this.count, this.list,
            this.judge, this.result, make('div', { class: 'line' }, button('eng.csv', () => this.file.click()), this.file,
                button('eng.export', () => this.exportAll())));
    }

    // Returns the tags of the chosen device, in the order of the tag list.
    get tags() {
        return this.session.model.tags.filter(({ source }) => source === this.device.value);
    }

    stateOf(tag) {
        return this.session.model.proofs.get(tag.index)?.state ?? 'none';
    }

    text(tag, value) {
        const { model } = this.session, group = model.group(tag.group);
        return `${numberText(value, decimalsOf(group, value) + (group ? 1 : 0))} ${unitText(tag.unit || group?.unit || '')}`.trim();
    }

    show() {
        const { model } = this.session;
        if (!model || this.element.offsetParent === null)
            return;
        const sources = [...new Set(model.tags.map(({ source }) => source).filter(Boolean))], chosen = this.device.value;
        fill(this.device, ...sources.map((source) => make('option', { value: source, selected: source === chosen }, source)));
        const { tags } = this, done = tags.filter((tag) => this.stateOf(tag) === 'pass').length;
        setText(this.count, say('eng.proven', { done, count: tags.length }));
        fill(this.list, ...tags.map((tag) => {
            const state = this.stateOf(tag);
            return make('li', {}, make('button', {
                type: 'button', 'aria-pressed': String(tag.name === this.tag), onclick: () => this.choose(tag),
            }, make('b', {}, tag.name), ' ', tag.description ?? '', make('i', { class: state }, say(`proof.${state}`))));
        }));
        this.judge.hidden = !this.tag;
        this.showNow();
    }

    showNow() {
        const tag = this.session.model.tag(this.tag);
        if (!tag)
            return;
        const { value } = this.session.model.readings[tag.index];
        setText(this.title, tag.name);
        setText(this.now, value === null ? say('novalue') : say('eng.now', { value: this.text(tag, value) }));
    }

    choose(tag) {
        this.tag = tag.name;
        this.loopCheck.disarm();
        this.stirred = null;
        setText(this.words, '');
        const of = this.expected.get(tag.name);
        this.wanted.value = of ? String(of.expected) : '';
        this.tolerance.value = of ? String(of.tolerance) : this.tolerance.value || String(this.spanOf(tag.index) / 200);
        this.remark.value = '';
        if (tag.position)
            this.showTag(tag);
        this.show();
        for (const part of [this.list.querySelector('[aria-pressed="true"]'), this.judge])
            part?.scrollIntoView({ block: 'nearest' });
    }

    spanOf(index) {
        const { model } = this.session, group = model.group(model.tags[index].group);
        return group ? group.max - group.min : Math.max(1, Math.abs(model.readings[index].value ?? 1));
    }

    arm() {
        this.loopCheck.arm();
        this.stirred = null;
        setText(this.words, `${say('eng.watching')} ${say('eng.still')}`);
        this.refresh();
    }

    onTags() {
        const { model } = this.session;
        if (this.session.time.atUs !== null)
            return; // ignores readings of the past, because they do not come from the transmitter that is forced now
        this.loopCheck.observe(model.readings.map(({ value, quality }) => (quality === 'bad' ? null : value)));
        if (this.element.offsetParent === null)
            return;
        this.showNow();
        const found = this.loopCheck.stirred((index) => this.spanOf(index));
        const name = found ? model.tags[found.index].name : null;
        if (!found)
            return;
        const by = this.text(model.tags[found.index], found.by);
        setText(this.words, [say('eng.moved', { tag: name, by }), name === this.tag ? ''
            : say('eng.swapped', { tag: name, wanted: this.tag })]
            .join(' ').trim());
        if (name !== this.stirred) {
            this.stirred = name;
            this.refresh();
        }
    }

    // Sends the result of a check to the server. A decimal comma is accepted as a decimal point.
    send(fail) {
        const read = (input) => (input.value.trim() ? Number(input.value.replace(',', '.')) : NaN);
        const expected = read(this.wanted), tolerance = read(this.tolerance);
        const wrong = [[this.wanted, Number.isFinite(expected)], [this.tolerance, tolerance >= 0]].filter(([, good]) => !good);
        for (const input of [this.wanted, this.tolerance])
            input.setAttribute('aria-invalid', String(wrong.some(([one]) => one === input)));
        if (wrong.length > 0)
            wrong[0][0].focus();
        else
            tellAsEngineer(this.session, 'prove', { tag: this.tag, expected, tolerance, fail, ...(this.remark.value
                ? { remark: this.remark.value } : {}) });
    }

    // Shows a check's result and selects the next tag that has not passed.
    onProved({ tag, passed, value, why, refusal }) {
        const { model } = this.session, { tags } = this, at = tags.findIndex(({ name }) => name === tag);
        const text = value === null ? say('novalue') : this.text(model.tag(tag), value);
        const because = `${refusalText(why, refusal)} (${text})`;
        setText(this.result, passed ? say('eng.passed', { tag, value: text }) : say('eng.failed', { tag, why: because }));
        const next = [...tags.slice(at + 1), ...tags.slice(0, at)].find((one) => this.stateOf(one) !== 'pass');
        if (passed && next)
            this.choose(next);
    }

    async readFile() {
        const [file] = this.file.files, list = file ? readExpected(await file.text()) : undefined;
        this.file.value = '';
        if (list === undefined)
            return;
        setText(this.result, list ? say('eng.csv.note', { count: list.size }) : say('eng.csv.bad'));
        this.expected = list ?? this.expected;
        const tag = this.session.model.tag(this.tag);
        if (tag)
            this.choose(tag);
    }

    async exportAll() {
        try {
            const answer = await ask('api/v1/proofs', {}, this.session.token);
            const link = make('a', { href: URL.createObjectURL(await answer.blob()), download: 'proofs.csv' });
            link.click();
            setTimeout(() => URL.revokeObjectURL(link.href), 10000);
        } catch (error) {
            setText(this.result, error.message);
        }
    }
}
