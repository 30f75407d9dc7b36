// SPDX-License-Identifier: GPL-3.0-or-later
// Decides for the whole page whether the user may trust the picture. Returns one state with a short and a long text.
import { ageText, zoneClock } from './format.js';
import { say, title } from './words.js';

// age in milliseconds of the oldest camera move whose picture is not drawn yet above which the page states the delay
const BEHIND_MS = 500;

// Returns a text with the delay of the picture on the screen; '' if the delay is short. latency: LatencyMeter (meters.js).
export function behindText(latency, now) {
    const ms = latency.behindMs(now);
    return ms > BEHIND_MS ? say('status.behind', { n: (ms / 1000).toFixed(1) }) : '';
}

const seconds = (ms) => say('age.s', { n: Math.max(1, Math.ceil(ms / 1000)) });

// Returns { kind, words, detail, banner }. words: short text about the state. detail: sentence with the reason; '' if there is none.
// banner: true if the page must show the text across the picture. kind: 'connecting': no connection yet; 'live'; 'simulated': at least one
// source simulates, and all sources are connected; 'past': the picture shows a past instant; 'partial': some sources are disconnected;
// 'nodata': the plant delivers no live values; 'silent': the connection is open, but the server sends nothing; 'lost': the connection was
// lost.
export function health(session, now) {
    const { connection, model, picture } = session;
    const old = picture ? say('health.old', { age: ageText(now - session.freshAt) }) : '';
    if (connection.state === 'open' && connection.quiet) {
        const detail = [say('health.silent', { age: ageText(now - connection.lastHeard) }), old].filter(Boolean).join(' ');
        return { kind: 'silent', words: say('health.noanswer'), detail, banner: true };
    }
    if (connection.state !== 'open' || !session.isCurrent || model.live === null)
        return lost(connection, picture, old, now);
    if (session.time.atUs !== null || picture?.past)
        return past(session);
    if (model.live === false)
        return { kind: 'nodata', words: say('health.nodata'), detail: downText(model), banner: true };
    const down = model.links.filter((link) => !link.up).length;
    const simulated = model.links.filter((link) => link.simulated).map((link) => link.source);
    const partly = simulated.length < model.links.length ? 'health.partly' : 'health.simulated';
    const live = say(simulated.length === 0 ? 'health.live' : partly);
    if (down > 0) {
        const words = say('health.down', { live, down, all: model.links.length });
        return { kind: 'partial', words, detail: downText(model), banner: false };
    }
    if (simulated.length > 0)
        return { kind: 'simulated', words: live, detail: say('health.unmeasured', { sources: simulated.join(', ') }), banner: false };
    return { kind: 'live', words: live, detail: '', banner: false };
}

// Returns the note that is shown over the picture if all or some values are simulated; '' if none are, or a past instant is shown.
export function simulatedText({ model, picture, time }) {
    const links = model?.links ?? [], simulated = links.filter((link) => link.simulated).length;
    if (simulated === 0 || time.atUs !== null || picture?.past)
        return '';
    return say(simulated < links.length ? 'simulated.partly' : 'simulated.all');
}

// Describes the past instant that is shown: the picture's instant if the picture on the screen shows the past, otherwise the
// requested one.
function past({ picture, time, model }) {
    const us = picture?.past ? picture.dataTimeUs : time.atUs;
    const { date, time: clock, offset } = zoneClock(model.plant.time_zone)(us / 1000);
    const words = say(time.atUs === null ? 'health.returning' : 'health.past');
    const nothing = picture?.past && picture.noLiveData ? `. ${say('health.nothing')}` : '';
    return { kind: 'past', words, detail: played(`${date} ${clock} ${offset}`, time) + nothing, banner: true };
}

function played(instant, { speed }) {
    return speed === 0 ? instant : say(speed < 0 ? 'health.back' : 'health.playing', { instant, speed: Math.abs(speed) });
}

function downText(model) {
    const down = model.links.filter((link) => !link.up).map((link) => link.source);
    if (down.length === 0)
        return say('health.nosensor');
    return down.length === 1 ? say('health.source', { source: down[0] }) : say('health.sources', { sources: down.join(', ') });
}

function lost(connection, picture, old, now) {
    const reason = connection.reason ? say('health.because', { reason: title(connection.reason) }) : '';
    if (connection.state === 'barred')
        return { kind: 'lost', words: say('health.barred'), detail: [reason, old].filter(Boolean).join(' '), banner: true };
    if (!picture && connection.tries === 0)
        return { kind: 'connecting', words: say('health.connecting'), detail: '', banner: false };
    const waits = connection.state === 'waiting';
    const next = waits ? say('health.retry', { age: seconds(connection.retryAt - now) }) : say('health.retrying');
    return { kind: 'lost', words: say('health.disconnected'), detail: [reason, old, next].filter(Boolean).join(' '), banner: true };
}
