// SPDX-License-Identifier: GPL-3.0-or-later
// The page of one display of a video wall: panes (areas with a view, a trend, alarms, ...) in a grid, one session with the
// server for texts and alarms, and a warning when the server is silent.
import { AlarmCall } from '../core/alarm_call.js';
import { Connection } from '../core/connection.js';
import { zoneClock } from '../core/format.js';
import { health } from '../core/health.js';
import { askInTime, loaderOf } from '../core/http.js';
import { Session } from '../core/session.js';
import { brightness, burnShift, millimetresPerPx, SPREAD_MS, wallFit } from '../core/wall.js';
import { language, learnWords, say } from '../core/words.js';
import { asOf } from '../app/alarms/alarm_bar.js';
import { clock, watchSleep } from '../app/common/clock.js';
import { byId, make, setText, setVariable } from '../app/common/dom.js';
import { store, stored } from '../app/common/storage.js';
import { chooseTheme } from '../app/common/theme.js';
import { watchMainThread } from '../app/common/watchdog.js';
import { renewIfOld, serveInstalled } from '../app/install.js';
import { keepScreenOn } from '../app/wall/keep_screen_on.js';
import { areaOf, paneOf } from './panes.js';
import { Pairing } from './pairing.js';
import { tileOf } from './tile.js';

const TICK_MS = 250, LOST_MS = 3000;
// LEAST: minimum size of a display in units of the page (CSS pixels before scaling); LETTERS_MM: height in millimetres of the
// letters of the message that the connection is lost
const LEAST = { width: 560, height: 315 }, LETTERS_MM = 100;
const query = new URLSearchParams(location.search), number = Math.max(1, Number(query.get('display')) || 1);

document.documentElement.lang = language;
chooseTheme(query);
await learnWords();

const pairing = new Pairing({ element: byId('denied'), place: { wall: query.get('wall') ?? '', display: number }, enter(secret) {
    session.token = secret;
    store('token', secret);
    connection.retryNow();
} });
const token = pairing.kept ?? stored('token');
if (token)
    store('token', token); // stores the token for the panes, which are separate pages in iframes
