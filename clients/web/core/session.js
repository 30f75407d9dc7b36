// SPDX-License-Identifier: GPL-3.0-or-later
// One viewer's session with the server: owns camera and parameters, and sends them again after a reconnect.
import { besideLegend, cameraMessage, cameraOfMessage, home, same, valid } from './camera.js';
import { quantityText } from './format.js';
import { LatencyMeter, RateMeter } from './meters.js';
import { Model } from './model.js';
import { decodeFrame, decodeMessage, isGivenUp, WireError } from './wire.js';
import { say } from './words.js';

export const PARAMS = [
    'group', 'interpolation', 'distance', 'fill', 'strength', 'decay', 'power', 'radius_m', 'reach_m', 'colormap', 'ramp_interval', 'range',
    'scale', 'breaks', 'isolines', 'look', 'light', 'environment', 'backdrop', 'arrows', 'selected', 'hidden', 'isolate', 'ghost', 'clip',
    'show', 'split',
];
const SAID = [...PARAMS, 'sensor', 'baseline', 'baselines', 'sensors', 'unit']; // parameters that the server reports
export const ENGINEERS = ['fill', 'strength', 'decay', 'power', 'radius_m', 'reach_m', 'sensors']; // parameters for engineers only
// parameters that both halves of a split view share
const SHARED = ['light', 'environment', 'backdrop', 'arrows', 'selected', 'hidden', 'isolate', 'ghost', 'clip', 'split'];
// Always sent, whatever the plant's defaults are.
const SETS = ['hidden', 'isolate', 'ghost'];
const GROUPS_OWN = ['interpolation', 'distance', 'fill', 'power', 'radius_m', 'reach_m', 'scale', 'isolines'];
const OF_THE_INSTANT = ['tags', 'picked']; // messages whose time is the shown instant
const NOW = { atUs: null, speed: 0, fromUs: null };
const QUALITIES = ['good', 'uncertain', 'bad'];
const MOST_BACKLOG_BYTES = 64 * 1024, RECENT_MS = 5000;

const pick = (from, names) => Object.fromEntries(names.filter((name) => from[name] !== undefined).map((name) => [name, from[name]]));

// Returns a frame's camera as requested: frames of orthographic cameras have a field of view of 0.
export const asAsked = (camera) => (camera.height_m === undefined ? camera : cameraOfMessage({ ...camera, fov: undefined }));

export class Session {
    // wanted: { camera or null, params, time } from the page's URL. Events: hello (new connection), welcome, params, shown, time, tags
    // (indices), status, alarms, alarmed (message), frame (frame), camera, error (message), astray (message: a part of our view was refused
    // and dropped), denied (message: a token is needed), ignored (reason).
    constructor({ connection, now, wanted = { camera: null, params: {} }, codecs = ['jpeg', 'png'] }) {
        Object.assign(this, { connection, now, codecs });
        this.listeners = new Map();
        this.model = null;
        this.camera = wanted.camera;
        this.params = { ...wanted.params };
        this.token = null;       // access token, where one is needed
        this.resume = null;      // secret that resumes this session on the server
        this.anew = false; // true: resumes only the session's id, by which others follow it, and not its view
        this.confirmed = null;   // parameters that the server last confirmed
        this.size = { width: 640, height: 360 };
        this.visible = true;
        this.unsent = {};        // parameters changed while disconnected
        this.asked = new Map();  // seq -> earlier parameters that pictures may still show
        this.cameraSeq = this.paramsSeq = this.fitSeq = this.pickSeq = this.alarmSeq = this.toldSeq = 0;
        this.cameraNews = false; // true: the camera changed and was not sent yet
        this.cameraInput = null; // time of the input that set the camera; start of the latency
        this.markers = new Map();
        this.serverTime = null;  // { us, at }: server time, and when it arrived
        this.freshAt = null;     // time of the last message from the server, for the picture's age once messages stop
        this.outlived = null;    // picture of the previous connection
        this.rate = new RateMeter();
        this.latency = new LatencyMeter();
        this.recent = [];        // recent pictures: { picture, decodeMs, hereUs }
        this.skew = null;        // { us, roundTripMs }: server clock minus ours, at the shortest round trip
        this.id = null; // id of this session, by which others follow it
        // followed session: { session: its id, width, height, gone: true if it has ended and only its last view is known }
        this.following = null;
        this.leader = null;      // session to follow, also after a reconnect; null: none
        this.lent = null;        // camera taken over from the followed session; null: none
        this.followers = { count: 0, sessions: [] }; // sessions that follow this one
        this.forget();
        // state of the time bar as the server reports it: atUs null: now; fromUs null: nothing is recorded
        this.time = { ...NOW, ...wanted.time };
        connection.onOpen = () => {
            const compares = this.params.show === 'difference' && this.params.baseline?.name;
            this.hello(['camera', 'params', ...(compares ? ['baseline'] : [])]);
        };
        this.unheard = null;     // texts queued by wait(): [[when, text], ...]; null: not waiting
        connection.onText = (text) => (this.unheard ? this.unheard.push([this.now(), text]) : this.hear(text));
        connection.onBytes = (bytes) => this.guard(() => {
            this.freshen();
            if (!isGivenUp(bytes))
                this.emit('frame', decodeFrame(bytes));
        });
    }

