// SPDX-License-Identifier: GPL-3.0-or-later
// The import panel: model and tag files, the plant's size next to a person's, and the matches of the tags.
import { numberText } from '../../core/format.js';
import { sizeOf, timesOf } from '../../core/matches.js';
import { standbyText } from '../../core/standby.js';
import { say } from '../../core/words.js';
import { byId, make, setText } from '../common/dom.js';
import { closeButton, fill } from '../common/widgets.js';
import { Exports } from './exports.js';
import { Highlights } from './highlights.js';
import { Report } from './report.js';
import { Source } from './source.js';
import { TagTable } from './tag_table.js';

const UNITS = ['', 'm', 'mm', 'cm', 'in', 'ft'], AXES = ['', 'y', 'z'];
// Character encodings of model and tag files that the import panel offers. The command line accepts others, too (`plantcast
// match --encoding`).
const ENCODINGS = ['UTF-8', 'GB18030', 'Big5', 'Shift-JIS', 'EUC-JP', 'EUC-KR', 'Windows-1250', 'Windows-1251', 'Windows-1252',
    'Windows-1253', 'Windows-1254', 'KOI8-R', 'CP866', 'CP850', 'UTF-16LE', 'UTF-16BE'];
const PLACEHOLDER = 'person'; // id of the only asset of a new plant, before the user has imported a model

