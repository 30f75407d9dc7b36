// SPDX-License-Identifier: GPL-3.0-or-later
// A first run: `plantcast init` creates everything that a service instance needs, and the daemon starts with it; certbot's hook
// installs a renewed certificate; a build without the page's charts fails.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, readdirSync, readFileSync, rmdirSync, renameSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';
import { test } from 'node:test';
import { folderOfTests } from './support/folders.mjs';
import { setUp } from './support/set_up.mjs';
import { BIN, missing, Program, runProgram, TinyPlant } from './support/tiny_plant.mjs';
import { freePort } from './support/ports.mjs';
import { sweep } from './support/sweep.mjs';
import { becomes, until } from './support/until.mjs';

const absent = missing();
if (!existsSync(join(BIN, 'plantcast-init')))
    absent.push('plantcast-init');
const skip = absent.length > 0 ? `not built: ${absent.join(', ')}` : false;
const root = folderOfTests();
let plant;

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
});
const init = (...args) => runProgram('plantcast', ['init', ...args, '--root', root]);
const etc = (...names) => join(root, 'etc/plantcast', ...names), mode = (path) => (statSync(path).mode & 0o777).toString(8);

const UP = /^plantcast_source_up\{[^}]*\} 1$/m;

test('plantcast init makes folders, plant file, certificate and tokens, and the daemon serves with them',
    { skip, timeout: 100000 }, async () => {
    const port = await freePort();
    const { code, out, err } = init('one', '--plant', plant.folder, '--host', 'localhost', '--port', String(port));
    assert.equal(code, 0, err);
    const said = Object.fromEntries(out.trim().split('\n').map((line) => line.split(/ {2,}/)));
    assert.equal(said.address, `https://localhost:${port}/`);
    assert.deepEqual([mode(etc('one')), mode(etc('one/tokens')), mode(etc('one/tls/privkey.pem'))], ['750', '640', '640']);
    assert.ok(existsSync(join(root, 'var/lib/plantcast/one/tags.csv')) && !existsSync(etc('one/tags.csv')));
    // a folder of prepared files without a manifest, as while plantcast-prep runs for the first time
    mkdirSync(etc('one/plant.prepared'));
    const check = runProgram('plantcastd', ['--check', etc('one/plant.yaml')]);
    assert.deepEqual([check.code, /not prepared yet/.test(check.out)], [0, true], check.err);
    rmdirSync(etc('one/plant.prepared'));
    const prepared = join(root, 'prepared');
    assert.equal(runProgram('plantcast-prep', ['-o', prepared, etc('one/plant.yaml')]).code, 0);
    const [, options] = readFileSync(etc('one/options'), 'utf8').match(/^PLANTCAST_OPTIONS="(.*)"$/m);
    const daemon = spawn(join(BIN, 'plantcastd'), [etc('one/plant.yaml'), '--prepared', prepared, ...options.split(' ')],
        { stdio: 'pipe' });
    try {
        await new Promise((done, fail) => {
            daemon.stdout.once('data', done);
            daemon.once('exit', () => fail(new Error('it ended')));
        });
        const ask = (token) => spawnSync('curl', ['-s', '-o', '/dev/null', '-w', '%{http_code}', '--cacert', etc('one/tls/fullchain.pem'),
            '-H', `Authorization: Bearer ${token}`, `${said.address}api/v1/tags`], { encoding: 'utf8' }).stdout;
        assert.deepEqual([ask(said.engineer), ask(said.viewer), ask('x'.repeat(43))], ['200', '200', '401']);
    } finally {
        const ended = new Promise((done) => daemon.removeAllListeners('exit').once('exit', done));
        daemon.kill();
        await ended;
    }
    const { code: whole, err: why } = runProgram('plantcast', ['audit', 'verify', join(root, 'var/lib/plantcast/one/audit.log')]);
    assert.equal(whole, 0, why);
});

