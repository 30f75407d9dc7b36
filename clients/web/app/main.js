// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the page together: one session, the viewport, and the panels around it.
import { readAddress, writeAddress } from '../core/address.js';
import { face } from '../core/camera.js';
import { Connection } from '../core/connection.js';
import { browserDecoding } from '../core/decoding.js';
import { Session } from '../core/session.js';
import { readWall } from '../core/wall.js';
import { language, say } from '../core/words.js';
import { AlarmPanel } from './alarms.js';
import { Assets } from './assets.js';
import { Card } from './card.js';
import { clock, watchSleep } from './clock.js';
import { byId, sayAll, setText } from './dom.js';
import { renewIfOld, serveInstalled } from './install.js';
import { Legend } from './legend.js';
import { Overlay } from './overlay.js';
import { Picture } from './picture.js';
import { Pilot } from './pilot.js';
import { Place } from './place.js';
import { Status } from './status.js';
import { TimingsPanel } from './timings.js';
import { TokenDialog } from './token.js';
import { Timeline } from './timeline.js';
import { chooseTheme, Tools } from './tools.js';
import { Toolbar } from './toolbar.js';
import { Trends } from './trends.js';
import { Views } from './views.js';
import { Viewport } from './viewport.js';

const ADDRESS_WAIT_MS = 400, TOAST_MS = 6000;
const ARRIVAL_MARGIN = 1.7; // around one piece of equipment
const TAG_DISTANCE_M = 5;

document.documentElement.lang = language;
sayAll(document);
chooseTheme(location.search);

const address = readAddress(location.hash);
const selection = { tag: address.tag, hover: null };
const wall = readWall(location.search);

