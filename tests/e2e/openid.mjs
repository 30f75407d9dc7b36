// SPDX-License-Identifier: GPL-3.0-or-later
// Sign-in with OpenID Connect: with a provider that the test makes misbehave, and with two independent ones, oidc-provider and
// Glewlwyd.
import assert from 'node:assert/strict';
import { chmodSync, existsSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer, request } from 'node:http';
import { createServer as createTcpServer } from 'node:net';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, shoot, waitForPicture } from './support/browser.mjs';
import { Glewlwyd, glewlwydIsThere } from './support/glewlwyd.mjs';
import { IdentityProvider } from './support/identity_provider.mjs';
import { linesOf } from './support/lines.mjs';
import { PlainClient } from './support/plain_client.mjs';
import { freePort } from './support/ports.mjs';
import { long, promise } from './support/promise.mjs';
import { setUp } from './support/set_up.mjs';
import { sweep } from './support/sweep.mjs';
import { notBuilt, runProgram, sleep, TinyPlant } from './support/tiny_plant.mjs';
import { until } from './support/until.mjs';

const skip = notBuilt();
let plant, provider, token, port;

const path = (name) => join(plant.folder, name);
// Waits for an entry of the audit trail, which is written asynchronously.
async function recorded(what, where) {
    return await until(`${what} in the trail`, () => trail().find(where), 90, () => readFileSync(path('audit.log'), 'utf8'));
}
const trail = () => linesOf(path('audit.log')).map((line) => JSON.parse(line));

// A browser reduced to what sign-in needs: it keeps cookies and sends them again, and does not follow redirects by itself.
class Browser {
    constructor() { this.jar = new Map(); }

    async get(url, options = {}) {
        const cookie = [...this.jar].map(([name, value]) => `${name}=${value}`).join('; ');
        const headers = { ...options.headers, ...(cookie ? { cookie } : {}) };
        const response = await fetch(url, { redirect: 'manual', ...options, headers });
        for (const line of response.headers.getSetCookie()) {
            const [, name, value, rest] = /^([^=]+)=([^;]*)(.*)$/.exec(line);
            this.last = line;
            if (/Max-Age=0/.test(rest))
                this.jar.delete(name);
            else
                this.jar.set(name, value);
        }
        return response;
    }

    at(where, options) { return this.get(`http://127.0.0.1:${port}${where}`, options); }

    // Begins a login. Returns the URL to which the provider redirects back.
    async begin(to = '/') {
        const response = await this.at(`/login?to=${encodeURIComponent(to)}`);
        assert.equal(response.status, 303);
        return provider.login(response.headers.get('location'));
    }

    async signIn(to) { return this.get(await this.begin(to)); }

    async me() { return (await this.at('/api/v1/me')).json(); }

    has(role) { return until(`the role ${role}`, async () => (await this.me()).role === role); }

    stream() {
        return PlainClient.open(port, { headers: [`Cookie: ${[...this.jar].map(([name, value]) => `${name}=${value}`).join('; ')}`] });
    }
}

function writeConfig(more = '', issuer = provider.issuer) {
    writeFileSync(path('openid.yaml'), `issuer: ${issuer}\nclient_id: plant\nclient_secret_file: secret\nurl: http://127.0.0.1:${port}/\n` +
        'label: Works\nroles:\n  - { group: operators, role: operator }\n  - { group: lookers, role: viewer }\n' + `check_s: 1\n${more}`);
}

async function start(...more) {
    await plant.daemon?.stop();
    await plant.startDaemon('--port', String(port), '--tokens', path('tokens'), '--openid', path('openid.yaml'), '--audit',
        path('audit.log'), ...more);
    const begins = async () => (await fetch(`http://127.0.0.1:${port}/login`, { redirect: 'manual' })).status === 303;
    await until('the way to the provider', begins);
}

