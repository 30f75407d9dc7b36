// SPDX-License-Identifier: GPL-3.0-or-later
// Finds out why no WebSocket opens although the same server delivered the page. Usually a proxy in between does not forward
// WebSockets; the message then names the proxy and the settings that it needs.
import { put } from './refusals.js';
import { say } from './words.js';

const ANSWER_MS = 5000;
const NGINX = 'proxy_http_version 1.1; proxy_set_header Upgrade $http_upgrade; proxy_set_header Connection "upgrade";';

// Returns the name of a proxy from the headers of an HTTP answer. Our own server sends none of these headers.
const proxyOf = (headers) => headers.get('server')?.split(/[/ ]/)[0] || /^\S+ ([^ ,]+)/.exec(headers.get('via') ?? '')?.[1] || '';

// Returns the reason why the WebSocket at `url` does not open; '' if the server does not answer over HTTP either.
async function whyBlocked(url) {
    const address = new URL(url.replace(/^ws/, 'http'));
    address.search = '?why'; // ?why tells the server not to log this HTTP request as a failed WebSocket
    const answer = await fetch(address, { cache: 'no-store', signal: AbortSignal.timeout(ANSWER_MS) });
    if (answer.status >= 500)
        return '';
    const refused = answer.status === 426 ? /^refused: (.+)$/m.exec(await answer.text())?.[1] : null;
    if (refused) // the server itself answered and says why it refused the WebSocket, so no proxy blocks it
        return refused;
    const proxy = proxyOf(answer.headers), isNginx = /nginx|openresty/i.test(proxy);
    const needs = isNginx ? put('page.blocked_lines', { lines: NGINX }) : put('page.blocked_page');
    return put('page.blocked', { proxy: proxy || put('page.blocked_proxy'), needs });
}

// Finds out over HTTP why the WebSocket does not open, and stores the reason in connection.blocked.
export async function explain(connection) {
    const tried = connection.unopened;
    connection.blocked = await whyBlocked(connection.url).catch(() => '');
    if (connection.unopened !== tried || connection.state !== 'waiting')
        return;
    connection.reason = connection.blocked || say('reason.unreachable');
    connection.become('waiting');
}
