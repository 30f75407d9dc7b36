// SPDX-License-Identifier: GPL-3.0-or-later
// Access control of OPC UA: user names and passwords, and certificates of client and server that the other side does not trust.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { shareOpcua } from './server.mjs';
import { makeCertificate, opcuaOptions } from '../support/opcua.mjs';
import { runProgram } from '../support/tiny_plant.mjs';

const options = opcuaOptions(400000);
const ROWS = ['TI-1,nsu=urn:test:plant%3B1;s=TI-1,,°C,temperature,E-101,0.5,0,0,,,,,,'];
const good = { quality_name: 'Good' };
let server, plant;

shareOpcua(options, (...made) => { [server, plant] = made; });
const until = (...args) => plant.until(...args);
const said = (...args) => plant.said(...args);
const start = (keys, rows = ROWS) => plant.start(keys, rows);
const at = (file) => join(server.folder, file);
const browse = (...more) => runProgram('plantcast', ['tags', '--browse', `opc.tcp://127.0.0.1:${server.port}`,
    '--certificate', at('client.crt'), '--key', at('client.key'), '--trusted', at('trusted'), ...more], 60000);

test('users sign in by password or certificate, and refusals name the reason', options, async () => {
    await server.restart({ anonymous: false });
    const login = join(server.folder, 'login');
    writeFileSync(login, 'reader\nsaid & done\n');
    await plant.run(`${server.security(', policy: Basic256Sha256')}, login: ${login}`, ROWS);
    await until('TI-1', good);
    assert.match(browse('--login', login).out, /^Plant\.TI-1,/m);
    assert.match(browse().err, /does not accept anonymous users/);
    writeFileSync(login, 'reader\nwrong\n');
    await plant.daemon.stop();
    await start(`${server.security()}, login: ${login}`);
    await said(/no readings \(Bad(IdentityTokenRejected|UserAccessDenied)/);
    await plant.daemon.stop();
    makeCertificate(server.folder, 'user', { ownKey: true });
    await plant.run(server.security(`, user_certificate: ${at('user.crt')}, user_key: ${at('user.key')}`), ROWS);
    await until('TI-1', good);
    await plant.daemon.stop();
    await start(server.security());
    await said(/no readings \(the OPC UA server does not accept anonymous users/);
    await plant.daemon.stop();
    await start('security: none');
    await said(/no readings \(/);
});

test('invalid certificates are refused by name, the server\'s and ours', options, async () => {
    const folder = server.folder;
    makeCertificate(folder, 'old', { dates: ['20200101000000Z', '20200201000000Z'] });
    makeCertificate(folder, 'elsewhere', { hosts: 'DNS:other.example' });
    makeCertificate(folder, 'stranger', { ownKey: true });
    const cases = [['server', ['stranger'], /BadCertificateUntrusted: the server's certificate/],
        ['old', ['old'], /BadCertificateTimeInvalid: the server's certificate: certificate has expired/],
        ['elsewhere', ['elsewhere'], /BadCertificateHostNameInvalid: the OPC UA server's certificate is not for 127\.0\.0\.1/]];
    for (const [certificate, trusted, pattern] of cases) {
        await server.restart({ certificate });
        server.trust(...trusted);
        await start(server.security());
        await said(pattern);
        assert.equal((await server.tell({})).sessions, 0);
        await plant.daemon.stop();
    }
    await plant.run(server.security(', server_name: other.example'), ROWS);
    await plant.daemon.stop();
    assert.equal(browse().code, 1);
    assert.match(browse('--server-name', 'other.example').out, /^Plant\.TI-1,/m);
    server.trust('server');
    await server.restart({ trustsAll: false });
    await start(server.security('', 'stranger'));
    await said(/no readings \((Bad\w+|the OPC UA server does not answer)/);
    await plant.daemon.stop();
    await start(server.security('', 'nothing'));
    await said(/no readings \(.*nothing\.crt cannot be read/);
});
