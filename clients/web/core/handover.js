// SPDX-License-Identifier: GPL-3.0-or-later
// Sorts shift notes and rows of the alarm journal for the shift handover.
import { fieldInstant, fieldText } from './instant.js';

const WORKED = { acknowledge: 'acknowledged', shelve: 'shelved', unshelve: 'shelved', out_of_service: 'aside', in_service: 'aside' };
// largest time in microseconds between an operator's equal actions on several alarms of a tag that the page lists as one action
const SAME_ACT_US = 1e6;

// Puts the alarms of /api/v1/alarms into a model, which counts and sorts them as the page does: one alarm for each tag.
export function hearAlarms(model, { mode, alarms }) {
    const rows = alarms.map((one) => [one.kind === 'LINK' ? one.tag : model.tag(one.tag)?.index, one.kind, one.state, one.priority,
        one.raised_us, one.value, one.limit, one.active, one.held, one.until_us, one.who, one.reason]);
    model.alarms.hear({ mode, all: true, alarms: rows });
}

// Adds a row of the journal that raises an alarm to the map `raised`. An alarm that rises from H to HH remains the same alarm
// of its tag and is not counted again.
function addRaise(raised, { tag, kind, priority, value, limit, unit, time_us: us }) {
    const known = raised.get(tag) ?? { tag, kinds: [], priority, count: 0, first: us, active: new Set() };
    const isNew = known.active.size === 0 || known.active.has(kind);
    if (isNew)
        known.active.clear();
    known.active.add(kind);
    raised.set(tag, { ...known, kinds: [...new Set([...known.kinds, kind])], priority: Math.min(known.priority, priority),
        count: known.count + Number(isNew), last: us, value, limit, unit: unit ?? null });
}

// Adds a row of the journal that records an operator's action. Equal actions on several alarms of a tag within SAME_ACT_US become one
// entry.
function addAct(list, row) {
    const { tag, kind, event, who, reason, time_us: us } = row;
    const same = list.findLast((one) => one.tag === tag && one.event === event && one.who === who && one.reason === reason);
    if (same && us - same.time_us < SAME_ACT_US)
        same.kinds.push(kind);
    else
        list.push({ ...row, kinds: [kind] });
}

// rows: rows of the alarm journal, in any order. Returns { raised: [{ tag, kinds, priority, count, first, last, value, limit, unit }], the
// most frequent first; acknowledged, shelved, aside (taken out of service or put back): lists of actions with `kinds`, oldest first }.
// value, limit and unit are those of the tag's last raise; unit null: not known.
export function sortJournal(rows) {
    const raised = new Map(), out = { acknowledged: [], shelved: [], aside: [] };
    for (const row of [...rows].sort((a, b) => a.time_us - b.time_us || a.id - b.id)) {
        if (row.event === 'raise' || row.event === 'call')
            addRaise(raised, row);
        if (row.event === 'clear')
            raised.get(row.tag)?.active.delete(row.kind);
        if (WORKED[row.event])
            addAct(out[WORKED[row.event]], row);
    }
    const order = (a, b) => b.count - a.count || a.priority - b.priority || a.first - b.first;
    return { ...out, raised: [...raised.values()].sort(order) };
}

const HOURS = { shift: 8, day: 24, week: 168 };
// Returns the limits of a named span of the alarm journal as [from, to] in microseconds; `to` null: the span ends now. The spans today and
// yesterday begin at midnight in the plant's time zone.
export function journalSpan(name, nowUs, timeZone) {
    if (name in HOURS)
        return [nowUs - HOURS[name] * 3600e6, null];
    const midnight = (us) => fieldInstant(fieldText(us, timeZone).slice(0, 10), timeZone), today = midnight(nowUs);
    return name === 'today' ? [today, null] : [midnight(today - 12 * 3600e6), today];
}

// Reads the alarm journal of a time span page by page, up to `most` rows. Returns { rows, cut (true if rows are missing),
// failed (why a later page could not be read, or null) }. Throws if the first page cannot be read. get(query) fetches
// /api/v1/alarms/journal.
export async function readJournal(get, from, to, most = 20000) {
    const rows = [];
    for (let before = null; ;) {
        let page;
        try {
            page = await get({ from, to, limit: 2000, ...(before ? { before } : {}) });
        } catch (error) {
            if (before === null)
                throw error;
            return { rows, cut: true, failed: error.message };
        }
        rows.push(...page.rows);
        before = page.next_before ?? null;
        if (before === null || rows.length >= most)
            return { rows, cut: before !== null, failed: null };
    }
}
