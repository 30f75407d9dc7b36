// SPDX-License-Identifier: GPL-3.0-or-later
// The states of the page's connection to the server, with a clock that the test advances.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
    CHECK_MS, DEAD_MS, EAGER_MS, FIRST_WAIT_MS, JITTER, LONGEST_WAIT_MS, OPENING_MS, QUIET_MS,
} from '../../clients/web/core/connection.js';
import { SPREAD_MS } from '../../clients/web/core/wall.js';
import { makeConnection } from './fixtures.mjs';

const waitOf = ({ connection, clock }) => connection.retryAt - clock.now();

test('the connection requests the subprotocol and reports its state', () => {
    const { connection, sockets } = makeConnection();
    const states = [];
    connection.onState = ({ state }) => states.push(state);
    connection.start();
    connection.start();
    assert.equal(sockets.length, 1);
    assert.equal(sockets[0].protocol, 'plantcast.v1');
    assert.equal(sockets[0].binaryType, 'arraybuffer');
    sockets[0].accept();
    sockets[0].fail(1001);
    assert.deepEqual(states, ['connecting', 'open', 'waiting']);
    assert.equal(connection.reason, 'The server shut down');
});

test('the connection waits 0.5, 1, 2, 4, 8, 8 seconds between attempts', () => {
    const bench = makeConnection();
    const { connection, sockets, clock } = bench;
    const waits = [];
    connection.start();
    for (let n = 0; n < 6; n++) {
        sockets.at(-1).fail();
        waits.push(waitOf(bench));
        clock.advance(waits.at(-1) - 1);
        assert.equal(sockets.length, n + 1, 'no attempt comes early');
        clock.advance(1);
        assert.equal(sockets.length, n + 2);
    }
    assert.deepEqual(waits, [500, 1000, 2000, 4000, 8000, 8000]);
});

test('after a loss the connection waits at most 2 seconds between attempts for 15 seconds, then longer', () => {
    for (const dice of [0, 0.5, 1]) {
        const bench = makeConnection({ random: () => dice }), { connection, sockets, clock } = bench;
        connection.start();
        sockets[0].accept();
        connection.settle();
        sockets[0].fail();
        const lost = clock.now();
        let tries = 0, longest = 0;
        for (; clock.now() - lost < EAGER_MS; tries++) {
            longest = Math.max(longest, waitOf(bench));
            clock.advance(waitOf(bench));
            sockets.at(-1).fail();
        }
        assert.ok(longest >= 1000 && longest <= 2000, `the longest wait is ${longest} ms`);
        assert.ok(tries >= 8);
        assert.ok(waitOf(bench) >= LONGEST_WAIT_MS * (1 - JITTER));
    }
});

test('jitter spreads the attempts of many clients, within limits', () => {
    for (const [dice, factor] of [[0, 1 - JITTER], [1, 1 + JITTER]]) {
        const bench = makeConnection({ random: () => dice });
        bench.connection.start();
        for (let n = 0; n < 8; n++) {
            bench.sockets.at(-1).fail();
            assert.ok(Math.abs(waitOf(bench) - Math.min(LONGEST_WAIT_MS, 500 * 2 ** n) * factor) < 1e-6);
            bench.clock.advance(waitOf(bench));
        }
    }
});

test('an open socket alone does not shorten the waits; the server\'s greeting does', () => {
    const bench = makeConnection();
    const { connection, sockets, clock } = bench;
    connection.start();
    sockets[0].fail();
    clock.advance(500);
    sockets[1].accept();
    sockets[1].fail(1001, 'the server is stopping');
    assert.equal(waitOf(bench), 1000);
    assert.equal(connection.reason, 'The server shut down');
    clock.advance(1000);
    sockets[2].accept();
    connection.settle();
    sockets[2].fail();
    assert.equal(waitOf(bench), 500);
});

test('a server that shuts down says when clients may reconnect', () => {
    const bench = makeConnection(), { connection, sockets } = bench;
    connection.start();
    sockets[0].accept();
    sockets[0].fail(1001, 'the server is stopping; retry after 7 s');
    assert.equal(waitOf(bench), 7000);
});

test('retryNow cuts a wait short, and does nothing else', () => {
    const { connection, sockets, clock } = makeConnection();
    connection.start();
    connection.retryNow();
    assert.equal(sockets.length, 1);
    sockets[0].fail();
    connection.retryNow();
    assert.equal(sockets.length, 2);
    clock.advance(600);
    assert.equal(sockets.length, 2, 'the old timer is cancelled');
});

test('a silent server is noticed, then given up without waiting for its close frame', () => {
    const { connection, sockets, clock } = makeConnection();
    connection.start();
    sockets[0].accept();
    clock.advance(QUIET_MS - 1000);
    assert.equal(connection.quiet, false);
    clock.advance(1500);
    assert.equal(connection.quiet, true);
    sockets[0].say({ type: 'pong' });
    assert.equal(connection.quiet, false);
    clock.advance(DEAD_MS + 100);
    assert.equal(connection.state, 'waiting');
    assert.equal(connection.reason, 'The server stopped responding');
    assert.ok(sockets[0].closed);
    assert.equal(sockets[0].onmessage, null, 'later messages of the old socket are ignored');
});

