// SPDX-License-Identifier: GPL-3.0-or-later
// `plantcast backup NAME` while the service's daemon runs, then `plantcast restore` on a host without Plantcast data: the
// restored files and the drawn picture equal those of the first host.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { hostname } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { BareRoot, missingBareRoot } from './support/bare_root.mjs';
import { folderOfTests } from './support/folders.mjs';
import { freePort } from './support/ports.mjs';
import { setUp } from './support/set_up.mjs';
import { BIN, notBuilt, TinyPlant } from './support/tiny_plant.mjs';

const has = (program) => spawnSync('which', [program]).status === 0;
const options = { timeout: 300000, skip: notBuilt() || (!existsSync(join(BIN, 'plantcast-restore')) && 'not built: plantcast-restore') ||
    (missingBareRoot() ?? (has('age') ? false : 'no age')) };
const SSHD = '/usr/sbin/sshd', BEGIN_S = Math.floor(Date.now() / 1000) - 86400, ETC = '/etc/plantcast/p1', STATE = '/var/lib/plantcast/p1';
const folder = folderOfTests();
let plant, port, first, tokens, picture, daemon, recipient;

const ok = ({ code, out, err }) => {
    assert.equal(code, 0, err);
    return out;
};

// Prepares and serves the plant p1 as its systemd unit does: as the user plantcast, with the options file.
async function serve(root) {
    const prepared = `--prepared ${STATE}/prepared --history ${STATE}/history`;
    const [program, args] = root.line(`. ${ETC}/options; exec setpriv --reuid plantcast --regid plantcast --init-groups sh -euc "` +
        `plantcast-prep -o ${STATE}/prepared ${ETC}/plant.yaml && exec plantcastd ${ETC}/plant.yaml ${prepared} $PLANTCAST_OPTIONS"`);
    daemon = spawn(program, args, { stdio: ['ignore', 'pipe', 'pipe'] });
    daemon.ended = new Promise((done) => daemon.once('exit', done));
    let said = '';
    daemon.stderr.on('data', (text) => { said += text; });
    await new Promise((done, fail) => {
        daemon.stdout.on('data', (text) => /ready/.test(said += text) && done());
        daemon.once('exit', () => fail(new Error(said)));
    });
}
async function stop() {
    if (daemon && daemon.exitCode === null) {
        const inner = readFileSync(`/proc/${daemon.pid}/task/${daemon.pid}/children`, 'utf8').trim().split(' ')[0];
        // the daemon is a child of unshare, which does not pass on signals, so the test signals the daemon itself
        process.kill(Number(inner), 'SIGTERM');
        await daemon.ended;
    }
}
// Returns a picture (PNG bytes) of the readings recorded for one instant, drawn by the running daemon; authenticates with the
// viewer token.
function draw(root) {
    root.write('/tmp/token', tokens.viewer, 0o600);
    ok(root.run(`plantcast snapshot https://localhost:${port}/ --ca ${ETC}/tls/fullchain.pem --token-file /tmp/token ` +
        `--at ${BEGIN_S + 3000} ` + '--size 320x200 -o /tmp/picture.png; chmod 644 /tmp/picture.png'));
    return readFileSync(root.path('tmp/picture.png'));
}
// Returns a sorted list of the files and folders that the service needs, with owner, group, mode, and size and checksum;
// history, prepared files and audit logs are left out.
const listing = (root) => ok(root.run(`find ${ETC} /etc/plantcast/mail.password ${STATE} -path ${STATE}/history -prune -o ` +
    `-path ${STATE}/prepared -prune -o ! -name 'audit.log*' -printf '%p %U %u %g %m ' ` +
    "! -type d -exec sha256sum {} ';' -o -type d -printf '\\n'"))
    .split('\n').map((line) => line.replace(/ \d+ (?=root|plantcast)/, ' ')).sort().join('\n');

