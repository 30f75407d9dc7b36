// SPDX-License-Identifier: GPL-3.0-or-later
// The page's model of the plant: the server's message `welcome`, and the newest value, quality and age of every tag.
import { Alarms, graver } from './alarms.js';
import { decodeBase64 } from './wire.js';
import { sayIfKnown, title } from './words.js';

export const QUALITIES = ['good', 'uncertain', 'bad']; // from best to worst

export const worst = (qualities) => QUALITIES[Math.max(-1, ...qualities.map((q) => QUALITIES.indexOf(q)))] ?? null;

// Returns the name of a sensor group's quantity, translated if it is a common quantity.
export const quantityText = ({ quantity, id }) => sayIfKnown(`quantity.${(quantity || id).toLowerCase()}`, title(quantity || id));

export class Model {
    constructor(welcome) {
        this.plant = { up: welcome.plant.home?.up, ...welcome.plant }; // an older server sends no `up`
        this.groups = welcome.groups;
        this.tags = welcome.tags.map((tag, index) => ({ ...tag, index }));
        this.colormaps = welcome.colormaps.map((map) => ({ ...map, rgb: decodeBase64(map.rgb) }));
        this.readings = this.tags.map(() => ({ value: null, quality: 'bad', qualityName: '', ageMs: null, alarm: null, at: 0 }));
        this.environments = welcome.environments ?? ['sky'];
        // templates of links from assets and tags to other systems
        this.references = welcome.links ?? [];
        this.assets = welcome.assets.map((asset) => ({ ...asset, tags: [] }));
        const starting = (how) => this.assets.filter(({ start }) => start === how).map(({ id }) => id);
        this.start = { hidden: starting('hidden'), isolate: [], ghost: starting('ghost') }; // initial parameters
        const assets = new Map(this.assets.map((asset) => [asset.id, asset]));
        for (const tag of this.tags)
            assets.get(tag.asset)?.tags.push(tag);
        this.alarms = new Alarms(this.tags);
        // draft sensor positions of an engineer: tag name -> entry of the message `placed`
        this.placed = new Map();
        this.proofs = new Map(); // by tag index
        this.provingBegun = false;
        this.links = [];
        this.live = null; // null: no message yet
        // true: a past instant is shown (stop())
        this.stopped = false;
        this.standby = null; // state of the standby, for engineers of a core that leads one (standby.js); null: no such core
        this.clockSet = true; // true: the server's clock is synchronised
        this.clockErrorMs = null; // maximum error of the server's clock in milliseconds; null: unknown
        this.leapS = 0; // leap second announced for the end of the month: 1: will be inserted, -1: will be removed, 0: none
        // { ms, at }: at the time `at`, each good or uncertain reading was at most `ms` old; null: unknown
        this.oldest = null;
    }

    // Freezes the model at a past instant: ages and alarms then follow from the readings of that instant. stopped false: back to the
    // present.
    stop(stopped) {
        this.stopped = stopped;
        this.alarms.then = stopped ? this.readings : null;
    }

    // Applies this session's draft positions; all other sensors are at their saved positions again.
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

    // Returns the state of a tag that has not passed its loop check, in which a technician forces the transmitter to see
    // whether the right reading changes. Returns null if the tag has passed, is a derived tag, or if no tag was ever checked.
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

    // Stores readings that the server sent. Returns the indices of the tags whose value or quality changed.
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

    // Stores an upper bound for the ages of all readings. The server sends a reading only when it changes, so unchanged
    // readings would otherwise seem to age.
    notOlder(ms, now) {
        this.oldest = ms === null ? null : { ms, at: now };
    }

    // Returns the age of a tag's reading: the age that the server sent, plus the time since then by the page's clock; null if
    // the tag never had a value.
    ageMs(index, now) {
        const { ageMs, at, quality } = this.readings[index];
        if (ageMs === null)
            return null;
        if (this.stopped)
            return ageMs;
        const age = ageMs + (now - at);
        return this.oldest && quality !== 'bad' ? Math.min(age, this.oldest.ms + (now - this.oldest.at)) : age;
    }

    // Returns the age of the oldest usable reading of a sensor group; null if the group has none.
    oldestAgeMs(groupId, now) {
        let oldest = null;
        for (const { index, group } of this.tags) {
            if (group === groupId && this.readings[index].quality !== 'bad')
                oldest = Math.max(oldest ?? 0, this.ageMs(index, now) ?? 0);
        }
        return oldest;
    }

    // Returns the most urgent alarm of an asset's tags that is neither shelved, suppressed nor out of service, or null.
    worstAlarm(asset) {
        const alarms = asset.tags.map((tag) => this.alarms.gravest(tag.index)).filter(Boolean);
        return alarms.sort(graver)[0] ?? null;
    }

    worstQuality(asset) {
        return worst(asset.tags.map((tag) => this.readings[tag.index].quality));
    }
}
