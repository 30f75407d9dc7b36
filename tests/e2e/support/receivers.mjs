// SPDX-License-Identifier: GPL-3.0-or-later
// Receivers of alarm notifications: a mail server with TLS and an HTTP server, on loopback, which can hang, refuse and
// disappear.
import { once } from 'node:events';
import { readFileSync } from 'node:fs';
import { createServer as createHttpServer } from 'node:http';
import { createServer } from 'node:net';
import { join } from 'node:path';
import { createSecureContext, TLSSocket } from 'node:tls';
import { freePort } from './ports.mjs';

// A mail server that implements only the part of RFC 5321 that one message needs. mode: 'take', 'hang' (never answers),
// 'refuse' (550 to every recipient), 'busy' (451), 'content' (550 to every text), 'later' (451 to every text).
// starttls true: TLS starts on request, and no mail is accepted before; false: TLS from the first byte.
export class MailServer {
    constructor(folder, { starttls = false, user = null, password = null } = {}) {
        Object.assign(this, { starttls, user, password, mode: 'take', mails: [], tried: 0, sockets: new Set() });
        this.context = createSecureContext({ key: readFileSync(join(folder, 'mail.key')), cert: readFileSync(join(folder, 'mail.pem')) });
    }

    // port: default: one that stays reserved while the server is away
    async listen(port = null) {
        this.server = createServer((socket) => this.serve(socket));
        this.server.listen(port ?? await freePort(), '127.0.0.1');
        await once(this.server, 'listening');
        this.port = this.server.address().port;
    }

    async close() {
        this.server.close();
        for (const socket of this.sockets)
            socket.destroy();
        await once(this.server, 'close');
    }

    serve(raw) {
        this.tried++;
        this.sockets.add(raw);
        raw.on('close', () => this.sockets.delete(raw));
        raw.on('error', () => {});
        if (this.mode === 'hang')
            return;
        if (this.starttls)
            this.talk(raw, false);
        else
            this.talk(this.secure(raw), true);
    }

    secure(raw) {
        const socket = new TLSSocket(raw, { isServer: true, secureContext: this.context });
        socket.on('error', () => {});
        return socket;
    }

    talk(socket, isSecure, greets = true) {
        const mail = { to: [], secure: isSecure, user: null }, say = (line) => socket.write(`${line}\r\n`);
        let text = '', inData = false, inAuth = false;
        const logIn = (base64) => {
            const [, user, password] = Buffer.from(base64, 'base64').toString().split('\0');
            inAuth = false;
            mail.user = user;
            say(user === this.user && password === this.password ? '235 welcome' : '535 who are you');
        };
        const command = (line) => {
            if (inAuth)
                return logIn(line);
            const verb = line.split(/[ :]/)[0].toUpperCase();
            if (verb === 'EHLO')
                return say(['250-mail.test', ...(isSecure ? [] : ['250-STARTTLS']), '250-AUTH PLAIN', '250 8BITMIME'].join('\r\n'));
            if (verb === 'STARTTLS') {
                say('220 go on');
                socket.removeAllListeners('data');
                return this.talk(this.secure(socket), true, false);
            }
            if (!isSecure && verb !== 'QUIT')
                return say('530 STARTTLS first');
            if (verb === 'AUTH' && !line.split(' ')[2]) {
                inAuth = true;
                return say('334 ');
            }
            if (verb === 'AUTH')
                return logIn(line.split(' ')[2]);
            if (verb === 'MAIL' && this.user && mail.user !== this.user)
                return say('530 log in first');
            if (verb === 'MAIL')
                mail.from = line;
            if (verb === 'RCPT' && ['refuse', 'busy'].includes(this.mode))
                return say(this.mode === 'refuse' ? '550 no such mailbox' : '451 later');
            if (verb === 'RCPT' && line.includes('<gone@'))
                return say('550-5.1.1 this is a reply of two lines:\r\n550 5.1.1 no such mailbox');
            if (verb === 'RCPT')
                mail.to.push(line.replace(/^RCPT TO:<(.*)>.*$/i, '$1'));
            inData = verb === 'DATA';
            return say(inData ? '354 go on' : verb === 'QUIT' ? '221 bye' : '250 ok');
        };
        socket.on('data', (bytes) => {
            text += bytes.toString('latin1');
            for (let end; (end = text.indexOf(inData ? '\r\n.\r\n' : '\r\n')) >= 0;) {
                const part = text.slice(0, end);
                text = text.slice(end + (inData ? 5 : 2));
                if (!inData) {
                    command(part);
                    continue;
                }
                inData = false;
                if (['content', 'later'].includes(this.mode)) {
                    say(this.mode === 'content' ? '550 5.7.1 content refused' : '451 later');
                    continue;
                }
                this.mails.push({ ...mail, ...readMail(part) });
                mail.to = [];
                say('250 taken');
            }
        });
        if (greets)
            say('220 mail.test');
    }
}

function readMail(text) {
    const [head, ...rest] = text.split('\r\n\r\n'), lines = head.replace(/\r\n[ \t]+/g, ' ').split('\r\n');
    const headers = Object.fromEntries(lines.map((line) => [line.split(':')[0].toLowerCase(), line.slice(line.indexOf(':') + 1).trim()]));
    const words = (value) => value.replace(/\?=\s+=\?/g, '?==?').replace(/(?:=\?UTF-8\?B\?([^?]*)\?=)+/g, (all) =>
        Buffer.concat([...all.matchAll(/\?B\?([^?]*)\?=/g)].map(([, part]) => Buffer.from(part, 'base64'))).toString());
    return { headers, subject: words(headers.subject), body: Buffer.from(rest.join(''), 'base64').toString() };
}

// Accepts JSON by POST. status: HTTP status of its answers; 0: it never answers. most: size in bytes of the largest body that it
// accepts; it answers 413 to larger ones.
export class HookServer {
    constructor() {
        Object.assign(this, { posts: [], status: 200, most: Infinity });
    }

    async listen(port = null) {
        this.server = createHttpServer((request, response) => {
            let text = '';
            request.on('data', (bytes) => { text += bytes; });
            request.on('end', () => {
                const { url, headers } = request, status = text.length > this.most ? 413 : this.status;
                this.posts.push({ url, headers, body: JSON.parse(text), status });
                if (status)
                    response.writeHead(status).end('{}');
            });
        });
        this.server.listen(port ?? await freePort(), '127.0.0.1');
        await once(this.server, 'listening');
        this.port = this.server.address().port;
    }

    get taken() {
        return this.posts.filter(({ status }) => status === 200).map(({ body }) => body);
    }

    async close() {
        this.server.closeAllConnections();
        this.server.close();
        await once(this.server, 'close');
    }
}