setUp(options.skip, async () => {
    plant = await TinyPlant.create();
    first = new BareRoot(folder);
    port = await freePort();
    cpSync(plant.folder, first.path('root/plant'), { recursive: true });
    const made = ok(first.run(`plantcast init p1 --plant /root/plant --host localhost --port ${port}`));
    tokens = Object.fromEntries(made.trim().split('\n').map((line) => line.split(/ {2,}/)));
    ok(first.run(`openssl genpkey -algorithm ed25519 -out ${ETC}/signing.key; echo secret >/etc/plantcast/mail.password
        for f in ${ETC}/signing.key /etc/plantcast/mail.password; do chgrp plantcast $f; chmod 640 $f; done
        sed -i 's# --audit# --signing-key ${ETC}/signing.key --audit#' ${ETC}/options
        echo 'notify: { recipients: [{ id: ops, email: a@example.org }], mail: { server: "smtp://localhost:25", from: a@example.org, ` +
        `user: a, password_file: ../mail.password }, rules: [{ id: all, to: ops }] }' >>${ETC}/plant.yaml`));
    const rows = Array.from({ length: 400 }, (_, i) => `TI-1,${BEGIN_S + i * 60},${(50 + 40 * Math.sin(i / 9)).toFixed(3)}`);
    first.write('/root/series.csv', ['Tag,Time,Value', ...rows].join('\n'));
    ok(first.run(`install -d -o plantcast -g plantcast ${STATE}/history
        plantcast history import ${ETC}/plant.yaml /root/series.csv
        chown -R plantcast:plantcast ${STATE}/history`));
    const key = ok(first.run('age-keygen 2>/dev/null'));
    first.write('/root/key', key, 0o600);
    recipient = ok(first.run('age-keygen -y /root/key')).trim();
    await serve(first);
    picture = draw(first);
    assert.ok(picture.length > 2000);
});
after(async () => {
    await stop();
    await plant?.destroy();
});

test('backup refuses to run without a choice for the keys, or without an instance', options, () => {
    const none = first.run('plantcast backup p1');
    assert.deepEqual([none.code, /--recipient KEY or --passphrase.*--without-secrets/.test(none.err)], [1, true], none.err);
    assert.match(first.run('plantcast backup p2 --without-secrets').err, /p2\/plant\.yaml does not exist/);
    assert.match(first.run('plantcast backup p1 --recipient nonsense').err, /malformed recipient[^]*age could not encrypt keys and tokens/);
    assert.equal(first.run('plantcast backup p1 --colour').code, 2);
    assert.deepEqual(readdirSync(first.path('var/backups/plantcast/p1')), [], 'a failed backup leaves nothing');
});

test('a backup of a running daemon contains everything, and its keys only encrypted', options, () => {
    // runs the backup with only those capabilities that the systemd unit of the nightly backup grants
    const [, unit] = readFileSync('deploy/systemd/plantcast-backup@.service', 'utf8').match(/^CapabilityBoundingSet=(.*)$/m);
    const set = unit.split(' ').map((name) => name.replace('CAP_', '+').toLowerCase());
    const { code, err, out } = first.run(`setpriv --no-new-privs --bounding-set=-all,${set.join(',')} ` +
        `plantcast backup p1 --recipient ${recipient} --keep 2`);
    assert.equal(code, 0, err);
    assert.match(out, /verified: a trial restore/);
    const [name] = readdirSync(first.path('var/backups/plantcast/p1'));
    const made = first.path(`var/backups/plantcast/p1/${name}`);
    cpSync(made, join(folder, 'backup'), { recursive: true });
    assert.deepEqual(readdirSync(made).filter((file) => !/sqlite$/.test(file)).sort(),
        ['backup.json', 'etc.tar', 'plant.yaml', 'secrets.tar.age', 'state.tar', 'tags.csv']);
    const plain = spawnSync('grep', ['-rlE', 'PRIVATE KEY|^secret$', made], { encoding: 'utf8' }).stdout;
    assert.equal(plain, '', 'the backup contains no key in plain text');
    assert.equal(spawnSync('find', [made, '-perm', '/077'], { encoding: 'utf8' }).stdout, '');
});

test('commands find a service\'s history from the path of its plant file', options, () => {
    // the command gets the plant file as a relative path; the backup must contain the history all the same
    ok(first.run(`cd ${ETC} && plantcast backup plant.yaml -o /root/plain`));
    assert.ok(readdirSync(first.path('root/plain')).some((name) => /^history-.*sqlite$/.test(name)));
    for (const path of [`${ETC}/plant.yaml`, 'plant.yaml', '../p1/plant.yaml']) {
        const other = new BareRoot(folder);
        cpSync(first.path('root/plain'), other.path('root/plain'), { recursive: true });
        const out = ok(other.run(`mkdir -p ${ETC} ${STATE} && cd ${ETC} && plantcast restore /root/plain ${path}`));
        assert.match(out, /the history is in \/var\/lib\/plantcast\/p1\/history$/m, path);
    }
});