setUp(skip, async (own) => {
    plant = own(await TinyPlant.create());
    plant.addAlarms();
    assert.equal(plant.prepare().code, 0);
    writeFileSync(path('secret'), 'geheim +\n');
    chmodSync(path('secret'), 0o600);
    token = runProgram('plantcast', ['token', 'add', path('tokens'), '--role', 'engineer', '--name', 'break-glass']).out.trim();
    provider = own(new IdentityProvider());
    // the provider listens on a reserved port, so that no other program takes it while tests stop the provider
    await provider.listen(await freePort());
    port = await freePort();
    writeConfig();
    await start();
});

test('a user signs in, acts under the own name, and signs out', { skip }, async () => {
    const browser = new Browser();
    const nobody = { name: null, role: 'nobody', signed_in: false, until: null, sign_in: 'Works', notice: null };
    assert.deepEqual(await browser.me(), nobody);
    const back = await browser.signIn('/?lang=de#tag=TI-1');
    assert.equal(back.status, 303, await back.text());
    assert.equal(back.headers.get('location'), '/?lang=de#tag=TI-1');
    assert.match(browser.last, /^plantcast-[0-9a-f]{8}=[\w-]{43}; Path=\/; Max-Age=43200; HttpOnly; SameSite=Strict$/);
    const me = await browser.me();
    assert.deepEqual([me.name, me.role, me.signed_in], ['kim', 'operator', true]);
    assert.equal((await browser.at('/api/v1/tags')).status, 200);
    assert.equal((await browser.at('/api/v1/reload', { method: 'POST' })).status, 403);
    const client = await browser.stream();
    assert.equal((await client.hello()).role, 'operator');
    client.say({ type: 'alarm', seq: 1, action: 'shelve', alarms: [['TI-1', 'H']], for_s: 60, reason: 'r', name: 'somebody else' });
    await client.text('alarmed');
    assert.equal((await browser.at('/logout', { method: 'POST', headers: { Origin: 'http://evil.example' } })).status, 403);
    const out = await (await browser.at('/logout', { method: 'POST' })).json();
    assert.match(out.provider, new RegExp(`^${provider.issuer}/end\\?client_id=plant&post_logout_redirect_uri=`));
    assert.equal((await client.until('a close', (c) => c.closed)).code, 1008);
    assert.equal((await client.text('error')).code, 'token_needed');
    assert.equal((await browser.me()).role, 'nobody');
    const login = await recorded('the log-in', (line) => line.event === 'login' && line.how === 'OpenID Connect');
    assert.deepEqual([login.who, login.role, login.result, login.what], ['kim', 'operator', 'done', 'sub s1']);
    const shelf = await recorded('the shelf', (line) => line.event === 'alarm');
    assert.deepEqual([shelf.who, /somebody else/.test(JSON.stringify(shelf))], ['kim', false]);
    await recorded('the end', (line) => line.event === 'leave' && line.who === 'kim' && line.what === 'signed out');
    await until('the refresh token being revoked', () => provider.asked.includes('/revoke'));
});

test('a user whose name at the provider equals another user\'s name is told apart', { skip }, async () => {
    for (const name of ['local', 'Local', 'break-glass']) {
        provider.claims.preferred_username = name;
        const browser = new Browser();
        await browser.signIn('/');
        assert.equal((await browser.me()).name, `${name} (signed in)`);
        const client = await browser.stream();
        await client.hello();
        client.say({ type: 'alarm', seq: 1, action: 'shelve', alarms: [['TI-1', 'H']], for_s: 60, reason: name });
        await client.text('alarmed');
        await recorded('the shelf', (line) => line.event === 'alarm' && line.who === `${name} (signed in)`);
        await browser.at('/logout', { method: 'POST' });
    }
    provider.claims.preferred_username = 'kim';
});

