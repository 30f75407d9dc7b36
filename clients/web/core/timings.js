// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the latency of recent pictures, stage by stage.

export const STAGES = ['wait', 'field', 'render', 'encode', 'network', 'decode'];
// stages of a picture's latency whose durations the server sends with the picture, in microseconds
const STATED = ['wait', 'field', 'render', 'encode'];

const rank = (sorted, share) => sorted[Math.min(sorted.length - 1, Math.ceil(share * sorted.length) - 1)];

// Returns the milliseconds of each stage of a picture's latency; null: unknown. hereUs: the server's time when the picture was decoded, or
// null.
function stages({ picture, decodeMs, hereUs }) {
    const network = hereUs === null ? null : Math.max(0, (hereUs - picture.sentTimeUs) / 1000 - decodeMs);
    return { network, decode: decodeMs, ...Object.fromEntries(STATED.map((name) => [name, picture[`${name}Us`] / 1000])) };
}

// recent: recent pictures of a session. Returns the percentiles { p50, p95 } of a stage's latency, or of 'sensor': from a changed reading
// to its picture. null: no data.
export function timingOf(recent, name) {
    const whole = (one) => (one.picture.data ? Object.values(stages(one)).reduce((sum, ms) => sum + (ms ?? 0), 0) : null);
    const known = recent.map((one) => (name === 'sensor' ? whole(one) : stages(one)[name])).filter((ms) => ms !== null);
    known.sort((a, b) => a - b);
    return known.length > 0 ? { p50: rank(known, 0.5), p95: rank(known, 0.95) } : null;
}

// Returns the bit rate of the pictures that arrived in the last withinMs milliseconds.
export const kbitPerS = (recent, now, withinMs = 5000) =>
    (recent.filter(({ picture }) => now - picture.at <= withinMs).reduce((sum, { picture }) => sum + picture.bytes, 0) * 8) / withinMs;
