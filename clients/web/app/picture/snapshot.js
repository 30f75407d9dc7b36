// SPDX-License-Identifier: GPL-3.0-or-later
// Saves a picture as a file. The server redraws it with the active notes; if the server signs frames, the file is the exact frame on the
// screen.
import { ask } from '../../core/http.js';
import { inForce } from '../../core/notes.js';
import { snapshotQuery } from '../../core/query.js';
import { halves } from '../../core/split_view.js';
import { language, say } from '../../core/words.js';
import { make, styled } from '../common/dom.js';
import { closeButton } from '../common/widgets.js';

const FLAG_SIGNED = 64; // flag of a frame whose payload is a signed PNG file
const SIGNED_WAIT_MS = 15000;

export class Snapshot {
    constructor({ session, tell }) {
        Object.assign(this, { session, tell, pending: null });
        session.on('frame', (frame) => frame.flags & FLAG_SIGNED && this.pending?.frames.set(frame.seq, frame));
        session.on('hello', () => this.pending?.fail(new Error(say('reason.unreachable'))));
        // ends the pending request for a signed file without a message: the page's error handler tells the user the reason
        session.on('error', ({ about, code }) => (about === 'sign' || code === 'not_signed') && this.pending?.fail(null));
    }

    save() {
        if (!this.session.signs)
            this.saveBy(() => this.drawnAgain());
        else if (!this.pending)
            this.choose();
    }

    async choose() {
        // loads the dialog's style sheet; if the server is unreachable, opens the dialog without it
        await styled('help/help').catch(() => {});
        this.dialog ??= this.makeDialog();
        this.dialog.showModal();
    }

    makeDialog() {
        const choice = (name, of) => [make('p', { class: 'note', id: `snapshot-${name}-note` }, say(`snapshot.${name}.note`)),
            make('button', { type: 'button', id: `snapshot-${name}`, 'aria-describedby': `snapshot-${name}-note`, onclick: () => {
                dialog.close();
                this.saveBy(of);
            } }, say(`snapshot.${name}`))];
        const dialog = make('dialog', { class: 'help ask', 'aria-labelledby': 'snapshot-title' },
            make('h2', { id: 'snapshot-title' }, say('bar.snapshot')), closeButton('close', () => dialog.close()),
            make('form', {}, ...choice('shown', () => this.onScreen()), ...choice('again', () => this.drawnAgain())));
        dialog.addEventListener('click', (event) => event.target === dialog && dialog.close());
        document.body.append(dialog);
        return dialog;
    }

    // Saves the picture that picture() makes. picture() returns a promise of { blob, us }: a PNG file, and its instant in microseconds.
    async saveBy(picture) {
        const { model } = this.session;
        try {
            if (!model)
                return;
            const { blob, us } = await picture(), url = URL.createObjectURL(blob), at = new Date(us / 1000).toISOString();
            make('a', { href: url, download: `${model.plant.name} ${at.slice(0, 19).replace(/:/g, '-')}Z.png` }).click();
            setTimeout(() => URL.revokeObjectURL(url), 10000);
        } catch (error) {
            if (error)
                this.tell(say('snapshot.failed', { why: error.message }));
        }
    }

    async drawnAgain() {
        const { session } = this, { camera, size, time } = session;
        if (session.params.show === 'difference' && !session.params.baseline?.name)
            throw new Error(say('snapshot.unnamed'));
        // reads all values before waiting for the server, because the user may change the view or the instant meanwhile
        const query = { ...snapshotQuery({ carried: session.carried(), camera, size, time }), language }, now = session.clockUs();
        // no notes are added to a signed file, because they would invalidate its signature
        const us = time.atUs ?? now, notes = session.signs ? [] : inForce(session.notes, now, time.atUs);
        const place = { model: session.model, camera, half: halves(session.params, size.width)[0] };
        const blob = await (await ask('snapshot.png', query, session.token)).blob();
        return { blob: notes.length === 0 ? blob : await (await import('./snapshot_notes.js')).addNotes(blob, notes, place), us };
    }

    // Asks the server to sign the next refined frame (frame in final quality). Returns its PNG file once that frame is on the
    // screen.
    async onScreen() {
        const { session } = this, frames = new Map();
        let timer;
        const drawn = new Promise((done, fail) => {
            const look = () => {
                const frame = frames.get(session.picture?.seq);
                if (frame)
                    done(frame);
                else if (this.pending)
                    requestAnimationFrame(look);
            };
            this.pending = { frames, fail };
            timer = setTimeout(() => fail(new Error(say('snapshot.late'))), SIGNED_WAIT_MS);
            session.post({ type: 'sign', frames: 'refined' });
            look();
        });
        try {
            const frame = await drawn;
            return { blob: new Blob([frame.payload], { type: 'image/png' }), us: frame.dataTimeUs };
        } finally {
            clearTimeout(timer);
            this.pending = null;
            session.post({ type: 'sign', frames: 'none' });
        }
    }
}
