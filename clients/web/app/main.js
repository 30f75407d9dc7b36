// SPDX-License-Identifier: GPL-3.0-or-later
// Assembles the page: one session, the viewport, and the panels around it.
import { watchSleep } from './common/clock.js';
import { byId, phone, setText, styled } from './common/dom.js';
import { address, connection, narrow, page, probeCodecs, session, viewport } from './startup.js';
import { listenToInput } from './input/input.js';
import { renewIfOld, serveInstalled } from './install.js';
import { Legend } from './viewport/legend.js';
import { Overlay } from './viewport/overlay.js';
import { onPixelRatio } from './viewport/pixel_ratio.js';
import { LazyModules } from './lazy_modules.js';
import { Status } from './toolbar/status.js';
import { AlarmBar } from './alarms/alarm_bar.js';
import { Tools } from './toolbar/tools.js';
import { Toolbar } from './toolbar/toolbar.js';

const ADDRESS_WAIT_MS = 400, TOAST_MS = 6000;
const WATCH_AFTER_MS = 5000; // delay in milliseconds before the watchdog is loaded, so that the first picture comes first
// Number of pictures after which the page tests for H.264. H.264 encodes only differences between pictures, so it saves data only with many
// pictures.
const MANY_PICTURES = 30;
// names of the commands (input/commands.js) that main.js passes to modules loaded on first use
const COMMANDS = ['selectTag', 'showTag', 'flyToTag', 'fitView', 'selectAsset', 'showTrend', 'addTrend', 'showAsset',
    'makeRoom'];

const selection = { tag: address.tag, hover: null };
const modules = new LazyModules(page, tell);
const does = (name) => (...given) => modules.use('commands', (commands) => commands[name](...given));
new Toolbar({ session, does });
const rightOf = (params) => params.split && { ...params, ...params.split };
// Returns true if both halves of a split view have the same legend, so that one legend is enough.
const isShared = (params, right) => right && legend.contents(params) === legend.contents(right, 1);
const legend = new Legend({ session, element: byId('legend'), lying: page.lying,
    paramsOf: (params) => !isShared(params, rightOf(params)) && params });
new Legend({ session, element: byId('legend-right'), lying: page.lying, paramsOf: rightOf, half: 1 });
const overlay = new Overlay({ canvas: byId('overlay'), viewport, session, selection });
overlay.unit = page.unit;
overlay.onRings = () => modules.prepare('callouts');
const alarmBar = new AlarmBar({ session, refresh });
const status = new Status({ session, onFreshness: (fresh) => {
    overlay.fresh = fresh;
    alarmBar.setFresh(fresh);
    refresh();
} });
new Tools({ session });
Object.assign(page, { selection, overlay, modules, saveAddress, refresh, tell });
page.onTell?.(tell);
for (const name of COMMANDS)
    page[name] = does(name);
page.onUnit = () => {
    overlay.unit = page.unit;
    refresh();
};

// --- selection

function refresh() {
    overlay.dirty = true;
    viewport.invalidate();
}

const BUTTONS = { fit: 'fit', home: 'home', measure: 'measure', snapshot: 'snapshot', theme: 'theme', hold: 'hold', 'share-open': 'share',
    'help-open': 'help', 'account-open': 'account', 'time-toggle': 'past', 'alarm-strip': 'alarms', 'views-toggle': 'views',
    'picture-toggle': 'picture', 'engineer-toggle': 'engineer', 'import-toggle': 'import', 'assets-toggle': 'assets',
    'split-toggle': 'split', 'display-toggle': 'display', 'more-toggle': 'more' };
for (const [id, name] of Object.entries(BUTTONS))
    byId(id).addEventListener('click', does(name));

// Stores the pointer's position for commands.js, and passes it on once that module is loaded.
function point(place) {
    page.pointed = place;
    modules.there('commands')?.point(place);
}

page.handlers = {
    click: does('click'), point, command: (name) => does(name)(),
    group: does('group'),
};
listenToInput(byId('viewport'), modules);
// Unlike a mouse, a finger gives no warning before its first touch, so the camera controller is loaded after the first picture.
if (window.matchMedia('(pointer: coarse)').matches)
    session.on('frame', () => modules.prepare('cameraController'));

// --- the picture, and the markers, cards and labels drawn over it

