// SPDX-License-Identifier: GPL-3.0-or-later
// Network links that tests can cut, and a tap in front of a device that records who polls. They run in a thread of their own,
// so that a test that blocks while it waits for a program does not delay the traffic.
import { connect, createServer } from 'node:net';
import { isMainThread, parentPort, Worker } from 'node:worker_threads';
import { CuttableLink } from './postgres_server.mjs';
import { until } from './until.mjs';

// current time in ms on a time base that is the same in all threads; performance.now() alone differs by thread
const now = () => performance.timeOrigin + performance.now();

// Opens the tap: relays connections to the device and records in pollers[], for each connection, the number of its requests, the times
// of the first and last one, and whether it has ended.
async function openTap(pollers, port, devicePort) {
    const server = createServer((near) => {
        const far = connect(devicePort, '127.0.0.1');
        let poller = null;
        near.on('data', (bytes) => {
            if (!poller)
                pollers.push(poller = { first: now(), requests: 0, ended: false });
            poller.last = now();
            poller.requests++;
            far.write(bytes);
        });
        far.on('data', (bytes) => near.write(bytes));
        for (const socket of [near, far]) {
            socket.on('error', () => {});
            socket.on('close', () => { near.destroy(); far.destroy(); });
        }
        near.on('close', () => {
            if (poller)
                poller.ended = true;
        });
    });
    await new Promise((done) => server.listen(port, '127.0.0.1', done));
}

if (!isMainThread) {
    const links = [], pollers = [];
    const does = {
        link: async (port, at) => {
            const link = await CuttableLink.open(port, at);
            return { n: links.push(link) - 1, port: link.port };
        },
        set: (n, how) => links[n][how](),
        tap: (port, devicePort) => openTap(pollers, port, devicePort),
        pollers: () => pollers,
    };
    parentPort?.on('message', async ({ id, what, args }) => parentPort.postMessage({ id, answer: await does[what](...args) }));
}

export class Network {
    constructor() {
        this.worker = new Worker(new URL(import.meta.url));
        this.waiting = new Map();
        this.worker.on('message', ({ id, answer }) => { this.waiting.get(id)(answer); this.waiting.delete(id); });
    }
    ask(what, ...args) {
        const id = (this.asked = (this.asked ?? 0) + 1);
        return new Promise((done) => {
            this.waiting.set(id, done);
            this.worker.postMessage({ id, what, args });
        });
    }

    // Opens a link to a port of this machine. Returns { port: where to connect, cut(), cutAnswers(), passAnswers(), freeze(), mend() }.
    async link(port, at = {}) {
        const { n, port: own } = await this.ask('link', port, at);
        return { port: own, cut: () => this.ask('set', n, 'cut'), freeze: () => this.ask('set', n, 'freeze'),
            cutAnswers: () => this.ask('set', n, 'cutAnswers'), passAnswers: () => this.ask('set', n, 'passAnswers'),
            mend: () => this.ask('set', n, 'mend') };
    }
    tap(port, devicePort) { return this.ask('tap', port, devicePort); }

    // Returns, for each pair of connections to the device that were in use at the same time, the overlap in ms. Only one core
    // may poll, so a test expects [].
    async overlaps() {
        const pollers = await this.ask('pollers'), found = [];
        for (let i = 1; i < pollers.length; i++)
            for (let k = 0; k < i; k++)
                if (pollers[i].first <= pollers[k].last)
                    found.push(pollers[k].last - pollers[i].first);
        return found;
    }
    // Returns the longest pause in ms between one connection's last request to the device and the next connection's first one,
    // counting pauses that end at `since` or later.
    async longestPause(since) {
        const turns = await this.ask('pollers');
        return Math.max(0, ...turns.slice(1).map(({ first }, i) => (first >= since ? first - turns[i].last : 0)));
    }
    // Waits until the device has been polled `count` more times.
    async polled(count) {
        const requests = async () => (await this.ask('pollers')).reduce((sum, one) => sum + one.requests, 0), from = await requests();
        await until(`${count} more polls`, async () => await requests() >= from + count);
    }
    // Waits until at most one connection to the device is open: the connections of former leaders send nothing more.
    onePoller() {
        return until('one connection to the device', async () => (await this.ask('pollers')).filter(({ ended }) => !ended).length <= 1);
    }
    async pollerCount() { return (await this.ask('pollers')).length; }
    now() { return now(); }
    close() { return this.worker.terminate(); }
}
