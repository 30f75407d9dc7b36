// SPDX-License-Identifier: GPL-3.0-or-later
// Debian's Glewlwyd as an identity provider on this machine, with one client and one user.
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { freePort } from './ports.mjs';
import { until } from './until.mjs';

const SCHEMA = '/usr/share/dbconfig-common/data/glewlwyd/install/sqlite3', MODULES = '/usr/lib/glewlwyd';
export const glewlwydIsThere = existsSync('/usr/bin/glewlwyd') && existsSync(SCHEMA) && existsSync('/usr/bin/sqlite3');

const settings = (port, folder) => `port=${port}
external_url="http://127.0.0.1:${port}"
login_url="login.html"
api_prefix="api"
static_files_path="/usr/share/glewlwyd/webapp/"
log_mode="console"
log_level="WARNING"
cookie_domain="127.0.0.1"
cookie_secure=0
session_key="GLEWLWYD2_SESSION_ID"
admin_scope="g_admin"
profile_scope="g_profile"
user_module_path="${MODULES}/user"
user_middleware_module_path="${folder}"
client_module_path="${MODULES}/client"
user_auth_scheme_module_path="${MODULES}/scheme"
plugin_module_path="${MODULES}/plugin"
use_secure_connection=false
secure_connection_key_file="${folder}/key.pem"
secure_connection_pem_file="${folder}/public.pem"
secure_connection_ca_file="${folder}/public.pem"
hash_algorithm="SHA512"
database = { type = "sqlite3" path = "${folder}/glewlwyd.db" };
`;

export class Glewlwyd {
    async start(redirectUri) {
        this.folder = mkdtempSync(join(tmpdir(), 'plantcast-glewlwyd-'));
        this.port = await freePort();
        this.issuer = `http://127.0.0.1:${this.port}/api/oidc`;
        const at = (name) => join(this.folder, name);
        execFileSync('sqlite3', [at('glewlwyd.db')], { input: readFileSync(SCHEMA) });
        writeFileSync(at('glewlwyd.conf'), settings(this.port, this.folder));
        spawnSync('openssl', ['genrsa', '-out', at('key.pem'), '2048']);
        spawnSync('openssl', ['rsa', '-in', at('key.pem'), '-pubout', '-out', at('public.pem')]);
        this.child = spawn('glewlwyd', ['-c', at('glewlwyd.conf')], { stdio: 'ignore' });
        await this.logIn();
        const claim = (name, property) => ({ name, 'user-property': property, type: 'string', mandatory: true, 'on-demand': false,
            scope: [] });
        await this.ask('POST', 'mod/plugin/', { module: 'oidc', name: 'oidc', display_name: 'OIDC', enabled: true, parameters: {
            iss: this.issuer, 'jwt-type': 'rsa', 'jwt-key-size': '256', key: readFileSync(at('key.pem'), 'utf8'),
            cert: readFileSync(at('public.pem'), 'utf8'), 'access-token-duration': 3600, 'refresh-token-duration': 86400,
            'code-duration': 600, 'refresh-token-rolling': true, 'refresh-token-one-use': 'never', 'allow-non-oidc': false,
            'auth-type-code-enabled': true, 'auth-type-code-revoke-replayed': true, 'auth-type-token-enabled': false,
            'auth-type-id-token-enabled': false, 'auth-type-none-enabled': false, 'auth-type-password-enabled': false,
            'auth-type-client-enabled': false, 'auth-type-device-enabled': false, 'auth-type-refresh-enabled': true, scope: [],
            'additional-parameters': [], claims: [claim('groups', 'user-code'), claim('preferred_username', 'username')],
            'jwks-show': true, 'request-parameter-allow': false, 'subject-type': 'public', 'name-claim': 'no', 'email-claim': 'no',
            'pkce-allowed': true, 'pkce-method-plain-allowed': false, 'pkce-required': true, 'introspection-revocation-allowed': true,
            'introspection-revocation-auth-scope': [], 'introspection-revocation-allow-target-client': true,
        } });
        await this.ask('POST', 'client/', { client_id: 'plant', name: 'plant', enabled: true, confidential: true,
            client_secret: 'geheim', redirect_uri: [redirectUri], authorization_type: ['code', 'refresh_token'], scope: ['openid'],
            token_endpoint_auth_method: ['client_secret_basic'] });
        await this.ask('POST', 'user/', this.person({}));
    }

    // The property `user-code` is one of the few that users have by default; here it holds the groups.
    person(more) {
        const lee = { username: 'lee', name: 'Lee', password: 'pass word 1', enabled: true, scope: ['openid'] };
        return { ...lee, 'user-code': 'operators', ...more };
    }

    async logIn() {
        const body = JSON.stringify({ username: 'admin', password: 'password' });
        this.cookie = await until('glewlwyd', async () => {
            const answer = await fetch(`http://127.0.0.1:${this.port}/api/auth/`, { method: 'POST', body,
                headers: { 'Content-Type': 'application/json' } }).catch(() => null);
            return answer?.ok && answer.headers.getSetCookie()[0].split(';')[0];
        });
    }

    async ask(method, path, json) {
        const answer = await fetch(`http://127.0.0.1:${this.port}/api/${path}`, { method, body: JSON.stringify(json),
            headers: { 'Content-Type': 'application/json', Cookie: this.cookie } });
        if (!answer.ok)
            throw new Error(`glewlwyd ${method} ${path}: ${answer.status} ${await answer.text()}`);
    }

    async stop() {
        if (this.child?.exitCode === null && this.child.signalCode === null) {
            const ended = new Promise((done) => this.child.once('exit', done));
            this.child.kill('SIGKILL');
            await ended;
        }
        if (this.folder)
            rmSync(this.folder, { recursive: true, force: true });
    }
}
