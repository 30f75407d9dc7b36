// SPDX-License-Identifier: GPL-3.0-or-later
// Status bar, connection state and banner, always visible as text. Between the server's messages, values age by the page's own
// clock.
import { ageText, zoneClock } from '../../core/format.js';
import { behindText, health, simulatedText } from '../../core/health.js';
import { say } from '../../core/words.js';
import { clock } from '../common/clock.js';
import { byId, make, setText, setVariable } from '../common/dom.js';

export class Status {
    // onFreshness(isFresh) is called when the server falls silent (isFresh false: shown values may be outdated), and when its messages
    // arrive again.
    constructor({ session, onFreshness }) {
        Object.assign(this, { session, onFreshness });
        this.fresh = true;
        session.on('welcome', () => {
            this.clock = zoneClock(session.model.plant.time_zone);
            setText(byId('config'), (session.model.plant.configuration ?? '–').slice(0, 8));
        });
        setInterval(() => this.show(), 250);
        session.connection.onState = () => this.show();
        byId('retry').addEventListener('click', () => session.connection.retryNow());
    }

    show() {
        const now = clock.now();
        const state = health(this.session, now);
        this.showHealth(state);
        this.showBar(state, now);
    }

    showHealth({ kind, words, detail, banner }) {
        const chip = byId('health'), strip = byId('banner'), picture = byId('viewport'), { classList } = picture;
        chip.dataset.kind = kind;
        chip.title = detail;
        setText(chip.querySelector('.words'), words);
        const fresh = kind !== 'lost' && kind !== 'silent';
        classList.toggle('is-old', !fresh);
        classList.toggle('is-past', kind === 'past');
        const simulated = simulatedText(this.session);
        classList.toggle('is-simulated', simulated !== '');
        byId('simulated').hidden = simulated === '';
        setText(byId('simulated'), simulated);
        if (fresh !== this.fresh)
            this.onFreshness(fresh);
        this.fresh = fresh;
        strip.hidden = !banner;
        strip.dataset.kind = kind;
        setText(strip.querySelector('strong'), words);
        setText(strip.querySelector('.detail'), detail);
        byId('retry').hidden = kind !== 'lost';
        if (banner)
            setVariable(picture, '--below', `${strip.getBoundingClientRect().bottom - picture.getBoundingClientRect().top}px`);
    }

    // Returns a text that says whether the server's clock is synchronised, and how well.
    clockState(isSet) {
        const { model } = this.session;
        if (!isSet)
            return say('status.unset.why');
        const parts = [];
        if (model?.clockErrorMs)
            parts.push(say('status.within', { n: model.clockErrorMs }));
        if (model?.leapS)
            parts.push(say(model.leapS > 0 ? 'status.leap' : 'status.leap.less'));
        return parts.join(' ');
    }

    showBar({ kind }, now) {
        const { session } = this;
        const past = kind === 'past' && session.picture?.past;
        const us = past ? session.picture.dataTimeUs : session.clockUs(now);
        this.past = past;
        document.body.classList.toggle('shows-past', Boolean(past));
        byId('clock').parentElement.classList.toggle('past', Boolean(past));
        if (us !== null && this.clock) {
            const { date, time, offset } = this.clock(us / 1000);
            const text = `${date} ${time} ${offset}`;
            if (byId('clock').textContent !== text)
                byId('clock').replaceChildren(make('span', {}, `${date} `), make('b', {}, time), make('span', {}, ` ${offset}`));
        }
        const clockSet = !session.model || session.model.clockSet;
        byId('clock').parentElement.classList.toggle('unset', !clockSet);
        byId('clock').parentElement.title = this.clockState(clockSet);
        const named = say(past ? 'status.then' : 'status.clock');
        setText(byId('clock-name'), clockSet ? named : say('status.unset', { clock: named }));
        const age = session.model ? session.model.oldestAgeMs(session.params.group, now) : null;
        setText(byId('age'), past ? '–' : age === null ? say('none') : ageText(age));
        byId('age').parentElement.classList.toggle('late', age === null || !['live', 'simulated', 'partial', 'past'].includes(kind));
        const rate = session.rate.perSecond(now);
        const quiet = say(['live', 'simulated', 'partial'].includes(kind) ? 'status.still' : 'none');
        setText(byId('rate'), rate > 0 ? say('status.rate', { count: Math.round(rate) }) : quiet);
        const latency = session.latency.median(now);
        const behind = behindText(session.latency, now);
        byId('latency').parentElement.classList.toggle('late', behind !== '');
        setText(byId('latency'), behind || (latency === null ? '–' : say('status.ms', { n: Math.round(latency) })));
        const { picture } = session;
        if (picture)
            setText(byId('size'), `${picture.fullWidth}×${picture.fullHeight} ${picture.codec.toUpperCase()}`);
    }
}
