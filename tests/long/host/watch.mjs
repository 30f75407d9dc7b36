// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a real Prometheus with the shipped rules and configuration, but with all durations divided by 60. Also samples memory
// and descriptors of processes.
import { spawn } from 'node:child_process';
import { copyFileSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { freePort } from '../../e2e/support/ports.mjs';

const SHIPPED = resolve('deploy/prometheus'), UNITS_S = { s: 1, m: 60, h: 3600, d: 86400 }, POLL_MS = 500, FASTER = 60;

// Returns the rules with the durations of `for:` and of time ranges divided by 60, but at least 1 s.
const hasten = (rules) => rules.replaceAll(/(for: |\[)(\d+)([smhd])(:1m)?/g, (whole, before, n, unit, step) =>
    `${before}${Math.max(1000, Math.round(n * UNITS_S[unit] * 1000 / FASTER))}ms${step ? ':1s' : ''}`);

export class Alerts {
    // Starts Prometheus in a folder. targets: [{ port, node, scheme }], the daemons that it reads; ca: certificate authorities
    // (PEM) of the https targets.
    static async start(folder, targets, token, ca) {
        const alerts = new Alerts(), port = await freePort();
        Object.assign(alerts, { port, firing: new Map(), fired: [] });
        writeFileSync(join(folder, 'rules.yml'), hasten(readFileSync(join(SHIPPED, 'rules.yml'), 'utf8')));
        writeFileSync(join(folder, 'plantcast.token'), token);
        const lines = targets.map(({ port: at, node, scheme }) =>
            `      - { targets: ["127.0.0.1:${at}"], labels: { plant: plant1, node: ${node}, __scheme__: ${scheme} } }\n`);
        writeFileSync(join(folder, 'prometheus.yml'), readFileSync(join(SHIPPED, 'prometheus-cores.yml'), 'utf8')
            .replaceAll('15s', '1s').replace(/( +- \{ targets: .*\n)+/, lines.join('')));
        copyFileSync(ca, join(folder, 'plantcast.pem'));
        const options = [`--config.file=${join(folder, 'prometheus.yml')}`, `--storage.tsdb.path=${join(folder, 'tsdb')}`,
            '--storage.tsdb.retention.time=3h', `--web.listen-address=127.0.0.1:${port}`];
        alerts.child = spawn('prometheus', options, { stdio: ['ignore', 'ignore', 'pipe'] });
        alerts.ended = new Promise((done) => alerts.child.once('exit', done));
        alerts.said = '';
        alerts.child.stderr.on('data', (chunk) => { alerts.said = (alerts.said + chunk).slice(-5000); });
        alerts.timer = setInterval(() => alerts.poll().catch(() => {}), POLL_MS);
        return alerts;
    }

    async ask(path) { return (await fetch(`http://127.0.0.1:${this.port}/api/v1/${path}`)).json(); }
    async poll() {
        const { data } = await this.ask('alerts'), now = performance.now();
        const firing = new Set(data.alerts.filter(({ state }) => state === 'firing').map(({ labels }) => labels.alertname));
        for (const name of firing)
            if (!this.firing.has(name)) {
                this.firing.set(name, now);
                this.fired.push({ name, at: now });
            }
        for (const name of this.firing.keys())
            if (!firing.has(name))
                this.firing.delete(name);
    }
    // Returns the names of the alerts that began to fire at the time `at` or later.
    since(at) { return new Set(this.fired.filter((one) => one.at >= at).map(({ name }) => name)); }
    // Returns the number of daemons that Prometheus can read at present.
    async read() { return (await this.ask('targets')).data.activeTargets.filter(({ health }) => health === 'up').length; }

    async end() {
        clearInterval(this.timer);
        this.child.kill('SIGKILL');
        await this.ended;
    }
}

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];
export class Footprint {
    constructor(processes) { // processes: function that returns [{ name, pid }] of the currently running processes
        Object.assign(this, { processes, samples: new Map(), began: new Map() });
        this.timer = setInterval(() => this.sample(), 5000);
    }
    sample() {
        for (const { name, pid } of this.processes()) {
            try {
                const status = readFileSync(`/proc/${pid}/status`, 'utf8');
                const of = (key) => Number(status.match(new RegExp(`^${key}:\\s+(\\d+)`, 'm'))[1]);
                if (!this.began.has(pid))
                    this.began.set(pid, Date.now());
                const row = { age_s: (Date.now() - this.began.get(pid)) / 1000, memory_mb: of('VmRSS') / 1024, threads: of('Threads'),
                    descriptors: readdirSync(`/proc/${pid}/fd`).length };
                this.samples.set(name, [...this.samples.get(name) ?? [], row]);
            } catch { /* the process has ended */ }
        }
    }
    // Returns for each process and quantity (memory, descriptors, threads) the medians [of the first third, of the last third]
    // of its samples, without those of its first 20 s.
    rows() {
        return [...this.samples].map(([name, all]) => {
            const settled = all.filter(({ age_s }) => age_s > 20), third = Math.ceil(settled.length / 3);
            const ends = (key) => [settled.slice(0, third), settled.slice(-third)].map((part) => median(part.map((row) => row[key])));
            const figures = { memory_mb: ends('memory_mb'), descriptors: ends('descriptors'), threads: ends('threads') };
            return { name, count: settled.length, ...figures };
        }).filter(({ count }) => count >= 6);
    }
    end() { clearInterval(this.timer); }
}
