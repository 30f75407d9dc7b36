// SPDX-License-Identifier: GPL-3.0-or-later
// What tags were matched to (matches.csv of `plantcast match`), and what people decide about it.

export const FILTERS = ['all', 'sure', 'likely', 'none', 'unplaced'];

// Rows of cells of a CSV text; quoted cells may have commas, quotes and line feeds in them.
export function readCsv(text) {
    const rows = [];
    let row = [], cell = '', quoted = false;
    const end = () => { row.push(cell); cell = ''; };
    for (let i = 0; i < text.length; i++) {
        const c = text[i];
        if (quoted && c === '"' && text[i + 1] === '"')
            cell += text[++i];
        else if (c === '"' && (quoted || cell === ''))
            quoted = !quoted;
        else if (!quoted && c === ',')
            end();
        else if (!quoted && c === '\n') {
            end();
            rows.push(row);
            row = [];
        } else if (quoted || c !== '\r')
            cell += c;
    }
    if (cell !== '' || row.length > 0) {
        end();
        rows.push(row);
    }
    return rows;
}

// [{ tag, status, asset, reason, candidates }]; candidates: ids of assets, the proposed one first.
export function readMatches(text) {
    const [header = [], ...rows] = readCsv(text);
    const column = (name) => header.indexOf(name);
    const [tag, status, asset, reason, candidates] = ['Tag', 'Status', 'Asset', 'Reason', 'Candidates'].map(column);
    return rows.filter((row) => row[tag]).map((row) => ({
        tag: row[tag], status: row[status] || 'none', asset: row[asset] ?? '', reason: row[reason] ?? '',
        candidates: [...new Set([row[asset], ...(row[candidates] ?? '').split('|')])].filter(Boolean),
    }));
}

// Names that differ in their digits alone have one pattern.
export const patternOf = (tag) => tag.replace(/\d/g, '#');

// Matches, and decisions about them that were not saved yet.
export class Matches {
    // placed(tag): whether a place is known of the tag of that name; null: it is none of the plant's sensors.
    constructor(placed = () => null) {
        this.placed = placed;
        this.all = [];
        this.decisions = new Map(); // by tag: { status, asset }
    }

    set(all) {
        this.all = all;
        const known = new Set(all.map(({ tag }) => tag));
        this.decisions = new Map([...this.decisions].filter(([tag]) => known.has(tag)));
    }

    // As it will be once decisions are saved.
    of(match) {
        return this.decisions.get(match.tag) ?? match;
    }

    // What nobody decided, and could be several, is doubtful.
    kindOf(match) {
        const { status } = this.of(match), open = status === 'none' && !this.decisions.has(match.tag);
        return open && match.candidates.length > 0 ? 'likely' : status;
    }

    fits(match, filter) {
        const kind = this.kindOf(match);
        return filter === 'all' || (filter === 'unplaced' ? kind === 'sure' && this.placed(match.tag) === false : filter === kind);
    }

    counts() {
        return Object.fromEntries(FILTERS.map((filter) => [filter, this.all.filter((match) => this.fits(match, filter)).length]));
    }

    // Those whose tag, asset or reason has all words of a text.
    rows(filter, text = '') {
        const words = text.toLowerCase().split(/\s+/).filter(Boolean);
        return this.all.filter((match) => {
            const said = `${match.tag} ${this.of(match).asset} ${match.reason}`.toLowerCase();
            return this.fits(match, filter) && words.every((word) => said.includes(word));
        });
    }

    // asset: '': it is on none. What is so already needs no decision.
    decide(match, asset) {
        const status = asset ? 'sure' : 'none', isOpen = match.status === 'none' && match.candidates.length > 0;
        if (match.status === status && match.asset === asset && !isOpen)
            this.decisions.delete(match.tag);
        else
            this.decisions.set(match.tag, { status, asset });
    }

    // Those that are doubtful, of the same pattern, and can be accepted at once, as [match, asset]: on what is proposed for each, or on
    // what was decided for another of the pattern where it may be that too.
    alike({ tag }) {
        const pattern = patternOf(tag), decided = [...this.decisions].filter(([name, { asset }]) => asset && patternOf(name) === pattern);
        return this.all.filter((one) => patternOf(one.tag) === pattern && this.kindOf(one) === 'likely').map((one) => [one, one.asset ||
            decided.findLast(([, { asset }]) => one.candidates.includes(asset))?.[1].asset]).filter(([, asset]) => asset);
    }

    // Of the decisions that were saved, those made anew since stay.
    settle(decided) {
        for (const [tag, decision] of decided)
            if (this.decisions.get(tag) === decision)
                this.decisions.delete(tag);
    }

    // What is sent to be saved.
    text() {
        const cell = (said) => (/[",;\t\r\n]|^ /.test(said) ? `"${said.replaceAll('"', '""')}"` : said);
        const rows = [...this.decisions].map(([tag, { status, asset }]) => [tag, status, asset].map(cell).join(','));
        return ['Tag,Status,Asset', ...rows, ''].join('\n');
    }
}

// How wide, deep and high a plant is, in metres, if its numbers are of other units than they were taken for.
const METRES = { m: 1, mm: 0.001, cm: 0.01, in: 0.0254, ft: 0.3048 };
export const sizeOf = ({ min, max }, times = 1) => max.map((x, i) => (x - min[i]) * times);
export const timesOf = (from, to) => (METRES[to] && METRES[from] ? METRES[to] / METRES[from] : 1);
