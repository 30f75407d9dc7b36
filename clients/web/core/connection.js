// SPDX-License-Identifier: GPL-3.0-or-later
// A WebSocket that reconnects after increasing waits, checks that the server still answers, and reports its own state to the page.
import { SUBPROTOCOL } from './wire.js';
import { say } from './words.js';

export const FIRST_WAIT_MS = 500, LONGEST_WAIT_MS = 8000, JITTER = 0.25;
// longest wait between attempts during the first EAGER_MS after the loss of a good connection: if the server has failed, a
// standby server takes over within 5 s
export const EAGER_WAIT_MS = 1500, EAGER_MS = 15000;
// milliseconds between pings, which the server answers even if it sends nothing else
export const PING_MS = 2000;
export const QUIET_MS = 5000;
// The page reconnects if the server is silent for DEAD_MS. deploy/pages/CAPACITY.md explains how this adds to the duration of a
// failover.
export const DEAD_MS = 7000, CHECK_MS = 500;
// milliseconds after which the page gives up opening a WebSocket, or waiting for the server's first message, which may contain
// long lists of tags
export const OPENING_MS = 10000;

const GOING = 1001, FULL = 1013, FULL_MS = 10000, ANSWER_MS = 1000;
const CLOSE_REASONS = {
    1001: 'reason.down', 1002: 'reason.version', 1008: 'reason.forbidden', 1009: 'reason.long', 1013: 'reason.full', 4000: 'reason.slow',
};

export class Connection {
    // stopped | connecting | open | waiting (for the next attempt) | barred (no attempts until retryNow() is called)
    state = 'stopped';
    // open, but silent for QUIET_MS
    quiet = false;
    // Why the last connection ended.
    reason = '';
    // Number of failed attempts since the last connection that worked.
    tries = 0;
    retryAt = null;
    // Minimum wait before the next attempt in milliseconds, set by the server.
    leastWait = 0;
    // When the last working connection ended; undefined: there was none, or a new connection works.
    lostAt;
    // Time of the last user activity by Date.now(), because that clock continues while a machine sleeps.
    activeAt = Date.now();
    // Maximum random addition, in milliseconds, to the first wait after a lost connection.
    spreadMs = 0;
    unopened = 0;
    blocked = '';

    // open(url, protocol) creates a WebSocket. clock: { now(), setTimeout(f, ms), clearTimeout(id) }. Handlers:
    // onState(connection), onOpen(), onText(string), onBytes(ArrayBuffer), onUnopened(): two WebSockets in a row did not open,
    // so the handler should set `blocked` to the reason to show.
    constructor({ url, open, clock, random = Math.random }) {
        Object.assign(this, { url, openSocket: open, clock, random });
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

    // Tries to connect without waiting, because the network is back or the user asks.
    retryNow() {
        if (this.state === 'waiting' || this.state === 'barred')
            this.connect();
    }

    // Sets the minimum wait before the next attempt in milliseconds. A server without room for more sessions asks for it.
    hold(ms) {
        this.leastWait = ms;
    }

    // Stops reconnecting after a refusal that only the user can resolve, for example with another token.
    bar(reason) {
        this.drop();
        this.reason = reason;
        this.become('barred');
    }

    // Resets the wait to its initial length, once the server has proved that it works.
    settle() {
        this.tries = 0;
        this.lostAt = undefined;
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
                this.leastWait ||= FULL_MS;
            const back = event.code === GOING && /retry after (\d+) s$/.exec(event.reason ?? '');
            if (back)
                this.leastWait = back[1] * 1000;
            const known = CLOSE_REASONS[event.code];
            // onUnopened() is called only from the second failure in a row on: the first may just be a restart of the server
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
        this.deadMs = OPENING_MS;
        this.lastHeard = this.clock.now();
        // time at which the first unanswered ping was sent; null: all pings are answered
        this.pingAt = null;
        this.nextPing = this.lastHeard + PING_MS;
        this.watch();
        this.state = 'open';
        // onOpen() discards the state of the previous connection, which must happen before onState() reports the state `open`
        this.onOpen();
        this.become('open');
    }

    heard(data) {
        this.deadMs = DEAD_MS;
        this.lastHeard = this.clock.now();
        this.pingAt = null;
        if (this.quiet)
            this.become('open', false);
        if (typeof data === 'string')
            this.onText(data);
        else
            this.onBytes(data);
    }

    watch(wait = CHECK_MS) {
        this.clock.clearTimeout(this.timer);
        const due = this.clock.now() + wait;
        this.timer = this.clock.setTimeout(() => {
            const silent = this.ask(), late = wait && this.clock.now() > due + ANSWER_MS;
            if (silent >= this.deadMs && !late) {
                this.lose(say('reason.silent'));
                return;
            }
            if (!this.quiet && silent >= QUIET_MS)
                this.become('open', true);
            // this timer came late, because the page hung: messages that arrived meanwhile must be handled first, so a new timer decides
            this.watch(late ? 0 : CHECK_MS);
        }, wait);
    }

    // Sends a ping if one is due. If a ping has been unanswered for ANSWER_MS, returns the milliseconds since the server's last
    // message, else 0. Without an unanswered ping, a long silence proves nothing: timers of a hidden page, which send the
    // pings, may pause for a minute.
    ask() {
        const now = this.clock.now();
        if (now >= this.nextPing) {
            this.pingAt ??= now;
            this.nextPing = now + PING_MS;
            this.send({ type: 'ping', t: now, ...(Date.now() - this.activeAt < 2 * PING_MS ? { active: true } : {}) });
        }
        return this.pingAt !== null && now - this.pingAt >= ANSWER_MS ? now - this.lastHeard : 0;
    }

    // Treats the server as silent until it answers: after the device slept, or if the server may be unreachable for another reason.
    doubt() {
        if (this.state !== 'open')
            return;
        this.nextPing = this.clock.now();
        this.ask();
        this.become('open', true);
        this.watch();
    }

    // Drops the socket without the closing handshake, which can take minutes over a dead connection.
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
        const was = this.state, now = this.clock.now();
        this.drop();
        this.reason = reason;
        if (was === 'open')
            this.lostAt ??= now;
        const most = this.lostAt > now - EAGER_MS ? EAGER_WAIT_MS : LONGEST_WAIT_MS;
        const usual = Math.min(most, FIRST_WAIT_MS * 2 ** this.tries);
        const wait = Math.max(usual, this.leastWait) * (1 + JITTER * (2 * this.random() - 1)) +
            (this.tries++ ? 0 : this.spreadMs * this.random());
        this.leastWait = 0;
        this.retryAt = now + wait;
        this.timer = this.clock.setTimeout(() => this.connect(), wait);
        this.become('waiting');
    }
}