let pictures = 0;
viewport.onTick = (now) => modules.there('cameraController')?.tick(now);
viewport.onDrawn = (newPicture, isWarped) => {
    if (newPicture) {
        byId('waiting').hidden = true;
        byId('viewport').classList.toggle('split', Boolean(session.shown.split));
        if (++pictures === MANY_PICTURES)
            probeCodecs();
    }
    if (newPicture && (session.picture.past || status.past))
        status.show(); // updates the status bar together with the picture, because its texts about the past must match the picture
    if (newPicture || isWarped || overlay.dirty) {
        for (const name of ['card', 'place', 'measure', 'clipGizmo', 'notes'])
            modules.there(name)?.show();
        overlay.draw();
    }
};
new ResizeObserver(refresh).observe(byId('viewport'));
onPixelRatio(() => {
    viewport.measure();
    refresh();
});
// when the toolbar's parts or the panels of picture settings or views open or close, repositions the sensor labels, so that
// they move aside
for (const id of ['display', 'more', 'picture-panel', 'views'])
    new MutationObserver(refresh).observe(byId(id), { attributeFilter: ['class'] });
// updates the sensor's card twice a second, because it shows the age of the value
setInterval(() => modules.there('card')?.tag && refresh(), 500);

for (const name of ['tags', 'alarms', 'proofs'])
    session.on(name, refresh);
session.on('alarms', async () => {
    const { raised } = session.model.alarms;
    if (raised.length > 0 && !document.body.classList.contains('wall'))
        (await modules.get('announcer')).take(raised);
});
session.on('time', () => {
    byId('time-toggle').hidden = !session.recorded;
    if (session.time.atUs !== null)
        modules.get('timeline');
    saveAddress();
    status.show();
    refresh();
});
session.on('params', async () => {
    const { params } = session;
    saveAddress();
    refresh();
    if ([params.hidden, params.isolate, params.ghost].some((ids) => ids?.length > 0))
        modules.get('shown');
    if (params.split)
        modules.get('split');
    for (const half of [params, params.split ?? {}]) {
        if (half.isolines?.length > 0 || session.model?.group(half.group)?.directed)
            modules.get('isolines');
        if (['difference', 'uncertainty', 'blind'].includes(half.show))
            modules.get('coverage');
    }
    // loads the clip gizmo (handles of section planes) if section planes cut the plant; a video wall needs no handles, because
    // nobody operates it
    if (params.clip && !document.body.classList.contains('wall') && await modules.get('clipGizmo'))
        refresh();
});
let moved = false;
session.on('camera', () => {
    moved = true;
    saveAddress();
    viewport.invalidate();
});
session.on('welcome', () => {
    renewIfOld();
    modules.retryNow();
    byId('engineer-toggle').hidden = session.role !== 'engineer';
    byId('import-toggle').hidden = !session.imports;
    if (session.imports && pictures === 0)
        modules.get('import');
    document.body.classList.toggle('looker', session.role === 'open');
    byId('time-toggle').hidden = true; // the history button stays hidden until the server says that it records history
    status.show();
    arrive();
    if (selection.tag)
        modules.get('card');
    if (session.model.plant.outside)
        modules.get('outside');
    viewport.invalidate();
});
session.on('status', ({ unrecorded = [] }) => {
    status.show();
    if (unrecorded.length > 0 || modules.there('unrecorded'))
        modules.use('unrecorded', (part) => part.show(unrecorded));
});
// Clears the page and asks for a token, after the server denied access or locked the session for inactivity.
session.on('denied', ({ code }) => {
    document.body.classList.add('denied');
    modules.use('token', (token) => token.ask(code));
});
session.on('welcome', () => document.body.classList.remove('denied'));
for (const event of ['pointerdown', 'pointermove', 'wheel', 'keydown', 'touchstart'])
    window.addEventListener(event, () => { session.connection.activeAt = Date.now(); }, { capture: true, passive: true });
session.on('notes', () => (session.notes.length > 0 || modules.there('notes')) && bring('notes'));
session.on('pointed', () => bring('notes'));
session.on('followers', () => modules.get('share'));
session.on('following', () => session.leader !== null && modules.get('following'));
session.on('ignored', (what) => console.warn(`ignored: ${what}`));

// Loads the panel of views, and then a module shown inside it.
async function bring(name) {
    await modules.get('views');
    modules.get(name);
}

// Opens the saved view named in the URL, or takes parameters from it, once the server has sent the list of views.
let fields = new URLSearchParams(location.hash.slice(1));
session.named = fields.get('named');
session.on('views', () => {
    for (const [name, call] of [['view', 'openNamed'], ['named', 'regain']]) {
        const id = fields.get(name);
        if (id)
            modules.use('views', (views) => views[call](id));
    }
    fields = new URLSearchParams();
});