test('each untrustworthy answer of the provider is refused with its reason, and nobody is signed in', { skip }, async () => {
    const now = () => Math.floor(Date.now() / 1000);
    const cases = [
        ['alg none', /not signed/, (claims, header) => { header.alg = 'none'; }, () => ''],
        ['alg none, with a signature', /not signed/, (claims, header) => { header.alg = 'none'; }],
        ['alg HS256', /not signed/, (claims, header) => { header.alg = 'HS256'; }],
        ['wrong audience', /another client \(aud\)/, (claims) => { claims.aud = 'other'; }],
        ['expired', /expired/, (claims) => { claims.exp = now() - 120; }],
        ['from the future', /time of issue of the ID token is implausible/, (claims) => { claims.iat = now() + 300; }],
        ['wrong issuer', /another issuer/, (claims) => { claims.iss = 'https://evil.example'; }],
        ['wrong nonce', /nonce/, (claims) => { claims.nonce = 'other'; }],
        ['no nonce', /nonce/, (claims) => { delete claims.nonce; }],
        ['an unknown key', /key that the provider does not publish/, (claims, header) => { header.kid = 'other'; }],
        ['a changed signature', /signature of the ID token is invalid/, () => {}, () => 'AAAA'],
        ['no role', /user kim: none of the user's groups has a role \(groups: \["cleaners"\]\)/,
            (claims) => { claims.groups = ['cleaners']; }],
        ['no groups', /none of the user's groups has a role \(groups: the provider sent no claim groups\)/,
            (claims) => { delete claims.groups; }],
    ];
    for (const [name, why, change, sign = null] of cases) {
        const browser = new Browser();
        Object.assign(provider, { change, sign });
        const answer = await browser.signIn();
        assert.equal(answer.status, 403, name);
        assert.match(await answer.text(), why, name);
        assert.equal((await browser.me()).role, 'nobody', name);
    }
    Object.assign(provider, { change: () => {}, sign: null });
    await recorded('a refusal', (line) => line.event === 'login' && line.result === 'refused' && /nonce/.test(line.why));
});

