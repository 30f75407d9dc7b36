// SPDX-License-Identifier: GPL-3.0-or-later
// Finds a camera with a free view of a tag. If there is none, makes the assets in front transparent while the user looks at the tag.
import { approaches } from '../../core/approach.js';
import { halfAt } from '../../core/nearest.js';
import { askPick } from '../../core/requests.js';
import { length, subtract } from '../../core/vector.js';

const ANSWER_MS = 700, TRIES = 3; // a pick is sent up to TRIES times, because another module's pick request may replace it
const SEARCH_MS = 1500, MOST_SEEN_THROUGH = 4, MOST_GHOSTS = 8;
const AROUND = [[-0.12, 0], [0.12, 0], [0, -0.12], [0, 0.12], [-0.2, -0.2], [0.2, -0.2], [-0.2, 0.2], [0.2, 0.2]], BEFORE = 0.9;
const NEAR_M = 0.05; // metres; a surface nearer to a sensor than this is the one on which the sensor is mounted

const has = (list, id) => (list ?? []).includes(id);
const without = (list, id) => (list ?? []).filter((other) => other !== id);

export class Approach {
    constructor({ session, viewport }) {
        Object.assign(this, { session, viewport });
        this.ghosts = [];    // ids of assets that were made transparent because they hide the tag (not by the user)
        this.number = 0; // sequence number of the newest approach; an earlier one that is still running compares it and stops
        this.heard = null;
        session.on('picked', (picked) => picked.purpose === 'sight' && this.heard?.(picked));
    }

    // Ends the approach, because the user moves the camera.
    stop() {
        this.number++;
    }

    // Shows the tag's asset if it is hidden or transparent.
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

    // Replaces the set of assets that are transparent because they hide the tag; those that the user made transparent stay so.
    setGhosts(ids) {
        const now = this.session.params.ghost ?? [], own = now.filter((id) => !has(this.ghosts, id));
        this.ghosts = ids.filter((id) => !has(own, id));
        const ghost = [...own, ...this.ghosts];
        if (ghost.join('\n') !== now.join('\n'))
            this.session.setParams({ ghost });
    }

    // Calls fly(camera) immediately, and again with another camera if it turns out that assets block the first view.
    async go(tag, asset, fly) {
        const number = ++this.number, isOvertaken = () => number !== this.number;
        this.setGhosts([]);
        this.reveal(asset);
        const cameras = approaches(this.session.camera, tag.position, asset.bounds);
        fly(cameras[0]);
        const behind = []; // ids of the assets that block a view, without the tag's own asset
        const latest = performance.now() + SEARCH_MS; // deadline, after which the best view found so far is used, as on a slow network
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

    // Makes blocking assets transparent one after the other. Returns true once the view of the tag is free.
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

    // Returns what a camera sees at the centre of its picture: { seen: true if the tag is visible, asset: id of the asset in front, or null
    // }; null: the server did not answer.
    async look(camera, tag) {
        const picked = await this.ask(camera, [0, 0]);
        if (!picked)
            return null;
        const { sensor, occluded, position, asset } = picked;
        const isThere = position !== null && length(subtract(position, tag.position)) < NEAR_M;
        return { seen: isThere || (sensor === tag.name && !occluded), asset };
    }

    // Returns at how many of the AROUND points near the centre an asset other than `id` is in front; stops counting at `most`.
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

    // Picks at an offset from the centre of the picture, in units of the picture's height. Returns null if there is no answer.
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
