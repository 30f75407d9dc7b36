// SPDX-License-Identifier: GPL-3.0-or-later
// Requests to the server that users cause only occasionally. (session.js sends the frequent ones: cameras, parameters and
// acknowledgements.)
import { basis, cameraMessage, isParallel } from './camera.js';
import { asAsked } from './session.js';
import { halves } from './split_view.js';
import { add, along, dot, subtract } from './vector.js';

// Time in milliseconds after which an unanswered pick request counts as lost.
const REPEAT_MS = 3000;
// purposes of pick requests for clicks that no module repeats
const CLICKS = ['measure', 'placing'];

// Decides when a module repeats an unanswered pick request. Each repetition waits twice as long as the previous one, because a repetition
// makes the session ignore the answers to earlier requests.
export class Repeater {
    constructor() {
        this.reset();
    }

    // The request was answered, or the module does not need its answer any more.
    reset() {
        this.waitMs = 0;
    }

    // A request was sent: a new one after reset(), otherwise a repetition. now: time in milliseconds.
    sent(now) {
        Object.assign(this, { sentAt: now, waitMs: 2 * this.waitMs || REPEAT_MS });
    }

    // Returns true while an unanswered request must not be repeated yet.
    waits(now) {
        return this.waitMs > 0 && now - this.sentAt < this.waitMs;
    }
}

// Asks the server for a camera that shows an asset, a tag or the whole plant (id null); side: as in the message `fit` (PROTOCOL.md). The
// server answers with `fitted`.
export function askFit(session, { id = null, side = 'now', projection } = {}) {
    session.post({ type: 'fit', seq: ++session.fitSeq, id, side, ...(projection ? { projection } : {}) });
}

// Shows an instant (null: now; undefined: the one already shown), and plays from there if `speed` is not 0.
export function travel(session, atUs, speed = 0) {
    if (session.leader !== null)
        session.follow(null);
    session.post({ type: 'time', ...(atUs === undefined ? {} : { at_us: atUs && Math.round(atUs) }), speed });
}

// Asks the server what is at a pixel of the current picture, or of a picture from another camera. The event `picked` has the answer to the
// latest request, with its purpose.
export function askPick(session, [x, y], purpose, camera = null) {
    if (!session.welcomed || !session.picture)
        return;
    Object.assign(session, { pickPurpose: purpose, pickedAt: performance.now() });
    const from = camera ?? asAsked(session.picture.camera);
    session.connection.send({ type: 'pick', seq: ++session.pickSeq, x, y, camera: cameraMessage(from) });
}

// Returns true while the answer to a measuring or placing click is due. Another pick request would replace the click, because the session
// takes only the answer to its newest request.
export function isClickDue(session, now = performance.now()) {
    return CLICKS.includes(session.pickPurpose) && now - session.pickedAt < REPEAT_MS;
}

// Asks the server for the surface point at a pixel, which becomes the centre of the next orbit or zoom. Sends nothing while the answer to
// a measuring or placing click is due.
export function askAnchor(session, pixel, now = performance.now()) {
    if (!isClickDue(session, now))
        askPick(session, pixel, 'anchor');
}

// Asks the server what is at a point of the plant, which may be outside the picture. Sends the pixel in the middle of the half, and the
// camera turned (orthographic: shifted) so that the point is at this pixel. half: half of a split view, 0 left, 1 right.
export function askPoint(session, point, purpose, half = 0, camera = asAsked(session.picture.camera)) {
    const { width, height } = session.following ?? session.size, all = halves(session.params, width), part = all[half] ?? all[0];
    const from = subtract(point, camera.target), { forward } = basis(camera), aside = along(from, forward, -dot(from, forward));
    askPick(session, [part.left + part.width / 2, height / 2], purpose, isParallel(camera)
        ? { ...camera, eye: add(camera.eye, aside), target: add(camera.target, aside) } : { ...camera, target: point });
}

// Applies an action to alarms [[tag, kind], ...]; the server answers with `alarmed`.
export function actOnAlarm(session, action, alarms, more = {}) {
    session.post({ type: 'alarm', seq: ++session.alarmSeq, action, alarms, ...more });
}

// Sends a message of the engineering panel: place (draft positions), gaps, save_tags or prove (result of a loop check). The
// server answers with an event of the same type. Returns the message's sequence number; 0 if not connected.
export function tellAsEngineer(session, type, fields = {}) {
    if (!session.welcomed)
        return 0;
    session.connection.send({ type, seq: ++session.toldSeq, ...fields });
    return session.toldSeq;
}

// Hands the lead to a session that follows this one: from then on, this session follows the other. The server confirms with
// `following`.
export function giveLead(session, other) {
    session.post({ type: 'lead', session: other });
}
