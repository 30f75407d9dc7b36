// SPDX-License-Identifier: GPL-3.0-or-later
// OPC UA, by one server process: node-opcua takes three seconds of a processor to load.
import { describe } from 'node:test';
import './opcua/server.mjs'; // which ends with the program, not with the first subject

// First the one whose first test needs the server's port.
for (const subject of ['hostile', 'values', 'secure'])
    describe(subject, () => import(`./opcua/${subject}.mjs`));
