// SPDX-License-Identifier: GPL-3.0-or-later
// An OpenID Connect identity provider on this machine that does what a test tells it, including what a provider must not do.
import { createHash, createSign, generateKeyPairSync, randomUUID } from 'node:crypto';
import { createServer } from 'node:http';
import { freePort } from './ports.mjs';

const encode = (value) => Buffer.from(typeof value === 'string' ? value : JSON.stringify(value)).toString('base64url');

export class IdentityProvider {
    constructor() {
        this.sub = 's1';
        this.claims = { preferred_username: 'kim', groups: ['operators'] }; // claims of the ID tokens issued from now on
        // a test may set change(claims, header), which is called to modify each ID token's content before it is signed
        this.change = () => {};
        this.sign = null;       // sign(text): makes the signature of ID tokens instead of the right one; null: signs rightly
        this.refreshes = true;  // true: issues refresh tokens and accepts them
        this.status = 200;      // HTTP status of refresh requests
        this.delay_ms = 0;      // delay of the token endpoint
        this.codesWait = null;  // a promise; until it is fulfilled, authorization codes get no answer; null: they are answered at once
        this.keysStatus = 200;
        this.fault = null;      // [status, JSON] that the token endpoint always answers; null: normal answers
        this.live = new Map();  // valid refresh tokens and their users
        this.codes = new Map();
        this.asked = [];
        this.rotate();
    }

    // Replaces the signing key. keep: the earlier public keys stay published with the new one; otherwise only the new one is.
    rotate(keep = false) {
        const { privateKey, publicKey } = generateKeyPairSync('rsa', { modulusLength: 2048 });
        this.kid = randomUUID();
        this.key = privateKey;
        this.keys = [...(keep ? this.keys : []), { ...publicKey.export({ format: 'jwk' }), kid: this.kid, use: 'sig', alg: 'RS256' }];
    }

    idToken(nonce, sub) {
        const now = Math.floor(Date.now() / 1000), header = { alg: 'RS256', kid: this.kid, typ: 'JWT' };
        const times = { iat: now, exp: now + 300, ...(nonce ? { nonce } : {}) };
        const claims = { iss: this.issuer, aud: 'plant', sub, ...times, ...this.claims };
        this.change(claims, header);
        const text = `${encode(header)}.${encode(claims)}`;
        const signature = this.sign ? this.sign(text) : createSign('RSA-SHA256').update(text).sign(this.key).toString('base64url');
        return `${text}.${signature}`;
    }

    // Performs a login. Returns the URL to which the browser is redirected.
    login(url) {
        const { searchParams: asked } = new URL(url), code = randomUUID(), back = new URL(asked.get('redirect_uri'));
        this.codes.set(code, { challenge: asked.get('code_challenge'), nonce: asked.get('nonce'),
            method: asked.get('code_challenge_method') });
        back.searchParams.set('code', code);
        back.searchParams.set('state', asked.get('state'));
        return back;
    }

    token(form, authorization) {
        if (this.fault)
            return this.fault;
        if (Buffer.from(authorization?.split(' ')[1] ?? '', 'base64').toString() !== 'plant:geheim%20%2B')
            return [401, { error: 'invalid_client' }];
        const given = randomUUID();
        const tokens = (nonce, sub = this.sub) => {
            if (this.refreshes)
                this.live.set(given, sub);
            return { access_token: 'at', token_type: 'Bearer', expires_in: 3600, id_token: this.idToken(nonce, sub),
                ...(this.refreshes ? { refresh_token: given } : {}) };
        };
        if (form.get('grant_type') === 'refresh_token') {
            const sub = this.live.get(form.get('refresh_token'));
            this.live.delete(form.get('refresh_token'));
            return this.status === 200 ? [200, tokens(null, sub)] : [this.status, { error: 'invalid_grant' }];
        }
        const code = this.codes.get(form.get('code'));
        const challenge = createHash('sha256').update(form.get('code_verifier') ?? '').digest('base64url');
        this.codes.delete(form.get('code'));
        if (!code || code.method !== 'S256' || challenge !== code.challenge)
            return [400, { error: 'invalid_grant' }];
        return [200, tokens(code.nonce)];
    }

    answer(path, form, authorization) {
        const at = (name) => `${this.issuer}/${name}`;
        if (path === '/.well-known/openid-configuration')
            return [200, { issuer: this.issuer, authorization_endpoint: at('auth'), token_endpoint: at('token'), jwks_uri: at('jwks'),
                end_session_endpoint: at('end'), revocation_endpoint: at('revoke'), ...this.metadata }];
        if (path === '/jwks')
            return [this.keysStatus, { keys: this.keys }];
        if (path === '/token')
            return this.token(form, authorization);
        if (path === '/revoke')
            this.live.delete(form.get('token'));
        return path === '/revoke' ? [200, {}] : [404, {}];
    }

    // Starts the provider. port: null: one that stays reserved for this provider while it is down.
    async listen(port = null) {
        const own = port ?? await freePort();
        this.server = createServer((request, response) => {
            let body = '';
            request.on('data', (chunk) => { body += chunk; });
            request.on('end', () => {
                this.asked.push(request.url);
                const { pathname, searchParams } = new URL(request.url, this.issuer);
                const login = pathname === '/auth' ? this.login(`${this.issuer}${request.url}`).href : null;
                const to = login ?? searchParams.get('post_logout_redirect_uri');
                if (to) {
                    response.writeHead(302, { Location: to }).end();
                    return;
                }
                const [status, json] = this.answer(request.url, new URLSearchParams(body), request.headers.authorization);
                const say = () => response.writeHead(status, { 'Content-Type': 'application/json' }).end(JSON.stringify(json));
                // if the client closes before the answer arrives, it does not have the new refresh token: makes that token
                // invalid
                response.once('close', () => {
                    if (!response.writableFinished)
                        this.live.delete(json.refresh_token);
                });
                const isCode = new URLSearchParams(body).get('grant_type') === 'authorization_code';
                Promise.resolve(isCode && this.codesWait).then(() => setTimeout(say, request.url === '/token' ? this.delay_ms : 0));
            });
        });
        return new Promise((done) => this.server.listen(own, '127.0.0.1', () => {
            this.port = this.server.address().port;
            this.issuer = `http://127.0.0.1:${this.port}`;
            done();
        }));
    }

    close() {
        this.server.closeAllConnections();
        return new Promise((done) => this.server.close(done));
    }
}
