// SPDX-License-Identifier: GPL-3.0-or-later
// Brings a tag into sight: from a side where nothing stands before it; else what stands there becomes a ghost for as long as one looks
// at the tag.
import { approaches } from '../../core/approach.js';
import { halfAt } from '../../core/nearest.js';
import { askPick } from '../../core/requests.js';
import { length, subtract } from '../../core/vector.js';

const ANSWER_MS = 700, TRIES = 3; // another question may have come between
const SEARCH_MS = 1500, MOST_SEEN_THROUGH = 4, MOST_GHOSTS = 8;
const AROUND = [[-0.12, 0], [0.12, 0], [0, -0.12], [0, 0.12], [-0.2, -0.2], [0.2, -0.2], [-0.2, 0.2], [0.2, 0.2]], BEFORE = 0.9;
const NEAR_M = 0.05; // what is hit there is the sensor's own surface

const has = (list, id) => (list ?? []).includes(id);
const without = (list, id) => (list ?? []).filter((other) => other !== id);

export class Approach {
    constructor({ session, viewport }) {
        Object.assign(this, { session, viewport });
        this.ghosts = [];    // ids of what stands before the tag: ours, not a person's
        this.number = 0;     // of the newest approach; others are overtaken
        this.heard = null;
        session.on('picked', (picked) => picked.purpose === 'sight' && this.heard?.(picked));
    }

    // Whoever takes the camera is not led on.
    stop() {
        this.number++;
    }

    // Equipment that is not shown is shown from now on, if a tag stands on it.
    reveal({ id }) {
        const { params } = this.session, change = {};
        for (const name of ['hidden', 'ghost'])
            if (has(params[name], id))
                change[name] = without(params[name], id);
        if (params.isolate?.length > 0 && !has(params.isolate, id))
            change.isolate = [...params.isolate, id];
        if (Object.keys(change).length > 0)
            this.session.setParams(change);
    }

    // These instead of those before; what a person made a ghost stays one.
    setGhosts(ids) {
        const now = this.session.params.ghost ?? [], own = now.filter((id) => !has(this.ghosts, id));
        this.ghosts = ids.filter((id) => !has(own, id));
        const ghost = [...own, ...this.ghosts];
        if (ghost.join('\n') !== now.join('\n'))
            this.session.setParams({ ghost });
    }

    // fly(camera) is told where to go: at once, and again where that turns out to be behind something.
    async go(tag, asset, fly) {
        const number = ++this.number, isOvertaken = () => number !== this.number;
        this.setGhosts([]);
        this.reveal(asset);
        const cameras = approaches(this.session.camera, tag.position, asset.bounds);
        fly(cameras[0]);
        const behind = []; // other equipment, not only what it stands on itself
        const latest = performance.now() + SEARCH_MS; // on a slow network what was found until then will do
        let best = null, least = Infinity;
        for (const camera of cameras) {
            const found = await this.look(camera, tag), covered = found?.seen ? await this.coverAround(camera, asset, least) : Infinity;
            if (isOvertaken() || !found)
                return;
            if (covered < least)
                [best, least] = [camera, covered];
            if (!found.seen && found.asset !== null && found.asset !== asset.id)
                behind.push(camera);
            if (covered === 0 || (performance.now() > latest && (best || behind.length > 0)))
                break;
        }
        if (best) {
            if (best !== cameras[0])
                fly(best);
            return;
        }
        for (const camera of behind.slice(0, MOST_SEEN_THROUGH)) {
            const isSeen = await this.seeThrough(camera, tag, asset, isOvertaken);
            if (isOvertaken())
                return;
            if (isSeen) {
                fly(camera);
                return;
            }
        }
        this.setGhosts([]);
    }

    // True: nothing but ghosts stands before it now.
    async seeThrough(camera, tag, asset, isOvertaken) {
        const ghosts = [];
        this.setGhosts([]);
        for (;;) {
            const found = await this.look(camera, tag);
            if (isOvertaken() || !found || found.seen)
                return Boolean(found?.seen);
            if (found.asset === null || found.asset === asset.id || has(ghosts, found.asset) || ghosts.length === MOST_GHOSTS)
                return false;
            ghosts.push(found.asset);
            this.setGhosts(ghosts);
        }
    }

    // What a camera would see in its middle: { seen (the tag), asset (what is in front, or null) }; null: no answer.
    async look(camera, tag) {
        const picked = await this.ask(camera, [0, 0]);
        if (!picked)
            return null;
        const { sensor, occluded, position, asset } = picked;
        const isThere = position !== null && length(subtract(position, tag.position)) < NEAR_M;
        return { seen: isThere || (sensor === tag.name && !occluded), asset };
    }

    // At how many places around the middle other equipment stands before it; counted no further than `most`.
    async coverAround(camera, { id }, most) {
        const far = length(subtract(camera.target, camera.eye));
        let count = 0;
        for (const place of AROUND) {
            if (count >= most)
                break;
            const { asset = null, position } = await this.ask(camera, place) ?? {};
            count += asset !== null && asset !== id && length(subtract(position, camera.eye)) < BEFORE * far;
        }
        return count;
    }

    // place: from the middle, in heights of the picture. null: no answer.
    async ask(camera, [right, down]) {
        const { session, viewport } = this, { width } = halfAt(session.params, viewport.width, 0), { height } = viewport;
        for (let tries = 0; tries < TRIES; tries++) {
            askPick(session, viewport.pixelOf(width / 2 + right * height, height / 2 + down * height), 'sight', camera);
            const picked = await new Promise((done) => {
                this.heard = done;
                setTimeout(done, ANSWER_MS, null);
            });
            if (picked)
                return picked;
        }
        return null;
    }
}
