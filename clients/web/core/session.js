// SPDX-License-Identifier: GPL-3.0-or-later
// One viewer's conversation with the server: it owns the camera and the parameters, and says both again after a reconnect.
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
const SAID = [...PARAMS, 'sensor', 'baseline', 'baselines', 'sensors', 'unit']; // by the server
export const ENGINEERS = ['fill', 'strength', 'decay', 'power', 'radius_m', 'reach_m', 'sensors']; // others may not ask for these
const SHARED = ['light', 'environment', 'backdrop', 'arrows', 'selected', 'hidden', 'isolate', 'ghost', 'clip', 'split']; // by both halves
// Kept as they are, whatever the plant begins with by then.
const SETS = ['hidden', 'isolate', 'ghost'];
const GROUPS_OWN = ['interpolation', 'distance', 'fill', 'power', 'radius_m', 'reach_m', 'scale', 'isolines'];
const OF_THE_INSTANT = ['tags', 'picked']; // their time is that of what is shown
const NOW = { atUs: null, speed: 0, fromUs: null };
const QUALITIES = ['good', 'uncertain', 'bad'];
const MOST_BACKLOG_BYTES = 64 * 1024, RECENT_MS = 5000;

const pick = (from, names) => Object.fromEntries(names.filter((name) => from[name] !== undefined).map((name) => [name, from[name]]));

// A frame's camera has a field of view of 0 where it has none.
export const asAsked = (camera) => (camera.height_m === undefined ? camera : cameraOfMessage({ ...camera, fov: undefined }));

