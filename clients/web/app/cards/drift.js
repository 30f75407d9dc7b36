// SPDX-License-Identifier: GPL-3.0-or-later
// Drift of a sensor from its neighbours' prediction over a week, computed by the daemon from recorded readings (HTTP.md,
// /api/v1/drift): a curve of the week on the sensor's card, and a list of drifting sensors.
import { decimalsOf, numberText, unitText } from '../../core/format.js';
import { askInTime } from '../../core/http.js';
import { say } from '../../core/words.js';

const WIDTH = 168, HEIGHT = 28, AGAIN_MS = 600000;
const kept = new Map(); // cached answers: query -> { at, rows }; the daemon recomputes drift only once an hour

// Returns a promise of the drift of the sensors that a query selects, one entry per sensor; empty if nothing is recorded or the
// daemon does not answer.
export async function driftOf(session, query) {
    const key = JSON.stringify(query), known = kept.get(key);
    if (!session.recorded || session.time.atUs !== null)
        return [];
    if (known && Date.now() - known.at < AGAIN_MS)
        return known.rows;
    const rows = await askInTime('api/v1/drift', query, session.token).then(({ sensors }) => sensors, () => null);
    if (rows)
        kept.set(key, { at: Date.now(), rows });
    return rows ?? [];
}

// Returns a sensor's drift as text, such as +1.4 °C ± 0.2, or null if the drift is unknown.
function changeText({ change, error }, group) {
    const number = (value) => numberText(Math.abs(value), Math.max(1, decimalsOf(group, value)));
    return `${change < 0 ? '−' : '+'}${number(change)} ${unitText(group.unit)} ± ${number(error)}`;
}

export function driftText(row, group) {
    if (!row || (row.verdict === 'unknown' && row.change === null))
        return null;
    return say(`drift.${row.verdict}`, { by: changeText(row, group) });
}

// Returns the residual (reading minus prediction) of each hour; null if either is unknown. Has no side effects.
export const residuals = (hours) => hours.map(([, value, predicted]) => (value === null || predicted === null ? null : value - predicted));

// Returns the residuals as polylines, one per stretch of hours without a gap. The vertical scale spans at least 6 sigma, so
// that mere noise does not fill the height. Has no side effects.
export function stretches(values, sigma) {
    const known = values.filter((value) => value !== null), low = Math.min(...known), high = Math.max(...known), all = [[]];
    const span = Math.max(high - low, 6 * sigma || 0) || 1;
    if (!(Math.abs(low) + Math.abs(high) + span < Infinity))
        return [];
    values.forEach((value, i) => {
        if (value === null)
            return void all.push([]);
        const y = HEIGHT / 2 - (value - low / 2 - high / 2) / span * (HEIGHT - 4);
        all.at(-1).push(`${i + 0.5},${y.toFixed(1)}`);
    });
    return all.filter((points) => points.length > 1).map((points) => points.join(' '));
}

// Returns the week's drift as a curve (SVG), or null if there is nothing to draw.
export function driftCurve(row) {
    if (row.scatter === null)
        return null;
    const lines = stretches(residuals(row.by_hour ?? []), row.scatter);
    if (lines.length === 0)
        return null;
    const NS = 'http://www.w3.org/2000/svg', svg = document.createElementNS(NS, 'svg');
    svg.setAttribute('viewBox', `0 0 ${WIDTH} ${HEIGHT}`);
    svg.setAttribute('class', 'drift-curve');
    svg.setAttribute('aria-hidden', 'true');
    for (const points of lines) {
        const line = document.createElementNS(NS, 'polyline');
        line.setAttribute('points', points);
        svg.append(line);
    }
    return svg;
}
