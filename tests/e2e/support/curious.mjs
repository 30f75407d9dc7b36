// SPDX-License-Identifier: GPL-3.0-or-later
// A random user who tries everything: every look, light, backdrop, group, quantity, split, section, ghost, size, instant and
// snapshot that the protocol offers. Each step waits for its answer, so an hour of a person's actions takes only as long as the
// machine needs for it.
import { http, PlainClient } from './plain_client.mjs';

const SIZES = [[640, 360], [1280, 720], [1366, 768], [1920, 1080], [390, 844], [1024, 1366]];
const PATIENCE_MS = 120000, QUIET_MS = 10000;
// after this time any picture will do, because on a busy machine readings may change so often that only previews come
const REFINED_MS = 30000;
const get = (port, path) => http(port, `GET ${path} HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n\r\n`, { timeoutMs: PATIENCE_MS });

// Returns a generator of numbers 0 <= x < 1 that repeats for the same seed (mulberry32).
export function dice(seed) {
    let a = seed >>> 0;
    return () => {
        a = (a + 0x6d2b79f5) | 0;
        let t = Math.imul(a ^ (a >>> 15), 1 | a);
        t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
        return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
    };
}

export class Curious {
    static async come(port, random, codec = random() < 0.5 ? 'jpeg' : 'h264') {
        const one = new Curious();
        Object.assign(one, { port, random, seq: 0, done: {}, refused: [], codec, playing: false, from: Date.now() * 1000 });
        [one.width, one.height] = one.any(SIZES);
        one.client = await PlainClient.open(port);
        one.welcome = await one.client.hello({ width: one.width, height: one.height, codecs: [codec] });
        one.camera = structuredClone(one.welcome.plant.home);
        await one.still();
        return one;
    }

    any(list) { return list[Math.floor(this.random() * list.length)]; }
    between(low, high) { return low + (high - low) * this.random(); }
    some(list, most) { return Array.from({ length: Math.floor(this.random() * (most + 1)) }, () => this.any(list)); }
    get ids() { return this.welcome.assets.map((asset) => asset.id); }

    // Waits for the refined picture of the last request. While the past is played back, or after REFINED_MS, any picture of
    // that request will do.
    async still() {
        const { seq, playing } = this;
        const said = performance.now(), any = () => playing || performance.now() - said > REFINED_MS;
        const is = (f) => (any() || (f.flags & 2) !== 0) && Math.max(f.camera_seq, f.params_seq) >= seq;
        const wrong = (t) => t.type === 'error';
        // true: for QUIET_MS no picture has come, so the server owes none and the wait ends
        const quiet = (c) => performance.now() - (c.frames.at(-1)?.at ?? said) > QUIET_MS;
        await this.client.until(`a picture of ${seq}`, (c) => c.closed !== null || c.texts.some(wrong) || c.frames.some(is) || quiet(c),
            PATIENCE_MS);
        if (this.client.closed)
            throw new Error(`closed: ${JSON.stringify(this.client.closed)}`);
        this.refused.push(...this.client.texts.filter(wrong).map((t) => t.text));
        this.client.frames.length = this.client.texts.length = 0;
    }

    async say(message) {
        this.client.say({ seq: ++this.seq, ...message });
        await this.still();
    }

    async params(params) { await this.say({ type: 'params', ...params }); }

    // Performs one random action and waits for its picture.
    async act(history) {
        const acts = Object.entries(ACTS).filter(([name]) => history || !name.startsWith('past'));
        const all = acts.reduce((sum, [, [weight]]) => sum + weight, 0);
        let at = this.random() * all;
        const [name, [, act]] = acts.find(([, [weight]]) => (at -= weight) < 0);
        this.done[name] = (this.done[name] ?? 0) + 1;
        await act(this);
        return name;
    }

    orbit(turn, rise) {
        const { eye, target } = this.camera, [x, y, z] = eye.map((v, i) => v - target[i]);
        const far = Math.hypot(x, y), angle = Math.atan2(y, x) + turn, zoom = this.between(0.9, 1.1);
        this.camera.eye = [target[0] + far * zoom * Math.cos(angle), target[1] + far * zoom * Math.sin(angle),
            Math.max(1, target[2] + z * zoom + rise)];
    }

    // Drags the camera in steps and waits for a picture after each, so that as many pictures are drawn as a person would see.
    async drag(pictures) {
        const turn = this.between(-0.08, 0.08), rise = this.between(-0.4, 0.4);
        for (let n = 0; n < pictures; n++) {
            this.orbit(turn, rise);
            const seq = ++this.seq;
            this.client.say({ type: 'camera', seq, eye: this.camera.eye, target: this.camera.target, fov: this.camera.fov });
            await this.client.frameWhere('a picture of a drag', (f) => f.camera_seq >= seq, PATIENCE_MS);
        }
        await this.still();
    }

    async leave() {
        this.client.close();
        await new Promise((done) => setTimeout(done, 20));
    }
}

