// SPDX-License-Identifier: GPL-3.0-or-later
// The session of this page with the server: stores the camera and the view's parameters, and sends them again after a reconnect.
import { besideLegend, cameraMessage, cameraOfMessage, home, same, valid } from './camera.js';
import { LatencyMeter, RateMeter } from './meters.js';
import { Model, QUALITIES, quantityText } from './model.js';
import { decodeFrame, decodeMessage, depthGridOf, isGivenUp, WireError } from './wire.js';
import { say } from './words.js';

export const PARAMS = [
    'group', 'interpolation', 'distance', 'fill', 'strength', 'decay', 'power', 'radius_m', 'reach_m', 'colormap', 'ramp_interval', 'range',
    'scale', 'breaks', 'isolines', 'look', 'light', 'environment', 'backdrop', 'arrows', 'selected', 'hidden', 'isolate', 'ghost', 'clip',
    'show', 'split',
];
const SAID = [...PARAMS, 'sensor', 'baseline', 'baselines', 'sensors', 'unit']; // parameters that the server reports
// Parameters that only engineers may send. The build copies this list into the server, from the following line.
export const ENGINEERS = ['fill', 'strength', 'decay', 'power', 'radius_m', 'reach_m', 'sensors'];
export const withoutEngineers = (params) => Object.fromEntries(Object.entries(params).filter(([name]) => !ENGINEERS.includes(name)));
// maySendAll() returns true if a role may send all parameters; a server that sends no role permits all. sendable() leaves out those that
// the role may not send.
export const maySendAll = (role) => !role || role === 'engineer';
export const sendable = (params, role) => (maySendAll(role) ? params : withoutEngineers(params));
// parameters shared by both halves of a split view
const SHARED = ['light', 'environment', 'backdrop', 'arrows', 'selected', 'hidden', 'isolate', 'ghost', 'clip', 'split'];
// parameters with lists of assets: an empty list is sent, too, because the default list of the plant file may not be empty
const SETS = ['hidden', 'isolate', 'ghost'];
const GROUPS_OWN = ['interpolation', 'distance', 'fill', 'power', 'radius_m', 'reach_m', 'scale', 'isolines'];
// types of messages whose contents belong to the instant that is shown, not to the present
const OF_THE_INSTANT = ['tags', 'picked'];
const NOW = { atUs: null, speed: 0, fromUs: null };
const MOST_BACKLOG_BYTES = 64 * 1024, RECENT_MS = 5000;

const pick = (from, names) => Object.fromEntries(names.filter((name) => from[name] !== undefined).map((name) => [name, from[name]]));

// Converts a frame's camera to the form of camera requests. In frames, an orthographic camera has a field of view of 0; the
// page leaves the field out.
export const asAsked = (camera) => (camera.height_m === undefined ? camera : cameraOfMessage({ ...camera, fov: undefined }));

