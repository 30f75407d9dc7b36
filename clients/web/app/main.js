// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the page together: one session, the viewport, and the panels around it.
import { say } from '../core/words.js';
import { Assets } from './assets.js';
import { watchSleep } from './clock.js';
import { byId, setText } from './dom.js';
import { address, connection, page, proveCodecs, session, viewport } from './first.js';
import { listenToHands } from './hands.js';
import { renewIfOld, serveInstalled } from './install.js';
import { Legend } from './legend.js';
import { Overlay } from './overlay.js';
import { Parts } from './parts.js';
import { Status } from './status.js';
import { AlarmStrip } from './strip.js';
import { changeTheme } from './theme.js';
import { Tools } from './tools.js';
import { Toolbar } from './toolbar.js';

const ADDRESS_WAIT_MS = 400, TOAST_MS = 6000;
const ARRIVAL_MARGIN = 1.7; // around one piece of equipment

const selection = { tag: address.tag, hover: null };
const parts = new Parts(page, tell);
const assets = new Assets({ session, selection });
const toolbar = new Toolbar({ session, selection });
const legend = new Legend({ session, element: byId('legend') });
new Legend({ session, element: byId('legend-right'), paramsOf: (params) => params.split && { ...params, ...params.split } });
const overlay = new Overlay({ canvas: byId('overlay'), viewport, session, selection });
overlay.unit = page.unit;
const status = new Status({ session, onFreshness: (fresh) => { overlay.fresh = fresh; refresh(); } });
const tools = new Tools({ session });
new AlarmStrip({ session, refresh });
Object.assign(page, { selection, overlay, assets, parts, selectTag, showTag, flyToTag, fitView, refresh, tell });
page.onUnit = () => {
    overlay.unit = page.unit;
    refresh();
};

// --- selection

function refresh() {
    overlay.dirty = true;
    viewport.invalidate();
}

function selectTag(tag) {
    selection.tag = tag?.name ?? null;
    selection.hover = null;
    if (tag) {
        parts.there('trends')?.follow(tag);
        parts.get('card');
    }
    assets.mark();
    saveAddress();
    refresh();
}

function showTag(tag) {
    if (tag.group && tag.group !== session.params.group)
        session.setParams({ group: tag.group });
    selectTag(tag);
    if (!overlay.marker(tag) || overlay.marker(tag).occluded)
        flyToTag(tag);
}

function flyToTag(tag) {
    const asset = session.model.asset(tag.asset);
    if (tag.position && asset)
        parts.use('pilot', (pilot) => pilot.flyToTag(tag, asset));
}

function selectAsset(asset) {
    const again = session.params.selected === asset.id;
    if (!again)
        session.setParams({ selected: asset.id });
    flyToAsset(asset);
}

const flyToAsset = ({ bounds }) => parts.use('pilot', (pilot) => pilot.flyToBox(bounds, ARRIVAL_MARGIN));

function clearSelection() {
    if (selection.tag)
        selectTag(null);
    else if (session.params.selected)
        session.setParams({ selected: null });
}

// --- commands

function fitView() {
    const chosen = session.model?.asset(session.params.selected);
    if (chosen)
        flyToAsset(chosen);
    else if (session.model)
        parts.use('pilot', (pilot) => pilot.flyToBox(session.model.plant.bounds));
}

const opens = (name) => (event) => parts.use(name, (part) => part.toggle(event), 'toggle');
const ofViews = (f) => () => parts.use('views', f);

const commands = {
    fit: fitView,
    home: () => session.model && parts.use('pilot', (pilot) => pilot.flyHome()),
    help: () => parts.use('help', (help) => help.open()),
    timings: opens('timings'),
    alarms: opens('alarms'),
    past: () => session.recorded && opens('timeline')(),
    live: () => session.time.atUs !== null && session.travel(null),
    assets: () => assets.setOpen(!assets.open),
    search: () => assets.openSearch(),
    top: ofViews((views) => views.lookFrom('top')),
    corner: ofViews((views) => views.lookFrom('iso')),
    projection: ofViews((views) => views.toggleProjection()),
    views: opens('views'),
    picture: opens('picture'),
    hide: ofViews((views) => views.show('hide')),
    ghost: ofViews((views) => views.show('ghost')),
    only: ofViews((views) => views.show('only')),
    showAll: ofViews((views) => views.showAll()),
    hold: () => tools.hold(),
    measure: opens('measure'),
    snapshot: () => parts.use('snapshot', (snapshot) => snapshot.save()),
    share: () => parts.use('share', (share) => share.open()),
    theme: () => session.setParams({ backdrop: changeTheme() }),
    escape() {
        parts.giveUp();
        toolbar.closeDisplay();
        for (const name of ['views', 'picture'])
            parts.there(name)?.close();
        const [alarms, measure, place] = ['alarms', 'measure', 'place'].map((name) => parts.there(name));
        if (alarms?.open)
            alarms.setOpen(false);
        else if (measure?.on)
            measure.setOn(false);
        else if (place?.picked)
            place.close();
        else
            clearSelection();
    },
};
const BUTTONS = { fit: 'fit', home: 'home', measure: 'measure', snapshot: 'snapshot', theme: 'theme', hold: 'hold', 'share-open': 'share',
    'help-open': 'help', 'time-toggle': 'past', 'alarm-strip': 'alarms', 'views-toggle': 'views', 'picture-toggle': 'picture' };
for (const [id, name] of Object.entries(BUTTONS))
    byId(id).addEventListener('click', (event) => commands[name](event));
