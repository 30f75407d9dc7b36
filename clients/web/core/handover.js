// SPDX-License-Identifier: GPL-3.0-or-later
// Sorts shift notes and rows of the alarm journal for the shift handover.

const WORKED = { acknowledge: 'acknowledged', shelve: 'shelved', unshelve: 'shelved', out_of_service: 'aside', in_service: 'aside' };

// rows: rows of the journal, in any order. Returns { raised: [{ tag, kind, priority, count, first, last }], the most frequent first;
// acknowledged, shelved, aside (taken out of service or put back): lists of rows, oldest first }.
export function sortJournal(rows) {
    const raised = new Map(), out = { acknowledged: [], shelved: [], aside: [] };
    for (const row of [...rows].sort((a, b) => a.time_us - b.time_us || a.id - b.id)) {
        const { tag, kind, event, priority, time_us: us } = row;
        if (event === 'raise') {
            const key = `${tag}/${kind}`, known = raised.get(key) ?? { tag, kind, priority, count: 0, first: us };
            raised.set(key, { ...known, priority: Math.min(known.priority, priority), count: known.count + 1, last: us });
        }
        out[WORKED[event]]?.push(row);
    }
    const order = (a, b) => b.count - a.count || a.priority - b.priority || a.first - b.first;
    return { ...out, raised: [...raised.values()].sort(order) };
}

// Reads the journal of a time span page by page, up to `most` rows. Returns { rows, cut: true if rows were left out }. get(query) fetches
// /api/v1/alarms/journal.
export async function readJournal(get, from, to, most = 20000) {
    const rows = [];
    for (let before = null; ;) {
        const page = await get({ from, to, limit: 2000, ...(before ? { before } : {}) });
        rows.push(...page.rows);
        before = page.next_before ?? null;
        if (before === null || rows.length >= most)
            return { rows, cut: before !== null };
    }
}