export class Session {
    // wanted: { camera or null, params, time } from the page's address. Events: hello (a new connection), welcome, params, shown, time,
    // tags (indices), status, alarms, alarmed (message), frame (frame), camera, error (message), astray (message: a part of our view
    // is refused, and not asked for again), denied (message: we need a token, or another one), ignored (what).
    constructor({ connection, now, wanted = { camera: null, params: {} }, codecs = ['jpeg', 'png'] }) {
        Object.assign(this, { connection, now, codecs });
        this.listeners = new Map();
        this.model = null;
        this.camera = wanted.camera;
        this.params = { ...wanted.params };
        this.token = null;       // lets us in, where one is needed
        this.resume = null;      // secret of our view on the server
        this.anew = false;       // of that view we want only the number, by which others follow us
        this.confirmed = null;   // what the server last said is in force
        this.size = { width: 640, height: 360 };
        this.visible = true;
        this.unsent = {};        // parameters that were changed while nobody listened
        this.asked = new Map();  // by seq, parameters before the newest: pictures may still show them
        this.cameraSeq = this.paramsSeq = this.fitSeq = this.pickSeq = this.alarmSeq = this.toldSeq = 0;
        this.cameraNews = false; // the server does not know the camera yet
        this.cameraInput = null; // when a hand made it; latency counts from there
        this.markers = new Map();
        this.serverTime = null;  // { us, at }
        this.freshAt = null;     // when the server of the picture last spoke: how old it is once that stops
        this.outlived = null;    // the picture of a connection that is gone
        this.rate = new RateMeter();
        this.latency = new LatencyMeter();
        this.recent = [];        // pictures of the last moments, and how they came: { picture, decodeMs, hereUs }
        this.skew = null;        // the server's clock less ours, in microseconds, by the shortest round trip: { us, roundTripMs }
        this.id = null;          // by which others can follow this session
        this.following = null;   // whose view is shown: { session, width, height, gone (it is the last of one who has gone) }
        this.leader = null;      // whom to follow once there is a connection, and that one
        this.lent = null;        // the camera is that of the picture: another's, or what he left us
        this.followers = { count: 0, sessions: [] }; // who follows us
        this.forget();
        this.time = { ...NOW, ...wanted.time }; // what the server shows: atUs null: now; fromUs null: nothing is recorded
        connection.onOpen = () => {
            const compares = this.params.show === 'difference' && this.params.baseline?.name;
            this.hello(['camera', 'params', ...(compares ? ['baseline'] : [])]);
        };
        this.unheard = null;     // texts, while nobody is there to hear what they say: [[when, text], ...]
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

    // Called with each greeting, and at once where there was one.
    greeted(listener) {
        this.on('welcome', listener);
        if (this.model)
            listener();
    }

    // Pictures are drawn meanwhile; what else is said waits for listen().
    wait() {
        this.unheard = [];
    }

    // What waited is heard as of when it came.
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

    // What is said to who has greeted us.
    post(message) {
        if (this.welcomed)
            this.connection.send(message);
    }

    // parts: what of our view to ask for.
    hello(parts) {
        const { shown } = this;
        this.welcomed = false;
        this.outlived = this.picture;
        if (this.unheard)
            this.unheard = []; // of a connection that is gone
        this.emit('hello');
        this.helloParts = parts;
        this.greetedSize = this.size;
        this.unsent = {};
        this.markers.clear();
        this.latency.clear();
        this.cameraSeq = this.paramsSeq = 0;
        this.asked = new Map([[-1, shown]]);
        if (this.picture)
            this.picture.paramsSeq = -1; // of a connection that is gone
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

    // Who we are, and whose view was ours: with it comes back what we do not say ourselves.
    proofs() {
        return { ...(this.token ? { token: this.token } : {}),
            ...(this.resume ? { resume: this.resume, idle_ms: Math.max(0, Date.now() - this.connection.activeAt) } : {}),
            ...(this.anew ? { anew: true } : {}) };
    }

    // What need not be said of the parameters: a group has it by itself, or the plant begins with it.
    get ownParams() {
        return this.ownOf(this.group);
    }

    // Likewise where another group is shown.
    ownOf(group) {
        const own = group ? { ...pick(group, GROUPS_OWN), range: [group.min, group.max], strength: 1, decay: 1 } : {};
        return { ...this.model?.start, ...own };
    }

    // The parameters to ask for again: not those that only are the group's own, which may have been changed there since.
    // What is compared with can have been forgotten meanwhile, and may then be left out.
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

    // inputTime: when the hand moved; latency counts from there.
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

    // Those of single sensors that are named are changed, null undoes one, or all.
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

    // Once per animation frame: the newest camera goes out, the ones in between never do.
    flush() {
        if (!this.cameraNews || !this.welcomed || this.connection.backlogBytes > MOST_BACKLOG_BYTES)
            return;
        if (this.connection.send({ type: 'camera', seq: ++this.cameraSeq, ...cameraMessage(this.camera) }) && this.cameraInput !== null)
            this.latency.sent(this.cameraSeq, this.cameraInput);
        this.cameraNews = false;
        this.cameraInput = null;
    }

    // null: nobody any more; our own view comes back.
    follow(session) {
        this.leader = session;
        if (session === null)
            this.following = null;
        this.post({ type: 'follow', session });
        this.emit('following');
    }

    // Whether what is said is said of the picture that is seen.
    get isCurrent() {
        return this.welcomed && (!this.picture || this.picture !== this.outlived);
    }

    freshen() {
        if (this.isCurrent)
            this.freshAt = this.now();
    }

    // This frame is on the screen.
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

    // What cannot be decoded is acknowledged too: more of it would change nothing.
    passedOver(frame) {
        if (!frame.more)
            this.connection.send({ type: 'ack', seq: frame.seq });
    }

    // The decoder lost its place: the next frame shall stand alone.
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

    // What changed between hello and welcome.
    catchUp() {
        if (!this.visible)
            this.setVisible(false);
        if (this.size !== this.greetedSize)
            this.connection.send({ type: 'resize', ...this.size });
        if (Object.keys(this.unsent).length > 0)
            this.setParams(this.unsent);
    }

    // The parameter that the server does not take; where it names none, a part of our view.
    helloWithout(name) {
        const isParam = name !== 'baseline' && this.params[name] !== undefined;
        if (isParam)
            delete this.params[name];
        if (name === 'sensor')
            delete this.params.show;
        this.hello(isParam ? this.helloParts : this.helloParts.slice(0, -1));
    }

    // Map from "tag/half" to { occluded, value, quality } for a picture, and its `isolines`; those of earlier ones are forgotten. What is
    // not in it has no marker there: hidden, cut away or behind the eye. null: nothing was said.
    markersOf(seq) {
        let newest = null;
        for (const known of [...this.markers.keys()].sort((a, b) => a - b).filter((key) => key <= seq)) {
            this.markers.delete(newest);
            newest = known;
        }
        return this.markers.get(newest) ?? null;
    }

    // --- what the screen asks

    // In CSS pixels. legendLies(): null: no legend lies in the picture.
    homeIn(width, height) {
        const { plant, groups: [group] } = this.model, lies = this.legendLies?.() ?? null, title = `${quantityText(group)} ${group.unit}`;
        return home(plant, width, height, lies === null ? {} : besideLegend(width, height, lies, title.length));
    }

    // What people share, which the server says after its greeting, if there is any.
    // views with names: { id, title, view, fixed } or { ..., by, time_us }; walls: what desks sent to panes, and the displays that are
    // there.
    forget() {
        Object.assign(this, { views: [], notes: [], pointed: [], walls: null });
    }

    get group() {
        return this.model?.group(this.params.group) ?? null;
    }

    // The parameters of the picture on the screen: what was asked for since is still on its way.
    get shown() {
        return this.asked.get(this.picture?.paramsSeq) ?? this.params;
    }

    // [min, max] of the colours, of one half.
    rangeOf(params) {
        const group = this.model?.group(params.group);
        return params.range ?? (group ? [group.min, group.max] : [0, 1]);
    }

    get range() {
        return this.rangeOf(this.params);
    }

    // The server's clock, carried on by ours; null before it spoke.
    clockUs(now = this.now()) {
        return this.serverTime && this.serverTime.us + (now - this.serverTime.at) * 1000;
    }
}

// What the server says, by its type; `this` is the session.
const HANDLERS = {
    welcome(message) {
        const before = this.model;
        this.model = new Model(message);
        this.markers.clear(); // also where the plant was loaded anew
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
            return; // an answer to what was changed again since
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

    // After the first message only what changed since the one before.
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

    // The server's word on what an engineer tries out: until it is saved, these sensors stand there for us alone.
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
            this.emit('astray', message); // our view of before is of another plant, or of another version
            this.helloWithout(message.text.split(':')[0]);
            return;
        }
        if (message.about === 'follow' && this.leader !== null) { // there is no such session, yet
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
