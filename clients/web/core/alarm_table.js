// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the alarm table and of the alarm journal: area, order, filter, and export as CSV. A row has at least { tag, kind, state,
// priority, us (time of the raise or of the change), area, about (description) }.

const STATES = ['unacknowledged', 'active', 'acknowledged', 'returned', 'latched', 'shelved', 'suppressed', 'out_of_service'];
const byText = (of) => (a, b) => of(a).localeCompare(of(b), undefined, { numeric: true });
const ORDERS = {
    state: (a, b) => STATES.indexOf(a.state) - STATES.indexOf(b.state),
    priority: (a, b) => a.priority - b.priority,
    tag: byText(({ tag }) => tag.name),
    kind: byText(({ kind }) => kind),
    area: byText(({ area }) => area),
    about: byText(({ about }) => about),
    us: (a, b) => b.us - a.us, // newest first
};

export const sortable = (name) => name in ORDERS;

// Returns the rows sorted by a column; by null: in their present order. Rows with equal values in the column keep their order.
export function sortRows(rows, { by, down }) {
    const order = ORDERS[by], sign = down ? -1 : 1;
    return order ? [...rows].sort((a, b) => sign * order(a, b)) : rows;
}

// Returns the sort order after a click on a column's title. Clicks cycle through this column, this column reversed, and the
// server's order.
export const nextSort = ({ by, down }, name) =>
    (by !== name ? { by: name, down: false } : down ? { by: null, down: false } : { by: name, down: true });

// Returns the area of a tag's equipment, or the equipment's tag name (such as P-101) or id if it has no area; empty for a field
// device.
export function areaOf(model, { asset: id }) {
    const asset = id ? model.asset(id) : null;
    return asset ? asset.area || asset.tag || asset.id : '';
}

// Returns the areas of rows, sorted, for a selection list.
export const areasOf = (rows) => [...new Set(rows.map(({ area }) => area).filter(Boolean))]
    .sort((a, b) => a.localeCompare(b, undefined, { numeric: true }));

// Returns true if a row is in the chosen area and has the chosen priority; '' matches any.
export const isIn = (row, { area = '', priority = '' }) =>
    (area === '' || row.area === area) && (priority === '' || row.priority === Number(priority));

// Converts a row of /api/v1/alarms/journal to a row of the table. Tags that the plant no longer has have no area. unit null: not known.
export function journalRow(model, { id, time_us: us, tag: name, kind, event, state, priority, value, limit, unit, who, reason }) {
    const tag = model.tag(name) ?? { name, index: null, group: null, asset: null, description: '' };
    return { id: `j${id}`, us, raisedUs: us, tag, kind, event, state, priority, value, limit, unit: unit ?? null, who, reason,
        area: areaOf(model, tag), about: tag.description ?? '' };
}

// Puts an apostrophe before a cell that a spreadsheet would run as a formula, as the server's own CSV files do.
function csvCell(value) {
    const text = String(value), safe = typeof value === 'string' && /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
    return /[,"\n\r]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

// Column names of the export, the same for alarms and for the journal.
const EXPORTED = ['time', 'state', 'event', 'priority', 'tag', 'kind', 'area', 'description', 'value', 'limit', 'unit', 'who', 'reason'];

// Returns rows as CSV, with times in UTC.
export function tableCsv(rows) {
    const lines = rows.map((row) => [row.us === null ? '' : new Date(row.us / 1000).toISOString(), row.state, row.event ?? '', row.priority,
        row.tag.name, row.kind, row.area, row.about, row.value ?? '', row.limit ?? '',
        (row.unit === undefined ? row.tag.unit : row.unit) ?? '', row.who, row.reason]);
    return [EXPORTED, ...lines].map((cells) => cells.map(csvCell).join(',')).join('\r\n').concat('\r\n');
}
