// SPDX-License-Identifier: GPL-3.0-or-later
// Creates connection, session and viewport: everything that the first picture needs. main.js loads the rest in the meantime.
import { Connection } from '../core/connection.js';
import { browserDecoding } from '../core/decoding.js';
import { Session } from '../core/session.js';
import { language } from '../core/words.js';
import { clock } from './common/clock.js';
import { byId, phone, sayAll, styled } from './common/dom.js';
import { stored } from './common/storage.js';
import { chooseTheme } from './common/theme.js';
import { Viewport } from './viewport/viewport.js';

const query = new URLSearchParams(location.search);
// if `wall` in the URL is the id of a video wall, not a size in inches and metres, opens that wall's page
if (query.has('wall') && !/^[\d.,]*$/.test(query.get('wall'))) {
    location.replace(`wall.html${location.search}`);
    await new Promise(() => {}); // never resolves, because the browser is leaving for that page
}
export const page = { unit: 1, onUnit: () => {} };

// sets language, texts and style sheets first, because they affect the size of the picture that is then requested
document.documentElement.lang = language;
sayAll(document);
const backdrop = chooseTheme(query);
export const narrow = window.matchMedia('(max-width: 1023px)'); // true on narrow screens, where the equipment list covers the picture
// touch screens load the style sheet for narrow screens at the start, because the server may be unreachable when the user turns
// the device
const turned = window.matchMedia('(any-pointer: coarse)');
const fold = () => Promise.all([(narrow.matches || turned.matches) && styled('common/narrow'), phone.matches && !query.has('wall') &&
    styled('common/sheet')])
    .catch(() => {});
for (const screen of [narrow, phone])
    screen.addEventListener('change', fold);
document.querySelector('.stage').classList.toggle('without-assets', narrow.matches);
await fold();
if (query.has('wall'))
    await (await import('./wall/wall.js')).hangOnWall(location.search, page);

const short = location.hash.startsWith('#v=') ? await (await import('./sharing/short_link.js')).openShort() : {};
const named = location.hash.length > 1 ? (await import('../core/address.js')).readAddress(location.hash) : {};
export const address = { camera: null, params: {}, tag: null, time: {}, ...named, ...short };

// JPEG can be shown immediately. Whether the browser decodes H.264 is tested only after some pictures (main.js), unless the URL asks for
// H.264.
const wantedCodec = query.get('codec') ?? 'auto';
const decoding = browserDecoding();
const codecs = () => decoding.codecs.filter((name) => name !== 'auto' || wantedCodec === 'auto');
if (wantedCodec === 'h264')
    await decoding.probe();
let isProven = wantedCodec !== 'auto';
export async function probeCodecs() {
    if (isProven)
        return;
    isProven = true;
    await decoding.probe();
    if (codecs().length > session.codecs.length)
        session.setCodecs(codecs());
}

const streamUrl = new URL('stream', location.href.replace(/^http/, 'ws').replace(/#.*$/, '')).href;
export const connection = new Connection({ url: streamUrl, open: (url, protocol) => new WebSocket(url, protocol), clock });
connection.onUnopened = () => import('../core/blocked.js').then(({ explain }) => explain(connection), () => {});
const wanted = { ...address, params: { ...address.params, backdrop } };
export const session = new Session({ connection, now: clock.now, wanted, codecs: codecs() });
session.wantsDepth = !query.has('wall') && 'WebGL2RenderingContext' in globalThis;
session.token = stored('token');
session.leader = Number(new URLSearchParams(location.hash.slice(1)).get('follow')) || null;
// After a reload, followers find this session again, because it resumes with its secret. The secret is stored only between two
// pages, so that two tabs never share it.
session.resume = sessionStorage.getItem('resume');
session.anew = session.resume !== null;
sessionStorage.removeItem('resume');
addEventListener('pagehide', () => session.resume && sessionStorage.setItem('resume', session.resume));
session.legendLies = () => (query.has('wall') ? null : phone.matches);
session.wait();
export const viewport = new Viewport({ element: byId('viewport'), canvas: byId('picture'), session, decoding });
viewport.onDrawn = (newPicture) => {
    if (newPicture)
        byId('waiting').hidden = true;
};
session.on('hello', () => viewport.forget());
session.on('welcome', fold); // retries after a failed fetch
connection.start();
Object.assign(page, { session, viewport, decoding });