const clipBox = (one) => {
    const { min, max } = one.welcome.plant.bounds, low = min.map((v, i) => one.between(v, (v + max[i]) / 2));
    return { box: { min: low, max: max.map((v, i) => one.between(low[i] + 0.1, v + 0.2)) } };
};
const clipPlanes = (one) => ({ planes: Array.from({ length: 1 + Math.floor(one.random() * 3) }, () => {
    const n = [one.between(-1, 1), one.between(-1, 1), one.between(-1, 1)], length = Math.hypot(...n);
    return [...n.map((v) => v / length), one.between(2, 20)];
}) });
const show = (one) => one.any([{ show: 'value' }, { show: 'operator' }, { show: 'difference', baseline: 'now' },
    { show: 'distance', sensor: one.any(one.welcome.tags.filter((t) => t.group === one.welcome.groups[0].id && t.position)).name,
        group: one.welcome.groups[0].id }]);
const field = (one) => one.any([{ interpolation: one.any(['shepard', 'paper']) }, { distance: one.any(['geodesic', 'euclidean']) },
    { power: one.between(1, 6) }, { strength: one.between(0.2, 4) }, { decay: one.between(0.2, 4) }, { reach_m: one.any([null, 2, 6, 20]) },
    { fill: one.any(['none', 'neighbours']) }]);
const looks = (one) => one.any([{ colormap: one.any(one.welcome.colormaps).name }, { ramp_interval: one.any([0, 5, 20]) },
    { isolines: one.any([null, 10, 25]) }, { range: null }]);
const LOOKS = ['default', 'glossy', 'flat', 'materials'];
const snapshot = (one, more) => get(one.port, `/snapshot.png?width=1280&height=720&look=${one.any(LOOKS)}` +
    `&group=${one.any(one.welcome.groups).id}${more}`);
const ago = (one) => Math.round(one.between(one.from, Date.now() * 1000)); // seconds since the client connected

const PLAIN = { split: null, clip: null, hidden: [], ghost: [], isolate: [], look: 'default' };

// The actions and their relative frequency.
const ACTS = {
    drag: [10, (one) => one.drag(8)],
    zoom: [4, (one) => { one.camera.target = one.any(one.welcome.tags.filter((t) => t.position)).position; return one.drag(4); }],
    home: [2, (one) => { one.camera = structuredClone(one.welcome.plant.home); return one.drag(1); }],
    look: [4, (one) => one.params({ look: one.any(LOOKS) })],
    light: [4, (one) => one.params({ light: [one.between(-1, 1), one.between(-1, 1), one.between(0.1, 1)] })],
    environment: [2, (one) => one.params({ environment: one.any(one.welcome.environments) })],
    backdrop: [1, (one) => one.params({ backdrop: one.any(['light', 'dark']) })],
    group: [3, (one) => one.params({ group: one.any(one.welcome.groups).id })],
    show: [3, (one) => one.params(show(one))],
    field: [4, (one) => one.params(field(one))],
    colours: [2, (one) => one.params(looks(one))],
    ghost: [2, (one) => one.params({ ghost: one.some(one.ids, 8), hidden: one.some(one.ids, 4), isolate: [] })],
    isolate: [1, (one) => one.params({ isolate: one.some(one.ids, 3), ghost: [], hidden: [] })],
    clip: [3, (one) => one.params({ clip: one.any([null, clipBox(one), clipPlanes(one)]) })],
    split: [2, (one) => one.params({ split: one.any([null, { group: one.any(one.welcome.groups).id }, show(one)]) })],
    plain: [2, (one) => one.params({ ...PLAIN, group: one.welcome.groups[0].id })],
    select: [2, (one) => one.params({ selected: one.any([null, ...one.ids]) })],
    size: [1, async (one) => {
        [one.width, one.height] = one.any(SIZES);
        one.client.say({ type: 'resize', width: one.width, height: one.height });
        await one.drag(1);
    }],
    pick: [2, async (one) => {
        one.client.say({ type: 'pick', seq: ++one.seq, x: one.between(0, one.width), y: one.between(0, one.height) });
        await one.client.text('picked', PATIENCE_MS);
    }],
    snapshot: [2, (one) => snapshot(one, '')],
    past_series: [2, async (one) => {
        const tag = encodeURIComponent(one.any(one.welcome.tags).name);
        await get(one.port, `/api/v1/history?tags=${tag}&from=-10m`);
    }],
    past_instant: [3, async (one) => {
        one.client.say({ type: 'time', at_us: ago(one), speed: 0 });
        one.playing = false;
        await one.drag(2);
    }],
    past_play: [1, async (one) => {
        one.client.say({ type: 'time', at_us: ago(one), speed: one.any([10, -10, 60]) });
        one.playing = true;
        await one.drag(6);
    }],
    past_end: [3, async (one) => {
        one.client.say({ type: 'time', at_us: null });
        one.playing = false;
        await one.drag(1);
    }],
    past_clip: [1, async (one) => {
        for (let n = 0, at = ago(one) / 1e6; n < 5; n++)
            await snapshot(one, `&at=${new Date((at + n) * 1000).toISOString()}`);
    }],
};
