// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of the plant: what `welcome` said, and the newest value, quality and age of every tag.
import { Alarms, graver } from './alarms.js';
import { worst } from './format.js';
import { decodeBase64 } from './wire.js';

export class Model {
    constructor(welcome) {
        this.plant = welcome.plant;
        this.groups = welcome.groups;
        this.tags = welcome.tags.map((tag, index) => ({ ...tag, index }));
        this.colormaps = welcome.colormaps.map((map) => ({ ...map, rgb: decodeBase64(map.rgb) }));
        this.readings = this.tags.map(() => ({ value: null, quality: 'bad', qualityName: '', ageMs: null, alarm: null, at: 0 }));
        this.environments = welcome.environments ?? ['sky'];
        this.references = welcome.links ?? []; // where else one reads about assets and tags
        this.assets = welcome.assets.map((asset) => ({ ...asset, tags: [] }));
        const starting = (how) => this.assets.filter(({ start }) => start === how).map(({ id }) => id);
        this.start = { hidden: starting('hidden'), isolate: [], ghost: starting('ghost') }; // parameters, until somebody changes them
        const assets = new Map(this.assets.map((asset) => [asset.id, asset]));
        for (const tag of this.tags)
            assets.get(tag.asset)?.tags.push(tag);
        this.alarms = new Alarms(this.tags);
        this.placed = new Map(); // by name: what `placed` says
        this.proofs = new Map(); // by index
        this.provingBegun = false;
        this.links = [];
        this.live = null; // nothing was said yet
        this.stopped = false; // see stop
        this.clockSet = true; // the server's clock is kept right
        this.clockErrorMs = null; // within this; null: not known
        this.leapS = 0; // a second that is added or taken away at the end of the month
        this.oldest = null; // { ms, at }: no reading that is not bad was older than that
    }

    // Of an instant of the past: ages and alarms are those of then, as `tags` has them.
    stop(stopped) {
        this.stopped = stopped;
        this.alarms.then = stopped ? this.readings : null;
    }

    // Sensors that stand elsewhere for us; all others are where the plant has them.
    place(sensors) {
        this.placed = new Map(sensors.map((sensor) => [sensor.tag, sensor]));
        for (const tag of this.tags) {
            tag.saved ??= { position: tag.position, asset: tag.asset };
            const moved = this.placed.get(tag.name);
            Object.assign(tag, moved ? { position: moved.surface, asset: moved.asset } : tag.saved);
        }
    }

    hearProofs({ all, begun, tags }) {
        this.proofs = all ? new Map() : this.proofs;
        this.provingBegun = begun;
        for (const [index, state, timeUs, value, expected, tolerance, who, remark] of tags)
            this.proofs.set(index, { state, timeUs, value, expected, tolerance, who, remark });
    }

    // None has shown yet that this is what is measured there; null: nobody has begun to, or it is computed.
    unproven(tag) {
        const state = this.proofs.get(tag.index)?.state ?? 'none';
        return this.provingBegun && tag.source && state !== 'pass' ? state : null;
    }

    get identity() {
        return JSON.stringify([this.plant.name, this.plant.bounds]);
    }

    group(id) {
        return this.groups.find((group) => group.id === id) ?? null;
    }

    asset(id) {
        return this.assets.find((asset) => asset.id === id) ?? null;
    }

    tag(name) {
        return this.tags.find((tag) => tag.name === name) ?? null;
    }

    colormap(name) {
        return this.colormaps.find((map) => map.name === name) ?? this.colormaps[0];
    }

    // Returns the indices of the tags whose value or quality changed.
    update(values, now, plainAgeMs = null) {
        const changed = [];
        for (const [index, value, quality = 'good', qualityName = 'Good', ageMs = plainAgeMs, alarm = null, ...of] of values) {
            const before = this.readings[index];
            if (!before)
                continue;
            if (before.value !== value || before.quality !== quality || before.qualityName !== qualityName)
                changed.push(index);
            this.readings[index] = { value, quality, qualityName, ageMs, alarm, at: now };
            if (alarm !== null)
                [this.readings[index].priority = 4, this.readings[index].state = 'active'] = of;
        }
        return changed;
    }

    // The server tells a reading when it changes; that an unchanged one was read again, only for all of them at once.
    notOlder(ms, now) {
        this.oldest = ms === null ? null : { ms, at: now };
    }

    // Aged by the client's own clock since the server spoke of it; null: there never was a value.
    ageMs(index, now) {
        const { ageMs, at, quality } = this.readings[index];
        if (ageMs === null)
            return null;
        if (this.stopped)
            return ageMs;
        const age = ageMs + (now - at);
        return this.oldest && quality !== 'bad' ? Math.min(age, this.oldest.ms + (now - this.oldest.at)) : age;
    }

    // Age of the oldest reading of a group that takes part in its picture; null: none does.
    oldestAgeMs(groupId, now) {
        let oldest = null;
        for (const { index, group } of this.tags) {
            if (group === groupId && this.readings[index].quality !== 'bad')
                oldest = Math.max(oldest ?? 0, this.ageMs(index, now) ?? 0);
        }
        return oldest;
    }

    // The gravest alarm of its tags that is to be seen, or null.
    worstAlarm(asset) {
        const alarms = asset.tags.map((tag) => this.alarms.gravest(tag.index)).filter(Boolean);
        return alarms.sort(graver)[0] ?? null;
    }

    worstQuality(asset) {
        return worst(asset.tags.map((tag) => this.readings[tag.index].quality));
    }
}
