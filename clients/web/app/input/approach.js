// SPDX-License-Identifier: GPL-3.0-or-later
// Finds a camera with a free view of a tag. If no camera outside has one, moves the eye past the walls in front of the tag, or
// makes the assets in front transparent while the user looks at the tag.
import { approaches, atDistance, isRoom } from '../../core/approach.js';
import { halfAt } from '../../core/nearest.js';
import { askPick } from '../../core/requests.js';
import { distance } from '../../core/camera_moves.js';
import { length, subtract } from '../../core/vector.js';

// The request for what is at a point of the picture is sent up to TRIES times, because the server answers only the newest
// request and another module may make one.
const ANSWER_MS = 700, TRIES = 3;
const SEARCH_MS = 1500, MOST_SEEN_THROUGH = 4, MOST_GHOSTS = 8;
const AROUND = [[-0.12, 0], [0.12, 0], [0, -0.12], [0, 0.12], [-0.2, -0.2], [0.2, -0.2], [-0.2, 0.2], [0.2, 0.2]], BEFORE = 0.9;
// A surface nearer to a sensor than this is the one on which the sensor is mounted: NEAR_M metres, but at most the fraction NEAR_PART of
// the asset's size.
const NEAR_M = 0.05, NEAR_PART = 0.02;
const MOST_COVERED = 9; // number of cameras to compare if the tag's own asset hides it from all sides
// MOST_WALLS: maximum number of walls past which the eye moves towards a tag, one after the other. CLEAR: the eye moves to this
// fraction of the last wall's distance from the tag, so that it is just past that wall.
const MOST_WALLS = 6, CLEAR = 0.95;
// A camera moved into the tag's room is accepted only if its free way towards the tag is at least this fraction of the distance
// from which the camera outside looked at the tag.
const ROOMY = 0.4;

const has = (list, id) => (list ?? []).includes(id);
const without = (list, id) => (list ?? []).filter((other) => other !== id);

export class Approach {
    constructor({ session, viewport }) {
        Object.assign(this, { session, viewport });
        // ids of assets that this module made transparent because they hide the tag (not those that the user made transparent)
        this.ghosts = [];
        // number of the newest search for a free view of a tag: an older search that is still running stops when it sees
        // another number
        this.number = 0;
        this.heard = null;
        session.on('picked', (picked) => picked.purpose === 'sight' && this.heard?.(picked));
    }

    // Ends the search for a free view of a tag, because the user moves the camera.
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

    // Sets the assets that this module makes transparent because they hide the tag; those that the user made transparent stay
    // so.
    setGhosts(ids) {
        const now = this.session.params.ghost ?? [], own = now.filter((id) => !has(this.ghosts, id));
        this.ghosts = ids.filter((id) => !has(own, id));
        const ghost = [...own, ...this.ghosts];
        if (ghost.join('\n') !== now.join('\n'))
            this.session.setParams({ ghost });
    }

    // Calls fly(camera) immediately, and again with another camera if assets turn out to block the first view of the tag.
    async go(tag, asset, fly) {
        const number = ++this.number, isOvertaken = () => number !== this.number;
        this.setGhosts([]);
        this.reveal(asset);
        const { camera: now, model, params } = this.session, { width } = halfAt(params, this.viewport.width, 0);
        // id of the tag's asset, which the eye must not enter; null: the asset is a room, which it may enter
        const solid = isRoom(asset, model.assets) ? null : asset.id;
        const cameras = approaches({ camera: now, point: tag.position, box: asset.bounds, aspect: width / this.viewport.height,
            whole: model.plant.bounds, solid: solid !== null, vertical: model.plant.up });
        fly(cameras[0]);
        const behind = [], own = []; // cameras whose view of the tag is blocked. behind: by another asset; own: by the tag's own asset
        // deadline, after which the best view found so far is used, for example on a slow network
        const latest = performance.now() + SEARCH_MS;
        let best = null, least = Infinity;
        for (const camera of cameras) {
            const found = await this.look(camera, tag), covered = found?.seen ? await this.coverAround(camera, asset, least) : Infinity;
            if (isOvertaken() || !found)
                return;
            if (covered < least)
                [best, least] = [camera, covered];
            if (!found.seen && found.asset !== null)
                (found.asset === asset.id ? own : behind).push(camera);
            if (covered === 0 || (performance.now() > latest && (best || behind.length > 0)))
                break;
        }
        best ??= await this.findInside(cameras, tag, solid, isOvertaken) ??
            await this.findThrough(behind, tag, asset, isOvertaken) ?? await this.leastCovered(own, asset);
        if (best && best !== cameras[0] && !isOvertaken())
            fly(best);
    }