    on(name, listener) {
        this.listeners.set(name, [...(this.listeners.get(name) ?? []), listener]);
    }

    // Registers for `welcome`, and calls the listener at once if there was one.
    greeted(listener) {
        this.on('welcome', listener);
        if (this.model)
            listener();
    }

    // Queues all text messages until listen() is called; frames are handled immediately.
    wait() {
        this.unheard = [];
    }

    // Handles the queued messages, with their times of arrival.
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

    // Sends a message if the server has welcomed us.
    post(message) {
        if (this.welcomed)
            this.connection.send(message);
    }

    // parts: names of the parts of our view (camera, parameters, ...) to request from the server.
    hello(parts) {
        const { shown } = this;
        this.welcomed = false;
        this.outlived = this.picture;
        if (this.unheard)
            this.unheard = []; // drops the queued texts of the previous connection
        this.emit('hello');
        this.helloParts = parts;
        this.greetedSize = this.size;
        this.unsent = {};
        this.markers.clear();
        this.latency.clear();
        this.cameraSeq = this.paramsSeq = 0;
        this.asked = new Map([[-1, shown]]);
        if (this.picture)
            // marks the picture as one of the previous connection, whose sequence numbers mean nothing to the new one
            this.picture.paramsSeq = -1;
        this.greetedCamera = parts.includes('camera') ? this.camera : null;
        const message = { type: 'hello', ...this.size, ...this.proofs(), codecs: this.codecs };
        if (this.time.atUs !== null)
            Object.assign(message, { at_us: this.time.atUs, speed: this.time.speed });
        if (this.greetedCamera)
            message.camera = { seq: ++this.cameraSeq, ...cameraMessage(this.greetedCamera) };
        const params = { ...this.carried({ baseline: parts.includes('baseline') }), ...pick(this.params, SETS) };
        if (parts.includes('params') && Object.keys(params).length > 0)
            message.params = { seq: ++this.paramsSeq, ...params };
        this.connection.send(message);
    }

    // Returns token and resume secret; the server then restores parameters that the page does not send itself.
    proofs() {
        return { ...(this.token ? { token: this.token } : {}),
            ...(this.resume ? { resume: this.resume, idle_ms: Math.max(0, Date.now() - this.connection.activeAt) } : {}),
            ...(this.anew ? { anew: true } : {}) };
    }

    // Default parameters: those of the group and the plant, which need not be sent.
    get ownParams() {
        return this.ownOf(this.group);
    }

    // Returns the default parameters for another group.
    ownOf(group) {
        const own = group ? { ...pick(group, GROUPS_OWN), range: [group.min, group.max], strength: 1, decay: 1 } : {};
        return { ...this.model?.start, ...own };
    }

