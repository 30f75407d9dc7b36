// SPDX-License-Identifier: GPL-3.0-or-later
// OPC UA tests that share one server process, because loading node-opcua takes three seconds of processor time.
import { describe } from 'node:test';
import './opcua/server.mjs'; // imported here, so that the server ends with the program and not with the first group of tests

// The group `hostile` sets the server's clock and therefore runs last: afterwards node-opcua's clock is off by some
// milliseconds.
for (const subject of ['values', 'secure', 'hostile'])
    describe(subject, () => import(`./opcua/${subject}.mjs`));