const streamUrl = new URL('stream', location.href.replace(/^http/, 'ws').replace(/#.*$/, '')).href;
const connection = new Connection({ url: streamUrl, open: (url, protocol) => new WebSocket(url, protocol), clock });
const decoding = browserDecoding();
const wantedCodec = new URLSearchParams(location.search).get('codec') ?? 'auto'; // jpeg, h264, or as the server chooses
if (wantedCodec !== 'jpeg')
    await decoding.prove();
const codecs = decoding.codecs.filter((name) => name !== 'auto' || wantedCodec === 'auto');
const session = new Session({ connection, now: clock.now, wanted: address, codecs });

new TokenDialog({ session });
const assets = new Assets({ session, selection });
const picture = new Picture({ session, selection });
const toolbar = new Toolbar({ session, showParams: (show) => picture.showParams(show) });
const legend = new Legend({ session, element: byId('legend') });
new Legend({ session, element: byId('legend-right'), paramsOf: (params) => params.split && { ...params, ...params.split } });
const viewport = new Viewport({ element: byId('viewport'), canvas: byId('picture'), session, decoding });
const overlay = new Overlay({ canvas: byId('overlay'), viewport, session, selection });
const pilot = new Pilot({ viewport, session });
const status = new Status({ session, onFreshness: (fresh) => { overlay.fresh = fresh; refresh(); } });
const timeline = new Timeline({ session });
const trends = new Trends({ session });
const card = new Card({ session, selection, overlay, viewport, onClose: () => selectTag(null), onTrend: (tag) => trends.add(tag) });

const timings = new TimingsPanel({ session });
const views = new Views({ session, pilot });
const place = new Place({ session, viewport });
const tools = new Tools({ session, selection, viewport, tell });
const alarms = new AlarmPanel({ session, onFly: (tag) => { showTag(tag); flyToTag(tag); }, refresh: () => refresh() });

// --- selection

function refresh() {
    overlay.dirty = true;
    viewport.invalidate();
}

function selectTag(tag) {
    selection.tag = tag?.name ?? null;
    selection.hover = null;
    if (tag)
        trends.follow(tag);
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
        pilot.flyTo(face(session.camera, tag.position, asset.bounds, TAG_DISTANCE_M));
}

function selectAsset(asset) {
    const again = session.params.selected === asset.id;
    if (!again)
        session.setParams({ selected: asset.id });
    pilot.flyToBox(asset.bounds, ARRIVAL_MARGIN);
}

function clearSelection() {
    if (selection.tag)
        selectTag(null);
    else if (session.params.selected)
        session.setParams({ selected: null });
}

// --- commands

function fitView() {
    const chosen = session.model?.asset(session.params.selected);
    if (session.model)
        pilot.flyToBox(chosen ? chosen.bounds : session.model.plant.bounds, chosen ? ARRIVAL_MARGIN : undefined);
}

const commands = {
    fit: fitView,
    home: () => session.model && pilot.flyHome(),
    help: async () => (await import('./help.js')).openHelp(),
    timings: () => timings.toggle(),
    alarms: () => alarms.toggle(),
    past: () => session.recorded && timeline.setOpen(!timeline.open),
    live: () => session.time.atUs !== null && session.travel(null),
    assets: () => assets.setOpen(!assets.open),
    search: () => assets.openSearch(),
    top: () => views.lookFrom('top'),
    corner: () => views.lookFrom('iso'),
    projection: () => views.toggleProjection(),
    views: () => views.toggle(),
    picture: () => byId('picture-toggle').click(),
    hide: () => views.show('hide'),
    ghost: () => views.show('ghost'),
    only: () => views.show('only'),
    showAll: () => views.showAll(),
    hold: () => tools.hold(),
    measure: () => tools.measure(),
    snapshot: () => tools.snapshot(),
    share: () => tools.share(),
    theme: () => tools.theme(),
    escape() {
        toolbar.closeDisplay();
        views.close();
        picture.close();
        if (alarms.open)
            alarms.setOpen(false);
        else if (tools.measuring?.on)
            tools.measuring.setOn(false);
        else if (place.picked)
            place.close();
        else
            clearSelection();
    },
};
pilot.onCommand = (name) => commands[name]();
pilot.onGroup = (index) => toolbar.chooseGroup(index);
let engineer = null; // made when it is first opened
async function openEngineer() {
    if (!engineer) {
        const { Engineer } = await import('./engineer.js');
        engineer = engineer ?? new Engineer({ session, viewport, overlay, selection, selectTag, showTag, refresh });
    }
    engineer.toggle();
}
byId('engineer-toggle').addEventListener('click', openEngineer);

let grips = null; // of what is cut away; made when something is
session.on('params', async () => {
    if (!session.params.clip || wall || grips)
        return;
    const { Grips } = await import('./grips.js');
    grips ??= new Grips({ session, viewport });
    refresh();
});
session.on('proofs', refresh);

pilot.onClick = (x, y, kind) => {
    if (engineer?.takesClick(x, y))
        return;
    if (tools.measuring?.on) {
        tools.measuring.click(x, y);
        return;
    }
    const tag = overlay.at(x, y, kind);
    selectTag(tag);
    if (tag)
        place.close();
    else
        place.open(x, y);
};
place.onSelect = (asset) => session.setParams({ selected: asset.id });
place.onShow = (how, asset) => {
    views.show(how, asset.id);
    place.close();
};
pilot.onPoint = (place) => {
    const tag = place ? overlay.at(place.x, place.y, 'mouse') : null;
    byId('viewport').classList.toggle('pointing', tag !== null);
    if (tag !== selection.hover) {
        selection.hover = tag;
        refresh();
    }
};
assets.onAsset = selectAsset;
assets.onTag = showTag;
byId('fit').addEventListener('click', fitView);
byId('home').addEventListener('click', commands.home);
byId('help-open').addEventListener('click', commands.help);
byId('help').addEventListener('click', (event) => event.target === event.currentTarget && byId('help').close());

// --- the picture and what lies over it

viewport.onTick = (now) => pilot.tick(now);
viewport.onDrawn = (newPicture) => {
    if (newPicture)
        byId('waiting').hidden = true;
    if (newPicture && (session.picture.past || status.past))
        status.show(); // what it shows and what is said of it change together
    if (newPicture || overlay.dirty) {
        card.show();
        place.show();
        tools.measuring?.show();
        grips?.show();
        overlay.draw();
    }
};
new ResizeObserver(refresh).observe(byId('viewport'));
setInterval(() => card.tag && refresh(), 500); // its age goes on

session.on('tags', refresh);
session.on('alarms', refresh);
session.on('time', () => {
    saveAddress();
    status.show();
    refresh();
});
session.on('params', () => {
    byId('viewport').classList.toggle('split', Boolean(session.params.split));
    saveAddress();
    refresh();
});
session.on('camera', () => {
    saveAddress();
    viewport.invalidate();
});
session.on('welcome', () => {
    byId('engineer-toggle').hidden = session.role !== 'engineer';
    viewport.forget();
    status.show();
    arrive();
    viewport.invalidate();
});
session.on('status', () => status.show());
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

// A link that names equipment or a tag but no camera opens there.
let arrived = false;
function arrive() {
    if (arrived)
        return;
    arrived = true;
    const tag = session.model.tag(selection.tag), asset = session.model.asset(session.params.selected);
    if (address.camera)
        return;
    if (tag) {
        if (tag.group && tag.group !== session.params.group)
            session.setParams({ group: tag.group });
        flyToTag(tag);
    } else if (asset) {
        pilot.flyToBox(asset.bounds, ARRIVAL_MARGIN);
    }
}

let toastTimer;
session.on('error', ({ text, about }) => {
    console.warn(`error about ${about}: ${text}`);
    if (about === 'ack')
        return; // nothing that a person did
    tell(say('viewport.refused', { text }));
});

function tell(text) {
    setText(byId('toast'), text);
    byId('toast').hidden = false;
    clearTimeout(toastTimer);
    toastTimer = setTimeout(() => { byId('toast').hidden = true; }, TOAST_MS);
}

// --- the page

let addressTimer;
function saveAddress() {
    clearTimeout(addressTimer);
    addressTimer = setTimeout(() => {
        if (session.leader !== null)
            return; // the link says whom to follow
        const { camera, params, time, ownParams: own } = session;
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
session.leader = Number(new URLSearchParams(location.hash.slice(1)).get('follow')) || null;
if (wall)
    (await import('./wall.js')).hangOnWall(wall, { overlay, refresh });
watchSleep(() => {
    connection.doubt();
    connection.retryNow();
    status.show();
});
renewIfOld(session);
serveInstalled();
connection.start();

// For the console and for tests of the whole.
globalThis.plantcast = { session, selection, overlay, legend, decoding, trends, pilot, assets };
