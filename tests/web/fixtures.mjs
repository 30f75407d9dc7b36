// SPDX-License-Identifier: GPL-3.0-or-later
// A clock that the test advances, a fake WebSocket whose other end the test controls, and a fake HTTP server.
import { readFileSync } from 'node:fs';
import { Connection } from '../../clients/web/core/connection.js';
import { Session } from '../../clients/web/core/session.js';

class Clock {
    constructor() {
        this.time = 1000;
        this.timers = new Map();
        this.last = 0;
    }

    now = () => this.time;

    setTimeout = (f, ms) => {
        this.timers.set(++this.last, { f, at: this.time + ms });
        return this.last;
    };

    clearTimeout = (id) => this.timers.delete(id);

    // Advances the clock by ms. Runs the timers that become due, in order, with the clock at the time of each.
    advance(ms) {
        const end = this.time + ms;
        for (;;) {
            const due = [...this.timers].filter(([, t]) => t.at <= end).sort((a, b) => a[1].at - b[1].at)[0];
            if (!due)
                break;
            this.timers.delete(due[0]);
            this.time = due[1].at;
            due[1].f();
        }
        this.time = end;
    }
}

export class Socket {
    constructor(url, protocol) {
        Object.assign(this, { url, protocol, sent: [], closed: false, bufferedAmount: 0 });
    }

    send(text) {
        this.sent.push(JSON.parse(text));
    }

    close() {
        this.closed = true;
    }

    accept() {
        this.onopen();
    }

    say(message) {
        this.onmessage({ data: typeof message === 'string' ? message : JSON.stringify(message) });
    }

    sayBytes(bytes) {
        this.onmessage({ data: bytes });
    }

    fail(code = 1006, reason = '') {
        this.onclose({ code, reason });
    }
}

// Makes a connection with the test's clock and fake WebSockets. random: source of the random part of reconnection delays; 0.5:
// no random part.
export function makeConnection({ random = () => 0.5 } = {}) {
    const clock = new Clock(), sockets = [];
    const connection = new Connection({
        url: 'ws://plant/stream', clock, random,
        open: (url, protocol) => {
            sockets.push(new Socket(url, protocol));
            return sockets.at(-1);
        },
    });
    return { clock, sockets, connection };
}

const vectors = new URL('../../protocol/vectors/', import.meta.url);
export const vector = (path) => JSON.parse(readFileSync(new URL(path, vectors), 'utf8'));
export const vectorBytes = (path) => new Uint8Array(readFileSync(new URL(path, vectors)));

export function makeSession(wanted) {
    const bench = makeConnection();
    const session = new Session({ connection: bench.connection, now: bench.clock.now, wanted });
    const events = [];
    for (const name of ['welcome', 'params', 'shown', 'tags', 'status', 'frame', 'camera', 'error', 'astray', 'denied', 'ignored'])
        session.on(name, (value) => events.push([name, value]));
    return { ...bench, session, events };
}

// Replaces fetch() while f runs. answer(query, options, path): returns the server's answer, or throws if there is none.
export async function withServer(answer, f) {
    const { fetch } = globalThis;
    globalThis.fetch = async (url, options) => {
        const [path, query] = url.split('?');
        return Response.json(await answer(new URLSearchParams(query), options, path));
    };
    try {
        await f();
    } finally {
        globalThis.fetch = fetch;
    }
}

// An answer() of withServer() for a request that stays unanswered until the page gives up.
export const silent = (query, { signal }) => new Promise((done, fail) => {
    signal?.addEventListener('abort', () => fail(signal.reason));
});
