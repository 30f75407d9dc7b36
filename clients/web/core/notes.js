// SPDX-License-Identifier: GPL-3.0-or-later
// Shift notes: where they are in the plant, and until when they are valid.
import { dateTime, zoneClock } from './format.js';
import { say } from './words.js';

// Returns the note's position [x, y, z], or null if this plant no longer has its tag or equipment.
export function placeOf(model, { position, tag, asset }) {
    if (position || tag)
        return position ?? model.tag(tag)?.position ?? null;
    const { min, max } = model.asset(asset)?.bounds ?? {};
    return min ? [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, max[2]] : null;
}

// Returns the name of the note's tag or equipment; null: the note is at a point or about the whole plant.
export const whereOf = (model, { tag, asset }) => tag ?? (asset ? model.asset(asset)?.tag || asset : null);

// Returns true if a note is about the whole plant.
export const isOfPlant = ({ tag, asset, position }) => !tag && !asset && !position;

// Returns the name of the tag or equipment that a note is about, or words for the plant or a place.
export const whereText = (model, note) => whereOf(model, note) ?? say(isOfPlant(note) ? 'notes.plant' : 'notes.place');

const timeText = (model, us) => dateTime(zoneClock(model.plant.time_zone), us / 1000);
export const endText = (model, { until_us: until }) => (until ? say('notes.ends', { time: timeText(model, until) }) : null);

// Returns what a note is about, who wrote it and when, and until when it is valid.
export function aboutText(model, note) {
    const made = say('named.by', { who: note.by, time: timeText(model, note.time_us) });
    return [whereText(model, note), made, endText(model, note)].filter(Boolean).join(' · ');
}

// Returns the notes that are valid now, or at the past instant atUs. nowUs null: the server's time is not known yet.
export const inForce = (notes, nowUs, atUs = null) => notes.filter(({ time_us: from, until_us: until, ended_us: ended }) => (atUs === null
    ? until === 0 || nowUs === null || until > nowUs
    : from <= atUs && (!until || until > atUs) && (!ended || ended > atUs)));
