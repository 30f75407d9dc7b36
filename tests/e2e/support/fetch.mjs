// SPDX-License-Identifier: GPL-3.0-or-later
// Makes each fetch() use a connection of its own. A connection that node keeps for reuse may have been closed by the server
// meanwhile, because it was idle or its daemon ended. A test that was busy waiting for another program does not notice, and its
// next request on that connection would fail.
const { fetch } = globalThis;

globalThis.fetch = (url, options = {}) => fetch(url, { ...options, headers: { Connection: 'close', ...options.headers } });