test('a repeated code, state or answer, another browser, another issuer and a foreign return address are refused', { skip }, async () => {
    const browser = new Browser();
    const back = await browser.begin();
    const stranger = await new Browser().get(back);
    assert.equal(stranger.status, 403, 'another browser is refused');
    assert.match(await stranger.text(), /this browser has no sign-in in progress/);
    assert.equal((await browser.get(back)).status, 303);
    const replayed = await browser.get(back);
    assert.equal(replayed.status, 403, 'a replayed state is refused');
    const again = await browser.begin();
    again.searchParams.set('code', back.searchParams.get('code'));
    const code = await browser.get(again);
    assert.equal(code.status, 403, 'a replayed code is refused');
    assert.match(await code.text(), /refuses the code: invalid_grant/);
    const other = await browser.begin();
    other.searchParams.set('iss', 'https://evil.example');
    assert.match(await (await browser.get(other)).text(), /the issuer \(iss\) in the provider's answer differs/);
    const denied = await browser.begin();
    denied.searchParams.delete('code');
    denied.searchParams.set('error', 'access_denied');
    const refusal = /refused to sign this user in, with the error: access_denied/;
    assert.match(await (await browser.get(denied)).text(), refusal);
    await recorded('the refusal', (line) => line.result === 'refused' && refusal.test(line.why ?? ''));
    for (const to of ['//evil.example', 'https://evil.example', '/\\evil.example', '/\r\nSet-Cookie: a=b'])
        assert.equal((await new Browser().signIn(to)).headers.get('location'), '/', to);
});

test('rotated keys are fetched, not more often than permitted', { skip: skip || long }, async () => {
    provider.rotate();
    await until('keys being requested again', async () => (await new Browser().signIn()).status === 303);
    const asked = () => provider.asked.filter((url) => url === '/jwks').length, before_ = asked();
    provider.change = (claims, header) => { header.kid = 'made up'; };
    for (let i = 0; i < 5; i++)
        assert.equal((await new Browser().signIn()).status, 403);
    provider.change = () => {};
    assert.ok(asked() - before_ <= 1);
});

test('a user who loses all rights loses the session; a smaller role applies at once', { skip }, async (t) => {
    t.after(() => { provider.claims.groups = ['operators']; provider.status = 200; });
    const browser = new Browser();
    await browser.signIn();
    const client = await browser.stream();
    await client.hello();
    provider.claims.groups = ['lookers'];
    await browser.has('viewer');
    client.say({ type: 'alarm', seq: 1, action: 'shelve', alarms: [['TI-1', 'H']], for_s: 60, reason: 'r' });
    assert.equal((await client.text('error')).code, 'not_allowed');
    provider.claims.groups = [];
    assert.equal((await client.until('a close', (c) => c.closed)).code, 1008);
    assert.equal((await browser.me()).role, 'nobody');
    provider.claims.groups = ['operators'];
    await browser.signIn();
    const none = await browser.stream();
    await none.hello();
    // The ID token has no claim `groups`, as some providers send for a user without groups: the session must end.
    delete provider.claims.groups;
    assert.equal((await none.until('a close', (c) => c.closed)).code, 1008);
    provider.claims.groups = ['operators'];
    await browser.signIn();
    const second = await browser.stream();
    await second.hello();
    provider.status = 400;
    assert.equal((await second.until('a close', (c) => c.closed)).code, 1008);
    provider.status = 200;
    await recorded('the end', (line) => line.event === 'leave' && /ended the user's sign-in/.test(line.why ?? ''));
});

test('while the provider is away, signed-in users stay, nobody new signs in, and a token still works', { skip }, async () => {
    const browser = new Browser();
    await browser.signIn();
    const client = await browser.stream();
    await client.hello();
    const { port: its } = provider;
    const waiting = await browser.begin();
    await provider.close();
    let checks = 0;
    const away = createTcpServer((socket) => { checks++; socket.destroy(); });
    await new Promise((done) => away.listen(its, '127.0.0.1', done));
    await plant.daemon.line(/openid: http.*users cannot sign in by OpenID Connect; signed-in users stay signed in/);
    await until('three failed checks of rights', () => checks >= 3);
    await new Promise((done) => away.close(done));
    assert.equal(client.closed, null);
    assert.equal((await browser.me()).role, 'operator');
    const answer = await browser.get(waiting);
    assert.equal(answer.status, 403);
    assert.match(await answer.text(), /does not answer/);
    const glass = await PlainClient.open(port);
    assert.equal((await glass.hello({ token })).role, 'engineer');
    await provider.listen(its);
    await plant.daemon.line(/openid: .* answers again/);
    assert.equal((await new Browser().signIn()).status, 303);
    assert.equal(client.closed, null);
    client.close();
    glass.close();
});

test('without refresh tokens a session ends with its access token; log and trail contain no secrets', { skip }, async () => {
    provider.refreshes = false;
    const browser = new Browser();
    assert.equal((await browser.signIn()).status, 303);
    // the user must lose all rights when the access token ends: there is neither a refresh token nor a UserInfo endpoint to
    // renew them
    await browser.has('nobody');
    provider.refreshes = true;
    const said = plant.daemon.said + readFileSync(path('audit.log'), 'utf8');
    for (const secret of ['geheim', token, ...browser.jar.values(), 'eyJ'])
        assert.ok(!said.includes(secret), secret);
    assert.equal(runProgram('plantcast', ['audit', 'verify', path('audit.log')]).code, 0);
});

// Sends a request from another address of this machine. Resolves with the answer.
function askFrom(localAddress, where, headers = {}) {
    return new Promise((done, fail) => {
        const asked = request({ host: '127.0.0.1', port, path: where, localAddress, headers }, (response) => {
            response.resume().on('end', () => done(response));
        });
        asked.on('error', fail).end();
    });
}

// Begins a login from this address as an attacker does. Returns a function that delivers a forged answer of the provider, with
// the state and cookie of this login.
async function beginFrom(localAddress) {
    const begun = await askFrom(localAddress, '/login'), cookie = begun.headers['set-cookie'][0].split(';')[0];
    const state = new URL(begun.headers.location).searchParams.get('state');
    return (more) => askFrom(localAddress, `/login/callback?state=${state}&${more}`, { cookie });
}

const refusals = () => trail().filter((line) => line.event === 'login' && line.result === 'refused').length;
// Largest number of lines by which the audit trail may summarise refused logins since then: two at once (one for tokens that
// were not checked, one for answers of the provider) and two per minute.
const sumsSince = (began) => 2 + 2 * Math.floor((performance.now() - began) / 60000);

test('thousands of forged sign-in answers leave one log line, and lock nobody out', { skip, timeout: 120000 }, async () => {
    const lines = refusals(), began = performance.now();
    let person = null;
    const guess = async () => {
        for (let i = 0; i < 500; i++) {
            assert.equal((await askFrom('127.0.0.9', '/login/callback?state=x&code=y')).statusCode, 403);
            person ??= i === 10 ? new Browser().signIn() : null;
        }
    };
    await Promise.all([guess(), guess(), guess(), guess()]);
    assert.equal((await person).status, 303);
    await recorded('their sum', (line) =>
        /^\d+ answers of the identity provider were rejected: they belonged to no sign-in/.test(line.what ?? ''));
    assert.ok(refusals() - lines <= sumsSince(began), String(refusals() - lines));
    const answer = await beginFrom('127.0.0.9');
    assert.equal((await answer('error=access_denied')).statusCode, 403, 'the address is not locked out');
});

test("provider errors and cancelled sign-ins slow nobody, and tokens still work", { skip }, async () => {
    const lines = refusals(), began = performance.now(), errors = ['access_denied', 'temporarily_unavailable'];
    const faults = [[401, { error: 'invalid_client' }], [400, { error: 'unauthorized_client' }], [429, { error: 'slow_down' }],
        [429, {}], [503, {}]];
    for (const fault of faults) {
        provider.fault = fault;
        for (let i = 0; i < 4; i++)
            assert.equal((await (await beginFrom('127.0.0.7'))('code=x')).statusCode, 403, JSON.stringify(fault));
    }
    provider.fault = null;
    await until('the reason in the log', () => plant.daemon.said.includes('the identity provider refuses the request'));
    for (let i = 0; i < 20; i++)
        assert.equal((await (await beginFrom('127.0.0.7'))(`error=${errors[i % 2]}`)).statusCode, 403);
    assert.equal((await askFrom('127.0.0.7', '/api/v1/me', { Authorization: `Bearer ${token}` })).statusCode, 200);
    assert.ok(refusals() - lines <= sumsSince(began), String(refusals() - lines));
    const guesses = [];
    for (let i = 0; i < 13; i++)
        guesses.push((await (await beginFrom('127.0.0.7'))(`code=made-up-${i}`)).statusCode);
    assert.ok(guesses.slice(10).includes(429), `guesses still slow the address: ${guesses}`);
    assert.equal((await new Browser().signIn()).status, 303);
});

test('made-up codes slow their own address, and others sign in meanwhile', { skip, timeout: 120000 }, async () => {
    const lines = refusals(), began = performance.now();
    let slowed = 0, person = null;
    const guess = async () => {
        for (let i = 0; i < 100; i++) {
            if ((await (await beginFrom('127.0.0.8'))(`code=made-up-${i}`)).statusCode === 429)
                slowed++;
            person ??= slowed > 0 ? new Browser().signIn() : null;
        }
    };
    await Promise.all([guess(), guess()]);
    assert.equal((await person).status, 303);
    // largest number of guesses that the server may check: ten at once, then one per 5 s, plus a margin of ten
    const checked = 20 + (performance.now() - began) / 5000;
    assert.ok(200 - slowed <= checked, `${slowed} of 200 guesses were slowed`);
    assert.ok(refusals() - lines <= checked + sumsSince(began), String(refusals() - lines));
});

test('with a slow provider, waiting codes are bounded, and the rights of 40 users end in time', { skip, timeout: 120000 }, async (t) => {
    const metrics = () => fetch(`http://127.0.0.1:${port}/metrics`, { headers: { Authorization: `Bearer ${token}` } });
    const people = async () => Number(/^plantcast_openid_people (\d+)/m.exec(await (await metrics()).text())[1]);
    t.after(() => { Object.assign(provider, { delay_ms: 0, sub: 's1', codesWait: null }); provider.claims.groups = ['operators']; });
    for (let i = 0; i < 40; i++) {
        provider.sub = `s${i % 4}`; // uses four users for 40 sessions, because a user may have at most 16
        assert.equal((await new Browser().signIn()).status, 303);
    }
    assert.ok(await people() >= 40);
    provider.claims.groups = [];
    provider.delay_ms = 1000;
    const began = Date.now(), answers = [];
    let answerCodes;
    // the provider keeps all codes waiting until the test has sent the last one
    provider.codesWait = new Promise((done) => { answerCodes = done; });
    for (let i = 0; i < 90; i++)
        answers.push((await beginFrom(`127.0.0.${20 + i % 9}`))('code=made-up').then((response) => response.statusCode));
    answerCodes();
    await until('the end of all 40 sessions', async () => await people() === 0);
    promise(t, 'the renewals of 40 sessions, 40 s one after the other', Date.now() - began, 30000);
    provider.delay_ms = 0;
    const codes = await Promise.all(answers), count = (status) => codes.filter((code) => code === status).length;
    assert.ok(count(503) >= 10, `${count(503)} of ${codes.length} clients were asked to retry`);
    assert.equal(count(403) + count(503) + count(429), 90);
    await until('all being revoked', () => provider.live.size === 0);
});

// Signatures, requests and checks of rights run in other threads, so the processor time of the event loop's thread is a valid
// measure even on a busy machine.
test('signing in, requests with cookies and checks of rights cost the event loop little time', { skip, timeout: 120000 }, async (t) => {
    const PEOPLE = 32, REQUESTS = 100;
    t.after(() => { provider.sub = 's1'; provider.claims.groups = ['operators']; });
    const { pid } = plant.daemon.child;
    // processor time of the loop's thread, in milliseconds
    const loop = () => Number(readFileSync(`/proc/${pid}/task/${pid}/schedstat`, 'utf8').split(' ')[0]) / 1e6;
    const cost = async (times, act) => {
        const before_ = loop();
        for (let i = 0; i < times; i++)
            await act(i);
        return (loop() - before_) / times;
    };
    let browser;
    const login = await cost(PEOPLE, async (i) => {
        provider.sub = `s${i % (PEOPLE / 16)}`; // one user (sub) may have at most 16 sessions, so several users are needed
        assert.equal((await (browser = new Browser()).signIn()).status, 303);
    });
    const asks = (headers) => cost(REQUESTS, async () => (await fetch(`http://127.0.0.1:${port}/api/v1/me`, { headers })).arrayBuffer());
    const cookie = [...browser.jar].map(([name, value]) => `${name}=${value}`).join('; ');
    assert.equal((await browser.me()).name, 'kim');
    const byToken = await asks({ Authorization: `Bearer ${token}` }), byCookie = await asks({ cookie });
    const refreshed = () => provider.asked.filter((what) => what === '/token').length;
    const from = refreshed(), began = loop();
    while (refreshed() < from + PEOPLE)
        await sleep(20);
    const check = (loop() - began) / PEOPLE;
    provider.claims.groups = []; // removes all rights, so that no signed-in user is left for the following tests
    await until('all being revoked', () => provider.live.size === 0);
    t.diagnostic(`a log-in ${login.toFixed(2)} ms of the loop; a request by token ` +
        `${byToken.toFixed(3)}, by cookie ${byCookie.toFixed(3)} ms; a check of rights ${check.toFixed(3)} ms`);
    assert.ok(login < 5, `a sign-in takes ${login} ms of the event loop`);
    assert.ok(byCookie < byToken + 0.5, `a request takes ${byCookie} ms of the event loop by cookie, ${byToken} by token`);
    assert.ok(check < 2, `a check of rights takes ${check} ms of the event loop`);
});

test('failing key requests end no session; signing out during a check leaves no refresh token', {
    skip: skip || long, timeout: 120000,
}, async (t) => {
    t.after(() => { Object.assign(provider, { keysStatus: 200, delay_ms: 0 }); });
    const browser = new Browser();
    await browser.signIn();
    await sleep(10500); // waits 10.5 s, because the daemon requests the provider's keys again at most every 10 s
    provider.keysStatus = 503;
    provider.rotate();
    await plant.daemon.line(/openid: http.*keys.*stay signed in/);
    await sleep(3000);
    assert.equal((await browser.me()).role, 'operator');
    provider.keysStatus = 200;
    await sleep(12000);
    assert.equal((await browser.me()).role, 'operator');
    provider.delay_ms = 1500;
    const asked = provider.asked.length;
    await until('a check', () => provider.asked.length > asked);
    await sleep(300);
    await browser.at('/logout', { method: 'POST' });
    await until('all being revoked', () => provider.live.size === 0);
});

test('a user who leaves all pages idle is signed out, after a notice', {
    skip: skip || (existsSync(process.env.CHROMIUM ?? '/usr/bin/chromium') ? false : 'chromium is not installed'), timeout: 120000,
}, async (t) => {
    writeFileSync(path('notice'), 'This system is for authorised people of the works only.\nWhat you do is recorded.\n');
    const LOCK_MS = 6000;
    await start('--lock-after', String(LOCK_MS / 60000), '--notice', path('notice'));
    t.after(() => start());
    const { page, close } = await openPage(`http://127.0.0.1:${port}/?lang=en`, { viewport: { width: 1000, height: 700 } });
    try {
        await page.locator('#token .sign-in').waitFor();
        assert.match(await page.locator('#token .notice').textContent(), /authorised people/);
        await shoot(page, 'sign-in-notice');
        await page.locator('#token .sign-in').click();
        const began = performance.now();
        let moves = 0, isThere = false;
        const picture = waitForPicture(page).then(() => { isThere = true; });
        await until('activity for longer than the lock time', async () => {
            await page.mouse.move(400 + ++moves % 100, 300);
            return isThere && performance.now() - began > LOCK_MS + 2000;
        });
        await picture;
        assert.equal(await page.locator('#token').evaluate((dialog) => dialog.open), false);
        await page.locator('#token .sign-in').waitFor(); // no more mouse moves: the page must now sign the user out
        assert.equal(await page.locator('.stage').evaluate((stage) => getComputedStyle(stage).visibility), 'hidden');
        await shoot(page, 'locked');
        await page.reload();
        await page.locator('#token .sign-in').waitFor();
        await recorded('the lock', (line) => line.event === 'leave' && line.why === 'the user was inactive for the time of --lock-after');
        await page.locator('#token .sign-in').click();
        await waitForPicture(page);
    } finally {
        await close();
    }
});

test('a user signs in on the page, sees the own name, and signs out', {
    skip: skip || (existsSync(process.env.CHROMIUM ?? '/usr/bin/chromium') ? false : 'chromium is not installed'), timeout: 120000,
}, async () => {
    for (const [language, theme] of sweep([['en', 'light'], ['de', 'dark'], ['ko', 'light']], [['de', 'dark']])) {
        const { page, close } = await openPage(`http://127.0.0.1:${port}/?lang=${language}&theme=${theme}#tag=TI-1`,
            { viewport: { width: 1000, height: 700 } });
        try {
            const button = page.locator('#token .sign-in');
            await button.waitFor();
            assert.match(await button.textContent(), /Works/);
            await shoot(page, `sign-in-${language}-${theme}`);
            await button.click();
            await waitForPicture(page);
            assert.match(page.url(), new RegExp(`lang=${language}.*#.*tag=TI-1`));
            await page.locator('#account-open').evaluate((element) => element.click());
            await page.locator('#account .who').waitFor();
            assert.match(await page.locator('#account .who').textContent(), /^kim /);
            await shoot(page, `account-${language}-${theme}`);
            await page.locator('#account-out').click();
            await page.locator('#token .sign-in').waitFor();
        } finally {
            await close();
        }
    }
});

test('with the independent provider oidc-provider, code flow, token refresh and sign-out work', { skip, timeout: 120000 }, async (t) => {
    const { default: Provider } = await import('oidc-provider').catch(() => ({ default: null }));
    if (!Provider)
        return t.skip('oidc-provider is not installed');
    const its = await freePort(), issuer = `http://127.0.0.1:${its}`;
    let groups = ['operators'], gone = false;
    const oidc = new Provider(issuer, {
        clients: [{ client_id: 'plant', client_secret: 'geheim +', redirect_uris: [`http://127.0.0.1:${port}/login/callback`],
            grant_types: ['authorization_code', 'refresh_token'], post_logout_redirect_uris: [`http://127.0.0.1:${port}/`] }],
        claims: { openid: ['sub'], profile: ['preferred_username', 'groups'] },
        scopes: ['openid', 'profile', 'offline_access'],
        pkce: { required: () => true, methods: ['S256'] },
        issueRefreshToken: async () => true,
        features: { revocation: { enabled: true }, userinfo: { enabled: true } },
        findAccount: async (ctx, id) => gone ? undefined :
            { accountId: id, claims: async () => ({ sub: id, preferred_username: id, groups }) },
    });
    const server = createServer(oidc.callback());
    await new Promise((done) => server.listen(its, '127.0.0.1', done));
    writeConfig('', issuer);
    await start();
    try {
        const browser = new Browser();
        let url = new URL((await browser.at('/login')).headers.get('location'));
        // follows oidc-provider's built-in pages, log-in and then consent, until it redirects back to the daemon
        for (let i = 0; i < 12 && url.port !== String(port); i++) {
            const page = await browser.get(url);
            const next = page.headers.get('location');
            if (next) {
                url = new URL(next, url);
                continue;
            }
            const html = await page.text(), [, action] = /action="([^"]+)"/.exec(html);
            const form = new URLSearchParams({ prompt: /name="prompt" value="(\w+)"/.exec(html)[1], login: 'lee', password: 'x' });
            const answer = await browser.get(new URL(action, url), { method: 'POST', body: form });
            url = new URL(answer.headers.get('location'), url);
        }
        const back = await browser.get(url);
        assert.equal(back.status, 303, await back.text());
        const me = await browser.me();
        assert.deepEqual([me.name, me.role], ['lee', 'operator']);
        groups = ['lookers'];
        await browser.has('viewer');
        gone = true;
        await browser.has('nobody');
    } finally {
        server.closeAllConnections();
        server.close();
    }
});