test('one restore command on a bare host gives the same server', options, async () => {
    const was = listing(first);
    await stop();
    rmSync(first.path('etc/plantcast'), { recursive: true });
    rmSync(first.path('var/lib/plantcast'), { recursive: true });
    const second = new BareRoot(folder);
    cpSync(join(folder, 'backup'), second.path('root/backup'), { recursive: true });
    second.write('/root/key', readFileSync(first.path('root/key')), 0o600);
    // adds another user first, so that the user plantcast gets a user ID here that differs from that of the first host
    second.run('useradd --system other');
    const { code, err, out } = second.run('plantcast restore /root/backup --identity /root/key');
    assert.equal(code, 0, err);
    assert.doesNotMatch(out, /missing/);
    assert.equal(listing(second), was);
    await serve(second);
    assert.ok(draw(second).equals(picture), 'the restored plant\'s picture is the same');
    ok(second.run(`plantcast audit verify ${STATE}/audit.log`));
    assert.match(readFileSync(second.path(`${STATE}/audit.log`), 'utf8'), /"event":"stop"|"event":"start"[^]*"event":"start"/);
    const again = second.run('plantcast restore /root/backup --identity /root/key');
    assert.deepEqual([again.code, /p1 exists already, so nothing was restored/.test(again.err)], [1, true], again.err);
});

test('a wrong key, a damaged file and a newer version are refused by name, and the restore leaves nothing behind', options, () => {
    const third = new BareRoot(folder), copy = (name) => cpSync(join(folder, 'backup'), third.path(`root/${name}`), { recursive: true });
    const refused = (name, why, more = '') => {
        const { code, err } = third.run(`plantcast restore /root/${name} ${more}`);
        assert.deepEqual([code, why.test(err)], [1, true], err);
        assert.equal(third.run('find /etc/plantcast /var/lib/plantcast -mindepth 1 2>/dev/null || true').out, '');
    };
    third.write('/root/key', readFileSync(first.path('root/key')), 0o600);
    ok(third.run('age-keygen -o /root/other 2>/dev/null'));
    copy('a');
    refused('a', /secrets\.tar\.age cannot be decrypted; nothing was restored/, '--identity /root/other');
    for (const name of ['state.tar', 'secrets.tar.age', 'tags.csv']) {
        copy(name);
        const bytes = readFileSync(third.path(`root/${name}/${name}`));
        bytes[bytes.length >> 1] ^= 1;
        writeFileSync(third.path(`root/${name}/${name}`), bytes);
        refused(name, new RegExp(`${name.replaceAll('.', '\\.')}: this file was changed or damaged`), '--identity /root/key');
    }
    copy('newer');
    const list = third.path('root/newer/backup.json'), text = readFileSync(list, 'utf8');
    writeFileSync(list, text.replace(/"plantcast": ".*"/, '"plantcast": "9.0.0"'));
    refused('newer', /made by Plantcast 9\.0\.0: install version 9\.0\.0 or later/, '--identity /root/key');
    writeFileSync(list, text.replace('"version": 1', '"version": 2'));
    refused('newer', /another version of Plantcast wrote it/);
    refused('nothing', /has no backup\.json/);
    third.write('/etc/plantcast/mail.password', 'of another plant');
    const taken = third.run('plantcast restore /root/a --identity /root/key');
    assert.deepEqual([taken.code, /mail\.password exists already and differs/.test(taken.err)], [1, true], taken.err);
    rmSync(third.path('etc/plantcast/mail.password'));
    const without = third.run('plantcast restore /root/a --without-secrets');
    assert.equal(without.code, 0, without.err);
    assert.match(without.out, /missing +\/etc\/plantcast\/p1\/tls\/fullchain\.pem\n[^]*missing +\/etc\/plantcast\/p1\/tokens/);
    const completed = third.run('plantcast init p1');
    assert.deepEqual([completed.code, /^engineer +pc_[^]*^viewer +pc_/m.test(completed.out)], [0, true], completed.err);
    const made = ok(third.run(`cd ${ETC} && stat -c '%n %U %G %a' tokens tls/* && ` +
        'openssl x509 -in tls/fullchain.pem -noout -ext subjectAltName'));
    assert.match(made, /tokens root plantcast 640\n[^]*ca\.key root root 600\n[^]*privkey\.pem root plantcast 640\n[^]*DNS:localhost/);
    assert.match(third.run('plantcast init p1').err, /exists already/);
});

