// SPDX-License-Identifier: GPL-3.0-or-later
// Loop check: finds the tag that moved when a transmitter was forced, by the largest change since arming compared with each tag's noise.

const KEEP = 0.9;        // weight of the previous noise estimate at each new value
const FLOOR = 0.002;     // fraction of a tag's span; smaller changes are ignored
const LEAST_RATIO = 8;   // minimum change, as a multiple of the tag's noise

export class LoopCheckSession {
    constructor() {
        this.noise = new Map(); // tag index -> average change from one value to the next: the tag's noise
        this.last = new Map();
        this.base = null;       // tag index -> value when the check was armed; null: not armed
    }

    // values: by tag index, number or null (no usable reading).
    observe(values) {
        values.forEach((value, index) => {
            if (value === null)
                return;
            const before = this.last.get(index);
            this.last.set(index, value);
            if (before === undefined || this.base)
                return; // once armed, changes count as signal, not noise
            const step = Math.abs(value - before), known = this.noise.get(index);
            this.noise.set(index, known === undefined ? step : Math.max(known * KEEP, KEEP * known + (1 - KEEP) * step, step / 2));
        });
    }

    arm() {
        this.base = new Map(this.last);
    }

    disarm() {
        this.base = null;
    }

    // Returns { index (of the tag that changed most), by (its change), ratio (of the change to the tag's noise) }, or null. spanOf(index):
    // width of the tag's range.
    stirred(spanOf) {
        let most = null;
        for (const [index, from] of this.base ?? []) {
            const by = this.last.get(index) - from;
            const ratio = Math.abs(by) / Math.max(this.noise.get(index) ?? 0, FLOOR * spanOf(index));
            if (ratio >= LEAST_RATIO && ratio > (most?.ratio ?? 0))
                most = { index, by, ratio };
        }
        return most;
    }
}

// Reads expected values by tag name from CSV text; null if columns are missing.
export function readExpected(text) {
    const lines = text.replace(/^\uFEFF/, '').split(/\r\n|\n|\r/).filter((line) => line.trim());
    const separator = [',', ';', '\t'].reduce((a, b) => (lines[0]?.split(b).length > lines[0]?.split(a).length ? b : a), ',');
    const cells = (line) => [...line.matchAll(separators(separator))].map(([, quoted, plain]) => (quoted?.replace(/""/g, '"')
        ?? plain).trim());
    const head = cells(lines[0] ?? '').map((name) => name.toLowerCase());
    const [name, expected, tolerance] = ['tag name', 'expected', 'tolerance'].map((column) => head.indexOf(column));
    if (name < 0 || expected < 0 || tolerance < 0)
        return null;
    const point = (cell) => (separator === ',' ? cell : cell.replace(',', '.')); // a decimal comma counts as a decimal point
    const number = (cell) => (cell?.trim() ? Number(point(cell)) : NaN);
    return new Map(lines.slice(1).map(cells).map((row) => [row[name], { expected: number(row[expected]),
        tolerance: number(row[tolerance]) }])
        .filter(([, of]) => Number.isFinite(of.expected) && of.tolerance >= 0));
}

const separators = (separator) => new RegExp(`(?:^|${separator})(?:\\s*"((?:[^"]|"")*)"\\s*|([^${separator}]*))`, 'g');
