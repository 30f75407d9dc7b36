// SPDX-License-Identifier: GPL-3.0-or-later
// Monitoring: a real Prometheus reads the metrics of a real daemon. The rules of deploy/prometheus must load, and the queries
// of the panels in deploy/grafana must find data.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { test } from 'node:test';
import { freePort } from './support/ports.mjs';
import { BIN, missing, Program, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const RULES = resolve('deploy/prometheus'), absent = missing();
const noPrometheus = spawnSync('promtool', ['--version']).status !== 0 && 'prometheus is not installed';
const promtool = (...args) => spawnSync('promtool', args, { cwd: RULES, encoding: 'utf8', timeout: 60000 });

test('every alert rule passes promtool, fires when it should, and has its entry in the runbook', { skip: noPrometheus }, () => {
    for (const args of [['check', 'rules', 'rules.yml'], ['test', 'rules', 'rules.test.yml'], ['check', 'config', 'prometheus.yml'],
        ...['tls', 'cores'].map((name) => ['check', 'config', '--syntax-only', `prometheus-${name}.yml`])]) {
        const { status, stdout, stderr } = promtool(...args);
        assert.equal(status, 0, `${args.join(' ')}: ${stdout}${stderr}`);
    }
    const rules = readFileSync(join(RULES, 'rules.yml'), 'utf8'), runbook = readFileSync(join(RULES, 'RUNBOOK.md'), 'utf8');
    const alerts = [...rules.matchAll(/- alert: (\w+)/g)].map(([, name]) => name);
    const links = [...rules.matchAll(/runbook_url: RUNBOOK\.md#(\w+)/g)].map(([, name]) => name);
    assert.deepEqual(links, alerts.map((name) => name.toLowerCase()));
    assert.deepEqual([...runbook.matchAll(/^## (\w+)$/gm)].map(([, name]) => name), alerts);
});

// Queries that find no data here, because the plant has only one daemon and no notifications, certificate, backup or clients.
const EMPTY = /plantcast_core|plantcast_renderers|notify|certificate|backup|histogram_quantile|\[1d|predict_linear/;

test('Prometheus scrapes a daemon and loads the rules, and every panel\'s query finds data',
    { skip: noPrometheus || (absent.length > 0 ? `not built: ${absent.join(', ')}` : false), timeout: 200000 }, async () => {
        const folder = mkdtempSync(join(tmpdir(), 'plantcast-prometheus-')), port = await freePort(), plant = await TinyPlant.running();
        writeFileSync(join(folder, 'prometheus.yml'), readFileSync(join(RULES, 'prometheus.yml'), 'utf8').replace('15s', '500ms')
            .replace('15s', '1s').replace('rules.yml', join(RULES, 'rules.yml')).replace('127.0.0.1:8080', `127.0.0.1:${plant.port}`));
        const prometheus = spawn('prometheus', [`--config.file=${join(folder, 'prometheus.yml')}`,
            `--storage.tsdb.path=${join(folder, 'data')}`, `--web.listen-address=127.0.0.1:${port}`], { stdio: 'ignore' });
        const ask = async (path) => (await fetch(`http://127.0.0.1:${port}/api/v1/${path}`)).json();
        const query = (expr) => ask(`query?query=${encodeURIComponent(expr)}`);
        try {
            await until('ten scrapes', async () => {
                const { data } = await query('count_over_time(plantcast_build_info[1m])').catch(() => ({}));
                return Number(data?.result?.[0]?.value?.[1]) >= 10;
            });
            const rules = await until('evaluated rules', async () => {
                const all = (await ask('rules')).data.groups.flatMap(({ rules: some }) => some);
                return all.length > 0 && all.every(({ health }) => health !== 'unknown') && all;
            });
            for (const rule of rules)
                assert.equal(rule.health, 'ok', `${rule.name}: ${rule.lastError}`);
            for (const name of ['operations', 'cores', 'alarms']) {
                const { panels, templating } = JSON.parse(readFileSync(resolve(`deploy/grafana/${name}.json`), 'utf8'));
                assert.deepEqual(templating.list.map(({ type }) => type), ['datasource', 'query']);
                for (const { title, targets } of panels)
                    for (const { expr } of targets) {
                        const { status, error, data } = await query(expr.replaceAll('$instance', '.+'));
                        assert.equal(status, 'success', `${title}: ${expr}: ${error}`);
                        assert.ok(EMPTY.test(expr) || data.result.length > 0, `${name}, ${title}: no data for ${expr}`);
                    }
            }
        } finally {
            prometheus.kill();
            await plant.destroy();
            rmSync(folder, { recursive: true, force: true });
        }
    });

// The configuration file that Debian's package installs: it has other jobs, and its rules are commented out.
const STOCK = `global:
  scrape_interval:     1s # Set the scrape interval.
rule_files:
  # - "first_rules.yml"
scrape_configs:
  - job_name: 'prometheus'
    static_configs:
      - targets: ['localhost:9090']
`;

test('prometheus-add keeps the file\'s other jobs, and scraping works with a self-signed certificate',
    { skip: noPrometheus || (absent.length > 0 ? `not built: ${absent.join(', ')}` : false), timeout: 200000 }, async (t) => {
        const plant = await TinyPlant.create(), root = mkdtempSync(join(tmpdir(), 'plantcast-monitored-')), run = join(root, 'run');
        const etc = (...names) => join(root, 'etc', ...names), port = await freePort(), own = await freePort();
        let daemon, prometheus;
        t.after(async () => {
            prometheus?.kill();
            await daemon?.stop();
            await plant.destroy();
            rmSync(root, { recursive: true, force: true });
        });
        const shell = (script) => {
            const { status, stdout, stderr } = spawnSync('sh', ['-euc', script], { encoding: 'utf8', cwd: root,
                env: { ...process.env, PATH: `${BIN}:${process.env.PATH}`, PLANTCAST_ROOT: root, PLANTCAST_RUN: run } });
            assert.equal(status, 0, stderr);
            return stdout;
        };
        shell(`plantcast init one --plant ${plant.folder} --host plant.example --port ${port} --root ${root}; mkdir run etc/prometheus`);
        writeFileSync(etc('prometheus/prometheus.yml'), STOCK);
        const add = resolve('deploy/prometheus/add');
        shell(`${add} one`);
        const config = readFileSync(etc('prometheus/prometheus.yml'), 'utf8');
        for (const line of STOCK.split('\n'))
            assert.ok(config.includes(line), line);
        shell(`${add} one`);
        assert.equal(readFileSync(etc('prometheus/prometheus.yml'), 'utf8'), config, 'a second run changes nothing');
        const rules = etc('prometheus/plantcast-rules.yml'), edited = `${readFileSync(rules, 'utf8')}# edited\n`;
        writeFileSync(rules, edited);
        assert.match(shell(`${add} one 2>&1`), /plantcast-rules\.yml differs from the rules of this version and was not replaced/);
        assert.equal(readFileSync(rules, 'utf8'), edited, 'rules that a person edited stay');
        assert.equal(statSync(etc('prometheus/plantcast-one.token')).mode & 0o077, 0);
        // deletes the token file in Prometheus's folder, as on a new machine on which only the plant was restored; the command
        // must make it again
        rmSync(etc('prometheus/plantcast-one.token'));
        shell(`${add} one`);
        assert.equal(readFileSync(etc('plantcast/one/tokens'), 'utf8').match(/prometheus/g).length, 1);
        const [, options] = readFileSync(etc('plantcast/one/options'), 'utf8').match(/^PLANTCAST_OPTIONS="(.*)"$/m);
        shell(`plantcast-prep -o prepared etc/plantcast/one/plant.yaml`);
        daemon = new Program('plantcastd', [etc('plantcast/one/plant.yaml'), '--prepared', join(root, 'prepared'),
            ...options.split(' ')], { env: { ...process.env, RUNTIME_DIRECTORY: run } });
        await daemon.line(/ready/);
        prometheus = spawn('prometheus', [`--config.file=${etc('prometheus/prometheus.yml')}`,
            `--storage.tsdb.path=${join(root, 'data')}`, `--web.listen-address=127.0.0.1:${own}`], { stdio: 'ignore' });
        // waits until Prometheus has read the daemon's metrics after the time `since` (ms), and returns the target's labels
        const scrapes = async (since) => {
            for (const end = Date.now() + 60000; ; await sleep(200)) {
                const { data } = await fetch(`http://127.0.0.1:${own}/api/v1/targets`).then((answer) => answer.json()).catch(() => ({}));
                const target = data?.activeTargets.find(({ labels }) => labels.plant === 'one');
                if (target?.health === 'up' && Date.parse(target.lastScrape) > since)
                    return target.labels;
                assert.ok(Date.now() < end, JSON.stringify(target));
            }
        };
        assert.equal((await scrapes(0)).job, 'plantcast');
        shell(`cd etc/plantcast/one/tls
            openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout ca.key -out ca.pem -days 9 \\
                -subj "/CN=Works CA"
            openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout new.key -out new.csr -subj "/CN=plant.example" \\
                -addext "subjectAltName=DNS:plant.example"
            openssl x509 -req -in new.csr -CA ca.pem -CAkey ca.key -CAcreateserial -copy_extensions copy -days 9 -out new.pem
            cat new.pem ca.pem >fullchain.pem; cat new.key >privkey.pem`);
        await daemon.line(/serving the new certificate/);
        const renewed = Date.now();
        await scrapes(renewed);
        assert.equal(statSync(join(run, 'certificate.pem')).mode & 0o777, 0o644);
    });

const DASHBOARDS = ['operations', 'cores', 'alarms', 'trends'];
const TYPES = ['row', 'stat', 'timeseries', 'table', 'state-timeline', 'bargauge', 'gauge', 'piechart', 'barchart'];
test('dashboards are valid for Grafana: panels fit in the grid, and their variables exist', () => {
    for (const name of DASHBOARDS) {
        const { panels, templating, uid, schemaVersion } = JSON.parse(readFileSync(resolve(`deploy/grafana/${name}.json`), 'utf8'));
        assert.deepEqual([uid, schemaVersion], [`plantcast-${name}`, 38]);
        assert.equal(new Set(panels.map(({ id }) => id)).size, panels.length, `${name}: panels have different ids`);
        const variables = new Set(templating.list.map((variable) => variable.name)), taken = new Map();
        for (const { title, type, gridPos: { x, y, w, h }, targets = [], repeat } of panels) {
            assert.ok(TYPES.includes(type), `${name}, ${title}: unknown panel type ${type}`);
            assert.ok(x >= 0 && w > 0 && h > 0 && x + w <= 24, `${name}, ${title}: the panel lies within 24 columns`);
            assert.ok(repeat === undefined || variables.has(repeat), `${name}, ${title}: the panel repeats an unknown variable ${repeat}`);
            for (let cell = 0; cell < w * h; cell++) {
                const place = `${x + cell % w},${y + Math.floor(cell / w)}`;
                assert.ok(!taken.has(place), `${name}: the panel ${title} covers ${taken.get(place)}`);
                taken.set(place, title);
            }
            assert.equal(new Set(targets.map(({ refId }) => refId)).size, targets.length);
        }
        const text = JSON.stringify([panels, templating]).replaceAll(/\$__\w+/g, '');
        for (const [, used, plain] of text.matchAll(/\$(?:\{(\w+)(?::\w+)?\}|(\w+))/g))
            assert.ok(variables.has(used ?? plain), `${name}: the variable $${used ?? plain} exists`);
    }
});

const noGrafana = spawnSync('grafana-server', ['-v']).status !== 0 && 'grafana-server is not installed (Debian has none)';
test('Grafana imports the dashboards unchanged', { skip: noGrafana, timeout: 120000 }, async () => {
    const folder = mkdtempSync(join(tmpdir(), 'plantcast-grafana-')), port = await freePort();
    const grafana = spawn('grafana-server', ['--homepath', '/usr/share/grafana'], { stdio: 'ignore', env: { ...process.env,
        GF_SERVER_HTTP_PORT: String(port), GF_SERVER_HTTP_ADDR: '127.0.0.1', GF_PATHS_DATA: folder, GF_PATHS_LOGS: folder } });
    const call = (path, init) => fetch(`http://127.0.0.1:${port}/api/${path}`, { ...init,
        headers: { authorization: `Basic ${Buffer.from('admin:admin').toString('base64')}`, 'content-type': 'application/json' } });
    try {
        for (const end = Date.now() + 60000; Date.now() < end && !(await call('health').catch(() => ({}))).ok;)
            await sleep(500);
        for (const name of DASHBOARDS) {
            const dashboard = JSON.parse(readFileSync(resolve(`deploy/grafana/${name}.json`), 'utf8'));
            const answer = await call('dashboards/db', { method: 'POST', body: JSON.stringify({ dashboard, overwrite: true }) });
            assert.equal(answer.status, 200, await answer.text());
        }
    } finally {
        grafana.kill();
        rmSync(folder, { recursive: true, force: true });
    }
});
