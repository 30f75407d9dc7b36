// SPDX-License-Identifier: GPL-3.0-or-later
// OPC UA tests that share one server process, because loading node-opcua takes three seconds of processor time.
import { describe } from 'node:test';
import './opcua/server.mjs'; // imported by this file, so that the server is stopped after the last group of tests and not after the first

// The group `hostile` sets the server's clock and therefore runs last: afterwards node-opcua's clock is off by some
// milliseconds.
for (const subject of ['values', 'secure', 'hostile'])
    describe(subject, () => import(`./opcua/${subject}.mjs`));
