// SPDX-License-Identifier: GPL-3.0-or-later
// Raises alarms in the simulated device all the time, lets operators acknowledge them, and clears them. Compares the alarm
// journals of both cores with these actions.
import { setTimeout as sleep } from 'node:timers/promises';
import { until } from '../../e2e/support/until.mjs';

const KIND = 'H', HIGH = 95, NORMAL = 50, SHOWN_MS = 60000, STEP_MS = 100, JOURNAL_MS = 30000, ROWS = 1000;
const PAUSE_MS = 4 * SHOWN_MS, AGAIN_MS = 5000, EARLIER_MS = 60000;
const EVENTS = ['raise', 'acknowledge', 'clear'];

export class AlarmCycles {
    // plant: passes commands to the device simulator; operators: the operators who acknowledge, in turn; tags: names of the
    // tags whose alarms are raised, acknowledged and cleared, each tag in its own cycle.
    constructor(plant, operators, tags) {
        Object.assign(this, { began: Date.now(), plant, operators, tags, failures: [], total: 0, notKept: 0, idle: new Set() });
        this.isPaused = this.isOver = false;
        this.counts = new Map(tags.map((tag) => [tag, 0]));
        this.newest = new Map();
        tags.forEach((tag, i) => this.run(tag, i));
    }

    async run(tag, turn) {
        for (; !this.isOver; turn++) {
            if (this.isPaused) {
                this.idle.add(tag);
                await sleep(STEP_MS);
                continue;
            }
            this.idle.delete(tag);
            try {
                await this.cycle(tag, this.operators[turn % this.operators.length]);
                this.counts.set(tag, this.counts.get(tag) + 1);
                this.total++;
            } catch ({ message }) {
                this.failures.push(`${tag}: ${message}`);
                await sleep(AGAIN_MS);
            }
        }
    }

    async cycle(tag, operator) {
        await this.plant.tell(`set ${tag} ${HIGH}`);
        await this.shown(tag, 'is raised', (state) => state === 'unacknowledged' || state === 'acknowledged');
        await this.acknowledge(tag, operator);
        await this.plant.tell(`set ${tag} ${NORMAL}`);
        await this.shown(tag, 'is cleared', (state) => state === undefined || state === 'normal');
    }

    // Repeats an acknowledgement, as a user would, until the server has confirmed it.
    async acknowledge(tag, operator) {
        for (const end = performance.now() + SHOWN_MS; performance.now() < end && !this.isOver; await sleep(STEP_MS)) {
            const answer = await operator.acknowledge(tag, KIND);
            if (answer?.not_kept)
                this.notKept++;
            if (answer?.done === 1 || operator.alarms.get(`${tag} ${KIND}`) === 'acknowledged')
                return;
        }
        this.failures.push(`${tag}: no acknowledgement within ${SHOWN_MS / 1000} s at ${operator.name}`);
    }

    async shown(tag, what, is) {
        const end = performance.now() + SHOWN_MS;
        while (!this.isOver && !this.operators.every(({ alarms, live }) => live && is(alarms.get(`${tag} ${KIND}`)))) {
            if (performance.now() > end) {
                const states = this.operators.map(({ alarms, live }) => `${live ? '' : 'not live '}${alarms.get(`${tag} ${KIND}`)}`);
                this.failures.push(`${tag}: not shown to all operators within ${SHOWN_MS / 1000} s that it ${what}: ${states.join(', ')}`);
                return;
            }
            await sleep(STEP_MS);
        }
    }

    async pause() {
        this.isPaused = true;
        await until('the end of the cycles', () => this.idle.size === this.tags.length, PAUSE_MS / 1000);
    }
    resume() {
        this.isPaused = false;
        this.idle.clear();
    }

    // Compares the alarm cycles since the last call with a core's journal; call it while the cycles are paused. Waits until a
    // standby has received all rows. Returns { lost, twice }: numbers of rows that are missing or repeated in the journal.
    // off_s: maximum number of seconds by which a core's clock was behind.
    async compare(core, off_s = 0) {
        const since = this.newest.get(core.name) ?? 0, from = new Date(this.began - off_s * 1000 - EARLIER_MS).toISOString();
        for (const end = performance.now() + JOURNAL_MS; ; await sleep(500)) {
            const rows = await journal(core, from, since), found = this.difference(rows);
            if (found.lost > 0 && performance.now() < end)
                continue;
            this.newest.set(core.name, Math.max(since, ...rows.map(({ id }) => id)));
            return found;
        }
    }
    difference(rows) {
        let lost = 0, twice = 0;
        for (const [tag, count] of this.counts)
            for (const event of EVENTS) {
                const off = rows.filter((row) => row.tag === tag && row.kind === KIND && row.event === event).length - count;
                lost += Math.max(0, -off);
                twice += Math.max(0, off);
            }
        return { lost, twice };
    }
    begin() {
        this.began = Date.now();
        for (const tag of this.tags)
            this.counts.set(tag, 0);
    }
}

// Returns a core's journal rows from the time `from` on whose id is above `since`. Reads all pages, because rows are sorted by
// time, and a core whose clock was behind has dated new rows before older ones.
async function journal(core, from, since) {
    const rows = [];
    for (let before = ''; ;) {
        const answer = await core.node.fetch(`/api/v1/alarms/journal?limit=${ROWS}&from=${from}${before}`);
        const { rows: more, next_before: next } = await answer.json();
        rows.push(...more.filter(({ id }) => id > since));
        if (!next)
            return rows;
        before = `&before=${next}`;
    }
}