    // Returns the parameters to request after a reconnect, without defaults, which may have changed. `baseline` can be left out because the
    // server may have forgotten the comparison.
    carried({ baseline = true } = {}) {
        const { params, ownParams: own } = this;
        const may = (name) => !this.role || this.role === 'engineer' || !ENGINEERS.includes(name);
        const wanted = pick(params, PARAMS.filter((name) => may(name) && JSON.stringify(params[name]) !== JSON.stringify(own[name])));
        if (may('sensors') && Object.keys(params.sensors ?? {}).length > 0)
            wanted.sensors = params.sensors;
        if (wanted.split)
            wanted.split = pick(wanted.split, PARAMS.filter((name) => may(name) && !SHARED.includes(name)));
        if (wanted.show === 'distance')
            wanted.sensor = params.sensor;
        if (wanted.show === 'difference' && baseline && params.baseline?.name)
            wanted.baseline = params.baseline.name;
        else if (wanted.show === 'difference')
            delete wanted.show;
        return wanted;
    }

    // inputTime: time of the input; start of the latency.
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
        this.asked.set(this.paramsSeq, this.params);
        this.params = { ...this.params, ...own, ...change, ...split, ...this.mergedSensors(change.sensors) };
        if (this.welcomed)
            this.connection.send({ type: 'params', seq: ++this.paramsSeq, ...change });
        else
            Object.assign(this.unsent, change);
        this.emit('params');
    }

    // Merges factors of single sensors into the current ones; null for a sensor removes it, null for all removes all.
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

    // Sends only the newest camera, once per animation frame.
    flush() {
        if (!this.cameraNews || !this.welcomed || this.connection.backlogBytes > MOST_BACKLOG_BYTES)
            return;
        if (this.connection.send({ type: 'camera', seq: ++this.cameraSeq, ...cameraMessage(this.camera) }) && this.cameraInput !== null)
            this.latency.sent(this.cameraSeq, this.cameraInput);
        this.cameraNews = false;
        this.cameraInput = null;
    }

    // session: id of the session to follow; null: none, so that our own view is shown again.
    follow(session) {
        this.leader = session;
        if (session === null)
            this.following = null;
        this.post({ type: 'follow', session });
        this.emit('following');
    }

    // Whether messages refer to the picture on the screen.
    get isCurrent() {
        return this.welcomed && (!this.picture || this.picture !== this.outlived);
    }

    freshen() {
        if (this.isCurrent)
            this.freshAt = this.now();
    }

    // Called when the frame is on the screen.
    drawn(frame, decodeMs) {
        const now = this.now();
        this.rate.count(now);
        this.latency.drawn(frame.cameraSeq, now);
        const { camera: was, shown } = this;
        if (this.lent)
            this.camera = asAsked(frame.camera);
        this.picture = { ...frame, payload: null, bytes: frame.payload?.length ?? 0, at: now };
        this.asked.forEach((params, seq) => seq < frame.paramsSeq && this.asked.delete(seq));
        if (this.shown !== shown)
            this.emit('shown');
        this.freshen();
        this.recent = this.recent.filter(({ picture }) => now - picture.at <= RECENT_MS);
        this.recent.push({ picture: this.picture, decodeMs, hereUs: this.skew ? now * 1000 + this.skew.us : this.clockUs(now) });
        this.connection.send({ type: 'ack', seq: frame.seq, decode_ms: Math.round(decodeMs * 100) / 100 });
        if (!this.following && !same(was, this.camera))
            this.emit('camera');
    }

    // Also acknowledges a frame that cannot be decoded, because the server would otherwise send nothing more.
    passedOver(frame) {
        if (!frame.more)
            this.connection.send({ type: 'ack', seq: frame.seq });
    }

    // Requests a key frame because the decoder lost its reference.
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

    // Sends what changed between hello and welcome.
    catchUp() {
        if (!this.visible)
            this.setVisible(false);
        if (this.size !== this.greetedSize)
            this.connection.send({ type: 'resize', ...this.size });
        if (Object.keys(this.unsent).length > 0)
            this.setParams(this.unsent);
    }

    // Sends hello without a parameter that the server refused; if it named none, without a part of our view.
    helloWithout(name) {
        const isParam = name !== 'baseline' && this.params[name] !== undefined;
        if (isParam)
            delete this.params[name];
        if (name === 'sensor')
            delete this.params.show;
        this.hello(isParam ? this.helloParts : this.helloParts.slice(0, -1));
    }

    // Returns a Map from "tag/half" to { occluded, value, quality } for a picture, with its `isolines`; drops those of earlier pictures.
    // Tags not in it have no marker: hidden, clipped or behind the camera. null: no markers known.
    markersOf(seq) {
        let newest = null;
        for (const known of [...this.markers.keys()].sort((a, b) => a - b).filter((key) => key <= seq)) {
            this.markers.delete(newest);
            newest = known;
        }
        return this.markers.get(newest) ?? null;
    }

    // --- what the screen asks

    // Returns the home camera for a size in CSS pixels. legendLies(): returns true if the legend lies across the top of the picture; null:
    // no legend in the picture.
    homeIn(width, height) {
        const { plant, groups: [group] } = this.model, lies = this.legendLies?.() ?? null, title = `${quantityText(group)} ${group.unit}`;
        return home(plant, width, height, lies === null ? {} : besideLegend(width, height, lies, title.length));
    }

    // Resets shared data, which the server sends after its greeting if there is any. views: { id, title, view, fixed } or { ..., by,
    // time_us }; walls: what desks sent to panes, and the connected displays.
    forget() {
        Object.assign(this, { views: [], notes: [], pointed: [], walls: null });
    }

    get group() {
        return this.model?.group(this.params.group) ?? null;
    }

    // The parameters of the picture on the screen; newer ones may still be on their way.
    get shown() {
        return this.asked.get(this.picture?.paramsSeq) ?? this.params;
    }

    // Returns [min, max] of the colours, for one half.
    rangeOf(params) {
        const group = this.model?.group(params.group);
        return params.range ?? (group ? [group.min, group.max] : [0, 1]);
    }

    get range() {
        return this.rangeOf(this.params);
    }

    // Returns the server's clock, extrapolated by ours; null before its first message.
    clockUs(now = this.now()) {
        return this.serverTime && this.serverTime.us + (now - this.serverTime.at) * 1000;
    }
}

