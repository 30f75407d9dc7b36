// SPDX-License-Identifier: GPL-3.0-or-later
// A pane with another plant's picture, which this plant's server fetches. Without a picture, the pane says why.
import { ageText } from '../core/format.js';
import { askInTime } from '../core/http.js';
import { say } from '../core/words.js';
import { clock } from '../app/common/clock.js';
import { make, setText } from '../app/common/dom.js';
import { timeOf } from '../app/alarms/alarm_bar.js';

// UNHEARD_MS: after a longer silence of this plant's server, the state of the other plant is unknown
const ASK_MS = 1000, UNHEARD_MS = 5000;

// Returns { tick(now) }.
export function SnapshotPane(pane, { session, title, body }) {
    const [id] = pane.items, image = make('img', { alt: '', hidden: '' }), card = make('div', { class: 'gone' });
    const about = make('span', { class: 'about' }), name = make('span', { class: 'said' });
    let state = null, asks = false, askedAt = -Infinity;
    // shown: { picture (id), ageMs (the picture's age at the time `at`), at }; changedAt: time when a different picture arrived
    let shown = null, changedAt = 0;
    title.replaceChildren(name, about);
    body.append(image, card);

    async function load({ picture, age_ms: ageMs, at }) {
        const blob = await askInTime('api/v1/other_plants/picture', { id, picture }, session.token, 'blob');
        const url = URL.createObjectURL(blob), old = image.src;
        image.src = url;
        await image.decode();
        shown = { picture, ageMs, at };
        if (old)
            URL.revokeObjectURL(old);
    }

    async function look() {
        // stores when the request was sent, not when the answer came, so that the picture's age includes the duration of the
        // request
        const at = askedAt = clock.now();
        asks = true;
        try {
            const { list: [said] } = await askInTime('api/v1/other_plants', { id }, session.token);
            if (said.picture !== state?.picture)
                changedAt = at;
            state = { ...said, at };
            if (said.picture && said.picture !== shown?.picture)
                await load(state);
        } catch {
            // does not report the failure: tick() does so once the server has been silent for too long
        } finally {
            asks = false;
        }
    }

    // Returns the reason why the picture is not shown; '' if it is shown.
    function whyNot(now) {
        if (!state)
            return 'waiting';
        if (now - state.at > UNHEARD_MS)
            return 'unheard';
        if (!state.picture)
            return state.why;
        return !shown ? 'waiting' : shown.picture === state.picture || now - changedAt < UNHEARD_MS ? '' : 'unheard';
    }

    return { tick(now) {
        if (!asks && now - askedAt >= ASK_MS)
            look();
        const why = whyNot(now), known = state?.name || id, aged = !why && shown.ageMs !== null;
        setText(name, pane.title ?? known);
        setText(about, [pane.title && known, !why && say('walls.age', { age: aged ? ageText(shown.ageMs + now - shown.at) : '–' })]
            .filter(Boolean).join(' · '));
        image.hidden = why !== '';
        card.hidden = why === '';
        const gone = why === 'waiting' ? '' : say('others.gone', { name: known, time: timeOf(session, state?.since_us) });
        if (why && card.dataset.shows !== gone + why)
            card.replaceChildren(...(gone ? [make('b', {}, gone)] : []), make('span', {}, say(`others.${why}`)));
        card.dataset.shows = gone + why;
    } };
}