test('models outside of the plant\'s folder are in a backup without secrets; other files there are not', options, () => {
    const host = new BareRoot(folder);
    cpSync(plant.folder, host.path('root/plant'), { recursive: true });
    ok(host.run(`plantcast init p1 --plant /root/plant --host localhost && mkdir -p ${STATE}/history '/srv/cad/Halle süd' /srv/linked
        cd /srv/cad && echo glb >'Halle süd/Kessel 1.glb' && echo bin >'Halle süd/teil 2.bin'
        echo png >tile.png && echo key >a.password
        echo '{"buffers": [{"uri": "teil%202.bin"}], "images": [{"uri": "../tile.png"}, {"uri": "data:image/png;base64,AA=="}]}' \\
            >'Halle süd/b.gltf'
        mkdir now && echo glb >v2.glb && ln -s ../v2.glb now/a.glb && ln -s now/a.glb newest.glb && ln -s now today
        ln -s /srv/cad/v2.glb /etc/plantcast/above.glb && echo glb >/srv/linked/c.glb && ln -s /srv/linked ${ETC}/linked
        mkdir /srv/live /srv/archive
        for file in fullchain privkey; do
            mv ${ETC}/tls/$file.pem /srv/archive/$file-1.pem
            ln -s ../archive/$file-1.pem /srv/live/$file.pem && ln -s /srv/live/$file.pem ${ETC}/tls/$file.pem
        done
        echo 'MODELS="/srv/cad/newest.glb /srv/cad/today/a.glb ../above.glb /srv/cad/a.password"' >>${ETC}/options
        echo "  x: { model: /srv/cad/Halle süd/Kessel 1.glb, y: 1 }
          model: /srv/cad/Halle süd/b.gltf  # comment
          from: /srv/step/LINE.STP
          from: /srv/packed/line.stp.gz" >>${ETC}/options
        mkdir -p '/srv/sub/a b/deep' /srv/plain /srv/flow && cd /srv && touch 'sub/a b/x.bin' 'sub/a b/deep/y.mtl' plain/p.bin flow/f.bin
        touch 'sub/a b/x.png'
        sed -i '/^assets:/i convert:\\
          - { model: a.glb, from: a.asm, also: "../../../srv/sub/a b/{*.bin,*/*.mtl}", command: "true" }\\
          - { model: b.glb, from: a.asm, also: /srv/flow/f.*, command: "true" } # comment\\
          - model: c.glb\\
            from: a.asm\\
            also: /srv/plain/{p,q}.bin # comment\\
            command: "true"' ${ETC}/plant.yaml
        mkdir /srv/step /srv/packed && cd /srv/step && echo step >LINE.STP && echo step >'Bolt 1.Step' && echo key >line.key
        cd /srv/packed && echo packed >line.stp.gz && echo step >nut.stp
        mkdir /srv/lib /srv/shared && echo step >/srv/lib/pin.stp && ln -s /srv/lib/pin.stp /srv/step/pin.stp
        echo bin >/srv/shared/tank.bin
        echo '{"buffers": [{"uri": "../../../srv/shared/tank.bin"}]}' >${ETC}/MODEL.GLTF`));
    ok(host.run('plantcast backup p1 --without-secrets -o /root/b'));
    const names = ok(host.run('tar --quoting-style=literal -tf /root/b/etc.tar')).split('\n');
    for (const name of ['Halle süd/Kessel 1.glb', 'Halle süd/b.gltf', 'Halle süd/teil 2.bin', 'tile.png', 'newest.glb', 'v2.glb'])
        assert.ok(names.includes(`srv/cad/${name}`), `${name} is not in ${names.join(', ')}`);
    for (const name of ['step/LINE.STP', 'step/Bolt 1.Step', 'packed/line.stp.gz', 'packed/nut.stp', 'step/pin.stp', 'lib/pin.stp',
        'shared/tank.bin', 'sub/a b/x.bin', 'sub/a b/deep/y.mtl', 'flow/f.bin', 'plain/p.bin'])
        assert.ok(names.includes(`srv/${name}`), `${name} is not in ${names.join(', ')}`);
    assert.ok(!names.includes('srv/step/line.key') && !names.includes('srv/sub/a b/x.png'));
    assert.ok(names.includes('srv/linked/c.glb') && !names.some((name) => /password|tokens|\.pem/.test(name)), names.join(', '));
    ok(host.run(`plantcast backup p1 --recipient ${recipient} -o /root/c; rm -r /etc/plantcast /var/lib/plantcast /srv/*`));
    const out = ok(host.run('plantcast restore /root/b'));
    assert.match(out, /systemctl enable --now plantcastd@p1 plantcast-backup@p1\.timer/);
    assert.equal(ok(host.run(`cat '/srv/cad/Halle süd/teil 2.bin' /srv/cad/newest.glb /srv/cad/today/a.glb /etc/plantcast/above.glb ` +
        `${ETC}/linked/c.glb`)), 'bin\nglb\nglb\nglb\nglb\n');
    assert.match(ok(host.run('plantcast init p1')), /^engineer +pc_/m, 'links to the lost certificate are not in the way');
    ok(host.run('rm -r /etc/plantcast /var/lib/plantcast /srv/*'));
    host.write('/root/key', readFileSync(first.path('root/key')), 0o600);
    ok(host.run('plantcast restore /root/c --identity /root/key'));
    assert.match(ok(host.run(`readlink /srv/live/privkey.pem && cat ${ETC}/tls/privkey.pem`)), /^\.\.\/archive[^]*PRIVATE KEY/);
});