test('plantcast init changes no existing file, and gives the next plant another port', { skip }, () => {
    const options = readFileSync(etc('one/options'), 'utf8');
    const again = init('one', '--plant', plant.folder);
    assert.equal(again.code, 1);
    assert.match(again.err, /exists already/);
    assert.equal(readFileSync(etc('one/options'), 'utf8'), options);
    for (const [name, port] of [['two', 8443], ['three', 8444]]) {
        const { out, err } = init(name, '--plant', plant.folder, '--host', 'plant.example');
        assert.match(out, new RegExp(`https://plant.example:${port}/`), err);
    }
    for (const wrong of [['../x'], [], ['a', 'b'], ['four', '--plant', root], ['four', '--host', 'a b', '--plant', plant.folder]])
        assert.notEqual(init(...wrong).code, 0, wrong.join(' '));
    assert.match(init('four', '--port', '8444', '--plant', plant.folder).err, /another plant uses port 8444: .*three\/options/);
    assert.ok(!existsSync(etc('four')));
});

test('plantcast init replaces a missing certificate, and keeps the key and the authority that are there', { skip }, () => {
    const tls = (name) => readFileSync(etc('two/tls', name), 'utf8'), names = ['ca.key', 'ca.pem', 'privkey.pem'];
    const before = names.map(tls), fullchain = tls('fullchain.pem'), tokens = readFileSync(etc('two/tokens'), 'utf8');
    rmSync(etc('two/tls/fullchain.pem'));
    assert.match(init('two', '--host', 'other.example').err, /the authority in .*two\/tls cannot sign a certificate for other\.example/);
    assert.ok(!existsSync(etc('two/tls/fullchain.pem')));
    for (const name of ['ca.key', 'ca.pem']) {
        renameSync(etc('two/tls', name), etc('two/tls', `${name}.safe`));
        assert.match(init('two').err, new RegExp(`two/tls/${name} is missing: put it back`));
        renameSync(etc('two/tls', `${name}.safe`), etc('two/tls', name));
    }
    const { code, err } = init('two');
    assert.equal(code, 0, err);
    assert.deepEqual([names.map(tls), readFileSync(etc('two/tokens'), 'utf8')], [before, tokens]);
    assert.notEqual(tls('fullchain.pem'), fullchain);
    assert.equal(spawnSync('openssl', ['verify', '-CAfile', etc('two/tls/ca.pem'), etc('two/tls/fullchain.pem')]).status, 0);
    const openssl = (...args) => spawnSync('openssl', args, { encoding: 'utf8' }).stdout;
    assert.equal(openssl('x509', '-in', etc('two/tls/fullchain.pem'), '-noout', '-pubkey'),
        openssl('pkey', '-in', etc('two/tls/privkey.pem'), '-pubout'), 'the certificate is for the key that stays');
    for (const name of ['privkey.pem', 'fullchain.pem'])
        rmSync(etc('two/tls', name));
    rmSync(etc('two/tokens'));
    assert.equal(init('two').code, 0);
    assert.deepEqual([mode(etc('two/tls/privkey.pem')), mode(etc('two/tokens')), tls('ca.pem')], ['640', '640', before[1]]);
    assert.deepEqual(readdirSync(etc()).sort(), ['one', 'three', 'two'], 'no temporary folder stays');
});

test('a certificate renewed by certbot is copied to the plants that name it', { skip }, () => {
    const lineage = join(root, 'live/plant.example');
    mkdirSync(lineage, { recursive: true });
    for (const part of ['fullchain', 'privkey'])
        writeFileSync(join(lineage, `${part}.pem`), `new ${part}`, { mode: 0o600 });
    writeFileSync(etc('two/certbot'), 'plant.example\n');
    writeFileSync(etc('three/certbot'), 'other.example\n');
    const { status, stderr } = spawnSync('deploy/systemd/certbot-hook', [],
        { encoding: 'utf8', env: { ...process.env, PLANTCAST_ETC: etc(), RENEWED_LINEAGE: lineage } });
    assert.equal(status, 0, stderr);
    assert.equal(readFileSync(etc('two/tls/privkey.pem'), 'utf8'), 'new privkey');
    assert.equal(mode(etc('two/tls/privkey.pem')), '640');
    assert.match(readFileSync(etc('three/tls/privkey.pem'), 'utf8'), /BEGIN PRIVATE KEY/);
});

