// SPDX-License-Identifier: GPL-3.0-or-later
// A picture to keep: what is shown, drawn once more by the server.
import { ask } from '../../core/history.js';
import { snapshotQuery } from '../../core/query.js';
import { say } from '../../core/words.js';
import { make } from '../common/dom.js';

export class Snapshot {
    constructor({ session, tell }) {
        Object.assign(this, { session, tell });
    }

    async save() {
        const { session } = this, { camera, size, time, model } = session;
        try {
            if (!model)
                return;
            if (session.params.show === 'difference' && !session.params.baseline?.name)
                throw new Error(say('snapshot.unnamed'));
            const query = snapshotQuery({ carried: { ...session.carried(), backdrop: null }, camera, size, time });
            const answer = await ask('snapshot.png', query, session.token);
            const url = URL.createObjectURL(await answer.blob()), at = new Date((time.atUs ?? session.clockUs()) / 1000).toISOString();
            make('a', { href: url, download: `${model.plant.name} ${at.slice(0, 19).replace(/:/g, '-')}Z.png` }).click();
            setTimeout(() => URL.revokeObjectURL(url), 10000);
        } catch (error) {
            this.tell(say('snapshot.failed', { why: error.message }));
        }
    }
}
