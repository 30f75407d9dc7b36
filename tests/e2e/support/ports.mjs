// SPDX-License-Identifier: GPL-3.0-or-later
// Reserves port numbers for programs that cannot choose a free port themselves. Neither another test nor an outgoing connection
// of this machine uses a reserved port.
import { createServer } from 'node:net';

// The same range of ports as in tests/support/ports.c. It lies below 32768, where the system's own range for outgoing
// connections (net.ipv4.ip_local_port_range) begins. Ports are reserved in groups of four, because the simulator of a plant
// with several devices also uses the ports after its first one.
const FIRST = 20000, COUNT = 1500, EACH = 4, LOCKS = FIRST + COUNT * EACH;

function listen(port, host) {
    const server = createServer();
    return new Promise((done) => {
        server.once('error', () => done(null));
        server.listen(port, host, () => done(server));
    });
}

// Returns the first port of a free group. Each group has a lock: another port on which the owner of the group listens. The lock
// is free again when the owner's process ends, however it ends.
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