test('a stopped server is noticed and left within 8.2 s, at any moment and with the longest wait; 1.8 s of 10 s remain', () => {
    const most = DEAD_MS + CHECK_MS + FIRST_WAIT_MS * (1 + JITTER);
    assert.ok(most <= 8200, `the longest time is ${most} ms`);
    for (let spoke = 0; spoke < 4000; spoke += 50) {
        const { connection, sockets, clock } = makeConnection({ random: () => 1 });
        connection.start();
        sockets[0].accept();
        sockets[0].say({ type: 'welcome' });
        connection.settle();
        for (let ms = 0; ms < spoke; ms += 50) {
            clock.advance(50);
            sockets[0].say({ type: 'tags' });
        }
        const last = clock.now();
        clock.advance(DEAD_MS - 1);
        assert.equal(sockets.length, 1, 'no new connection before the limit');
        while (sockets.length < 2)
            clock.advance(10);
        assert.ok(clock.now() - last <= most + 10, `left after ${clock.now() - last} ms, the server sent for ${spoke} ms`);
    }
});

test('long lists over a slow link get more time before the first message', () => {
    const { connection, sockets, clock } = makeConnection();
    connection.start();
    sockets[0].accept();
    clock.advance(OPENING_MS - 100);
    assert.equal(connection.state, 'open');
    sockets[0].say({ type: 'welcome' });
    clock.advance(DEAD_MS - 100);
    assert.equal(connection.state, 'open');
    clock.advance(100 + CHECK_MS);
    assert.ok(sockets[0].closed);
});

test('a page that hung longer than the limit processes the messages that arrived meanwhile first', () => {
    for (const answers of [true, false]) {
        const { connection, sockets, clock } = makeConnection();
        connection.start();
        sockets[0].accept();
        sockets[0].say({ type: 'welcome' });
        clock.advance(2100); // advances the clock until a ping has been sent
        clock.time += DEAD_MS + 1000;
        const [[id, late]] = clock.timers;
        clock.timers.delete(id);
        late.f(); // runs the overdue timer before the message that arrived meanwhile is handled, as a browser may do
        assert.equal(connection.state, 'open');
        if (answers)
            sockets[0].say({ type: 'pong' });
        clock.advance(1);
        assert.equal(connection.state, answers ? 'open' : 'waiting');
    }
});

test('a server that sends every two seconds is never given up', () => {
    const { connection, sockets, clock } = makeConnection();
    connection.start();
    sockets[0].accept();
    for (let n = 0; n < 30; n++) {
        clock.advance(2000);
        sockets[0].say({ type: 'status' });
        assert.equal(connection.quiet, false);
    }
    assert.equal(sockets.length, 1);
});

test('a server that never opens the connection is given up', () => {
    const { connection, clock, sockets } = makeConnection();
    connection.start();
    clock.advance(10001);
    assert.equal(connection.reason, 'The server does not answer');
    assert.ok(sockets[0].closed);
});

test('a full server is retried only after the time that it names, or after ten seconds', () => {
    const { clock, sockets, connection } = makeConnection();
    connection.start();
    sockets[0].accept();
    connection.hold(30000);
    sockets[0].fail(1013, 'full');
    clock.advance(29999);
    assert.equal(sockets.length, 1);
    clock.advance(1);
    assert.equal(sockets.length, 2);
    sockets[1].fail(1013);
    clock.advance(9999);
    assert.equal(sockets.length, 2);
    clock.advance(1);
    assert.equal(sockets.length, 3);
});

test('after a refused sign-in the connection retries only with new credentials', () => {
    const { clock, sockets, connection } = makeConnection();
    connection.start();
    sockets[0].accept();
    connection.bar('a token is needed');
    assert.ok(sockets[0].closed);
    assert.deepEqual([connection.state, connection.reason], ['barred', 'a token is needed']);
    clock.advance(600000);
    assert.equal(sockets.length, 1);
    connection.retryNow();
    assert.equal(sockets.length, 2);
});

test('nothing is sent while the connection is not open, and stop is final', () => {
    const { connection, sockets, clock } = makeConnection();
    connection.start();
    assert.equal(connection.send({ type: 'ping' }), false);
    sockets[0].accept();
    assert.equal(connection.send({ type: 'ping' }), true);
    connection.stop();
    clock.advance(60000);
    assert.equal(connection.state, 'stopped');
    assert.equal(sockets.length, 1);
    assert.equal(clock.timers.size, 0);
});

test('forty displays that lose the server at one moment reconnect at different times', () => {
    for (const close of [[1006], [1001, 'the server is stopping; retry after 1 s']]) {
        const waits = Array.from({ length: 40 }, () => {
            const bench = makeConnection({ random: Math.random });
            bench.connection.spreadMs = SPREAD_MS;
            bench.connection.start();
            bench.sockets[0].accept();
            bench.connection.settle();
            bench.sockets[0].fail(...close);
            return waitOf(bench);
        }).sort((a, b) => a - b);
        const most = Math.max(...waits.map((from) => waits.filter((ms) => ms >= from && ms < from + 100).length));
        assert.ok(most <= 12, `${most} of 40 displays reconnect within 100 ms`);
        assert.ok(waits.at(-1) < 4000);
    }
});

test('a display reconnects after each of 200 losses, the last as soon as the first', () => {
    const bench = makeConnection(), { connection, sockets, clock } = bench;
    connection.spreadMs = SPREAD_MS;
    connection.start();
    for (let loss = 0; loss < 200; loss++) {
        for (let n = 0; n < loss % 5; n++) { // several attempts to connect fail
            sockets.at(-1).fail();
            clock.advance(waitOf(bench));
        }
        sockets.at(-1).accept();
        connection.settle();
        assert.equal(connection.state, 'open');
        sockets.at(-1).fail(loss % 2 ? 1006 : 1001);
        assert.ok(waitOf(bench) <= 500 * (1 + JITTER) + SPREAD_MS, `the wait after loss ${loss} is ${waitOf(bench)} ms`);
        clock.advance(waitOf(bench));
    }
});
