// SPDX-License-Identifier: GPL-3.0-or-later
// Proposed matches of tags to equipment (matches.csv of `plantcast match`), and the user's decisions about them.

export const FILTERS = ['all', 'sure', 'likely', 'none', 'unplaced'];

// Returns the rows of a CSV text as lists of cells; quoted cells may contain commas, quotes and line feeds.
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

// Returns [{ tag, status, asset, reason, candidates }]; candidates: ids of assets, the proposed one first.
export function readMatches(text) {
    const [header = [], ...rows] = readCsv(text);
    const column = (name) => header.indexOf(name);
    const [tag, status, asset, reason, candidates] = ['Tag', 'Status', 'Asset', 'Reason', 'Candidates'].map(column);
    return rows.filter((row) => row[tag]).map((row) => ({
        tag: row[tag], status: row[status] || 'none', asset: row[asset] ?? '', reason: row[reason] ?? '',
        candidates: [...new Set([row[asset], ...(row[candidates] ?? '').split('|')])].filter(Boolean),
    }));
}

// Returns the pattern of a tag name: the name with # for each digit. A decision about one tag is also offered for tags of the
// same pattern.
export const patternOf = (tag) => tag.replace(/\d/g, '#');

// The matches, and decisions about them that are not saved yet.
export class Matches {
    // placed(tag) returns whether the tag's position is known; null: the plant has no sensor of that name.
    constructor(placed = () => null) {
        this.placed = placed;
        this.all = [];
        this.decisions = new Map(); // unsaved decisions: tag -> { status, asset }
    }

    set(all) {
        this.all = all;
        const known = new Set(all.map(({ tag }) => tag));
        this.decisions = new Map([...this.decisions].filter(([tag]) => known.has(tag)));
    }

    // Returns the match with the user's unsaved decision applied.
    of(match) {
        return this.decisions.get(match.tag) ?? match;
    }

    // Returns the kind of a match for the filter: its status, but 'likely' if the user has not decided about it and it has candidates.
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

    // Returns the matches that pass the filter and whose tag, asset or reason contains all words of `text`.
    rows(filter, text = '') {
        const words = text.toLowerCase().split(/\s+/).filter(Boolean);
        return this.all.filter((match) => {
            const said = `${match.tag} ${this.of(match).asset} ${match.reason}`.toLowerCase();
            return this.fits(match, filter) && words.every((word) => said.includes(word));
        });
    }

    // Records the user's decision about a match. asset '': the tag is on no equipment. A decision that equals the proposal is dropped.
    decide(match, asset) {
        const status = asset ? 'sure' : 'none', isOpen = match.status === 'none' && match.candidates.length > 0;
        if (match.status === status && match.asset === asset && !isOpen)
            this.decisions.delete(match.tag);
        else
            this.decisions.set(match.tag, { status, asset });
    }

    // Returns the undecided matches of tags with the same pattern, which the user can accept together, as [match, asset].
    // asset: the proposed one, or the one that the user chose for another tag of the pattern, if it is a candidate.
    alike({ tag }) {
        const pattern = patternOf(tag), decided = [...this.decisions].filter(([name, { asset }]) => asset && patternOf(name) === pattern);
        return this.all.filter((one) => patternOf(one.tag) === pattern && this.kindOf(one) === 'likely').map((one) => [one, one.asset ||
            decided.findLast(([, { asset }]) => one.candidates.includes(asset))?.[1].asset]).filter(([, asset]) => asset);
    }

    // Drops the decisions that the server has saved, unless the user has changed them since they were sent.
    settle(decided) {
        for (const [tag, decision] of decided)
            if (this.decisions.get(tag) === decision)
                this.decisions.delete(tag);
    }

    // Returns the unsaved decisions as CSV text.
    text() {
        const cell = (said) => (/[",;\t\r\n]|^ /.test(said) ? `"${said.replaceAll('"', '""')}"` : said);
        const rows = [...this.decisions].map(([tag, { status, asset }]) => [tag, status, asset].map(cell).join(','));
        return ['Tag,Status,Asset', ...rows, ''].join('\n');
    }
}

// sizeOf() returns the plant's width, depth and height in metres, multiplied by `times`. timesOf() returns that factor for a
// model whose unit was assumed to be `from` but is `to`.
const METRES = { m: 1, mm: 0.001, cm: 0.01, in: 0.0254, ft: 0.3048 };
export const sizeOf = ({ min, max }, times = 1) => max.map((x, i) => (x - min[i]) * times);
export const timesOf = (from, to) => (METRES[to] && METRES[from] ? METRES[to] / METRES[from] : 1);
