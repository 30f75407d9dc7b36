// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of a machine that runs for years: the volume of the history becomes read-only, and the daemon's certificate expires.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import {
    appendFileSync, copyFileSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { after, test } from 'node:test';
import { missingClocks, SetClock } from './support/clocks.mjs';
import { DESKTOP, shoot, waitForPicture, withPage } from './support/browser.mjs';
import { missingBrowser } from './support/drivers.mjs';
import { get, PlainClient } from './support/plain_client.mjs';
import { notBuilt, runProgram, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
const scratch = mkdtempSync(join(tmpdir(), 'plantcast-faults-'));
const at = (name) => join(scratch, name), sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const sh = (line) => spawnSync('/bin/sh', ['-euc', line], { encoding: 'utf8' });
after(() => rmSync(scratch, { recursive: true, force: true }));

// Mount point of an ext4 volume that becomes read-only, as after an error of the disk below, when a test writes to the file
// (trigger_fs_error) that makeVolume() returns.
const volume = at('volume');
function makeVolume() {
    mkdirSync(volume);
    const made = sh(`truncate -s 64M ${volume}.img; mkfs.ext4 -q ${volume}.img; mount -o loop,errors=remount-ro ${volume}.img ${volume}`);
    const device = made.status === 0 && basename(sh(`findmnt -nro SOURCE ${volume}`).stdout.trim());
    const trigger = device && `/sys/fs/ext4/${device}/trigger_fs_error`;
    return trigger && existsSync(trigger) ? trigger : undefined;
}
const unmount = () => sh(`umount ${volume} 2>/dev/null || umount -l ${volume}`);

async function gauge(plant, name) {
    const { body } = await get(plant.port, '/metrics');
    return Number(String(body).match(new RegExp(`^${name} (.*)$`, 'm'))?.[1]);
}
const ledger = (plant, folder) => runProgram('plantcast',
    ['history', 'export', plant.file, '--tags', 'TI-1', '--folder', folder, '--from', '-1h']).out.trim().split('\n').slice(1);

// Sets TI-1 and waits until the daemon has read the value, because the daemon could miss a value that lasts less than a poll
// interval.
async function take(plant, value) {
    await plant.tell(`set TI-1 ${value}`);
    await until(`${value} is read`, async () => {
        const { tags } = JSON.parse((await get(plant.port, '/api/v1/tags?count=9')).body);
        return tags.find(({ name }) => name === 'TI-1').value === value;
    });
}

test('on a volume that becomes read-only the daemon runs on and reports it; unsaved points are stored once it is repaired', {
    skip: skip || (process.getuid() === 0 ? false : 'needs root'), timeout: 180000,
}, async (t) => {
    const trigger = makeVolume();
    if (!trigger) {
        unmount();
        t.skip('no volume can be mounted here');
        return;
    }
    const runtime = at('runtime'), history = join(volume, 'history');
    mkdirSync(runtime);
    // folder in which the daemon stores, when it stops, the readings that the disk did not accept; systemd sets this variable
    // for the service
    process.env.RUNTIME_DIRECTORY = runtime;
    const plant = await TinyPlant.create();
    try {
        await plant.start('--history', history);
        await take(plant, 11);
        await until('a point on disk', () => ledger(plant, history).some((line) => /,11[.,]/.test(`${line},`)));
        writeFileSync(trigger, '1');
        assert.notEqual(sh(`touch ${volume}/x`).status, 0, 'the volume is read-only');
        // 77 does not lie on the straight line between the values 11 and 33, so the history must store this reading as a point
        // of its own
        await take(plant, 77);
        await until('plantcast_history_good is 0', async () => await gauge(plant, 'plantcast_history_good') === 0);
        await plant.daemon.line(/history-[\d-]+\.sqlite: .*error$/m);
        await plant.daemon.line(/history: the history cannot be written to disk \(/);
        assert.equal((await get(plant.port, '/snapshot.png?width=320&height=200')).status, 200, 'pictures are still drawn');
        const ready = await get(plant.port, '/readyz');
        assert.deepEqual([ready.status, String(ready.body)], [200, 'ok; readings are not recorded: the log says why\n']);
        await take(plant, 33);
        assert.deepEqual(await plant.daemon.stop(), { code: 0, signal: null }, plant.daemon.said);
        unmount();
        // Repairs and mounts a copy of the volume's image. Programs with mount namespaces of their own (unshare, services) may
        // still use the volume itself, which therefore stays read-only.
        const mended = sh(`cp --sparse=always ${volume}.img ${volume}.mended; fsck.ext4 -fy ${volume}.mended >/dev/null || [ $? = 1 ]
            mount -o loop ${volume}.mended ${volume}; touch ${volume}/x`);
        assert.equal(mended.status, 0, mended.stderr);
        await plant.startDaemon('--history', history);
        await until('all three values on disk', () => {
            const lines = ledger(plant, history).join('\n');
            return ['11', '77', '33'].every((value) => new RegExp(`,${value}(\\.0*)?(,|$)`, 'm').test(lines));
        });
        await until('plantcast_history_good is 1', async () => await gauge(plant, 'plantcast_history_good') === 1);
    } finally {
        delete process.env.RUNTIME_DIRECTORY;
        await plant.destroy();
        unmount();
    }
});

test('after a downgrade, log, /readyz and a metric tell of a history file in a newer version, and its removal helps', {
    skip, timeout: 180000,
}, async () => {
    const plant = await TinyPlant.create(), history = join(plant.folder, 'history'), moved = join(plant.folder, 'moved');
    try {
        await plant.start('--history', history);
        await take(plant, 11);
        await until('a point on disk', () => ledger(plant, history).some((line) => /,11[.,]/.test(`${line},`)));
        await plant.daemon.stop();
        const [file] = readdirSync(history).filter((name) => /^history-.*\.sqlite$/.test(name));
        sh(`python3 -c "import sqlite3; sqlite3.connect('${join(history, file)}').execute('PRAGMA user_version = 99')"`);
        await plant.startDaemon('--history', history);
        const [, command] = await plant.daemon.line(new RegExp(`${file}: version 99 of this file was written by a newer Plantcast; ` +
            'this program supports version \\d+, .* run `(mv .*) ANOTHER'));
        await plant.daemon.line(/history: the history cannot be written to disk \(a newer Plantcast wrote a file: /);
        await until('plantcast_history_good is 0', async () => await gauge(plant, 'plantcast_history_good') === 0);
        const { status, body } = await get(plant.port, '/readyz');
        assert.equal(status, 200);
        assert.match(String(body), /^ok; readings are not recorded, because a newer Plantcast wrote a history file: /);
        await plant.daemon.stop();
        mkdirSync(moved);
        assert.equal(sh(`${command} ${moved}`).status, 0);
        await plant.startDaemon('--history', history);
        await take(plant, 22);
        await until('a point on disk again', () => ledger(plant, history).some((line) => /,22[.,]/.test(`${line},`)));
        assert.equal(String((await get(plant.port, '/readyz')).body), 'ok\n');
        assert.equal(await gauge(plant, 'plantcast_history_good'), 1);
    } finally {
        await plant.destroy();
    }
});

test('log, /readyz and a metric name each other file that a newer version wrote or that is damaged', {
    skip: skip || (missingBrowser('chromium') ?? false), timeout: 180000,
}, async () => {
    const plant = await TinyPlant.create(), history = join(plant.folder, 'history');
    const ready = async () => String((await get(plant.port, '/readyz')).body);
    try {
        mkdirSync(history);
        sh(`python3 -c "import sqlite3; sqlite3.connect('${join(history, 'alarms.sqlite')}').execute('PRAGMA user_version = 99')"`);
        writeFileSync(join(history, 'notes.json'), '{"version": 9, "notes": []}');
        writeFileSync(join(history, 'views.json'), '{"version": 1, "views": [');
        await plant.start('--history', history);
        await plant.daemon.line(/alarms\.sqlite: version 99 of this file was written by a newer Plantcast/);
        await plant.daemon.line(/alarms: the alarm journal in \S+ cannot be read \(a newer Plantcast .*\): .* are not restored/);
        await plant.daemon.line(/notes\.json: version 9 of this file was written by a newer Plantcast/);
        await plant.daemon.line(/views\.json:1: .*; the file is ignored and not changed/);
        assert.equal(await gauge(plant, 'plantcast_alarm_journal_good'), 0);
        assert.equal(await ready(), 'ok; alarm events are not recorded, because a newer Plantcast wrote the alarm journal: the log names ' +
            'the file and the command that moves it away; these files are not used, because they cannot be read: views.json, ' +
            'notes.json: the log says why\n');
        assert.equal(readFileSync(join(history, 'notes.json'), 'utf8'), '{"version": 9, "notes": []}');
        const client = await PlainClient.open(plant.port);
        await client.hello();
        assert.deepEqual((await client.text('status')).unrecorded, ['alarms', 'lists']);
        appendFileSync(plant.file, '# a changed file\n');
        plant.daemon.child.kill('SIGHUP');
        await plant.daemon.line(/alarms: the alarm journal in \S+ cannot be read \(a newer Plantcast .*\): alarms keep their states, but /);
        await plant.daemon.line(/reload: configuration \w+ replaced \w+ after/);
        const statuses = client.texts.filter(({ type }) => type === 'status');
        assert.deepEqual(statuses.filter(({ unrecorded }) => String(unrecorded) !== 'alarms,lists'), [], 'the warning stays');
        client.close();
        await withPage(`http://127.0.0.1:${plant.port}/`, DESKTOP, async (page) => {
            await waitForPicture(page);
            await page.waitForSelector('.unrecorded');
            assert.equal(await page.textContent('.unrecorded output'), 'Not recorded: alarm changes, views, notes and other lists');
            assert.match(await page.getAttribute('.unrecorded', 'title'), /^Not recorded: alarm changes, .*\. The server cannot /);
            assert.ok(await page.evaluate(() => {
                const output = document.querySelector('.unrecorded output');
                return output.scrollWidth <= output.clientWidth;
            }), 'no name is truncated');
            await shoot(page, 'unrecorded');
        });
        await plant.daemon.stop();
        for (const name of ['alarms.sqlite', 'notes.json', 'views.json'])
            rmSync(join(history, name));
        await plant.startDaemon('--history', history);
        assert.equal(await ready(), 'ok\n');
        assert.equal(await gauge(plant, 'plantcast_alarm_journal_good'), 1);
    } finally {
        await plant.destroy();
    }
});

// Makes a key and a certificate NAME.pem that expires in this number of seconds.
function certificate(name, seconds) {
    const utc = (ms) => new Date(ms).toISOString().replace(/[-:T]/g, '').slice(2, 14) + 'Z';
    writeFileSync(at('ca.cnf'), `[ca]\ndefault_ca=a\n[a]\ndatabase=${at('index')}\nnew_certs_dir=${scratch}\nrand_serial=yes
default_md=sha256
policy=p\nx509_extensions=x\n[p]\ncommonName=supplied\n[x]\nsubjectAltName=DNS:localhost,IP:127.0.0.1\nbasicConstraints=CA:TRUE\n`);
    writeFileSync(at('index'), '');
    const made = sh(`cd ${scratch}
        openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout ${name}.key -out ${name}.csr -subj /CN=localhost
        openssl ca -batch -notext -config ca.cnf -selfsign -keyfile ${name}.key -in ${name}.csr -out ${name}.pem \
            -startdate ${utc(Date.now() - 3600e3)} -enddate ${utc(Date.now() + seconds * 1000)}`);
    assert.equal(made.status, 0, made.stderr);
}

test('a certificate that expires while in use is reported, and a new one is loaded', {
    skip: skip || (missingClocks() ?? false), timeout: 120000,
}, async (t) => {
    const plant = await TinyPlant.create(), clock = new SetClock(at('clock')), ENDS_S = 3600;
    t.after(() => plant.destroy());
    assert.equal(plant.prepare().code, 0);
    certificate('old', ENDS_S);
    certificate('new', 90 * 86400);
    copyFileSync(at('old.pem'), at('cert.pem'));
    copyFileSync(at('old.key'), at('key.pem'));
    plant.confine(...clock.starter());
    await plant.startDaemon('--tls-cert', at('cert.pem'), '--tls-key', at('key.pem'));
    await plant.daemon.line(/warn .*cert\.pem: this certificate expires within 14 days, in \d\.\d hours/);
    assert.doesNotMatch(plant.daemon.said, /has expired/);
    clock.set(ENDS_S);
    await plant.daemon.line(/error .*cert\.pem: this certificate has expired$/m);
    const [env, ...variables] = clock.starter(), address = `https://127.0.0.1:${plant.port}/metrics`;
    const curl = (...args) => spawnSync(env, [...variables, 'curl', '-s', '--max-time', '60', ...args, address], { encoding: 'utf8' });
    assert.equal(curl('--cacert', at('old.pem')).status, 60, 'curl with the expired certificate fails');
    const { stdout } = curl('-k');
    const left = Number(stdout.match(/^plantcast_certificate_expiry_timestamp_seconds (.*)$/m)[1]) * 1000 - clock.now();
    assert.ok(left <= 0 && left > -ENDS_S * 1000, String(left));
    for (const [from, to] of [['new.pem', 'cert.pem'], ['new.key', 'key.pem']])
        copyFileSync(at(from), at(to));
    await plant.daemon.line(/cert\.pem: serving the new certificate/);
    assert.equal(curl('--cacert', at('new.pem')).status, 0);
});