test('an own certificate is renewed before it expires, clients that trust the old one accept it; other certificates stay', { skip }, () => {
    const tls = (name) => etc('two/tls', name), openssl = (...args) => {
        const { status, stdout, stderr } = spawnSync('openssl', args, { encoding: 'utf8' });
        return { status, stdout, stderr };
    };
    const renew = () => {
        const { status, stdout, stderr } = spawnSync('deploy/systemd/renew-certificate', ['two'],
            { encoding: 'utf8', env: { ...process.env, PLANTCAST_ETC: etc() } });
        assert.equal(status, 0, stderr);
        return stdout;
    };
    const expiresSoon = () => openssl('x509', '-in', tls('fullchain.pem'), '-noout', '-checkend', String(360 * 86400)).status === 1;
    const names = () => openssl('x509', '-in', tls('fullchain.pem'), '-noout', '-ext', 'subjectAltName,basicConstraints').stdout;
    rmSync(etc('two'), { recursive: true });
    rmSync(join(root, 'var/lib/plantcast/two'), { recursive: true });
    assert.equal(init('two', '--plant', plant.folder, '--host', 'plant.example').code, 0);
    assert.deepEqual([mode(tls('ca.key')), mode(tls('privkey.pem')), mode(tls('ca.pem'))], ['600', '640', '640']);
    assert.equal(renew(), '');
    // replaces the certificate with one for the same names and key that expires in 20 days
    const copy = ['-copy_extensions', 'copy'], byAuthority = (days) => openssl('x509', '-req', '-in', tls('csr'), ...copy,
        '-CA', tls('ca.pem'), '-CAkey', tls('ca.key'), '-days', days, '-out', tls('leaf.pem'));
    openssl('x509', '-in', tls('fullchain.pem'), '-x509toreq', ...copy, '-signkey', tls('privkey.pem'), '-out', tls('csr'));
    byAuthority('20');
    writeFileSync(tls('fullchain.pem'), readFileSync(tls('leaf.pem'), 'utf8') + readFileSync(tls('ca.pem'), 'utf8'));
    cpSync(tls('fullchain.pem'), tls('old.pem'));
    const was = names(), others = readdirSync(etc('two/tls')).sort();
    assert.match(was, /CA:FALSE[^]*DNS:plant\.example, DNS:localhost, IP Address:127\.0\.0\.1/);
    assert.ok(expiresSoon());
    assert.match(renew(), /fullchain\.pem: renewed until .*: programs that trust/);
    assert.ok(!expiresSoon());
    assert.deepEqual([names(), readdirSync(etc('two/tls')).sort(), mode(tls('fullchain.pem'))], [was, others, '640']);
    const trusted = openssl('verify', '-CAfile', tls('old.pem'), '-verify_hostname', 'plant.example', tls('fullchain.pem'));
    assert.equal(trusted.status, 0, trusted.stderr);
    assert.equal(openssl('x509', '-in', tls('fullchain.pem'), '-noout', '-pubkey').stdout,
        openssl('pkey', '-in', tls('privkey.pem'), '-pubout').stdout);
    assert.equal(renew(), '');
    // The authority made by init may sign only for this plant's host names: a certificate for bank.example that it signs must
    // be invalid.
    openssl('req', '-new', '-key', tls('privkey.pem'), '-subj', '/CN=bank.example', '-addext', 'subjectAltName=DNS:bank.example',
        '-out', tls('csr'));
    byAuthority('3');
    assert.match(openssl('verify', '-CAfile', tls('ca.pem'), tls('leaf.pem')).stderr, /permitted subtree violation/);
    // replaces the certificate, first with a self-signed one, as older versions of init made, and later with one of another
    // authority
    openssl('req', '-x509', '-key', tls('privkey.pem'), '-days', '20', '-out', tls('fullchain.pem'), '-subj', '/CN=plant.example',
        '-addext', 'subjectAltName=DNS:plant.example');
    assert.match(renew(), /: copy it to browsers/);
    assert.ok(!expiresSoon());
    openssl('x509', '-req', '-in', tls('csr'), '-CA', tls('fullchain.pem'), '-CAkey', tls('privkey.pem'), '-days', '3',
        '-out', tls('leaf.pem'));
    cpSync(tls('leaf.pem'), tls('fullchain.pem'));
    assert.equal(renew(), '');
    assert.ok(expiresSoon());
});

