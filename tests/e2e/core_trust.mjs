// SPDX-License-Identifier: GPL-3.0-or-later
// The core checks the user itself before it does what a renderer requests, so that a renderer under an attacker's control gains
// no rights. The tests send messages to /core with a renderer's token.
import assert from 'node:assert/strict';
import { chmodSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { linesOf } from './support/lines.mjs';
import { IdentityProvider } from './support/identity_provider.mjs';
import { Nodes, until } from './support/nodes.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { setUp } from './support/set_up.mjs';
import { notBuilt, runProgram } from './support/tiny_plant.mjs';

const options = { skip: notBuilt(), timeout: 120000 };
let nodes, core, renderer, provider, identity, engineer;

const path = (name) => join(nodes.plant.folder, name);
const trail = () => linesOf(path('audit.log')).map((line) => JSON.parse(line));
const recorded = (what, where) => until(what, () => trail().findLast(where));

function openidFile(name, port, more = '') {
    writeFileSync(path(name), `issuer: ${provider.issuer}\nclient_id: plant\nclient_secret_file: secret\nurl: http://127.0.0.1:${port}/\n` +
        `roles: [{ group: operators, role: operator }, { group: bosses, role: engineer }]\ncheck_s: 1\n${more}`);
    return path(name);
}

setUp(options.skip, async (own) => {
    nodes = own(await Nodes.create({ slowDevice: true }));
    nodes.trustsLocal = false;
    provider = own(new IdentityProvider());
    await provider.listen();
    writeFileSync(path('secret'), 'geheim +\n');
    chmodSync(path('secret'), 0o600);
    engineer = runProgram('plantcast', ['token', 'add', nodes.tokenFile, '--role', 'engineer', '--name', 'eve']).out.trim();
    const port = await freePort(), coreConfig = openidFile('core.yaml', port);
    core = await nodes.core(port, '--audit', path('audit.log'), '--openid', coreConfig);
    const at = await freePort();
    renderer = await nodes.renderer('r1', core, '--port', String(at), '--openid', openidFile('renderer.yaml', at));
    core.token = renderer.token = nodes.tokens.viewer;
    await nodes.plant.tell('set TI-1 95.5');
    await until('readings and an alarm', async () => renderer.alarm('TI-1', nodes.tokens.viewer));
    identity = await learnIdentity();
});

const state = async () => (await core.alarm('TI-1', nodes.tokens.viewer))?.state;
async function open(token = nodes.tokens.renderer) {
    const client = await PlainClient.open(core.port, { path: '/core', protocol: 'plantcast.core.v1',
        headers: [`Authorization: Bearer ${token}`] });
    const { onMessage } = client;
    // binary messages, which carry readings, are ignored
    client.onMessage = (message) => (client.opcode === 1 ? onMessage.call(client, message) : undefined);
    return client;
}

// Returns the version, plant name and configuration that a renderer must send. Any renderer can learn them: from the programs
// and from the core's message.
async function learnIdentity() {
    const client = await open(), [, version] = /plantcastd (\S+)/.exec(runProgram('plantcastd', ['--version']).out);
    const configuration = /configuration ([0-9a-f]{16})/.exec(core.program.said)[1];
    client.say({ type: 'renderer', version, plant: 'Two boxes', configuration, node: 'evil' });
    await client.text('core');
    client.close();
    return { version, plant: 'Two boxes', configuration };
}

// Sends a message on behalf of `who`, like a renderer that an attacker has taken over.
async function asEvil(message, who) {
    const client = await open();
    client.say({ type: 'renderer', node: 'evil', ...identity });
    await client.text('core');
    client.say({ type: 'act', id: 7, message, ...who });
    const { texts } = await client.text('answer');
    client.close();
    return texts.map((text) => JSON.parse(text));
}
const ACK = { type: 'alarm', seq: 1, action: 'acknowledge', alarms: [['TI-1', 'H']] };
const OUT = { type: 'alarm', seq: 2, action: 'out_of_service', alarms: [['TI-1', 'H']], reason: 'gone' };
const NOTE = { type: 'note', seq: 3, text: 'evil was here', asset: 'E-101' };

test('a renderer\'s token alone authorises no action, whatever user it names; the refusal names node and token', options, async () => {
    for (const who of [{ who: 'eve', role: 'engineer', from: '10.0.0.1', signed_in: false },
        { who: 'kim', role: 'engineer', from: '', signed_in: true }, {}, { token: nodes.tokens.renderer }, { token: 'pc_0' },
        { id_token: 'x.y.z' }, { token: nodes.tokens.viewer }, { token: 5 }])
        for (const message of [ACK, OUT, NOTE, { type: 'pair', seq: 4, digits: '123456' }]) {
            const answers = await asEvil(message, who), what = JSON.stringify([who, message, answers]);
            assert.deepEqual(answers.map(({ type, code }) => [type, code]), [['error', 'not_allowed']], what);
        }
    assert.equal(await state(), 'unacknowledged');
    const refused = await recorded('a refusal', ({ event, result, through }) => event === 'access' && result === 'refused' && through);
    assert.equal(refused.through, 'node evil, token r');
    assert.ok(!trail().some(({ who, result }) => who === 'eve' && result === 'done'), 'nothing was done in the name of eve');
});

test('a user\'s token grants its role only: an operator may acknowledge, but not take an alarm out of service', options, async () => {
    const [over] = await asEvil(OUT, { token: nodes.tokens.operator, role: 'engineer', who: 'eve' });
    assert.deepEqual([over.code, await state()], ['not_allowed', 'unacknowledged']);
    const anna = await renderer.client({}, { token: nodes.tokens.operator });
    anna.say(ACK);
    assert.equal((await anna.text('alarmed')).done, 1);
    anna.close();
    const { who, role, through } = await recorded('it', ({ event, result }) => event === 'alarm' && result === 'done');
    assert.deepEqual([who, role, through], ['anna', 'operator', 'node r1, token r']);
    const eve = await renderer.client({}, { token: engineer });
    eve.say(OUT);
    assert.equal((await eve.text('alarmed')).done, 1);
    eve.say({ ...OUT, action: 'in_service', seq: 5 });
    await eve.until('that it is back', ({ texts }) => texts.some(({ seq }) => seq === 5));
    eve.close();
});

test('a token known only to the renderer\'s token file authorises nothing at the core', options, async () => {
    const own = path('own'), lines = readFileSync(nodes.tokenFile, 'utf8');
    writeFileSync(own, lines, { mode: 0o600 });
    const token = runProgram('plantcast', ['token', 'add', own, '--role', 'engineer', '--name', 'mallory']).out.trim();
    const other = await nodes.renderer('r2', core, '--tokens', own);
    await until('its core', async () => (await other.tags(nodes.tokens.viewer))['TI-1'].quality_name === 'Good');
    const client = await other.client({}, { token });
    client.say(ACK);
    const { code, text } = await client.text('error');
    assert.equal(code, 'not_allowed');
    assert.match(text, /not done: the core does not accept this token/);
    client.close();
    await other.stop();
});

// Signs in at the renderer like a browser. Returns the cookie.
async function signIn() {
    const at = (where, more) => fetch(`http://127.0.0.1:${renderer.port}${where}`, { redirect: 'manual', ...more });
    const begun = await until('the provider', async () => {
        const answer = await at('/login?to=/');
        return answer.status === 303 && answer;
    });
    const jar = begun.headers.getSetCookie().map((line) => line.split(';')[0]).join('; ');
    const back = await fetch(provider.login(begun.headers.get('location')), { redirect: 'manual', headers: { cookie: jar } });
    return back.headers.getSetCookie().map((line) => line.split(';')[0]).find((line) => /^plantcast-\w+=.{43}$/.test(line));
}

test('a user signed in at the renderer acts at the core, too, with the rights from the identity provider', options, async () => {
    provider.claims = { preferred_username: 'kim', groups: ['operators'] };
    const client = await renderer.client({ headers: [`Cookie: ${await signIn()}`] });
    assert.equal(client.welcome.role, 'operator');
    client.say({ type: 'note', seq: 8, text: 'seen by kim', asset: 'E-101' });
    assert.equal((await client.text('noted')).kept, true);
    const { who, role, through } = await recorded('the note', ({ event, result }) => event === 'note' && result === 'done');
    assert.deepEqual([who, role, through], ['kim', 'operator', 'node r1, token r']);
    client.close();
    const tokenOf = (claims, change = () => {}) => {
        Object.assign(provider, { claims: { preferred_username: 'kim', ...claims }, change });
        const token = provider.idToken(null, 's1');
        provider.change = () => {};
        return token;
    };
    const now = Math.floor(Date.now() / 1000);
    for (const [what, token, done] of [['an operator', tokenOf({ groups: ['operators'] }), true],
        ['nobody\'s group', tokenOf({ groups: ['cleaners'] }), false],
        ['another client', tokenOf({ groups: ['bosses'] }, (claims) => { claims.aud = 'another'; }), false],
        ['another issuer', tokenOf({ groups: ['bosses'] }, (claims) => { claims.iss = 'http://evil.example'; }), false],
        ['not signed', tokenOf({ groups: ['bosses'] }, (claims, header) => { header.alg = 'none'; }), false],
        ['of yesterday', tokenOf({ groups: ['bosses'] },
            (claims) => { claims.iat = now - 20 * 3600; claims.exp = claims.iat + 300; }), false],
        ['an hour old, as where a provider gives no newer one', tokenOf({ groups: ['operators'] },
            (claims) => { claims.iat = now - 3600; claims.exp = claims.iat + 300; }), true]]) {
        const answers = await asEvil({ type: 'note', seq: 9, text: what, asset: 'E-101' }, { id_token: token });
        assert.deepEqual(answers.map(({ type }) => type), [done ? 'noted' : 'error'], `${what}: ${JSON.stringify(answers)}`);
    }
    const namesake = tokenOf({ groups: ['operators'], preferred_username: 'eve' });
    await asEvil({ type: 'note', seq: 10, text: 'by a namesake', asset: 'E-101' }, { id_token: namesake });
    await recorded('eve, who is none of the tokens', ({ event, who: name }) => event === 'note' && name === 'eve (signed in)');
    const [over] = await asEvil(OUT, { id_token: tokenOf({ groups: ['operators'] }) });
    assert.equal(over.code, 'not_allowed');
});

test('a renderer\'s token cannot join as a standby, and a standby\'s token cannot join as a renderer', options, async () => {
    for (const [token, more, why] of [[nodes.tokens.renderer, { standby: true, id: '12345678', journal: 0 },
        /the token r has the role renderer, but a standby needs a token of the role standby \(plantcast token add FILE --role standby/],
    [nodes.tokens.standby, {}, /the token s has the role standby, but a renderer needs a token of the role renderer/]]) {
        const client = await open(token);
        client.say({ type: 'renderer', node: 'evil', ...identity, ...more });
        const refused = await client.text('refused');
        assert.match(refused.why, why);
        assert.equal(refused.votes, false);
        client.close();
        await until('its log', () => /(standby|renderer) evil: refused: the token/.test(core.program.said));
    }
    await until('the renderer alone', async () => await core.metric('plantcast_renderers') === 1);
});