test('with Debian\'s Glewlwyd, code flow and changing and ending groups work', {
    skip: skip || (glewlwydIsThere ? false : 'glewlwyd is not installed'), timeout: 120000,
}, async (t) => {
    const glewlwyd = new Glewlwyd();
    t.after(() => glewlwyd.stop());
    // Glewlwyd does not decode the secret in HTTP Basic (RFC 6749, 2.3.1), so it needs one that is the same when encoded
    writeFileSync(path('secret'), 'geheim\n');
    await glewlwyd.start(`http://127.0.0.1:${port}/login/callback`);
    writeConfig('scope: openid\n', glewlwyd.issuer);
    await start();
    const browser = new Browser(), its = `http://127.0.0.1:${glewlwyd.port}/api`, headers = { 'Content-Type': 'application/json' };
    const body = JSON.stringify({ username: 'lee', password: 'pass word 1' });
    assert.equal((await browser.get(`${its}/auth/`, { method: 'POST', headers, body })).status, 200);
    const granted = JSON.stringify({ scope: 'openid' });
    assert.equal((await browser.get(`${its}/auth/grant/plant`, { method: 'PUT', headers, body: granted })).status, 200);
    // Acts like its login page after the user has logged in and agreed.
    const there = await browser.get(`${(await browser.at('/login')).headers.get('location')}&g_continue`);
    assert.match(there.headers.get('location'), /\/login\/callback\?/);
    const back = await browser.get(there.headers.get('location'));
    assert.equal(back.status, 303, await back.text());
    assert.equal((await browser.me()).name, 'lee');
    await browser.has('operator');
    await glewlwyd.ask('PUT', 'user/lee', glewlwyd.person({ 'user-code': 'lookers' }));
    await browser.has('viewer');
    // takes the user out of all groups with rights; disabling the user would not do, because Glewlwyd renews tokens even of
    // disabled users
    await glewlwyd.ask('PUT', 'user/lee', glewlwyd.person({ 'user-code': 'cleaners' }));
    await browser.has('nobody');
});