export class Session {
    // wanted: { camera or null, params, time } from the page's URL. Events: hello (new connection), welcome, params, shown, time, tags
    // (indices), status, alarms, alarmed (message), frame (frame), camera, error (message), astray (message: the server refused a part of
    // our view, which was dropped), denied (message: a token is needed), ignored (reason).
    constructor({ connection, now, wanted = { camera: null, params: {} }, codecs = ['jpeg', 'png'] }) {
        Object.assign(this, { connection, now, codecs });
        this.listeners = new Map();
        this.model = null;
        this.camera = wanted.camera;
        this.params = { ...wanted.params };
        this.token = null;       // access token; null: none
        // secret that lets the server restore this session after a reconnect
        this.resume = null;
        this.anew = false; // true: a reconnect restores only this session's id, which its followers use, but not its view
        // view parameters that the server last confirmed
        this.confirmed = null;
        this.size = { width: 640, height: 360 };
        this.visible = true;
        this.unsent = {};        // parameters changed while disconnected
        // sequence number -> view parameters sent with it: pictures on the way may still show earlier ones
        this.asked = new Map();
        this.cameraSeq = this.paramsSeq = this.fitSeq = this.pickSeq = this.alarmSeq = this.toldSeq = 0;
        this.cameraNews = false; // true: the camera has changed but has not been sent yet
        this.cameraInput = null; // time of the user's input that set the camera; the latency of its picture is measured from that time
        this.markers = new Map();
        // largest errors in uncertain places, by half of a split view (message `markers`)
        this.drawnErrors = [0, 0];
        // { us, at }: the server's time, and the page's time when it arrived
        this.serverTime = null;
        // time of the server's last message: if messages stop, the picture's age counts from here
        this.freshAt = null;
        this.outlived = null;    // picture of the previous connection
        this.rate = new RateMeter();
        this.latency = new LatencyMeter();
        // recent pictures, for the latencies in core/timings.js: { picture, decodeMs, hereUs (server's time when it was
        // decoded) }
        this.recent = [];
        // { us, roundTripMs }: the server's clock minus the page's, measured at the shortest round trip so far
        this.skew = null;
        // id of this session; other sessions use it to follow its view
        this.id = null;
        // the session that this one follows: { session (id), width, height, gone (true: it has ended, and its last view is shown) }; null:
        // none
        this.following = null;
        this.leader = null;      // id of the session to follow, also after a reconnect; null: none
        // camera of the followed session while this session shows it; null: none
        this.lent = null;
        this.followers = { count: 0, sessions: [], names: [] }; // sessions that follow this one
        // true: asks the server for depth grids, which let the page show a picture from another camera
        this.wantsDepth = false;
        // newest depth grids: { messages (binary), more (true: the grid of the split view's other half has not arrived), seq (number
        // of the picture that the grid belongs to) }
        this.depth = null;
        this.forget();
        // the instant shown, as the server reports it; atUs null: the present; fromUs: start of the recorded history, null: none
        this.time = { ...NOW, ...wanted.time };
        connection.onOpen = () => {
            const compares = this.params.show === 'difference' && this.params.baseline?.name;
            this.hello(['camera', 'params', ...(compares ? ['baseline'] : [])]);
        };
        // [[arrival time, text], ...]: text messages that are held back between wait() and listen(); null: messages are handled
        // at once
        this.unheard = null;
        connection.onText = (text) => (this.unheard ? this.unheard.push([this.now(), text]) : this.hear(text));
        connection.onBytes = (bytes) => this.guard(() => {
            this.freshen();
            const grid = depthGridOf(bytes), { depth } = this;
            // a left half whose right half has not arrived is dropped when the grid of another picture arrives
            if (grid)
                this.depth = { ...grid, messages: [...(depth?.more && depth.seq === grid.seq ? depth.messages : []), bytes] };
            else if (!isGivenUp(bytes))
                this.receive(decodeFrame(bytes));
        });
    }

    on(name, listener) {
        this.listeners.set(name, [...(this.listeners.get(name) ?? []), listener]);
    }

    // Calls the listener at each message `welcome`, and immediately if one has already arrived.
    greeted(listener) {
        this.on('welcome', listener);
        if (this.model)
            listener();
    }

    // Holds back all text messages until listen() is called; frames are handled immediately.
    wait() {
        this.unheard = [];
    }

    // Handles the messages that were held back, with their arrival times.
    listen() {
        const { now, unheard } = this;
        this.unheard = null;
        try {
            for (const [at, text] of unheard) {
                this.now = () => at;
                this.hear(text);
            }
        } finally {
            this.now = now;
        }
    }

    // Attaches the depth grids that belong to a frame, and passes the frame on.
    receive(frame) {
        frame.depth = frame.hasDepth && !this.depth?.more ? this.depth : null;
        this.emit('frame', frame);
    }

    hear(text) {
        this.guard(() => this.heard(decodeMessage(text)));
    }

    emit(name, value) {
        for (const listener of this.listeners.get(name) ?? [])
            listener(value);
    }

    guard(f) {
        try {
            f();
        } catch (error) {
            if (!(error instanceof WireError))
                throw error;
            this.emit('ignored', error.message);
        }
    }

    // --- to the server

