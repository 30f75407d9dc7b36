// SPDX-License-Identifier: GPL-3.0-or-later
// The one answer to "may I trust this picture?": kind, words for it, and how long it has been so.
import { ageText, zoneClock } from './format.js';

const seconds = (ms) => `${Math.max(1, Math.ceil(ms / 1000))} s`;

// { kind: connecting | live | past | partial | nodata | silent | lost, words, detail, banner (bool) }
export function health(session, now) {
    const { connection, model, picture } = session;
    const old = picture ? `This picture is ${ageText(now - session.freshAt)} old.` : '';
    if (connection.state === 'open' && connection.quiet) {
        const detail = `The server has been silent for ${ageText(now - connection.lastHeard)}. ${old}`;
        return { kind: 'silent', words: 'No answer', detail, banner: true };
    }
    if (connection.state !== 'open' || !session.welcomed || model.live === null)
        return lost(connection, picture, old, now);
    if (session.time.atUs !== null || picture?.past)
        return past(session);
    if (model.live === false)
        return { kind: 'nodata', words: 'No live data', detail: downText(model), banner: true };
    const down = model.links.filter((link) => !link.up).length;
    const simulated = model.links.filter((link) => link.simulated).map((link) => link.source);
    const live = simulated.length === 0 ? 'Live' : simulated.length < model.links.length ? 'Live, partly simulated' : 'Simulated';
    if (down > 0)
        return { kind: 'partial', words: `${live}, ${down} of ${model.links.length} sources down`, detail: downText(model), banner: false };
    if (simulated.length > 0)
        return { kind: 'partial', words: live, detail: `Not measured in the plant: ${simulated.join(', ')}.`, banner: false };
    return { kind: 'live', words: live, detail: '', banner: false };
}

// The picture's own time where it is one of the past: until then it still shows now, and is not what the words would say.
function past({ picture, time, model }) {
    const us = picture?.past ? picture.dataTimeUs : time.atUs;
    const { date, time: clock, offset } = zoneClock(model.plant.time_zone)(us / 1000);
    const words = time.atUs === null ? 'Returning to now' : 'History';
    return { kind: 'past', words, detail: `${date} ${clock} ${offset}${speedText(time)}`, banner: true };
}

function speedText({ speed }) {
    return speed === 0 ? '' : speed < 0 ? `, playing back ${-speed}×` : `, playing ${speed}×`;
}

function downText(model) {
    const down = model.links.filter((link) => !link.up).map((link) => link.source);
    if (down.length === 0)
        return 'No sensor delivers values.';
    return down.length === 1 ? `Source ${down[0]} does not answer.` : `Sources ${down.join(', ')} do not answer.`;
}

function lost(connection, picture, old, now) {
    const reason = connection.reason ? `${connection.reason[0].toUpperCase()}${connection.reason.slice(1)}.` : '';
    if (connection.state === 'barred')
        return { kind: 'lost', words: 'Not let in', detail: [reason, old].filter(Boolean).join(' '), banner: true };
    if (!picture && connection.tries === 0)
        return { kind: 'connecting', words: 'Connecting', detail: '', banner: false };
    const next = connection.state === 'waiting' ? `Trying again in ${seconds(connection.retryAt - now)}.` : 'Trying again now.';
    return { kind: 'lost', words: 'Disconnected', detail: [reason, old, next].filter(Boolean).join(' '), banner: true };
}
