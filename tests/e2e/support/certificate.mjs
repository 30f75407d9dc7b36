// SPDX-License-Identifier: GPL-3.0-or-later
// Self-signed certificates.
import { spawnSync } from 'node:child_process';
import { isIP } from 'node:net';
import { join } from 'node:path';

const EC = ['ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1'];

// Makes FOLDER/NAME.pem and FOLDER/NAME.key, valid for 30 days. hosts: host names and addresses of the certificate; the first is
// its common name. key: type of the private key, as arguments of `openssl req -newkey`.
export function makeCertificate(folder, name, hosts = ['localhost', '127.0.0.1'], key = EC) {
    const { status, stderr } = spawnSync('openssl', ['req', '-x509', '-newkey', ...key, '-nodes',
        '-keyout', join(folder, `${name}.key`), '-out', join(folder, `${name}.pem`), '-days', '30', '-subj', `/CN=${hosts[0]}`,
        '-addext', `subjectAltName=${hosts.map((host) => `${isIP(host) ? 'IP' : 'DNS'}:${host}`)}`]);
    if (status !== 0)
        throw new Error(String(stderr));
}