    // Sends a message, if the server has welcomed this session.
    post(message) {
        if (this.welcomed)
            this.connection.send(message);
    }

    // Sends `hello`, the first message of a connection. parts: which parts of the page's view to ask for: its camera, its
    // parameters, its baseline (saved readings to compare with).
    hello(parts) {
        const { shown } = this;
        this.welcomed = false;
        this.outlived = this.picture;
        if (this.unheard)
            // drops the text messages of the previous connection that were held back
            this.unheard = [];
        this.emit('hello');
        this.helloParts = parts;
        this.greetedSize = this.size;
        this.unsent = {};
        this.markers.clear();
        this.latency.clear();
        this.cameraSeq = this.paramsSeq = 0;
        this.asked = new Map([[-1, shown]]);
        if (this.picture)
            // The shown picture's parameter number is from the previous connection, and the new connection may use it again.
            // Replaces it by -1, which is never used.
            this.picture.paramsSeq = -1;
        this.greetedCamera = parts.includes('camera') ? this.camera : null;
        const message = { type: 'hello', ...this.size, ...this.proofs(), codecs: this.codecs,
            ...(this.wantsDepth ? { depth: true } : {}) };
        this.depth = null;
        if (this.time.atUs !== null)
            Object.assign(message, { at_us: this.time.atUs, speed: this.time.speed });
        if (this.greetedCamera)
            message.camera = { seq: ++this.cameraSeq, ...cameraMessage(this.greetedCamera) };
        const params = { ...this.carried({ baseline: parts.includes('baseline') }), ...pick(this.params, SETS) };
        if (parts.includes('params') && Object.keys(params).length > 0)
            message.params = { seq: ++this.paramsSeq, ...params };
        this.connection.send(message);
    }

    // Returns the user's token and the resume secret for `hello`. With the secret, the server restores parameters that the page does not
    // send.
    proofs() {
        return { ...(this.token ? { token: this.token } : {}),
            ...(this.resume ? { resume: this.resume, idle_ms: Math.max(0, Date.now() - this.connection.activeAt) } : {}),
            ...(this.anew ? { anew: true } : {}) };
    }

    // Returns the default parameters of the shown sensor group and the plant, which need not be sent to the server.
    get ownParams() {
        return this.ownOf(this.group);
    }

    // Returns the default picture parameters (range, colours, ...) of a sensor group.
    ownOf(group) {
        const own = group ? { ...pick(group, GROUPS_OWN), range: [group.min, group.max], strength: 1, decay: 1 } : {};
        return { ...this.model?.start, ...own };
    }

    // Returns the view's parameters to send after a reconnect. Parameters equal to the defaults are left out, because the
    // plant's defaults may have changed. baseline false: leaves out the baseline (saved readings to compare with), which the
    // server may have lost.
    carried({ baseline = true } = {}) {
        const { ownParams: own } = this, params = sendable(this.params, this.role);
        const wanted = pick(params, PARAMS.filter((name) => JSON.stringify(params[name]) !== JSON.stringify(own[name])));
        if (Object.keys(params.sensors ?? {}).length > 0)
            wanted.sensors = params.sensors;
        if (wanted.split)
            wanted.split = pick(sendable(wanted.split, this.role), PARAMS.filter((name) => !SHARED.includes(name)));
        if (wanted.show === 'distance')
            wanted.sensor = params.sensor;
        if (wanted.show === 'difference' && baseline && params.baseline?.name)
            wanted.baseline = params.baseline.name;
        else if (wanted.show === 'difference')
            delete wanted.show;
        return wanted;
    }

    // inputTime: time of the input that moved the camera; latency is measured from it.
    setCamera(camera, inputTime = this.now()) {
        if (!valid(camera) || same(camera, this.camera))
            return;
        if (this.leader !== null)
            this.follow(null);
        this.camera = camera;
        this.lent = null;
        this.cameraNews = true;
        this.cameraInput ??= inputTime;
        this.emit('camera');
    }

