// SPDX-License-Identifier: GPL-3.0-or-later
// Forty wall displays lose their server at the same time. Expected: they reconnect at different times, and all show values
// again. Each display runs the page's own connection and session code on a plain socket instead of a browser.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Connection, FIRST_WAIT_MS, JITTER } from '../../clients/web/core/connection.js';
import { Session } from '../../clients/web/core/session.js';
import { SPREAD_MS } from '../../clients/web/core/wall.js';
import { encodeFrame, PlainClient } from './support/plain_client.mjs';
import { notBuilt, TinyPlant } from './support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 240000 };
const DISPLAYS = 40, TEXT = 1, PATIENCE_MS = 120000;
const clock = { now: () => performance.now(), setTimeout: (f, ms) => setTimeout(f, ms), clearTimeout: (id) => clearTimeout(id) };
let plant, displays = [];

// A WebSocket with those members of the browser's WebSocket that core/connection.js uses.
class Socket {
    constructor(port) {
        PlainClient.open(port, { acknowledge: false }).then((client) => this.use(client), () => this.end({ code: 1006, reason: '' }));
    }

    use(client) {
        this.client = client;
        if (this.closed) {
            client.close();
            return;
        }
        client.onMessage = (bytes) => this.onmessage?.({ data: client.opcode === TEXT ? bytes.toString() : new Uint8Array(bytes).buffer });
        this.onopen?.();
        client.until('its end', () => client.closed, 2 ** 31 - 1).then(({ code, text }) => this.end({ code, reason: text }), () => {});
    }

    end(how) {
        this.onclose?.(how);
    }

    send(text) {
        this.client.write(encodeFrame(TEXT, text));
    }

    close() {
        this.closed = true;
        this.client?.close();
    }
}

class Display {
    constructor() {
        this.tries = [];
        this.waits = [];
        this.liveAt = 0; // time when the first picture of this connection arrived
        this.connection = new Connection({ url: '', clock, open: () => {
            this.tries.push(clock.now());
            return new Socket(plant.port);
        } });
        this.connection.spreadMs = SPREAD_MS; // as in clients/web/wall/main.js
        this.session = new Session({ connection: this.connection, now: clock.now, codecs: ['jpeg'] });
        this.session.size = { width: 64, height: 36 };
        this.session.on('frame', (frame) => {
            this.session.drawn(frame, 0);
            this.liveAt ||= clock.now();
        });
        const { onState } = this.connection;
        this.connection.onState = (connection) => {
            onState(connection);
            if (connection.state === 'waiting') {
                this.liveAt = 0;
                this.waits.push(connection.retryAt - clock.now());
            }
        };
        this.connection.start();
    }
}

async function all(what, is) {
    for (const end = clock.now() + PATIENCE_MS; !displays.every(is); await new Promise((done) => setTimeout(done, 20)))
        assert.ok(clock.now() < end, `${what}: ${displays.filter(is).length} of ${DISPLAYS}`);
}

before(async () => {
    if (!options.skip)
        plant = await TinyPlant.running();
});
after(async () => {
    displays.forEach(({ connection }) => connection.stop());
    await plant?.destroy();
});

test('forty displays reconnect one after another, and all are live', options, async (t) => {
    displays = Array.from({ length: DISPLAYS }, () => new Display());
    await all('live', ({ liveAt, session }) => liveAt > 0 && session.isCurrent);
    displays.forEach((display) => { display.tries = []; display.waits = []; });
    await plant.daemon.stop('SIGKILL');
    await all('lost', ({ liveAt, waits }) => liveAt === 0 && waits.length > 0);
    const waits = displays.map((display) => display.waits[0]).sort((a, b) => a - b);
    const most = Math.max(...waits.map((from) => waits.filter((ms) => ms >= from && ms < from + 100).length));
    // if the displays spread evenly, 2 would reconnect within 100 ms on average; 12 allows for chance
    assert.ok(most <= 12, `${most} of ${DISPLAYS} displays reconnected within 100 ms`);
    assert.ok(waits.at(-1) - waits[0] > SPREAD_MS / 2 && waits.at(-1) <= FIRST_WAIT_MS * (1 + JITTER) + SPREAD_MS,
        `the displays waited: ${waits}`);
    const { port } = plant;
    await plant.startDaemon('--port', String(port));
    const began = clock.now();
    await all('live again', ({ liveAt, session }) => liveAt > 0 && session.isCurrent);
    const lives = displays.map(({ liveAt }) => liveAt - began).sort((a, b) => a - b).map(Math.round);
    t.diagnostic(`first tries from ${waits[0].toFixed(0)} to ${waits.at(-1).toFixed(0)} ms after the loss, at most ${most} within ` +
        `100 ms; live from ${lives[0]} to ${lives.at(-1)} ms after the start`);
});
