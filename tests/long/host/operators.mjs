// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated operators without a screen. They connect to the load balancer with the page's own connection code and record the
// periods in which they did not see the plant.
import { Connection } from '../../../clients/web/core/connection.js';
import { get, PlainClient } from '../../e2e/support/plain_client.mjs';

const PICTURE_MS = 2000, ANSWER_MS = 15000, NOTICED_MS = 1000;
const clock = { now: () => performance.now(), setTimeout: (f, ms) => setTimeout(f, ms), clearTimeout: (id) => clearTimeout(id) };

// PlainClient with the interface of a browser's WebSocket. It stores the load balancer's cookie and sends it again, as a
// browser does.
class PageSocket {
    constructor(port, jar) {
        this.open(port, jar).catch(() => this.end({ code: 1006, reason: '' }));
    }
    async open(port, jar) {
        const { headers } = await get(port, '/healthz', 'GET', jar.cookie ? `Cookie: ${jar.cookie}\r\n` : '', { timeoutMs: 10000 });
        jar.cookie = headers['set-cookie']?.split(';')[0] ?? jar.cookie;
        this.client = await PlainClient.open(port, jar.cookie ? { headers: [`Cookie: ${jar.cookie}`] } : {});
        if (this.isClosed)
            return this.close();
        this.onopen?.();
        this.client.wake = () => this.pass();
        return this.pass();
    }
    pass() {
        for (const text of this.client.texts.splice(0))
            this.onmessage?.({ data: JSON.stringify(text) });
        for (const frame of this.client.frames.splice(0))
            this.onmessage?.({ data: frame });
        if (this.client.closed)
            this.end({ code: this.client.closed.code, reason: this.client.closed.text });
    }
    end(how) {
        if (!this.isClosed)
            this.onclose?.(how);
        this.isClosed = true;
    }
    send(text) { this.client.say(text); }
    close() {
        this.isClosed = true;
        this.client?.close();
    }
}

export class Operator {
    // watched: name of a tag whose reading changes all the time; the operator counts as not seeing the plant while no change of
    // this tag arrives.
    constructor({ name, port, token, watched }) {
        Object.assign(this, { name, watched, tags: [], bad: new Set(), alarms: new Map(), live: false, frameAt: 0, gaps: [], seq: 0 });
        this.visits = 0; // number of connections that opened
        this.answers = new Map();
        this.seenAt = performance.now();
        const jar = {};
        this.jar = jar;
        this.connection = new Connection({ url: '', clock, open: () => new PageSocket(port(), jar) });
        this.connection.onOpen = () => {
            this.visits++;
            this.live = false;
            this.alarms.clear();
            this.connection.send({ type: 'hello', tokens: true, token, width: 160, height: 90, codecs: ['jpeg'] });
        };
        this.connection.onText = (text) => this.read(JSON.parse(text));
        this.connection.onBytes = () => { this.frameAt = performance.now(); this.look(); };
        this.connection.onState = ({ state }) => {
            if (state !== 'open')
                for (const done of this.answers.values())
                    done(null);
        };
        this.connection.start();
    }

    read(message) {
        if (message.type === 'welcome') {
            this.tags = message.tags.map((tag) => tag.name);
            this.connection.settle();
        } else if (message.type === 'status') {
            this.live = message.live;
        } else if (message.type === 'tags') {
            for (const [index, , , quality] of message.values)
                this.bad[quality === undefined || quality.startsWith('Good') ? 'delete' : 'add'](this.tags[index]);
            this.changed = message.values.some(([index]) => this.tags[index] === this.watched);
            this.look();
        } else if (message.type === 'alarms') {
            if (message.all)
                this.alarms.clear();
            for (const [index, kind, state] of message.alarms)
                this.alarms.set(`${this.tags[index] ?? index} ${kind}`, state);
        } else if (message.type === 'alarmed') {
            this.answers.get(message.seq)?.(message);
        }
    }

    // Called when readings or frames arrive. Notes that the operator sees the plant now, if the watched tag is good and has
    // changed since the last call and a frame arrived recently. Records the period since the operator last saw the plant if it
    // was noticeable.
    look() {
        const now = performance.now();
        if (!this.live || this.bad.has(this.watched) || !this.changed || now - this.frameAt > PICTURE_MS)
            return;
        this.changed = false;
        if (now - this.seenAt > NOTICED_MS)
            this.gaps.push([this.seenAt, now]);
        this.seenAt = now;
    }
    get sees() { return performance.now() - this.seenAt < PICTURE_MS; }

    // Returns the longest period in milliseconds in which this operator did not see the plant, of those that ended after
    // `since` or still last.
    longestBlind(since) {
        const now = performance.now();
        return Math.max(0, ...[...this.gaps, [this.seenAt, now]].filter(([, to]) => to >= since)
            .map(([from, to]) => to - Math.max(from, since)));
    }

    // Resolves with the server's answer to the acknowledgement, or with null if the connection was lost or no answer arrived in
    // time.
    acknowledge(tag, kind) {
        const seq = ++this.seq;
        return new Promise((done) => {
            const timer = setTimeout(() => done(null), ANSWER_MS);
            this.answers.set(seq, (answer) => { clearTimeout(timer); this.answers.delete(seq); done(answer); });
            if (!this.connection.send({ type: 'alarm', seq, action: 'acknowledge', alarms: [[tag, kind]] }))
                this.answers.get(seq)(null);
        });
    }

    leave() { this.connection.stop(); }
}
