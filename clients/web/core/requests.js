// SPDX-License-Identifier: GPL-3.0-or-later
// What a viewer asks of the server now and then, beside what session.js says all the time.
import { cameraMessage } from './camera.js';
import { asAsked } from './session.js';

// Asks for a camera that looks at something (id: asset, tag or null; side: as in plantcast.v1); answered by the event `fitted`.
export function askFit(session, { id = null, side = 'now', projection } = {}) {
    session.post({ type: 'fit', seq: ++session.fitSeq, id, side, ...(projection ? { projection } : {}) });
}

// Goes to an instant (null: to now; undefined: stays where it is) and plays from there.
export function travel(session, atUs, speed = 0) {
    if (session.leader !== null)
        session.follow(null);
    session.post({ type: 'time', ...(atUs === undefined ? {} : { at_us: atUs && Math.round(atUs) }), speed });
}

// Asks what is at a pixel of the picture on the screen, or of another camera's; the event `picked` answers the newest question, and says
// its purpose.
export function askPick(session, [x, y], purpose, camera = null) {
    if (!session.welcomed || !session.picture)
        return;
    session.pickPurpose = purpose;
    const from = camera ?? asAsked(session.picture.camera);
    session.connection.send({ type: 'pick', seq: ++session.pickSeq, x, y, camera: cameraMessage(from) });
}

// alarms: [[tag, kind], ...]; answered by the event `alarmed`.
export function actOnAlarm(session, action, alarms, more = {}) {
    session.post({ type: 'alarm', seq: ++session.alarmSeq, action, alarms, ...more });
}

// What engineers say: place, gaps, save_tags, prove; each answer comes as the event of its type. Its number; 0: nobody listens.
export function tellAsEngineer(session, type, fields = {}) {
    if (!session.welcomed)
        return 0;
    session.connection.send({ type, seq: ++session.toldSeq, ...fields });
    return session.toldSeq;
}

// One of those who follow us leads from now on; the event `following` says that it does.
export function giveLead(session, other) {
    session.post({ type: 'lead', session: other });
}