const choice = (key, values, onchange) => {
    const select = make('select', { onchange }, ...values.map((value) =>
        make('option', { value }, say(`import.${key}.${value || 'said'}`))));
    return [make('label', { class: 'choice' }, make('span', {}, say(`import.${key}`)), select), select];
};
const button = (key, onclick, attributes = {}) => make('button', { type: 'button', onclick, ...attributes }, say(key));
const megabytes = (bytes) => say('import.bytes', { mb: numberText(bytes / 1e6, bytes < 1e7 ? 2 : 0) });
// Removes the exports folder's path from output of the server's programs.
const plain = (text) => text.replace(/\S*\/exports\//g, '');

// Returns as text each file's encoding, parsed from program output such as "tags.csv: read as Windows-1251", and the second
// most likely encoding if the output names one.
const readAs = (said) => [...new Set([...plain(said).matchAll(/^(.*): read as ([^,\n]+)(?:, but it may be ([^:\n]+))?/gm)]
    .map(([, file, name, other]) => say(other ? 'import.encoding.unsure' : 'import.encoding.read', { file, name, other })))].join(' · ');

export class Import {
    constructor(page) {
        this.page = page;
        this.button = byId('import-toggle');
        this.highlights = new Highlights(page);
        this.exports = new Exports({ session: page.session, onState: (state) => this.show(state),
            onEnd: (state, sent) => this.onEnd(state, sent) });
        this.table = new TagTable({ page, highlights: this.highlights, save: () => this.decide() });
        this.source = new Source({ session: page.session, connect: (source) => this.try(() => this.exports.order('/source', source)) });
        this.report = new Report({ answer: (unit) => this.try(() => this.read({ what: 'anew', mesh_units: unit })) });
        this.build();
        page.session.greeted(() => this.greet());
        page.session.on('status', () => this.showStandby());
        for (const name of ['dragover', 'drop'])
            document.addEventListener(name, (event) => this.drag(event));
    }

    build() {
        this.pick = make('input', { type: 'file', id: 'import-pick', multiple: true, class: 'unseen', onchange: () => {
            this.upload([...this.pick.files]);
            this.pick.value = '';
        } });
        this.drop = make('label', { class: 'drop' }, make('b', {}, say('import.drop')), make('i', {}, say('import.more')),
            make('span', {}, say('import.formats')), this.pick);
        this.files = make('ul', { class: 'files' });
        this.filesTitle = make('summary', {});
        this.phase = make('p', { class: 'phase', role: 'status' });
        this.standby = make('p', { class: 'quiet', role: 'status' });
        this.wrong = make('p', { class: 'wrong', role: 'alert' });
        this.cancel = button('cancel', () => this.try(async () => {
            await this.exports.post('/cancel');
            await this.exports.look();
        }));
        this.again = button('import.again', () => this.try(() => this.read()));
        this.said = make('pre', { tabindex: '0' });
        this.details = make('details', {}, make('summary', {}, say('import.details')), this.said);
        this.readAs = make('p', { class: 'quiet' });
        this.encoding = make('select', { onchange: () => this.try(() => this.read({ what: 'anew' })) }, make('option', { value: '' },
            say('import.encoding.found')), ...ENCODINGS.map((value) => make('option', { value }, value)));
        this.encodingLine = make('label', { class: 'choice' }, make('span', {}, say('import.encoding')), this.encoding);
        this.filesFold = make('details', { open: true }, this.filesTitle, this.files, this.readAs, this.encodingLine, this.details);
        this.size = make('b', { class: 'size' });
        const [units, unitsSelect] = choice('units', UNITS, () => this.showSize());
        const [up, upSelect] = choice('up', AXES, () => this.showSize());
        Object.assign(this, { units: unitsSelect, up: upSelect });
        this.apply = button('import.apply', () => this.try(() => this.read({ what: 'anew' })));
        this.person = make('input', { type: 'checkbox', checked: true, onchange: () => this.showPerson() });
        this.measures = make('details', { class: 'measures' }, make('summary', {}, say('import.size'), ' ', this.size),
            make('div', { class: 'line' }, units, up, this.apply),
            make('label', { class: 'check' }, this.person, say('import.person')), make('p', { class: 'quiet' }, say('import.units.note')));
        this.element = make('section', { class: 'import', id: 'import', hidden: true, 'aria-label': say('bar.import') },
            make('header', {}, make('h2', {}, say('bar.import')), closeButton('close', () => this.toggle())),
            make('div', { class: 'part' },
                make('section', {}, this.drop, this.filesFold,
                    make('div', { class: 'line' }, this.phase, this.cancel, this.again), this.wrong, this.standby),
                this.report.element, this.measures, this.source.element, this.table.element));
        byId('viewport').parentElement.append(this.element);
        // a drop zone for files, which covers the picture of a plant that has no model yet
        this.zone = make('label', { class: 'drop-zone', for: this.pick.id, hidden: true }, make('span', { class: 'frame' },
            make('b', {}, say('import.drop')), make('span', {}, say('import.formats'))));
        byId('viewport').append(this.zone);
    }

    get open() {
        return !this.element.hidden;
    }

    close() {
        if (this.open)
            this.toggle();
    }

    toggle() {
        for (const name of ['alarms', 'engineer']) { // closes alarm list and engineering panel, which share this panel's space
            const other = this.page.modules.there(name);
            if (!this.open && other?.open)
                other.toggle();
        }
        this.element.hidden = this.open;
        this.button.setAttribute('aria-expanded', this.open);
        this.highlights.show({ assets: [] });
        this.showPerson();
        if (this.open) {
            this.exports.look();
            this.table.showAgain();
            this.table.refresh();
        }
        (this.open ? this.pick : this.button).focus({ preventScroll: true });
    }

    // Updates the panel for the plant that the server has loaded, which may be another one than before.
    greet() {
        const { assets } = this.page.session.model;
        this.isNew = assets.length === 1 && assets[0].id === PLACEHOLDER;
        this.filesFold.open = this.isNew;
        this.element.classList.toggle('new', this.isNew);
        this.zone.hidden = !this.isNew;
        if (this.isNew && !this.open)
            this.toggle();
        this.showSize();
        this.showStandby();
        this.exports.look();
        this.bringMatches();
        this.bringReport();
    }

    showStandby() {
        setText(this.standby, standbyText(this.page.session.model.standby));
    }

    async bringReport() {
        try {
            this.report.set((await this.exports.report()).models);
        } catch (error) {
            if (error.status === 404) // 404: the server has not read a model yet; other errors leave the report unchanged
                this.report.set([]);
        }
    }

    async bringMatches() {
        try {
            this.table.set(this.isNew ? '' : await this.exports.matches());
        } catch (error) {
            if (error.status === 404) // 404: no tags were matched yet; other errors leave the list of matches unchanged
                this.table.set('');
        }
    }

    // --- files

    drag(event) {
        if (![...event.dataTransfer?.types ?? []].includes('Files'))
            return;
        event.preventDefault();
        if (event.type !== 'drop')
            return;
        if (!this.open)
            this.toggle();
        this.upload([...event.dataTransfer.files]);
    }

    // Calls f, which carries out a user's request, and shows its error if it fails.
    async try(f) {
        setText(this.wrong, '');
        try {
            await f();
        } catch (error) {
            setText(this.wrong, error.message);
        }
    }

    upload(files) {
        return files.length > 0 && this.try(async () => {
            for (const file of files) {
                setText(this.phase, say('import.uploading', { name: file.name }));
                await this.exports.post('/upload', { name: file.name }, file);
            }
            setText(this.phase, '');
            await this.exports.look();
            const { files: all } = this.exports.state, names = files.map(({ name }) => name);
            const onlyTags = all.every(({ name, kind }) => kind === 'tags' || !names.includes(name));
            if (all.some(({ kind }) => kind === 'model'))
                await this.read(onlyTags && !this.isNew ? { what: 'tags' } : {});
        });
    }

    read(query = {}) {
        return this.exports.order('/run', { units: this.units.value, up: this.up.value, encoding: this.encoding.value,
            mesh_units: this.known?.mesh_units ?? '', ...query });
    }

    decide() {
        const { matches } = this.table;
        this.decided = new Map(matches.decisions);
        return this.try(() => this.exports.order('/decide', {}, matches.text()));
    }

    show(state) {
        const busy = state.phase !== 'idle';
        fill(this.files, ...state.files.map(({ name, kind, bytes }) => make('li', {}, make('b', {}, name),
            make('span', {}, `${say(`import.kind.${kind}`)} · ${megabytes(bytes)}`),
            closeButton('import.remove', () => this.try(async () => {
                await this.exports.post('/remove', { name });
                await this.exports.look();
            })))));
        setText(this.filesTitle, say('import.files', { count: state.files.length }));
        this.filesFold.hidden = state.files.length === 0;
        setText(this.phase, busy ? say(`import.phase.${state.phase}`) : state.number > 0 && !state.failed ? say('import.done') : '');
        this.element.classList.toggle('busy', busy);
        this.cancel.hidden = !busy;
        this.again.hidden = busy || !state.files.some(({ kind }) => kind === 'model');
        this.apply.disabled = this.again.hidden;
        this.source.element.hidden = this.isNew || !state.files.some(({ kind }) => kind === 'tags');
        this.source.set(state.source, busy);
        if (!busy)
            this.takeUnits(state);
        this.table.setBusy(busy);
        setText(this.said, plain(state.said));
        this.encoding.disabled = busy;
        setText(this.readAs, readAs(state.said));
        this.details.hidden = state.said === '';
        if (!busy)
            setText(this.wrong, plain(state.failed ?? ''));
    }

    // Shows the settings with which the server read the current models. Choices that the user has not applied yet stay until the
    // server reads the models with other settings.
    takeUnits({ units, up, encoding, mesh_units }) {
        if (this.known?.encoding !== encoding) {
            if (encoding && ![...this.encoding.options].some(({ value }) => value === encoding))
                this.encoding.append(make('option', { value: encoding }, encoding));
            this.encoding.value = encoding;
        }
        if (this.known?.units === units && this.known?.up === up && this.known?.encoding === encoding &&
            this.known?.mesh_units === mesh_units)
            return;
        this.known = { units, up, encoding, mesh_units };
        this.units.value = units;
        this.up.value = up;
        this.showSize();
    }

    onEnd(state, sent) {
        this.showSize();
        if (!state.failed && sent?.path === '/decide')
            this.table.settle(this.decided);
        this.bringMatches();
        this.bringReport();
    }

    // --- size of the plant

    showSize() {
        const { model } = this.page.session;
        this.measures.hidden = !model || this.isNew;
        if (!model)
            return;
        const times = this.units.value ? timesOf(this.known?.units || 'm', this.units.value) : 1;
        const sides = sizeOf(model.plant.bounds, times).map((m) => numberText(m, m < 10 ? 2 : m < 1000 ? 1 : 0));
        const [wide, deep, high] = sides;
        const size = say('import.metres', { wide, deep, high }), { outside } = model.plant;
        setText(this.size, outside ? `${size} ${say('import.outside', outside)}` : size);
        this.showPerson();
    }

    showPerson() {
        this.highlights.show({ person: this.open && this.person.checked && !this.isNew });
    }
}