    setParams(change) {
        if (this.leader !== null)
            this.follow(null);
        const own = change.group && change.group !== this.params.group ? pick(this.model?.group(change.group) ?? {}, GROUPS_OWN) : {};
        const split = change.split && { split: { ...this.params.split, ...change.split } };
        // The followed session may have used the next number, too. Forgets the parameters stored under this number.
        const next = this.paramsSeq + 1;
        if (this.picture?.paramsSeq === next)
            this.keepShown(this.shown);
        this.asked.delete(next);
        this.remember(this.paramsSeq, this.params);
        this.params = { ...this.params, ...own, ...change, ...split, ...this.mergedSensors(change.sensors) };
        if (this.welcomed)
            this.connection.send({ type: 'params', seq: ++this.paramsSeq, ...change });
        else
            Object.assign(this.unsent, change);
        this.emit('params');
    }

    // Stores which view parameters pictures with this number show.
    remember(seq, params) {
        this.asked.delete(seq); // so that the number becomes the newest
        this.asked.set(seq, params);
    }

    // Marks the picture on the screen as showing these parameters, under the number -1, which the server never sends.
    keepShown(params) {
        this.remember(-1, params);
        this.picture.paramsSeq = -1;
    }

    // Forgets all parameters stored before those with the number `seq`. If `seq` is not stored, forgets all.
    forgetBefore(seq) {
        for (const earlier of this.asked.keys()) {
            if (earlier === seq)
                break;
            this.asked.delete(earlier);
        }
    }

    // Merges changed factors of single sensors into the current ones. null for a sensor removes its factors; null as a whole removes all.
    mergedSensors(change) {
        if (change === undefined)
            return {};
        const all = change === null ? [] : Object.entries({ ...this.params.sensors, ...change });
        return { sensors: Object.fromEntries(all.filter(([, own]) => own !== null)) };
    }

    resize(size) {
        if (size.width === this.size.width && size.height === this.size.height && size.pixel_ratio === this.size.pixel_ratio)
            return;
        this.size = size;
        this.post({ type: 'resize', ...size });
    }

    setVisible(visible) {
        this.visible = visible;
        this.post({ type: 'visible', visible });
    }

    // Sends the newest camera, if it has not been sent yet and the connection's send buffer has room. Called once per animation
    // frame.
    flush() {
        if (!this.cameraNews || !this.welcomed || this.connection.backlogBytes > MOST_BACKLOG_BYTES)
            return;
        if (this.connection.send({ type: 'camera', seq: ++this.cameraSeq, ...cameraMessage(this.camera) }) && this.cameraInput !== null)
            this.latency.sent(this.cameraSeq, this.cameraInput);
        this.cameraNews = false;
        this.cameraInput = null;
    }

    // session: id of the session to follow; null: follow none and show this session's own view again.
    follow(session) {
        this.leader = session;
        if (session === null)
            this.following = null;
        this.post({ type: 'follow', session });
        this.emit('following');
    }

    // True if the server's messages belong to the picture on the screen. After a reconnect, they do not until the first new picture.
    get isCurrent() {
        return this.welcomed && (!this.picture || this.picture !== this.outlived);
    }

    freshen() {
        if (this.isCurrent)
            this.freshAt = this.now();
    }

    // Updates rate, latency and the shown picture after a frame has been drawn on the screen.
    drawn(frame, decodeMs) {
        const now = this.now();
        this.rate.count(now);
        this.latency.drawn(frame.cameraSeq, now);
        const { camera: was, shown } = this;
        if (this.lent)
            this.camera = asAsked(frame.camera);
        this.picture = { ...frame, payload: null, bytes: frame.payload?.length ?? 0, at: now };
        if (this.following && !this.asked.has(frame.paramsSeq)) {
            // No message `following` has named this number: the server has skipped the number, or its message arrives later. The
            // parameters shown so far stay.
            this.keepShown(shown);
        } else
            this.forgetBefore(frame.paramsSeq);
        if (this.shown !== shown)
            this.emit('shown');
        this.freshen();
        this.recent = this.recent.filter(({ picture }) => now - picture.at <= RECENT_MS);
        this.recent.push({ picture: this.picture, decodeMs, hereUs: this.skew ? now * 1000 + this.skew.us : this.clockUs(now) });
        this.connection.send({ type: 'ack', seq: frame.seq, decode_ms: Math.round(decodeMs * 100) / 100 });
        if (!this.following && !same(was, this.camera))
            this.emit('camera');
    }

