// SPDX-License-Identifier: GPL-3.0-or-later
// Gives each fetch() of a test its own connection. The server closes idle connections, and a daemon that ends closes its own; a
// test that was waiting for another program has not noticed this yet, and its next request on such a connection would fail.
const { fetch } = globalThis;

globalThis.fetch = (url, options = {}) => fetch(url, { ...options, headers: { Connection: 'close', ...options.headers } });