    // Returns the camera that sees the tag through transparent assets; null: none.
    async findThrough(cameras, tag, asset, isOvertaken) {
        for (const camera of cameras.slice(0, MOST_SEEN_THROUGH)) {
            const isSeen = await this.seeThrough(camera, tag, asset, isOvertaken);
            if (isSeen || isOvertaken())
                return camera;
        }
        this.setGhosts([]);
        return null;
    }

    // Returns the camera with the fewest other assets in front of its picture's centre; null: there are no cameras.
    async leastCovered(cameras, asset) {
        let best = null, least = Infinity;
        for (const camera of cameras.slice(0, MOST_COVERED)) {
            const covered = await this.coverAround(camera, asset, least);
            if (covered < least)
                [best, least] = [camera, covered];
            if (covered === 0)
                break;
        }
        return best;
    }

    // Returns a camera in the same room as the tag: the one with the longest free way to the tag, or else to the tag's
    // equipment. Returns null if no camera has at least the fraction ROOMY of its distance free.
    async findInside(cameras, tag, solid, isOvertaken) {
        const latest = performance.now() + SEARCH_MS;
        let best = null, most = -Infinity;
        for (const side of cameras) {
            const found = await this.passWalls(side, tag, solid), part = found ? found.free / distance(side) : 0;
            if (isOvertaken() || performance.now() > latest)
                break;
            if (part >= ROOMY && part - !found.seen > most)
                [best, most] = [found.camera, part - !found.seen];
            if (most >= CLEAR * CLEAR)
                break;
        }
        return best;
    }

    // Moves the eye towards the tag, past one wall after another, but not into the asset `solid`. Returns { camera, seen: true
    // if the tag is visible, free: metres from the eye to the tag or to the asset }; null: the eye finds no position behind the
    // walls.
    async passWalls(camera, tag, solid) {
        for (let walls = 0, eye = camera; walls < MOST_WALLS; walls++) {
            const found = await this.look(eye, tag), metres = found?.position ? length(subtract(found.position, tag.position)) : 0;
            if (found?.seen || (found && walls > 0 && found.asset === solid))
                return { camera: eye, seen: found.seen, free: distance(eye) - (found.seen ? 0 : metres) };
            if (metres === 0 || found.asset === solid)
                return null;
            eye = atDistance(camera, CLEAR * Math.min(metres, distance(eye)));
        }
        return null;
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

    // Returns what a camera sees at the centre of its picture: { seen: true if the tag is visible, asset and position: id of the asset in
    // front, and the point on its surface, or null }; null: the server did not answer.
    async look(camera, tag) {
        const picked = await this.ask(camera, [0, 0]);
        if (!picked)
            return null;
        const { sensor, occluded, position, asset } = picked, { min, max } = this.session.model.asset(tag.asset).bounds;
        const near = Math.min(NEAR_M, NEAR_PART * length(subtract(max, min)));
        const isThere = position !== null && length(subtract(position, tag.position)) < near;
        return { seen: isThere || (sensor === tag.name && !occluded), asset, position };
    }

    // Asks the server what is at the points AROUND, near the centre of the camera's picture, where the tag is. Returns at how
    // many of these points an asset other than `id` is clearly in front of the tag; stops counting at `most`.
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

    // Asks the server what is at an offset from the centre of a camera's picture, in units of the picture's height. Returns null if there
    // is no answer.
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
