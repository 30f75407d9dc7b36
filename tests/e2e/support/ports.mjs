// SPDX-License-Identifier: GPL-3.0-or-later
// Port numbers for programs that cannot choose their own: neither another test nor an outgoing connection of this machine gets
// the same one.
import { createServer } from 'node:net';

// The same ports as in tests/support/ports.c. They lie below the system's own range for outgoing connections
// (net.ipv4.ip_local_port_range begins at 32768). Ports come in groups of four: the simulator of a plant with several devices
// uses the ports after its first.
const FIRST = 20000, COUNT = 1500, EACH = 4, LOCKS = FIRST + COUNT * EACH;

function listen(port, host) {
    const server = createServer();
    return new Promise((done) => {
        server.once('error', () => done(null));
        server.listen(port, host, () => done(server));
    });
}

// Each group has another port as its lock: the process that listens there owns the group until it ends, in whatever way.
export async function freePort() {
    for (let tries = 0; tries < COUNT; tries++) {
        const n = Math.floor(Math.random() * COUNT), port = FIRST + n * EACH, lock = await listen(LOCKS + n, '127.0.0.1');
        if (!lock)
            continue;
        lock.unref();
        const probe = await listen(port, '0.0.0.0'); // another program may listen there
        if (!probe) {
            lock.close();
            continue;
        }
        await new Promise((done) => probe.close(done));
        return port;
    }
    throw new Error('no port is free');
}
