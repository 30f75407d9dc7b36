// SPDX-License-Identifier: GPL-3.0-or-later
// Sends import requests to the server (models, tag lists), and polls their progress.
import { answerText } from '../../core/refusals.js';
import { say } from '../../core/words.js';

const LOOK_MS = 700;

export class Exports {
    // onState(state) is called with the server's import state. onEnd(state, sent) is called when a job has ended; sent is the request {
    // path, query } if this page sent it, else null.
    constructor({ session, onState, onEnd }) {
        Object.assign(this, { session, onState, onEnd, state: null, sent: null });
    }

    async ask(path, { query = {}, ...options } = {}) {
        const text = new URLSearchParams(query).toString(), { token } = this.session;
        const answer = await fetch(`api/v1/import${path}${text && `?${text}`}`, {
            ...options, headers: token ? { Authorization: `Bearer ${token}` } : {},
        }).catch(() => {
            throw new Error(say('reason.unreachable'));
        });
        if (!answer.ok)
            throw Object.assign(new Error(await answerText(answer)), { status: answer.status });
        return answer;
    }

    post(path, query, body) {
        return this.ask(path, { method: 'POST', query, body });
    }

    // Polls the server until no import job is running. sent: the request that the server has just accepted, or null.
    async look(sent = null) {
        clearTimeout(this.timer);
        const before = this.state;
        try {
            this.state = await (await this.ask('')).json();
            if (sent)
                this.sent = { ...sent, number: this.state.number };
        } catch (error) {
            this.state = before && { ...before, failed: error.message };
        }
        const { state } = this;
        if (!state)
            return;
        if (state.phase !== 'idle')
            this.timer = setTimeout(() => this.look(), LOOK_MS);
        this.onState(state);
        if (state.phase === 'idle' && before && (before.phase !== 'idle' || before.number !== state.number))
            this.onEnd(state, this.sent?.number === state.number ? this.sent : null);
    }

    async order(path, query = {}, body = undefined) {
        await this.post(path, query, body);
        await this.look({ path, query });
    }

    async report() {
        return (await this.ask('/report')).json();
    }

    async matches() {
        return (await this.ask('/matches')).text();
    }
}