test('backup and restore work with a passphrase typed at age\'s prompt, and a wrong one restores nothing',
    { ...options, skip: options.skip || (has('script') ? false : 'no script') }, () => {
    const host = new BareRoot(folder);
    cpSync(plant.folder, host.path('root/plant'), { recursive: true });
    ok(host.run('plantcast init p1 --plant /root/plant --host localhost'));
    const typed = (command, ...lines) => host.run(`(for line in ${lines.join(' ')}; do sleep 1; echo "$line"; done; sleep 1) | ` +
        `script -qec '${command}' /dev/null`);
    ok(typed('plantcast backup p1 --passphrase -o /root/b', 'correct-horse', 'correct-horse'));
    ok(host.run('rm -r /etc/plantcast /var/lib/plantcast'));
    const wrong = typed('plantcast restore /root/b', 'wrong-horse');
    assert.deepEqual([wrong.code, /incorrect passphrase[^]*nothing was restored/.test(wrong.out)], [1, true], wrong.out);
    ok(typed('plantcast restore /root/b', 'correct-horse'));
    assert.match(readFileSync(host.path(`${ETC}/tls/privkey.pem`), 'utf8'), /PRIVATE KEY/);
});

test('a backup is sent to another host by SFTP, and restored from there',
    { ...options, skip: options.skip || (existsSync(SSHD) ? false : 'no sshd') }, async (t) => {
        const host = new BareRoot(folder), sshPort = await freePort(), dropPort = await freePort(), kept = join(folder, 'kept');
        const mine = `p1@${hostname()}-`;
        mkdirSync(kept);
        mkdirSync('/run/sshd', { recursive: true });
        for (const [name, path] of [['host', join(folder, 'host-key')], ['user', host.path('root/.ssh/id_ed25519')]])
            ok({ code: spawnSync('ssh-keygen', ['-q', '-t', 'ed25519', '-N', '', '-f', path]).status, err: name });
        cpSync(host.path('root/.ssh/id_ed25519.pub'), join(folder, 'authorized'));
        host.write('/root/.ssh/config', 'Host *\n  StrictHostKeyChecking no\n  UserKnownHostsFile /dev/null\n', 0o600);
        writeFileSync(join(folder, 'sshd'), [`Port ${sshPort}`, `Port ${dropPort}`, 'ListenAddress 127.0.0.1',
            `HostKey ${join(folder, 'host-key')}`, 'StrictModes no', 'PidFile none',
            `AuthorizedKeysFile ${join(folder, 'authorized')}`,
            'PermitRootLogin yes', 'UsePAM no',
            'Subsystem sftp internal-sftp', `Match LocalPort ${dropPort}`,
            'ForceCommand internal-sftp -P opendir,remove,rmdir', ''].join('\n'));
        const sshd = spawn(SSHD, ['-D', '-f', join(folder, 'sshd')], { stdio: 'inherit' });
        t.after(() => sshd.kill());
        cpSync(plant.folder, host.path('root/plant'), { recursive: true });
        ok(host.run('plantcast init p1 --plant /root/plant --host localhost'));
        const there = `sftp://root@127.0.0.1:${sshPort}${kept}`;
        host.write('/usr-hook', '#!/bin/sh\necho "$1" >/root/hooked\n', 0o755);
        const listens = `for i in $(seq 100); do sftp -q -b /dev/null sftp://root@127.0.0.1:${sshPort} 2>/dev/null && break; ` +
            'sleep 0.1; done';
        ok(host.run(`${listens}; plantcast backup p1 --recipient ${recipient} --to ${there} --hook /usr-hook -o /root/b`));
        assert.equal(readFileSync(host.path('root/hooked'), 'utf8'), '/root/b\n');
        assert.deepEqual(readdirSync(kept), [`${mine}b`]);
        ok(host.run('rm -r /etc/plantcast /var/lib/plantcast /root/b'));
        host.write('/root/key', readFileSync(first.path('root/key')), 0o600);
        ok(host.run(`plantcast restore ${there}/${mine}b --identity /root/key`));
        assert.match(readFileSync(host.path(`${ETC}/tls/privkey.pem`), 'utf8'), /PRIVATE KEY/);
        // --keep also deletes older copies there: complete and interrupted ones of this plant and host, nothing else
        const stay = [`${mine}2026-notes`, `${mine}20-2026-01-01T000000Z`, `p1-20@${hostname()}-2026-01-01T000000Z`,
            'p1@other-2026-01-01T000000Z', 'p1-2026-01-01T000000Z', 'p1-20-2026-01-01T000000Z', 'p2-2026-01-01T000000Z'];
        for (const name of [`${mine}2026-01-01T000000Z`, `${mine}2026-01-02T000000Z.part`, ...stay]) {
            mkdirSync(join(kept, name));
            writeFileSync(join(kept, name, 'a file'), '');
        }
        const pruned = host.run(`plantcast backup p1 --without-secrets --to ${there} --keep 1`);
        assert.equal(pruned.code, 0, pruned.err);
        const [newest] = readdirSync(host.path('var/backups/plantcast/p1'));
        assert.deepEqual(readdirSync(kept).sort(), [mine + newest, `${mine}b`, ...stay].sort());
        mkdirSync(join(kept, `${mine}2026-01-01T000000Z/folder`), { recursive: true }); // a folder, which `rm` does not delete
        const kept2 = host.run(`plantcast backup p1 --without-secrets --to ${there} --keep 2`);
        assert.deepEqual([kept2.code, /older backups were not deleted there/.test(kept2.err)], [0, true], kept2.err);
        assert.ok(readdirSync(kept).includes(`${mine}2026-01-01T000000Z.part`), 'the partly deleted copy is named as incomplete');
        // a store that permits neither listing nor deletion
        const drop = there.replace(sshPort, dropPort);
        const dropped = host.run(`plantcast backup p1 --without-secrets --to ${drop} --keep 2 -o /root/d`);
        assert.deepEqual([dropped.code, /older backups were not deleted there/.test(dropped.err)], [0, true], dropped.err);
        assert.ok(readdirSync(kept).includes(`${mine}d`), dropped.err);
        // a failed copy or hook: the metrics keep the time of the last good backup, and old backups are deleted all the same
        const stamp = () => statSync(host.path(`${STATE}/history/last-backup`)).mtimeMs, good = stamp();
        const local = () => readdirSync(host.path('var/backups/plantcast/p1')).sort();
        const gone = host.path('var/backups/plantcast/p1/2026-01-01T000000Z');
        mkdirSync(gone);
        const away = host.run(`plantcast backup p1 --without-secrets --to sftp://root@127.0.0.1:${sshPort}/proc/nothing --keep 1`);
        assert.deepEqual([away.code, /was not copied; it is in \/var/.test(away.err)], [1, true], away.err);
        assert.deepEqual([stamp(), existsSync(gone), local().length], [good, false, 1]);
        const hooked = host.run('plantcast backup p1 --without-secrets --hook /bin/false -o /root/e');
        assert.deepEqual([hooked.code, stamp()], [1, good], hooked.err);
        ok(host.run('plantcast backup p1 --without-secrets -o /root/f'));
        assert.ok(stamp() > good);
    });
