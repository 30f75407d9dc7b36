// SPDX-License-Identifier: GPL-3.0-or-later
// `plantcast match`: compares matches of generated tag lists for real plants with the true equipment. Also tests malformed
// lists, manual changes followed by a second run, and all steps from a CAD export to a picture.
import { DATA, inFolder } from './support/folders.mjs';
import { boxesFile } from './support/gltf_model.mjs';
import { seed, sweep } from './support/sweep.mjs';
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { chmodSync, copyFileSync, cpSync, existsSync, lstatSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync, statSync,
    symlinkSync, utimesSync, watch, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { formats, makeTagList } from './support/tag_lists.mjs';
import { promise } from './support/promise.mjs';
import { BIN, missing, Program, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const absent = missing();
const notBuilt = absent.length > 0 ? `not built: ${absent.join(', ')}` : false;
const noData = notBuilt || (existsSync(join(DATA, 'cad')) ? false : 'no ../shared/data/cad');
const run = (program, ...args) => spawnSync(join(BIN, program), args, { encoding: 'utf8', timeout: 300000 });
const good = (said) => (assert.equal(said.status, 0, said.stderr), said);

const cells = (line) => [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map((m) => (m[1] ?? m[2]).replaceAll('""', '"'));
function table(path) {
    const [header, ...rows] = readFileSync(path, 'utf8').trim().split('\n').map(cells);
    return rows.map((row) => Object.fromEntries(header.map((name, i) => [name, row[i] ?? ''])));
}
const assetsOf = (plant) =>
    [...readFileSync(join(plant, 'plant.yaml'), 'utf8').matchAll(/\{ id: "((?:[^"\\]|\\.)+)"/g)].map(([, id]) => id);

// Makes a plant of boxes with these names, without a CAD system.
function boxPlant(folder, names) {
    writeFileSync(join(folder, 'model.gltf'), boxesFile(names, 1, 50));
    writeFileSync(join(folder, 'plant.yaml'), `plant: { name: Boxes }\n\nassets:\n  - { id: all, model: model.gltf }\n\n` +
        'groups:\n  - { id: temperature, quantity: Temperature, unit: °C, min: 0, max: 100 }\n\ntags: tags.csv\n');
    writeFileSync(join(folder, 'tags.csv'), 'Tag Name,Address\n');
}

function count(plant, truth) {
    const counts = { sure: [0, 0], likely: [0, 0], none: [0, 0] };
    let wrong = '';
    for (const { Tag, Status, Asset, Reason } of table(join(plant, 'matches.csv'))) {
        const want = truth.get(Tag.replace(/\s+/g, ' '));
        assert.notEqual(want, undefined, `the truth does not contain the tag ${Tag}`);
        const right = Status === 'none' ? want === null : Asset === want;
        counts[Status][right ? 0 : 1]++;
        if (Status === 'sure' && !right)
            wrong += `\n#   ${Tag}: ${Asset} (${Reason}), in truth ${want}`;
    }
    const own = [...truth.values()].filter((asset) => asset !== null).length, [right, not] = counts.sure;
    return { counts, wrong, own, precision: right / (right + not), recall: right / own };
}

// Each real plant is imported and matched with 5,000 generated tags; the numbers of right and wrong matches are compared with
// limits. By default only the first is.
for (const { plant, format, bring } of [
    { plant: 'plm-sample', format: 'kepware', bring: (out) => run('plantcast', 'import', join(DATA, 'cad/plm-sample.rvm'), '-o', out) },
    { plant: 'huldra_WD1-PSUP', format: 'intouch',
        bring: (out) => run('plantcast', 'import', join(DATA, 'cad/huldra_WD1-PSUP.rvm'), '-o', out) },
    { plant: 'duplex_mep', format: 'honeywell', equipment: ['M_*:*'], bring: (out) => {
        spawnSync('mkdir', ['-p', out]);
        copyFileSync(join(DATA, 'models/duplex_mep.glb'), join(out, 'duplex_mep.glb'));
        writeFileSync(join(out, 'plant.yaml'), 'plant: { name: Duplex }\nassets:\n- { id: all, model: duplex_mep.glb }\ngroups:\n' +
            '- { id: temperature, unit: °C, min: 0, max: 100 }\ntags: tags.csv\n');
        writeFileSync(join(out, 'tags.csv'), 'Tag Name,Address\n');
        writeFileSync(join(out, 'none.csv'), 'Tag Name\nnothing\n');
        const choice = ['M_*Boiler*', 'M_*Pump*', 'M_Radiator*', 'M_*Fan*', 'M_*Valve*', 'M_Backflow*', 'M_Water Closet*', 'M_Lavatory*',
            'M_Thermostat*', 'M_*Tub*', 'M_Sink*', 'M_Range*', 'M_Refrigerator*'].flatMap((pattern) => ['--equipment', pattern]);
        return run('plantcast', 'match', out, join(out, 'none.csv'), ...choice);
    } },
].slice(0, sweep(3, 1)))
    test(`${plant}: enough of 5,000 tags generated from its names are matched correctly`, { skip: noData }, () => inFolder((folder) => {
        const out = join(folder, 'plant'), list = join(folder, 'export');
        good(bring(out));
        rmSync(join(out, 'matches.csv'), { force: true });
        writeFileSync(join(out, 'tags.csv'), 'Tag Name,Address\n');
        const equipment = assetsOf(out), { rows, truth } = makeTagList(equipment, { seed });
        writeFileSync(list, formats[format](rows));
        const before = Date.now(), said = good(run('plantcast', 'match', out, list)), ms = Date.now() - before;
        const { counts, wrong, own, precision, recall } = count(out, truth);
        console.log(`# ${plant}, seed ${seed}: ${equipment.length} assets, ${truth.size} tags (${own} of this plant) in ${ms} ms`);
        for (const [status, [right, not]] of Object.entries(counts))
            console.log(`#   ${status}: ${right} right, ${not} ${status === 'none' ? 'missed' : 'wrong'}`);
        console.log(`#   precision ${(100 * precision).toFixed(2)} %, recall ${(100 * recall).toFixed(2)} %${wrong}`);
        assert.ok(precision >= 0.995, 'precision is below 99.5 %');
        assert.ok(recall >= 0.9, 'recall is below 90 %');
        assert.match(said.stdout, /ignored \d+ duplicate rows/);
        good(run('plantcastd', '--check', join(out, 'plant.yaml')));
    }));

test('matching 5,000 tags to 2,000 assets takes no more than 2 minutes', { skip: notBuilt }, (t) => inFolder((folder) => {
    const names = Array.from({ length: 2000 }, (_, i) => `${'PEVKC'[i % 5]}-${10 + i % 40}${100 + Math.floor(i / 5)}`);
    boxPlant(folder, names);
    const list = join(folder, 'export'), { rows, truth } = makeTagList(names, { seed, foreign: 0.05 });
    writeFileSync(list, formats.ignition(rows));
    const before = Date.now(), said = good(run('plantcast', 'match', folder, list, '--equipment', 'level=2')), ms = Date.now() - before;
    const { precision, recall } = count(folder, truth);
    console.log(`# ${ms} ms; precision ${(100 * precision).toFixed(2)} %, recall ${(100 * recall).toFixed(2)} %`);
    assert.match(said.stdout, /2000 nodes selected as assets/);
    promise(t, 'matching', ms, 120000);
}));

test('a malformed list with duplicate rows, Korean, slashes, blanks and control characters is matched',
    { skip: notBuilt }, () => inFolder((folder) => {
    boxPlant(folder, ['열교환기-101', 'P-102 A/B', 'V 201']);
    const rows = [['열교환기-101/TT-01', '열교환기 입구 온도'], ['P-102 A/B_PT01', ''], [' V 201 . LT\u0001 01 ', 'level'],
        ['', 'nothing'], ['X\u0007', '']];
    const all = [...rows, ...rows, ...rows].map(([name, text], i) => `"${name}",${i === 6 ? 7 : 1},"${text}"`);
    writeFileSync(join(folder, 'export.csv'), ['Tag Name,Address,Description', ...all].join('\r\n'));
    const said = good(run('plantcast', 'match', folder, join(folder, 'export.csv'), '--equipment', 'level=2'));
    assert.match(said.stdout, /ignored 7 duplicate rows/);
    assert.match(said.stdout,
        /1 row repeats a tag, with other contents: only the first row of each tag is used: P-102 A\/B_PT01 \(lines 3 and 8\)/);
    assert.match(said.stdout, /ignored 3 rows without a tag name/);
    assert.match(said.stdout, /replaced 6 control characters by blanks/);
    const found = Object.fromEntries(table(join(folder, 'matches.csv')).map(({ Tag, Status, Asset }) => [Tag, `${Status} ${Asset}`]));
    assert.deepEqual(found, { '열교환기-101/TT-01': 'sure 열교환기-101', 'P-102 A/B_PT01': 'sure P-102 A/B',
        'V 201 . LT  01': 'sure V 201', X: 'none ' });
}));

test('manual changes stay, and a second run changes nothing', { skip: notBuilt }, () => inFolder((folder) => {
    boxPlant(folder, ['E-101', 'P-101', 'V-201']);
    const list = join(folder, 'export.csv'), match = (...more) => good(run('plantcast', 'match', folder, list, ...more)).stdout;
    const texts = () => ['plant.yaml', 'tags.csv', 'matches.csv'].map((name) => readFileSync(join(folder, name), 'utf8'));
    const edit = (name, from, to) => {
        const path = join(folder, name), text = readFileSync(path, 'utf8');
        assert.ok(text.includes(from), `${name}: ${text}`);
        writeFileSync(path, text.replace(from, to));
    };
    const rows = () => Object.fromEntries(table(join(folder, 'tags.csv')).map((row) => [row['Tag Name'], `${row.Asset} ${row.Place}`]));
    writeFileSync(list, 'Tag Name,Eng Units,Scaled Low,Scaled High,Description\nE-101.TT-01,degC,0,250,Inlet\n' +
        'E-101.TT-02,degC,0,150,Outlet\nLT-201,%,0,100,Level\nPT-101,bar,0,10,Pressure\nFT-999,m3/h,0,10,Flow\n');
    match('--equipment', 'level=2');
    assert.deepEqual(rows(), { 'E-101.TT-01': 'E-101 equipment', 'E-101.TT-02': 'E-101 equipment', 'LT-201': 'V-201 equipment',
        'PT-101': ' ', 'FT-999': ' ' });
    assert.match(readFileSync(join(folder, 'plant.yaml'), 'utf8'),
        /- \{ id: "temperature", quantity: "Temperature", unit: "°C", min: 0, max: 250 \}/);
    const first = texts();
    match();
    assert.deepEqual(texts(), first);
    // A user's corrections. In matches.csv: PT-101 gets an asset, LT-201 gets none. In tags.csv: the position of one tag on
    // E-101 is confirmed, and another tag gets another asset. A second run must keep them.
    edit('matches.csv', 'PT-101,none,,', 'PT-101,none,P-101,');
    edit('matches.csv', 'LT-201,sure,V-201', 'LT-201,none,V-201');
    edit('tags.csv', ',E-101,equipment,', ',E-101,,');
    edit('tags.csv', ',E-101,equipment,', ',V-201,equipment,');
    edit('plant.yaml', 'max: 250', 'max: 300');
    match();
    assert.deepEqual(rows(), { 'E-101.TT-01': 'E-101 ', 'E-101.TT-02': 'V-201 equipment', 'LT-201': ' ',
        'PT-101': 'P-101 equipment', 'FT-999': ' ' });
    assert.match(readFileSync(join(folder, 'plant.yaml'), 'utf8'), /max: 300/);
    const second = texts();
    assert.match(second[2], /PT-101,sure,P-101,.*by hand/);
    assert.match(second[2], /E-101\.TT-02,sure,V-201,.*by hand/);
    match();
    assert.deepEqual(texts(), second);
    // A new export states other values: the tag list keeps its own, and the output names the tags.
    const before = readFileSync(list, 'utf8');
    writeFileSync(list, before.replace('degC,0,250', 'degC,0,260').replace('LT-201,%', 'LT-201,mm'));
    assert.match(match(), new RegExp('^2 tags have another address, type, scaling, unit or limit in this export; the tag list keeps ' +
        'its own: E-101\\.TT-01 \\(Scaled High 250, in the export 260\\), LT-201 \\(Eng Units %, in the export mm\\)$', 'm'));
    assert.deepEqual(texts()[1], second[1]);
    writeFileSync(list, before);
    match();
    // Rules and aliases of the site add matches.
    writeFileSync(join(folder, 'match_rules.csv'), 'Tag,Equipment\n"^FT-9([0-9])9$",P-10\\1\n^FT-999$,P-101\n');
    match();
    assert.match(readFileSync(join(folder, 'matches.csv'), 'utf8'), /FT-999,sure,P-101,.*rule 2 maps the tag to 'P-101'/);
    writeFileSync(join(folder, 'match_rules.csv'), 'Tag,Equipment\n[,x\n');
    const said = run('plantcast', 'match', folder, list);
    assert.equal(said.status, 1);
    assert.match(said.stderr, /match_rules\.csv: line 2: column Tag: '\[' is not a valid regular expression/);
    rmSync(join(folder, 'match_rules.csv'));
    writeFileSync(join(folder, 'aliases.csv'), 'Alias,Equipment\nfeed tank,V-201\n');
    writeFileSync(list, `${readFileSync(list, 'utf8')}XT_7,degC,0,90,Feed tank shell\n`);
    match();
    assert.match(readFileSync(join(folder, 'matches.csv'), 'utf8'), /XT_7,sure,V-201,.*alias 'feed tank'/);
}));

test('a change that a user saves during matching is not overwritten', { skip: notBuilt }, () => inFolder(async (folder) => {
    boxPlant(folder, ['E-101']);
    const list = join(folder, 'export.csv'), mine = 'Tag,Status,Asset\nE-101.TT-01,none,\n';
    const rows = ['Tag Name,Eng Units', ...Array.from({ length: 5000 }, (_, i) => `E-101.TT-${i},degC`)].join('\n');
    writeFileSync(list, rows);
    good(run('plantcast', 'match', folder, list));
    const first = readFileSync(join(folder, 'matches.csv'), 'utf8');
    for (let stopped = false, tries = 0; !stopped; tries++) {
        assert.ok(tries < 20, 'the match program was never seen at work');
        writeFileSync(join(folder, 'matches.csv'), first);
        writeFileSync(list, `${rows}\nE-101.XT-${tries},degC\n`);
        const child = spawn(join(BIN, 'plantcast-match'), [folder, list], { timeout: 60000 });
        const ended = new Promise((done) => child.once('exit', done)), watched = watch(folder);
        let said = '';
        child.stderr.on('data', (piece) => { said += piece; });
        // The trial file changes when the program has matched the tags and is about to check the result, but has not written it
        // yet.
        watched.on('change', (_, name) => {
            if (!/^\.trial/.test(name) || stopped || child.exitCode !== null)
                return;
            child.kill('SIGSTOP');
            // while the trial file exists, the result is not written; the user's change of matches.csv at this moment must not
            // be lost
            stopped = existsSync(join(folder, `.trial.${child.pid}.yaml`));
            if (stopped)
                writeFileSync(join(folder, 'matches.csv'), mine);
            child.kill('SIGCONT');
        });
        const status = await ended;
        watched.close();
        if (!stopped)
            continue;
        assert.equal(status, 1, said);
        assert.match(said, /matches\.csv: this file was changed by another program during matching, so nothing was written/);
        assert.equal(readFileSync(join(folder, 'matches.csv'), 'utf8'), mine);
        assert.doesNotMatch(readFileSync(join(folder, 'tags.csv'), 'utf8'), new RegExp(`XT-${tries},`));
    }
}));

test('a killed, interrupted, concurrent or out-of-disk match leaves a valid plant, and the next run completes it', { skip: notBuilt },
    () => inFolder(async (folder) => {
        const list = join(folder, 'export.csv'), first = join(folder, 'first'), whole = join(folder, 'whole');
        const plant = join(folder, 'plant');
        const names = ['plant.yaml', 'tags.csv', 'matches.csv'], rights = 0o640;
        const filesOf = (from) => Object.fromEntries(names.map((name) => [name, existsSync(join(from, name)) &&
            readFileSync(join(from, name), 'utf8')]));
        const rows = (count, unit) => ['Tag Name,Address,Eng Units,Scaled Low,Scaled High', ...Array.from({ length: count },
            (_, i) => `E-10${i % 3}.TT-${i},${400001 + 2 * i},${unit},0,90`)].join('\n');
        mkdirSync(first);
        boxPlant(first, ['E-100', 'E-101', 'E-102']);
        // the first run matches a plant without tags; the second run matches one with tags and adds the group of another unit
        for (const [count, unit] of [[6, 'degC'], [600, 'bar']]) {
            writeFileSync(list, rows(count, unit));
            cpSync(first, whole, { recursive: true });
            const args = [list, '--modbus', '127.0.0.1:502'];
            good(run('plantcast', 'match', whole, ...args));
            const replacedAt = names.map((name) => statSync(join(whole, name), { bigint: true }).ctimeNs);
            assert.deepEqual(replacedAt, [...replacedAt].sort((a, b) => Number(a - b)), 'files are replaced in the order of their names');
            // `names` lists the files in the order in which the program renames them; the loop restores the state after each of
            // the renames
            for (let replaced = 0; replaced <= names.length; replaced++) {
                rmSync(plant, { recursive: true, force: true });
                cpSync(first, plant, { recursive: true });
                for (const name of names.slice(0, replaced))
                    copyFileSync(join(whole, name), join(plant, name));
                for (const left of ['tags.csv.4194304.new', 'matches.csv.4194304.3.new', '.trial.4194304.yaml'])
                    // half-written file left by a process that has ended: no process can have the number 4194304
                    writeFileSync(join(plant, left), 'half of a li');
                const others = [`tags.csv.${process.pid}.new`, 'tags.csv.4194304.7.new'], hourAgo = Date.now() / 1000 - 3600;
                // files that may belong to a running process, of this machine (first name) or of another container (second
                // name): they must not be removed
                for (const name of others)
                    writeFileSync(join(plant, name), 'half of a li');
                for (const name of readdirSync(plant).filter((each) => /4194304/.test(each) && each !== others[1]))
                    utimesSync(join(plant, name), hourAgo, hourAgo);
                chmodSync(join(plant, 'tags.csv'), rights);
                good(run('plantcastd', '--check', join(plant, 'plant.yaml')));
                good(run('plantcast', 'match', plant, ...args));
                assert.deepEqual(filesOf(plant), filesOf(whole), `after ${replaced} replaced files`);
                assert.equal(statSync(join(plant, 'tags.csv')).mode & 0o777, rights);
                assert.deepEqual(readdirSync(plant).sort(), [...names, 'model.gltf', ...others].sort());
            }
            rmSync(first, { recursive: true });
            cpSync(whole, first, { recursive: true });
            rmSync(whole, { recursive: true });
        }
        writeFileSync(list, rows(3000, 'degC'));
        const before = filesOf(first), script = `trap '' XFSZ; ulimit -f 200; exec "$0" "$1" "$2"`;
        const full = spawnSync('bash', ['-c', script, join(BIN, 'plantcast-match'), first, list], { encoding: 'utf8', timeout: 60000 });
        assert.equal(full.status, 1);
        assert.equal(full.stderr.trim().split('\n').length, 1, full.stderr);
        assert.deepEqual(filesOf(first), before);
        assert.deepEqual(readdirSync(first).sort(), [...names, 'model.gltf'].sort());
        const held = spawn('flock', [first, 'sh', '-c', 'echo held; read line'], { stdio: ['pipe', 'pipe', 'ignore'] });
        await new Promise((done) => held.stdout.once('data', done));
        const refused = run('plantcast', 'match', first, list), ended = new Promise((done) => held.once('exit', done));
        held.stdin.end();
        await ended;
        assert.equal(refused.status, 1);
        assert.match(refused.stderr, /^plantcast match: [^\n]*first: (flock|sh) \(process \d+\) is using the plant's folder\n$/);
        assert.deepEqual(filesOf(first), before);
        const elsewhere = join(folder, 'tags.csv');
        renameSync(join(first, 'tags.csv'), elsewhere);
        symlinkSync(elsewhere, join(first, 'tags.csv'));
        good(run('plantcast', 'match', first, list));
        assert.ok(lstatSync(join(first, 'tags.csv')).isSymbolicLink());
        assert.notEqual(readFileSync(elsewhere, 'utf8'), before['tags.csv']);
    }));

// Starts a daemon on a folder in which the replacement of files by an import was interrupted. Expected: the daemon completes it
// and logs that once, the files equal those in `whole`, and no temporary file is left.
async function startsWhole(folder, whole, filesOf, what) {
    const daemon = new Program('plantcastd', ['--port', '0', '--gl', 'osmesa', '--h264', 'off', join(folder, 'plant.yaml')]);
    try {
        await daemon.line(/ready http/);
        assert.equal(daemon.said.match(/which had been interrupted/g)?.length, 1, daemon.said);
        assert.match(daemon.said, new RegExp(`completed ${what}, which had been interrupted`));
        assert.deepEqual(filesOf(folder), whole);
        assert.deepEqual(readdirSync(folder).filter((name) => /^\.(import|revision\.)/.test(name)), []);
    } finally {
        await daemon.stop();
    }
}

// A preloaded library kills an import before each of its renames in turn, also before those that set aside the old file.
const KILLER = join(process.env.PLANTCAST_OUT ?? 'build/release', 'tests/faults/kill_at_rename.so');
const noKiller = notBuilt || (existsSync(KILLER) ? false : 'not built: kill_at_rename.so');
for (const last of ['import', 'undo'])
    test(`an ${last} killed midway is completed first by the next command`, { skip: noKiller }, () => inFolder(async (folder) => {
        const [first, plant, whole, before, served] = ['first', 'plant', 'whole', 'before', 'served'].map((name) => join(folder, name));
        const model = join(folder, 'model.gltf'), list = join(folder, 'export.csv');
        const names = ['model.glb', 'plant.yaml', 'tags.csv', 'matches.csv', 'review.csv'];
        const filesOf = (from) => Object.fromEntries(names.map((name) => [name, existsSync(join(from, name)) &&
            readFileSync(join(from, name)).toString('latin1')]));
        const draw = (...equipment) => boxPlant(folder, equipment);
        const tags = (...equipment) => writeFileSync(list, ['Tag Name,Address,Eng Units,Scaled Low,Scaled High',
            ...equipment.map((name, i) => `${name}.TT-1,${400001 + 2 * i},degC,0,90`)].join('\n'));
        const match = (to) => run('plantcast', 'match', to, list, '--modbus', '127.0.0.1:502');
        draw('E-100', 'E-101', 'E-102');
        tags('E-100', 'E-101', 'E-102');
        good(run('plantcast', 'import', model, '-o', first));
        good(match(first));
        good(run('plantcast-prep', join(first, 'plant.yaml')));
        draw('E-103', 'E-101', 'E-102'); // the new model has no E-100, so the equipment of a tag is missing
        const args = last === 'undo' ? ['--undo', '-o'] : [model, '-o'];
        if (last === 'undo')
            good(run('plantcast', 'import', model, '-o', first));
        tags('E-103', 'E-101');
        cpSync(first, served, { recursive: true });
        good(run('plantcast', 'import', ...args, served));
        const settled = filesOf(served);
        for (const [to, imports] of [[whole, true], [before, false]]) {
            cpSync(first, to, { recursive: true });
            if (imports)
                good(run('plantcast', 'import', ...args, to));
            good(match(to));
        }
        const [imported, not] = [filesOf(whole), filesOf(before)];
        assert.notDeepEqual(imported, not);
        let at = 0, finished = 0, early = 0;
        for (let killed = true; killed;) {
            cpSync(first, plant, { recursive: true });
            const child = spawnSync(join(BIN, 'plantcast-import'), [...args, plant], { encoding: 'utf8',
                env: { ...process.env, LD_PRELOAD: KILLER, KILL_AT_RENAME: String(++at), ASAN_OPTIONS: 'verify_asan_link_order=0' } });
            killed = child.signal === 'SIGKILL';
            assert.ok(killed || child.status === 0, child.stderr);
            const left = existsSync(join(plant, '.revision.pending')) || existsSync(join(plant, '.revision.undoing'));
            if (left && finished === 1) {
                rmSync(served, { recursive: true });
                cpSync(plant, served, { recursive: true });
                await startsWhole(served, settled, filesOf, last === 'undo' ? 'the undo of an import' : 'an import');
            }
            good(match(plant));
            const now = filesOf(plant);
            if (killed && !left && now['plant.yaml'] === not['plant.yaml']) {
                assert.deepEqual(now, not, `the import was killed at rename ${at}`);
                early++;
            } else {
                assert.deepEqual(now, imported, `the import was killed at rename ${at}`);
                finished += left;
            }
            assert.deepEqual(readdirSync(plant).filter((name) => /^\.(import|revision\.)/.test(name)), [],
                `the import was killed at rename ${at}`);
            rmSync(plant, { recursive: true });
        }
        console.log(`# killed at ${at - 1} places: ${early} before it began, ${finished} while files were replaced`);
        assert.ok(finished >= 3, `only ${finished} kills were recovered`);
    }));

// A tag list exported by Kepware and a plant drawn in PDMS. The test uses both unedited, as a user would.
const ROOM = `Tag Name,Address,Data Type,Respect Data Type,Client Access,Scan Rate,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,\
Eng Units,Description,Negate Value
"ART1105BA_TT01",400001,Float,1,R/O,100,None,,,0,150,"degC","Tank ART1105BA shell top temperature"
"ART1105BA_TT02",400003,Float,1,R/O,100,None,,,0,150,"degC","Tank ART1105BA shell bottom temperature"
"TT-1101",400005,Float,1,R/O,100,None,,,0,120,"degC","Pump ART1101PO bearing DE temperature"
"art1111po.TE-03",400007,Float,1,R/O,100,None,,,0,120,"degC","Bearing temperature"
"ART1010TY_TI_01",400009,Float,1,R/O,100,None,,,0,200,"degC","Feed line"
"DWX12O1GL-TT-01",400011,Float,1,R/O,100,None,,,0,100,"degC","Duct"
"ART1101PO_PT01",400013,Float,1,R/O,100,None,,,0,16,"bar(g)","Discharge pressure"
"ART1101PO_RUN",000001,Boolean,1,R/O,100,None,,,,,"","Running"
"TT-9011",400015,Float,1,R/O,100,None,,,0,90,"degC","Cooling tower, another unit",1
"ART1101PO_TEXT",400017,String,1,R/O,100,None,,,,,"","Last operator"
`;

test('two systems\' exports become a live picture', { skip: noData, timeout: 240000 }, async () => {
    const tiny = await TinyPlant.create(), out = tiny.folder;
    for (const name of readdirSync(out))
        rmSync(join(out, name), { recursive: true });
    good(run('plantcast', 'import', join(DATA, 'cad/plm-sample.rvm'), '-o', out));
    writeFileSync(join(out, 'kepware.csv'), ROOM);
    const source = ['--modbus', `127.0.0.1:${tiny.modbusPort}`, '--byte-order', 'CDAB'];
    const said = good(run('plantcast', 'match', out, join(out, 'kepware.csv'), ...source));
    assert.match(said.stdout, /10 tags; matches to equipment: 9 sure, 0 likely, 1 none/);
    assert.match(said.stdout, /1 tag is not in the tag list, because the tag is text/);
    const rows = table(join(out, 'tags.csv'));
    assert.deepEqual(rows.map(({ 'Tag Name': name, Asset, Group, Place }) => [name, Asset, Group, Place].join(' ')), [
        'ART1105BA_TT01 -ART1105BA- temperature equipment', 'ART1105BA_TT02 -ART1105BA- temperature equipment',
        'TT-1101 -ART1101PO- temperature equipment', 'art1111po.TE-03 -ART1111PO- temperature equipment',
        'ART1010TY_TI_01 -ART1010TY- temperature equipment', 'DWX12O1GL-TT-01 -DWX1201GL- temperature equipment',
        'ART1101PO_PT01 -ART1101PO- pressure equipment', 'ART1101PO_RUN -ART1101PO-  ', 'TT-9011   ']);
    assert.deepEqual(rows.map((row) => row['Negate Value']), ['', '', '', '', '', '', '', '', '1']);
    const before = ['plant.yaml', 'tags.csv', 'matches.csv'].map((name) => readFileSync(join(out, name), 'utf8'));
    good(run('plantcast', 'match', out, join(out, 'kepware.csv')));
    assert.deepEqual(['plant.yaml', 'tags.csv', 'matches.csv'].map((name) => readFileSync(join(out, name), 'utf8')), before);
    // The user names the equipment of a tag and leaves the coordinates empty: `plantcastd --check` must accept that.
    const list = join(out, 'tags.csv'), shorter = before[1].replace(/^(TT-1101,.*,equipment,,).*$/m, '$1,,');
    assert.notEqual(shorter, before[1]);
    writeFileSync(list, shorter);
    good(run('plantcastd', '--check', tiny.file));
    assert.equal(tiny.prepare().code, 0);
    try {
        await tiny.startSim();
        await tiny.startDaemon();
        for (const [tag, value] of [['ART1105BA_TT01', 70], ['ART1105BA_TT02', 135], ['TT-1101', 95], ['art1111po.TE-03', 40],
            ['ART1010TY_TI_01', 160], ['DWX12O1GL-TT-01', 25], ['ART1101PO_PT01', 6]])
            await tiny.tell(`set ${tag} ${value}`);
        const url = `http://127.0.0.1:${tiny.port}/`, tags = async () => (await (await fetch(`${url}api/v1/tags`)).json()).tags;
        assert.equal((await tags()).filter(({ place }) => place === 'equipment').length, 7);
        await until('a value', async () => (await tags()).find(({ name }) => name === 'ART1105BA_TT02').value > 130);
        // hides the walls, so that the picture shows the equipment
        const walls = ['-HZA05-B', '-HZB05-B', '-HZC05-B', '-HAA01---B', 'IMAGE-DALLE', '-HZ0501M-', 'ORIGINE_BATIMENT'];
        const view = `width=1280&height=800&group=temperature&hidden=${walls.map(encodeURIComponent).join(',')}`;
        const bare = await fetch(`${url}snapshot.png?${view}`);
        assert.equal(bare.status, 200, await (bare.status === 200 ? '' : bare.text()));
        const refused = await fetch(`${url}snapshot.png?width=160&height=100&group=temperature&show=distance&sensor=TT-1101`);
        assert.equal(refused.status, 400);
        assert.match(await refused.text(), /the location of this sensor on -ART1101PO- is not given/);
        if (process.env.PLANTCAST_SHOTS)
            writeFileSync(join(BIN, 'screenshots/match_snapshot.png'), Buffer.from(await bare.arrayBuffer()));
    } finally {
        await tiny.destroy();
    }
});

test('unreadable input gets one error line, and no file is written', { skip: notBuilt }, () => inFolder((folder) => {
    boxPlant(folder, ['E-101']);
    const list = join(folder, 'export.csv'), before = readdirSync(folder);
    for (const [text, why] of [['', 'no header'], ['a,b\n1,2\n', 'no header'], ['Tag Name\n"x\n', 'a quote is never closed'],
        ['PK\x03\x04', 'not a spreadsheet'], ['{"tags": [', 'not JSON'], ['['.repeat(200000), 'maximum parsing depth'],
        [`${'{"tags":'.repeat(100000)}1${'}'.repeat(100000)}`, 'maximum parsing depth'], [Buffer.alloc(5000), 'no header'],
        [`Tag Name${',a'.repeat(200000)}\n`, 'more than 1000 cells']]) {
        writeFileSync(list, text);
        const said = run('plantcast', 'match', folder, list);
        assert.equal(said.status, 1);
        assert.equal(said.stderr.trim().split('\n').length, 1);
        assert.ok(said.stderr.includes(why), said.stderr);
    }
    rmSync(list);
    assert.deepEqual(readdirSync(folder), before);
    assert.equal(run('plantcast', 'match', folder).status, 2);
}));
