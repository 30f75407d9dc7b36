// SPDX-License-Identifier: GPL-3.0-or-later
// Requests that users cause now and then; session.js sends cameras, parameters and acknowledgements.
import { cameraMessage } from './camera.js';
import { asAsked } from './session.js';

// Requests a camera for an asset, a tag or the whole plant (id: null); side: see plantcast.v1. The event `fitted` answers.
export function askFit(session, { id = null, side = 'now', projection } = {}) {
    session.post({ type: 'fit', seq: ++session.fitSeq, id, side, ...(projection ? { projection } : {}) });
}

// Goes to a time (null: now; undefined: unchanged) and plays from there.
export function travel(session, atUs, speed = 0) {
    if (session.leader !== null)
        session.follow(null);
    session.post({ type: 'time', ...(atUs === undefined ? {} : { at_us: atUs && Math.round(atUs) }), speed });
}

// Requests what is at a pixel of the current picture, or of another camera's; the event `picked` answers the latest request, with its
// purpose.
export function askPick(session, [x, y], purpose, camera = null) {
    if (!session.welcomed || !session.picture)
        return;
    session.pickPurpose = purpose;
    const from = camera ?? asAsked(session.picture.camera);
    session.connection.send({ type: 'pick', seq: ++session.pickSeq, x, y, camera: cameraMessage(from) });
}

// Applies an action to alarms, [[tag, kind], ...]; the event `alarmed` answers.
export function actOnAlarm(session, action, alarms, more = {}) {
    session.post({ type: 'alarm', seq: ++session.alarmSeq, action, alarms, ...more });
}

// Sends a message of the engineering panel: place, gaps, save_tags or prove; the event of the same type answers. Returns its sequence
// number; 0 if not connected.
export function tellAsEngineer(session, type, fields = {}) {
    if (!session.welcomed)
        return 0;
    session.connection.send({ type, seq: ++session.toldSeq, ...fields });
    return session.toldSeq;
}

// Hands the lead to a session that follows this one; the event `following` confirms.
export function giveLead(session, other) {
    session.post({ type: 'lead', session: other });
}