// Handlers of the server's messages by type; `this` is the session.
const HANDLERS = {
    welcome(message) {
        const before = this.model;
        this.model = new Model(message);
        this.markers.clear(); // drops the markers of the previous plant or connection
        this.forget();
        this.welcomed = true;
        this.id = message.session;
        this.following = this.skew = this.lent = null;
        this.followers = { count: 0, sessions: [] };
        this.resume = message.resume ?? null;
        this.anew = false;
        this.role = message.role ?? null;
        this.imports = message.imports === true;
        this.signs = message.signing_key;
        this.codec = message.codec;
        this.connection.settle();
        this.confirmed = this.params = pick(message.view, SAID);
        if (!this.helloParts.includes('camera') || (before && before.identity !== this.model.identity))
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
            return; // ignores the answer to an earlier change, since overridden
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

    // Markers. After the first message only changes are sent.
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
        if ('drawn_error' in message)
            this.emit('shown', this.drawnError = message.drawn_error);
        this.markers.set(message.seq, known);
    },

    following({ session, width, height, gone = false, ...shown }) {
        this.lent ||= session ?? this.leader;
        this.following = session === null ? null : { session, width, height, ...(gone ? { gone } : {}) };
        this.leader = session;
        this.confirmed = this.params = pick(shown, SAID);
        this.asked.clear();
        this.emit('params');
        this.emit('following');
    },

    followers({ count, sessions }) {
        this.followers = { count, sessions };
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
        if (message.seq === this.pickSeq)
            this.emit('picked', { ...message, purpose: this.pickPurpose });
    },

    alarms(message) {
        this.model.alarms.hear(message);
        this.emit('alarms');
    },

    // Draft positions of an engineer: until saved, only this session sees them.
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
        this.model.clockSet = message.clock_set !== false;
        this.model.clockErrorMs = message.clock_error_ms ?? null;
        this.model.leapS = message.leap_s ?? 0;
        this.emit('status');
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
            this.emit('astray', message); // a part of our earlier view does not exist in this plant or version
            this.helloWithout(message.text.split(':')[0]);
            return;
        }
        if (message.about === 'follow' && this.leader !== null) { // the followed session does not exist (yet)
            this.emit('following');
            return;
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
    ...Object.fromEntries('alarmed gaps places_accepted tags_diff tags_saved proved view_saved noted sent_to_wall paired'.split(' ')
        .map((type) => [type, function passOn(message) { this.emit(type, message); }])),
};
