// SPDX-License-Identifier: GPL-3.0-or-later
// Occasional requests to the server; session.js sends what is needed all the time.
import { cameraMessage } from './camera.js';
import { asAsked } from './session.js';

// Asks for a camera that looks at something (id: asset, tag or null; side: as in plantcast.v1); answered by the event `fitted`.
export function askFit(session, { id = null, side = 'now', projection } = {}) {
    session.post({ type: 'fit', seq: ++session.fitSeq, id, side, ...(projection ? { projection } : {}) });
}

// Goes to a time (null: now; undefined: unchanged) and plays from there.
export function travel(session, atUs, speed = 0) {
    if (session.leader !== null)
        session.follow(null);
    session.post({ type: 'time', ...(atUs === undefined ? {} : { at_us: atUs && Math.round(atUs) }), speed });
}

// Asks what is at a pixel of the picture on the screen, or of that of another camera; the event `picked` has the answer to the newest
// question, with its purpose.
export function askPick(session, [x, y], purpose, camera = null) {
    if (!session.welcomed || !session.picture)
        return;
    session.pickPurpose = purpose;
    const from = camera ?? asAsked(session.picture.camera);
    session.connection.send({ type: 'pick', seq: ++session.pickSeq, x, y, camera: cameraMessage(from) });
}

// Does an action to alarms, [[tag, kind], ...]; answered by the event `alarmed`.
export function actOnAlarm(session, action, alarms, more = {}) {
    session.post({ type: 'alarm', seq: ++session.alarmSeq, action, alarms, ...more });
}

// Sends a message of the engineer's panel: place, gaps, save_tags or prove; answered by the event of its type. Returns its number; 0 if not
// connected.
export function tellAsEngineer(session, type, fields = {}) {
    if (!session.welcomed)
        return 0;
    session.connection.send({ type, seq: ++session.toldSeq, ...fields });
    return session.toldSeq;
}

// Hands the lead to a session that follows this one; confirmed by the event `following`.
export function giveLead(session, other) {
    session.post({ type: 'lead', session: other });
}