    // Acknowledges a frame that cannot be decoded. Without the acknowledgement the server would send no more frames.
    passedOver(frame) {
        if (!frame.more)
            this.connection.send({ type: 'ack', seq: frame.seq });
    }

    // Requests a key frame, because the decoder has lost frames that later ones refer to.
    askKeyFrame() {
        this.post({ type: 'key_frame' });
    }

    setCodecs(codecs) {
        this.codecs = codecs;
        this.post({ type: 'codecs', codecs });
    }

    // --- from the server

    heard(message) {
        const ofThen = this.time.atUs !== null && OF_THE_INSTANT.includes(message.type);
        if (message.time_us !== undefined && !ofThen)
            this.serverTime = { us: message.time_us, at: this.now() };
        this.freshen();
        const handler = HANDLERS[message.type];
        if (!handler)
            this.emit('ignored', `message of type ${message.type}`);
        else if (message.type === 'welcome' || message.type === 'error' || this.model)
            handler.call(this, message);
        if (message.not_kept || message.unaudited)
            this.emit('unkept', message);
    }

    // Sends visibility, size and parameters that have changed between `hello` and the server's `welcome`.
    catchUp() {
        if (!this.visible)
            this.setVisible(false);
        if (this.size !== this.greetedSize)
            this.connection.send({ type: 'resize', ...this.size });
        if (Object.keys(this.unsent).length > 0)
            this.setParams(this.unsent);
    }

    // Sends `hello` again after a refusal, without the parameter that the server named. If the server named none, leaves out the last of
    // helloParts (parts of the view, such as camera and parameters), so that repeated refusals end with a hello without any part.
    helloWithout(name) {
        const isParam = name !== 'baseline' && this.params[name] !== undefined;
        if (isParam)
            delete this.params[name];
        if (name === 'sensor')
            delete this.params.show;
        this.hello(isParam ? this.helloParts : this.helloParts.slice(0, -1));
    }

    // Returns a Map from "tag/half" (half of a split view: 0 left, 1 right) to { occluded, value, quality } for a picture, with
    // its `isolines`; forgets the markers of earlier pictures. Tags that are not in the Map have no marker: hidden, clipped or
    // behind the camera. Returns null if no markers are known.
    markersOf(seq) {
        let newest = null;
        for (const known of [...this.markers.keys()].sort((a, b) => a - b).filter((key) => key <= seq)) {
            this.markers.delete(newest);
            newest = known;
        }
        return this.markers.get(newest) ?? null;
    }

    // --- state of the view that the page reads

    // Returns the home camera for a window size in CSS pixels. legendLies() returns true if the legend lies across the top of the picture,
    // null if the picture has no legend.
    homeIn(width, height) {
        const { plant, groups: [group] } = this.model, lies = this.legendLies?.() ?? null, title = `${quantityText(group)} ${group.unit}`;
        return home(plant, width, height, lies === null ? {} : besideLegend(width, height, lies, title.length));
    }

    // Empties the lists that all users share; the server sends them again after `hello`. views: [{ id, title, view, fixed } or { id, title,
    // view, by, time_us }]; notes: shift notes; pointed: positions at which users point on walls; walls: views that users sent to panes of
    // walls, and the connected displays.
    forget() {
        Object.assign(this, { views: [], notes: [], pointed: [], walls: null });
    }

    get group() {
        return this.model?.group(this.params.group) ?? null;
    }

    // View parameters of the picture on the screen. The newest parameters may differ until their picture arrives.
    get shown() {
        return this.asked.get(this.picture?.paramsSeq) ?? this.params;
    }

    // Returns the range [min, max] of the colour scale for view parameters, such as those of one half of a split view.
    rangeOf(params) {
        const group = this.model?.group(params.group);
        return params.range ?? (group ? [group.min, group.max] : [0, 1]);
    }

