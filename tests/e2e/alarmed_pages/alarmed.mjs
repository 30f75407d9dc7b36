// SPDX-License-Identifier: GPL-3.0-or-later
// The plant with an alarm that all subjects of this folder look at, each by pages of its own. None of them changes anything of it.
import { after } from 'node:test';
import { startAlarmed } from '../support/panels.mjs';

let plant;
after(async () => (await plant)?.[0].destroy());

// [plant, url]; started by who asks first.
export function alarmed() {
    plant ??= startAlarmed();
    return plant;
}