// A plant whose PLC is simulated by `make run`.
async function simulatedPlant() {
    const own = await TinyPlant.create();
    const block = `  - id: plc1\n    type: modbus\n    host: 127.0.0.1\n    port: ${own.modbusPort}\n    poll_ms: 100\n` +
        '    byte_order: ABCD\n    address_base: 1\n    simulated: yes\n';
    writeFileSync(own.file, readFileSync(own.file, 'utf8').replace(/^ *- \{ id: plc1, .*\n/m, block));
    return own;
}

test('a second `make run` on a machine takes another port, and both plants get values', { skip, timeout: 200000 }, async (t) => {
    const own = await simulatedPlant(), runs = [], yaml = readFileSync(own.file, 'utf8');
    t.after(async () => {
        for (const run of runs)
            await run.stop();
        await own.destroy();
    });
    const ports = [await freePort(), await freePort()];
    for (const port of ports) {
        runs.push(new Program('', [own.file, String(port)], {}, ['deploy/run']));
        await runs.at(-1).line(/^plantcast: ready /m);
    }
    assert.match(runs[1].said, new RegExp(`port ${own.modbusPort} is taken; the simulated PLC has \\d+`));
    assert.doesNotMatch(runs[0].said, /is taken/);
    assert.equal(readFileSync(own.file, 'utf8'), yaml);
    for (const port of ports)
        await until(`values at ${port}`, async () => UP.test(await (await fetch(`http://127.0.0.1:${port}/metrics`)).text()));
    for (const run of runs)
        assert.deepEqual(await run.stop(), { code: 0, signal: null }, run.said);
});

// `make run` builds and runs the release configuration.
const OUT = resolve(process.env.PLANTCAST_OUT ?? 'build/release');
const notReleased = OUT === join(BIN, 'release') ? false : 'not the release build';

// Returns the names of the running plantcast programs that have this plant file among their arguments.
const processesOf = (file) => readdirSync('/proc').filter((pid) => /^\d+$/.test(pid)).map((pid) => {
    try {
        return readFileSync(`/proc/${pid}/cmdline`, 'utf8').split('\0');
    } catch {
        return [];
    }
}).filter(([program, ...args]) => /plantcast/.test(program) && args.includes(file)).map(([program]) => basename(program));

const ENDINGS = [['kill of make alone', (make) => make.kill('SIGTERM')], ['kill -9 of make alone', (make) => make.kill('SIGKILL')],
    ['Ctrl-C', (make) => process.kill(-make.pid, 'SIGINT')], ['a closed terminal', (make) => process.kill(-make.pid, 'SIGHUP')]];
for (const [how, end] of sweep(ENDINGS, [ENDINGS[1], ENDINGS[2]]))
    test(`the simulator and the daemon of \`make run\` end by ${how}`, { skip: skip || notReleased, timeout: 200000 }, async (t) => {
        const own = await simulatedPlant(), port = await freePort(), stamp = statSync(join(OUT, 'codecs')).mtimeMs;
        t.after(() => own.destroy());
        const make = spawn('make', ['run', `build=${BIN}`, `PLANT=${own.file}`, `PORT=${port}`], { detached: true });
        t.after(() => {
            try {
                // kills a `make run` that the test did not end, because its open outputs would keep this test program waiting
                process.kill(-make.pid, 'SIGKILL');
            } catch {
                // it has ended
            }
        });
        let said = '';
        await new Promise((ready, failed) => {
            make.stdout.on('data', (text) => /^plantcast: ready .*\n$/m.test(said += text) && ready());
            make.once('exit', () => failed(new Error(said)));
        });
        assert.ok(said.trim().split('\n').length < 20, said);
        assert.match(said.trim().split('\n').at(-1), new RegExp(`^plantcast: ready http://127.0.0.1:${port}/$`));
        assert.equal(statSync(join(OUT, 'codecs')).mtimeMs, stamp, 'the next make compiles everything again');
        // waits, because a program that is just starting another one appears twice between fork and exec
        await becomes(() => processesOf(own.file).sort(), ['plantcast-sim', 'plantcastd']);
        make.removeAllListeners('exit');
        end(make);
        while (processesOf(own.file).length > 0)
            await new Promise((done) => setTimeout(done, 50));
    });

test('without npm or a network, the build fails instead of making a page without charts', () => {
    const tree = join(root, 'tree'), bin = join(root, 'bin');
    mkdirSync(join(tree, 'clients/web'), { recursive: true });
    mkdirSync(join(tree, 'deploy'));
    mkdirSync(bin);
    cpSync('deploy/vendor', join(tree, 'deploy/vendor'));
    for (const name of ['package.json', 'package-lock.json'])
        cpSync(join('clients/web', name), join(tree, 'clients/web', name));
    const run = (PATH) => spawnSync('/bin/sh', [join(tree, 'deploy/vendor'), join(root, 'scratch')], { encoding: 'utf8', env: { PATH } });
    const without = run(bin);
    assert.notEqual(without.status, 0);
    writeFileSync(join(bin, 'npm'), '#!/bin/sh\nexit 1\n', { mode: 0o755 });
    const offline = run(`${bin}:/usr/bin:/bin`);
    assert.notEqual(offline.status, 0);
    assert.match(offline.stderr, /could not download uPlot/);
});

test('a package that this Debian lacks is skipped if optional, and is an error if required', () => {
    const tree = join(root, 'deps'), bin = join(root, 'deps-bin'), packages = join(tree, 'deploy/packages');
    mkdirSync(packages, { recursive: true });
    mkdirSync(bin);
    cpSync('deploy/deps', join(tree, 'deploy/deps'));
    const program = (name, script) => writeFileSync(join(bin, name), `#!/bin/sh\n${script}\n`, { mode: 0o755 });
    program('dpkg-query', 'exit 1'); // a fake dpkg-query that reports no package as installed
    program('apt-cache', 'case $2 in known*) echo "  Candidate: 1.0" ;; none*) echo "  Candidate: (none)" ;; esac');
    program('apt-get', `[ $1 = update ] || echo "$@" >>${root}/installed; case "$*" in *" none"*) exit 100 ;; esac`);
    program('id', 'echo 0');
    const deps = (...lines) => {
        writeFileSync(join(packages, 'build'), lines.join('\n'));
        rmSync(join(root, 'installed'), { force: true });
        const { status, stderr } = spawnSync(join(tree, 'deploy/deps'), ['build'],
            { encoding: 'utf8', env: { PATH: `${bin}:/usr/bin:/bin` } });
        return { status, stderr, installed: existsSync(join(root, 'installed')) ? readFileSync(join(root, 'installed'), 'utf8') : '' };
    };
    const some = deps('known1', 'known2? # a comment', 'none3?', 'unheard4?');
    assert.equal(some.status, 0, some.stderr);
    assert.match(some.installed, /known1 known2$/m);
    assert.deepEqual(deps('none3?', 'unheard4?'), { status: 0, stderr: '', installed: '' });
    assert.match(deps('known2?').installed, /known2$/m);
    assert.equal(deps('none3').status, 1);
});