// Shows what is named in the link that opened the page. Reports parts of the link, or of the previous view, that this plant
// does not have.
let arrived = false, astray = [];
session.on('astray', (message) => astray.push(message));
function arrive() {
    const link = arrived ? null : address, refused = astray;
    if (refused.length > 0 || (!arrived && location.hash.length > 1))
        modules.use('arrival', (arrival) => arrival.come(link, refused));
    arrived = true;
    astray = [];
}

let toastTimer;
session.on('error', async ({ text, about, code, refusal }) => {
    console.warn(`error about ${about}: ${text}`);
    if (['ack', 'share_view'].includes(about))
        // no message for two kinds of requests: acknowledgements, which the user does not cause, and short links, without which
        // the share dialog shows the long link
        return;
    const { put, refusalText } = await import('../core/refusals.js');
    tell(put('page.refused', { text: refusalText(text, refusal, code) }));
});

// Reports that an action took effect, but that the server could not write it to its disk, or not completely.
session.on('unkept', async ({ not_kept: count, why, refusal, unaudited, unaudited_refusal: missing }) => {
    const { put, refusalText } = await import('../core/refusals.js');
    tell(count ? put('page.unkept', { text: refusalText(why, refusal) })
        : put('page.unaudited', { text: refusalText(unaudited, missing) }), 5 * TOAST_MS);
});

function tell(text, ms = TOAST_MS) {
    setText(byId('toast'), text);
    byId('toast').hidden = false;
    clearTimeout(toastTimer);
    toastTimer = setTimeout(() => { byId('toast').hidden = true; }, ms);
}

// --- the page

// Returns true if the user has changed nothing since the page opened, so that the URL stays unchanged.
const isUntouched = () => !location.hash && session.paramsSeq <= 1 && !moved && !selection.tag && session.time.atUs === null;

let addressTimer, addressTries = 0;
function saveAddress() {
    if (isUntouched())
        return;
    clearTimeout(addressTimer);
    addressTimer = setTimeout(async () => {
        if (session.leader !== null)
            return; // leaves the URL unchanged, because it names the session to follow
        // browsers may remember a failed fetch of a URL forever, so each try after one has another URL
        const module = await import(`../core/address.js${addressTries > 0 ? `?again=${addressTries}` : ''}`).catch(() => null);
        addressTries += module ? 0 : 1;
        if (module) // else the server is away: the next change of the view tries again
            history.replaceState(null, '', location.pathname + location.search + module.addressOf(session, selection.tag));
    }, ADDRESS_WAIT_MS);
}

window.addEventListener('hashchange', () => location.reload());
window.addEventListener('online', () => connection.retryNow());
document.addEventListener('visibilitychange', () => {
    session.setVisible(!document.hidden);
    if (!document.hidden) {
        connection.retryNow();
        refresh();
    }
});
watchSleep(() => {
    connection.doubt();
    connection.retryNow();
    status.show();
});
// Loads the style sheet for forced colours and for more contrast if the system asks for either.
for (const query of ['(forced-colors: active)', '(prefers-contrast: more)'].map((text) => window.matchMedia(text))) {
    const wear = () => query.matches && styled('common/contrast').catch(() => {});
    query.addEventListener('change', wear);
    wear();
}
serveInstalled();
// Loads the button that shows the plant on a VR headset, if the browser supports headsets and one is connected now or later.
const offerVr = () => navigator.xr?.isSessionSupported('immersive-vr').then((yes) => yes && modules.prepare('enterVr'), () => {});
navigator.xr?.addEventListener('devicechange', offerVr);
offerVr();
// Loads the watchdog of the main thread; retries later if the server does not answer.
const watch = () => setTimeout(() => import('./common/watchdog.js').then(({ watchMainThread }) => watchMainThread(
    { scale: () => page.unit, reloads: document.body.classList.contains('wall') && parent === window })).catch(watch), WATCH_AFTER_MS);
// no watchdog in a pane (iframe) of a video wall's page: both pages run in the same main thread, which the wall's page watches
if (!new URLSearchParams(location.search).has('pane'))
    watch();
// Opens the equipment list at the start if the window has room for it.
const showAssets = () => !narrow.matches && !document.body.classList.contains('wall') && modules.get('assets');
narrow.addEventListener('change', showAssets);
showAssets();
const useSheets = () => phone.matches && !document.body.classList.contains('wall') && import('./common/sheet.js').catch(console.warn);
phone.addEventListener('change', useSheets);
useSheets();
session.listen();
refresh();

// Global object with the page's parts, for the browser's console and for end-to-end tests.
globalThis.plantcast = { ...page, legend, get cameraController() { return modules.there('cameraController'); },
    get trends() { return modules.there('trends'); }, get assets() { return modules.there('assets'); } };
