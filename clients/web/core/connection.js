// SPDX-License-Identifier: GPL-3.0-or-later
// A WebSocket that reconnects: with pauses between tries, a check that the server still answers, and its state for the page.
import { SUBPROTOCOL } from './wire.js';
import { say } from './words.js';

export const FIRST_WAIT_MS = 500, LONGEST_WAIT_MS = 8000, JITTER = 0.25;
// A server with nothing to say answers at least these.
export const PING_MS = 2000;
export const QUIET_MS = 5000;
export const DEAD_MS = 12000;

const GOING = 1001, FULL = 1013, FULL_MS = 10000, OPENING_MS = 10000, ANSWER_MS = 1000;
const CLOSE_REASONS = {
    1001: 'reason.down', 1002: 'reason.version', 1008: 'reason.forbidden', 1009: 'reason.long', 1013: 'reason.full', 4000: 'reason.slow',
};

export class Connection {
    // open(url, protocol): a WebSocket. clock: { now(), setTimeout(f, ms), clearTimeout(id) }. Handlers: onState(connection),
    // onOpen(), onText(string), onBytes(ArrayBuffer). onUnopened(): a WebSocket did not open, for
    // at least the second time in a row; `blocked` holds the reason to show.
    // spreadMs, to be set: up to so much is added to each wait.
    constructor({ url, open, clock, random = Math.random }) {
        Object.assign(this, { url, openSocket: open, clock, random, spreadMs: 0, unopened: 0, blocked: '' });
        // stopped | connecting | open | waiting | barred (until retryNow)
        this.state = 'stopped';
        // Open, but nothing was heard for QUIET_MS.
        this.quiet = false;
        // Why the last connection ended.
        this.reason = '';
        // Failed tries since the last good connection.
        this.tries = 0;
        this.retryAt = null;
        // The least wait before the next try, as the server asked, in ms.
        this.leastWait = 0;
        // When the last good connection ended.
        this.lostAt = null;
        // When somebody was last at the page; of the clock that runs on while a machine sleeps.
        this.activeAt = Date.now();
        this.onState = this.onOpen = this.onText = this.onBytes = this.onUnopened = () => {};
    }

    start() {
        if (this.state === 'stopped')
            this.connect();
    }

    stop() {
        this.drop();
        this.become('stopped');
    }

    // Tries now instead of when the wait is over: the network came back, or somebody asks.
    retryNow() {
        if (this.state === 'waiting' || this.state === 'barred')
            this.connect();
    }

    // The server has no room: not before so long.
    hold(ms) {
        this.leastWait = ms;
    }

    // The server does not let us in as we are: no more tries until somebody has something new to say.
    bar(reason) {
        this.drop();
        this.reason = reason;
        this.become('barred');
    }

    // The peer has proved that it speaks with us: the next loss starts with the shortest wait again.
    settle() {
        this.tries = 0;
        this.lostAt = null;
        this.reason = '';
    }

    send(message) {
        if (this.state !== 'open')
            return false;
        this.socket.send(JSON.stringify(message));
        return true;
    }

    get backlogBytes() {
        return this.socket?.bufferedAmount ?? 0;
    }

    become(state, quiet = false) {
        this.state = state;
        this.quiet = quiet;
        this.onState(this);
    }

    connect() {
        this.drop();
        let socket;
        try {
            socket = this.openSocket(this.url, SUBPROTOCOL);
        } catch (error) {
            this.lose(error.message);
            return;
        }
        this.socket = socket;
        socket.binaryType = 'arraybuffer';
        socket.onopen = () => this.opened();
        socket.onmessage = (event) => this.heard(event.data);
        socket.onclose = (event) => {
            if (event.code === FULL)
                this.leastWait = this.leastWait || FULL_MS;
            const back = event.code === GOING && /retry after (\d+) s$/.exec(event.reason ?? '');
            if (back)
                this.leastWait = back[1] * 1000;
            const known = CLOSE_REASONS[event.code];
            // Not the first time: a server that was restarting is back by the second.
            const again = this.state === 'connecting' && !known && this.unopened++;
            this.lose(known ? say(known) : event.reason || this.blocked || say('reason.unreachable'));
            if (again)
                this.onUnopened();
        };
        this.timer = this.clock.setTimeout(() => this.lose(say('reason.unanswered')), OPENING_MS);
        this.become('connecting');
    }

    opened() {
        this.unopened = 0;
        this.blocked = '';
        this.lastHeard = this.clock.now();
        // Time of the first ping that nothing came after.
        this.pingAt = null;
        this.nextPing = this.lastHeard + PING_MS;
        this.watch();
        this.state = 'open';
        // Before onState: what the last server said no longer holds.
        this.onOpen();
        this.become('open');
    }

    heard(data) {
        this.lastHeard = this.clock.now();
        this.pingAt = null;
        if (this.quiet)
            this.become('open', false);
        if (typeof data === 'string')
            this.onText(data);
        else
            this.onBytes(data);
    }

    watch() {
        this.clock.clearTimeout(this.timer);
        this.timer = this.clock.setTimeout(() => {
            const silent = this.ask();
            if (silent >= DEAD_MS) {
                this.lose(say('reason.silent'));
                return;
            }
            if (!this.quiet && silent >= QUIET_MS)
                this.become('open', true);
            this.watch();
        }, 500);
    }

    // Sends a ping when one is due. Returns for how long the server has been silent though it was asked: the timers of a page that
    // nobody looks at may rest for a minute.
    ask() {
        const now = this.clock.now();
        if (now >= this.nextPing) {
            this.pingAt = this.pingAt ?? now;
            this.nextPing = now + PING_MS;
            this.send({ type: 'ping', t: now, ...(Date.now() - this.activeAt < 2 * PING_MS ? { active: true } : {}) });
        }
        return this.pingAt !== null && now - this.pingAt >= ANSWER_MS ? now - this.lastHeard : 0;
    }

    // We slept, or something else makes it doubtful that the peer is still there: until it speaks it counts as silent.
    doubt() {
        if (this.state !== 'open')
            return;
        this.nextPing = this.clock.now();
        this.ask();
        this.become('open', true);
        this.watch();
    }

    // Lets go of the socket at once: a close over a dead line can take minutes.
    drop() {
        this.clock.clearTimeout(this.timer);
        const socket = this.socket;
        this.socket = null;
        if (!socket)
            return;
        socket.onopen = socket.onmessage = socket.onclose = null;
        socket.close();
    }

    lose(reason) {
        const was = this.state;
        this.drop();
        this.reason = reason;
        if (was === 'open')
            this.lostAt = this.lostAt ?? this.clock.now();
        const usual = Math.min(LONGEST_WAIT_MS, FIRST_WAIT_MS * 2 ** this.tries);
        const wait = Math.max(usual, this.leastWait) * (1 + JITTER * (2 * this.random() - 1)) + this.spreadMs * this.random();
        this.leastWait = 0;
        this.tries++;
        this.retryAt = this.clock.now() + wait;
        this.timer = this.clock.setTimeout(() => this.connect(), wait);
        this.become('waiting');
    }
}