byId('engineer-toggle').addEventListener('click', opens('engineer'));
// What is cut away is moved by hand, but for a wall.
session.on('params', async () => {
    if (session.params.clip && !document.body.classList.contains('wall') && await parts.get('grips'))
        refresh();
});
session.on('proofs', refresh);

function click(x, y, kind) {
    if (parts.there('engineer')?.takesClick(x, y))
        return;
    if (parts.there('measure')?.on) {
        parts.there('measure').click(x, y);
        return;
    }
    const tag = overlay.at(x, y, kind);
    selectTag(tag);
    if (tag)
        parts.there('place')?.close();
    else
        openPlace(x, y, session.camera);
}

// By another camera something else would be there.
const openPlace = (x, y, camera) => parts.use('place', (place) => camera === session.camera && place.open(x, y));

page.showTrend = (tag) => parts.use('trends', (trends) => trends.add(tag));
page.showAsset = (how, asset) => ofViews((views) => views.show(how, asset.id))();
function point(place) {
    const tag = place ? overlay.at(place.x, place.y, 'mouse') : null;
    byId('viewport').classList.toggle('pointing', tag !== null);
    if (tag !== selection.hover) {
        selection.hover = tag;
        if (tag)
            parts.get('card');
        refresh();
    }
}
page.told = { click, point, command: (name) => commands[name](), group: (index) => toolbar.chooseGroup(index) };
listenToHands(byId('viewport'), parts);
assets.onAsset = selectAsset;
assets.onTag = showTag;
// --- the picture and what lies over it

let proving = null; // once there is a picture
viewport.onTick = (now) => parts.there('pilot')?.tick(now);
viewport.onDrawn = (newPicture) => {
    if (newPicture && !proving) {
        byId('waiting').hidden = true;
        proving = proveCodecs();
    }
    if (newPicture && (session.picture.past || status.past))
        status.show(); // what it shows and what is said of it change together
    if (newPicture || overlay.dirty) {
        for (const name of ['card', 'place', 'measure', 'grips'])
            parts.there(name)?.show();
        overlay.draw();
    }
};
new ResizeObserver(refresh).observe(byId('viewport'));
setInterval(() => parts.there('card')?.tag && refresh(), 500); // its age goes on

session.on('tags', refresh);
session.on('alarms', refresh);
session.on('time', () => {
    byId('time-toggle').hidden = false;
    if (session.time.atUs !== null)
        parts.get('timeline');
    saveAddress();
    status.show();
    refresh();
});
session.on('params', () => {
    byId('viewport').classList.toggle('split', Boolean(session.params.split));
    saveAddress();
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
    parts.retryNow();
    byId('engineer-toggle').hidden = session.role !== 'engineer';
    byId('time-toggle').hidden = true; // until the server says that it records
    status.show();
    arrive();
    if (selection.tag)
        parts.get('card');
    viewport.invalidate();
});
session.on('status', () => status.show());
session.on('denied', ({ code }) => parts.use('token', (token) => token.ask(code)));
// The view of another keeps its shape.
function shape() {
    const { style, classList } = byId('viewport'), { following } = session;
    style.width = style.height = '';
    classList.toggle('following-another', Boolean(following));
    if (!following)
        return;
    const box = byId('viewport').parentElement.getBoundingClientRect(), ratio = following.width / following.height;
    const free = box.right - Math.max(box.left, byId('assets').getBoundingClientRect().right);
    const width = Math.min(free, box.height * ratio);
    style.width = `${width}px`;
    style.height = `${width / ratio}px`;
}
window.addEventListener('resize', shape);
session.on('following', () => {
    shape();
    byId('following').hidden = !session.following;
    setText(byId('following').querySelector('span'), session.following ? say('following.title', session.following) : '');
});
byId('following').querySelector('button').addEventListener('click', () => session.follow(null));
session.on('ignored', (what) => console.warn(`ignored: ${what}`));

// Where a link leads, and what of it, or of the view before, is not in this plant.
let arrived = false, astray = [];
session.on('astray', (text) => astray.push(text));
function arrive() {
    const link = arrived ? null : address, refused = astray;
    if (refused.length > 0 || (!arrived && location.hash.length > 1))
        parts.use('arrival', (arrival) => arrival.come(link, refused));
    arrived = true;
    astray = [];
}

let toastTimer;
session.on('error', async ({ text, about, code }) => {
    console.warn(`error about ${about}: ${text}`);
    if (about === 'ack')
        return; // nothing that a person did
    const { put, refusalText } = await import('../core/refusals.js');
    tell(put('refused', { text: refusalText(text, code) }));
});

function tell(text, ms = TOAST_MS) {
    setText(byId('toast'), text);
    byId('toast').hidden = false;
    clearTimeout(toastTimer);
    toastTimer = setTimeout(() => { byId('toast').hidden = true; }, ms);
}

// --- the page

// Nobody has changed anything since the greeting: the address stays as it came.
const isUntouched = () => !location.hash && session.paramsSeq <= 1 && !moved && !selection.tag && session.time.atUs === null;

let addressTimer;
function saveAddress() {
    if (isUntouched())
        return;
    clearTimeout(addressTimer);
    addressTimer = setTimeout(async () => {
        if (session.leader !== null)
            return; // the link says whom to follow
        const { camera, params, time, ownParams: own } = session;
        const { writeAddress } = await import('../core/address.js');
        const hash = writeAddress({ camera, params, tag: selection.tag, time, own });
        history.replaceState(null, '', location.pathname + location.search + hash);
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
serveInstalled();
session.listen();
refresh();

// For the console and for tests of the whole.
globalThis.plantcast = { ...page, legend, get pilot() { return parts.there('pilot'); }, get trends() { return parts.there('trends'); } };
