// SPDX-License-Identifier: GPL-3.0-or-later
// Sets up what a group of tests shares, and ends it after the last test of the group.
import { after, before } from 'node:test';

// Calls `prepare` before the first test of the current group; skip: the tests are skipped, so nothing is prepared. `prepare` gets
// own(object), which returns the object. Owned objects are ended in reverse order, also if `prepare`
// fails or one of them cannot be ended.
export function setUp(skip, prepare) {
    const owned = [];
    const own = (object) => {
        owned.push(object);
        return object;
    };
    before(async () => {
        if (!skip)
            await prepare(own);
    });
    after(async () => {
        const errors = [];
        for (const object of owned.reverse()) {
            try {
                await (object.destroy ?? object.stop ?? object.close).call(object);
            } catch (error) {
                errors.push(error);
            }
        }
        if (errors.length > 0)
            throw errors[0];
    });
}
