// SPDX-License-Identifier: GPL-3.0-or-later
// OPC UA, by one server process: node-opcua takes three seconds of a processor to load.
import { describe } from 'node:test';
import './opcua/server.mjs'; // which ends with the program, not with the first subject

// Last the one that sets the server's clock: node-opcua is some milliseconds off from then on.
for (const subject of ['values', 'secure', 'hostile'])
    describe(subject, () => import(`./opcua/${subject}.mjs`));
