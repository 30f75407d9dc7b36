// SPDX-License-Identifier: GPL-3.0-or-later
// Loop check: finds the tag whose reading changed when a transmitter was forced: the one with the largest change since the check was armed,
// relative to its noise.

const KEEP = 0.9;        // weight of the old noise estimate when a new value updates the estimate
const FLOOR = 0.002;     // minimum change of a reading, as a fraction of the tag's range; smaller changes are ignored
const LEAST_RATIO = 8;   // minimum change of a reading, as a multiple of the tag's noise; smaller changes are ignored

export class LoopCheckSession {
    constructor() {
        this.noise = new Map(); // tag index -> noise of the tag: average change from one value to the next
        this.last = new Map();
        this.base = null;       // tag index -> value when the user armed (started) the check; null: no check is armed
    }

    // Takes new readings. values: by tag index, a number or null (no usable reading).
    observe(values) {
        values.forEach((value, index) => {
            if (value === null)
                return;
            const before = this.last.get(index);
            this.last.set(index, value);
            if (before === undefined || this.base)
                return; // the check looks for changes while it is armed, so they do not count as noise
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

    // Returns the tag that changed most relative to its noise: { index, by (its change), ratio (change to noise) }; null: no change is
    // large enough. spanOf(index) returns the width of the tag's range.
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

// Reads a CSV text with the values that an engineer expects, by tag name; null if columns are missing.
export function readExpected(text) {
    const lines = text.replace(/^\uFEFF/, '').split(/\r\n|\n|\r/).filter((line) => line.trim());
    const separator = [',', ';', '\t'].reduce((a, b) => (lines[0]?.split(b).length > lines[0]?.split(a).length ? b : a), ',');
    const cells = (line) => [...line.matchAll(separators(separator))].map(([, quoted, plain]) => (quoted?.replace(/""/g, '"')
        ?? plain).trim());
    const head = cells(lines[0] ?? '').map((name) => name.toLowerCase());
    const [name, expected, tolerance] = ['tag name', 'expected', 'tolerance'].map((column) => head.indexOf(column));
    if (name < 0 || expected < 0 || tolerance < 0)
        return null;
    // a comma in a number is a decimal point, unless the comma separates the cells
    const point = (cell) => (separator === ',' ? cell : cell.replace(',', '.'));
    const number = (cell) => (cell?.trim() ? Number(point(cell)) : NaN);
    return new Map(lines.slice(1).map(cells).map((row) => [row[name], { expected: number(row[expected]),
        tolerance: number(row[tolerance]) }])
        .filter(([, of]) => Number.isFinite(of.expected) && of.tolerance >= 0));
}

const separators = (separator) => new RegExp(`(?:^|${separator})(?:\\s*"((?:[^"]|"")*)"\\s*|([^${separator}]*))`, 'g');