const streamUrl = new URL('stream', location.href.replace(/^http/, 'ws').replace(/[?#].*$/, '')).href;
const connection = new Connection({ url: streamUrl, open: (url, protocol) => new WebSocket(url, protocol), clock });
connection.onUnopened = () => import('../core/blocked.js').then(({ explain }) => explain(connection), () => {});
connection.spreadMs = SPREAD_MS;
const session = new Session({ connection, now: clock.now, codecs: ['jpeg'] });
session.token = token;
session.size = { width: 16, height: 16 }; // requests tiny pictures, because this session needs only alarms and texts
session.on('frame', (frame) => session.drawn(frame, 0));

let wall = null, shape = '', panes = [], scale = 1;
const call = new AlarmCall();

// --- layout

function clear() {
    for (const { close } of panes)
        close?.();
    panes = [];
}

function sayWrong(text) {
    clear();
    byId('grid').replaceChildren(make('p', { class: 'wrong' }, text));
}

// Sets the page's size unit, on which all font sizes depend.
function fit() {
    if (!wall)
        return;
    const { innerWidth: width, innerHeight: height } = window, { inches, distance_m: metres } = wall;
    ({ scale } = wallFit({ inches, metres }, window.screen, { width, height }, LEAST));
    setVariable(document.body, '--unit', `${scale}px`);
    setVariable(document.body, '--scale', scale);
    setVariable(document.body, '--letters', `${Math.min(LETTERS_MM / millimetresPerPx(inches, window.screen), width / 12)}px`);
}

function build(walls) {
    wall = walls.find(({ id }) => id === query.get('wall')) ?? null;
    const display = wall?.displays[number - 1];
    if (!wall)
        return sayWrong(say('walls.unknown', { id: query.get('wall'), known: walls.map(({ id }) => id).join(', ') || say('none') }));
    if (!display)
        return sayWrong(say('walls.display', { n: number, id: wall.id, count: wall.displays.length }));
    const grid = byId('grid'), [theme, lang] = ['theme', 'lang'].map((name) => query.get(name));
    const context = { session, call, wall, display: number, theme, lang, streamUrl };
    clear();
    document.body.classList.toggle('tiled', display.panes.some(({ tile }) => tile));
    fit();
    grid.style.gridTemplateAreas = display.grid.map((row) => `"${row.trim().split(/ +/).map(areaOf).join(' ')}"`).join(' ');
    grid.style.gridTemplateRows = display.grid.map(() => 'minmax(0, 1fr)').join(' ');
    grid.style.gridTemplateColumns = display.grid[0].trim().split(/ +/).map(() => 'minmax(0, 1fr)').join(' ');
    panes = display.panes.map((pane) => (pane.tile ? tileOf(pane, context) : paneOf(pane, context)));
    grid.replaceChildren(...panes.map(({ element }) => element));
    return undefined;
}

// Tells the server which display of the wall this page is.
const sayWho = () => wall?.displays[number - 1] && !session.model?.plant.only &&
    session.post({ type: 'display', wall: wall.id, display: number });

const look = loaderOf(session, () => askInTime('api/v1/walls', {}, session.token), (answer, error) => {
    const now = JSON.stringify(answer?.walls);
    if (error && !shape)
        sayWrong(error.message);
    else if (!error && now !== shape) {
        build(answer.walls);
        shape = now;
    }
    sayWho();
});

// --- periodic work

// OPENED: time of day when the page was opened, by the display's own clock
const lostWords = make('p'), lostSelf = make('p', { class: 'self' }), OPENED = new Date().toLocaleTimeString('en-GB');
byId('lost').replaceChildren(lostWords, lostSelf);

// Covers a pane that an error has stopped, so that nobody takes its contents for current ones. error null: uncovers the pane.
function showError({ element }, error) {
    element.querySelector(':scope > .failure')?.remove();
    if (error)
        element.append(make('p', { class: 'failure' }, say('walls.failed')));
}

// Updates a pane. An error in one pane must not stop the other panes; reports an error once.
function tickPane(pane, now) {
    const before = pane.error ?? null;
    try {
        pane.tick(now);
        pane.error = null;
    } catch (error) {
        const text = String(error); // not empty, unlike error.message
        if (pane.error !== text)
            console.error(error);
        pane.error = text;
    }
    if (pane.error !== before)
        showError(pane, pane.error);
}

let lostAt = null;
function tick() {
    const now = clock.now(), { kind } = health(session, now), { model } = session;
    const gone = kind === 'lost' || kind === 'silent';
    lostAt = gone ? lostAt ?? now : null;
    byId('lost').hidden = lostAt === null || now - lostAt < LOST_MS || !byId('denied').hidden;
    const heard = model && session.freshAt !== null;
    if (!byId('lost').hidden) {
        setText(lostWords, heard ? say('walls.lost', { time: asOf(session) }) : say('walls.never'));
        setText(lostSelf, heard ? '' : say('walls.self', { wall: query.get('wall'), display: number, time: OPENED }));
    }
    if (!model)
        return;
    const [x, y] = burnShift(session.clockUs());
    setVariable(document.body, '--shift-x', `${x}px`);
    setVariable(document.body, '--shift-y', `${y}px`);
    if (gone)
        return;
    for (const pane of panes)
        tickPane(pane, now);
    if (wall) {
        const [hours, minutes] = zoneClock(model.plant.time_zone)(session.clockUs() / 1000).time.split(':').map(Number);
        const calls = model.alarms.list().some(({ waiting }) => waiting);
        setVariable(document.body, '--light', brightness(wall.dim, hours * 60 + minutes, calls));
    }
}

setInterval(tick, TICK_MS);
window.addEventListener('resize', fit);
session.on('welcome', () => {
    pairing.hide();
    renewIfOld('renewedWall');
    look();
});

// --- access, and waking up

session.on('denied', () => {
    session.token = null;
    store('token', '');
    clear();
    byId('grid').replaceChildren();
    pairing.show();
    shape = '';
});

watchSleep(() => {
    connection.doubt();
    connection.retryNow();
});
window.addEventListener('online', () => connection.retryNow());
keepScreenOn();
serveInstalled();
watchMainThread({ scale: () => scale, reloads: parent === window }).catch(console.warn);
connection.start();
// global object with the page's parts, for the browser's console and for tests
globalThis.wall = { session, call, get panes() { return panes; } };