    get range() {
        return this.rangeOf(this.params);
    }

    // Returns the colour scale of view parameters as { min, max, scale }, for decimalsOf() in format.js.
    scaleOf(params) {
        const [min, max] = this.rangeOf(params);
        return { min, max, scale: params.scale };
    }

    // Returns the server's time, continued by the page's clock; null before the server's first message.
    clockUs(now = this.now()) {
        return this.serverTime && this.serverTime.us + (now - this.serverTime.at) * 1000;
    }
}

// Handlers of the server's messages by type; `this` is the session.
const HANDLERS = {
    welcome(message) {
        const before = this.model;
        this.model = new Model(message);
        // drops the sensor markers and the drawn errors of the previous plant or connection
        this.markers.clear();
        this.drawnErrors = [0, 0];
        this.forget();
        this.welcomed = true;
        this.id = message.session;
        this.following = this.skew = this.lent = null;
        this.followers = { count: 0, sessions: [], names: [] };
        this.resume = message.resume ?? null;
        this.anew = false;
        this.role = message.role ?? null;
        this.imports = message.imports === true;
        this.reprojects = message.reprojection === true;
        this.signs = message.signing_key;
        this.codec = message.codec;
        this.connection.settle();
        this.confirmed = this.params = pick(message.view, SAID);
        const isOther = before && before.identity !== this.model.identity;
        if (before && !isOther)
            this.model.alarms.times = before.alarms.times;
        if (!this.helloParts.includes('camera') || isOther)
            this.camera = null;
        const { width, height, pixel_ratio: ratio = 1 } = this.size;
        this.camera ??= this.homeIn(width / ratio, height / ratio);
        this.cameraNews = !same(this.camera, this.greetedCamera ?? this.model.plant.home);
        this.catchUp();
        if (this.leader !== null)
            this.connection.send({ type: 'follow', session: this.leader });
        this.emit('welcome');
        this.emit('params');
    },

    params(message) {
        if (message.seq < this.paramsSeq)
            return; // ignores the answer to an earlier change of parameters, because a newer change has been sent
        this.confirmed = this.params = pick(message, SAID);
        this.emit('params');
    },

    tags(message) {
        this.emit('tags', this.model.update(message.values, this.now(), message.age_ms));
    },

    pong(message) {
        const now = this.now(), roundTripMs = now - message.t;
        if (roundTripMs >= 0 && roundTripMs <= (this.skew?.roundTripMs ?? Infinity))
            this.skew = { us: message.time_us - (now - roundTripMs / 2) * 1000, roundTripMs };
        this.model.notOlder(message.oldest_age_ms ?? null, this.now());
    },

    // The message `markers` of a frame. The first one has all sensor markers, later ones only changed markers.
    markers(message) {
        const newest = this.markers.get(Math.max(...this.markers.keys())) ?? new Map();
        const known = message.markers ? new Map(message.markers.map(([tag, , , occluded, half = 0, value = null, quality = null]) =>
            [`${tag}/${half}`, { occluded: occluded !== 0, value, quality: QUALITIES[quality] ?? null }])) : new Map(newest);
        for (const [tag, half, value, quality = 0] of message.values ?? []) {
            const id = `${tag}/${half}`;
            known.set(id, { ...known.get(id), value, quality: QUALITIES[quality] ?? null });
        }
        known.isolines = message.isolines ?? newest.isolines;
        known.arrows = message.arrows ?? newest.arrows;
        const { drawn_error: left, drawn_error_right: right } = message;
        if (left !== undefined || right !== undefined)
            this.emit('shown', this.drawnErrors = [left ?? this.drawnErrors[0], right ?? this.drawnErrors[1]]);
        this.markers.set(message.seq, known);
    },

    // Later pictures with the number `params_seq` show the parameters in this message. The followed session and this one may use equal
    // numbers. Therefore the picture on the screen, which keeps its parameters, gets a number that is never used. An older server
    // sends no number: the parameters are then taken to be those of the picture on the screen.
    following({ session, who, width, height, gone = false, params_seq: seq, ...shown }) {
        const { shown: before, picture } = this;
        this.lent ||= session ?? this.leader;
        // If the followed session has ended, the message does not name its user: keeps the name known so far.
        const name = who ?? (this.following?.session === session ? this.following.who : undefined);
        this.following = session === null ? null : { session, who: name, width, height, ...(gone ? { gone } : {}) };
        this.leader = session;
        this.confirmed = this.params = pick(shown, SAID);
        if (seq === undefined)
            this.asked.clear();
        else if (picture) {
            const { paramsSeq } = picture;
            this.keepShown(before);
            this.remember(paramsSeq, before);
        }
        if (session === null)
            this.asked.delete(this.paramsSeq); // the followed session may have used this number, too
        if (seq !== undefined)
            this.remember(seq, this.params);
        this.emit('params');
        this.emit('following');
    },

    followers({ count, sessions, names = [] }) {
        this.followers = { count, sessions, names };
        this.emit('followers');
    },

    time(message) {
        this.time = { atUs: message.at_us ?? null, speed: message.speed ?? 0, fromUs: message.from_us ?? null };
        this.recorded = true;
        this.model.stop(this.time.atUs !== null);
        this.emit('time');
    },

    camera(message) {
        if (message.seq === this.fitSeq)
            this.emit('fitted', cameraOfMessage(message));
    },

    picked(message) {
        if (message.seq !== this.pickSeq)
            return;
        const purpose = this.pickPurpose;
        this.pickPurpose = null; // answered
        this.emit('picked', { ...message, purpose });
    },

    alarms(message) {
        this.model.alarms.hear(message);
        this.emit('alarms');
    },

    // Draft sensor positions of an engineer, which only this session sees until they are saved.
    placed(message) {
        this.model.place(message.sensors);
        this.emit('placed', message);
    },

    proofs(message) {
        this.model.hearProofs(message);
        this.emit('proofs', message);
    },

    status(message) {
        this.model.links = message.links;
        this.model.live = message.live;
        this.model.standby = message.standby ?? null;
        this.model.clockSet = message.clock_set !== false;
        this.model.clockErrorMs = message.clock_error_ms ?? null;
        this.model.leapS = message.leap_s ?? 0;
        this.emit('status', message);
    },

    error(message) {
        if (['token_needed', 'bad_token', 'locked'].includes(message.code)) {
            this.connection.bar(say(`reason.${message.code}`));
            this.emit('denied', message);
            return;
        }
        if (message.code === 'full') {
            this.connection.hold((message.retry_after_s ?? 10) * 1000);
            return;
        }
        if (message.about === 'hello' && !this.welcomed && this.helloParts.length > 0) {
            // the server refused a part of the view that the page asked for, because this plant or server version does not have it: sends
            // `hello` again without that part
            this.emit('astray', message);
            this.helloWithout(message.text.split(':')[0]);
            return;
        }
        // the session to follow has ended or has not started yet: app/sharing/following.js asks again later
        if (message.about === 'follow' && this.leader !== null) {
            this.emit('following');
            return;
        }
        // a server that records no history shows the present, and never sends the message `time`
        if (message.about === 'time' && message.refusal?.code === 'unrecorded') {
            Object.assign(this, { time: { ...NOW }, recorded: false });
            this.model.stop(false);
            this.emit('time');
        }
        if (message.about === 'params' && this.confirmed) {
            this.params = this.confirmed;
            this.asked.clear();
            this.emit('params');
        }
        this.emit('error', message);
    },

    ...Object.fromEntries(['views', 'notes', 'pointed', 'walls'].map((type) =>
        [type, function keep(message) {
            this[type] = message.displays ? message : message.list;
            this.emit(type);
        }])),
    ...Object.fromEntries('alarmed gaps places_accepted tags_diff tags_saved proved view_saved view_shared noted sent_to_wall paired'
        .split(' ').map((type) => [type, function passOn(message) { this.emit(type, message); }])),
};
