// SPDX-License-Identifier: GPL-3.0-or-later
// A slow link to a port of this machine (tests/relay/relay.c).
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join, resolve } from 'node:path';

const PROGRAM = join(resolve(process.env.PLANTCAST_OUT ?? 'build/release'), 'tests/relay/relay');
export const relayMissing = () => (existsSync(PROGRAM) ? null : PROGRAM);

export class Relay {
    static async open(port, { bytesPerS, delayMs }) {
        const relay = new Relay();
        relay.child = spawn(PROGRAM, [port, bytesPerS, delayMs].map(String), { stdio: ['pipe', 'pipe', 'inherit'] });
        const line = await new Promise((done) => relay.child.stdout.once('data', (data) => done(data.toString())));
        relay.port = Number(line.match(/listening (\d+)/)[1]);
        return relay;
    }

    close() {
        this.child.stdin.end();
    }
}
