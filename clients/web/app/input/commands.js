// SPDX-License-Identifier: GPL-3.0-or-later
// Commands triggered by clicks, keys and buttons: selecting, flying to the selection, and opening parts of the page. Loaded on
// first use.
import { nearestMarker } from '../../core/nearest.js';
import { travel } from '../../core/requests.js';
import { byId, phone } from '../common/dom.js';
import { store } from '../common/storage.js';
import { wear } from '../common/theme.js';
import { hasRoom } from '../cards/card_position.js';
import { bandsOf } from '../toolbar/toolbar.js';

// factor on the camera's distance from an asset at the end of a flight to it, so that the picture has a margin around the asset
const ARRIVAL_MARGIN = 1.7;
const REACH_PX = { mouse: 14, pen: 18, touch: 26 };
const HELD_US = 3.5e6;      // age in microseconds up to which a shown instant counts as the present

// Returns the tags of the shown group from which the page can show distances along the surface: tags with a position, on an
// asset whose distances plantcast-prep has computed. If the group has `singles: whole` (a single sensor colours its whole
// asset), there are no distances on assets with one sensor of the group.
export function sensorsOf({ model, params }) {
    const all = model.tags.filter(({ group, asset, position }) => group === params.group && asset && position);
    if (model.group(params.group)?.singles !== 'whole')
        return all;
    const counts = new Map();
    for (const { asset } of all)
        counts.set(asset, (counts.get(asset) ?? 0) + 1);
    return all.filter(({ asset }) => counts.get(asset) > 1);
}

export class Commands {
    constructor(page) {
        Object.assign(this, commandsOf(page));
        this.point(page.pointed ?? null);
    }
}

// Toggles the theme and returns it.
function changeTheme() {
    const theme = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    store('theme', theme);
    return wear(theme);
}

// Returns all commands by name: those called by the page, and those triggered by keys (core/keys.js).
function commandsOf({ session, viewport, modules, selection, overlay, saveAddress, refresh }) {
    function selectTag(tag) {
        selection.tag = tag?.name ?? null;
        selection.hover = null;
        modules.there('place')?.end(); // a late answer about a clicked point must not replace this selection
        if (tag) {
            modules.get('card');
        }
        modules.there('assets')?.mark();
        modules.there('engineer')?.onSelection();
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
            modules.use('cameraController', (cameraController) => cameraController.flyToTag(tag, asset));
    }

    function selectAsset(asset) {
        modules.there('place')?.end();
        const again = session.params.selected === asset.id;
        if (!again)
            session.setParams({ selected: asset.id });
        flyToAsset(asset);
    }

    const flyToAsset = ({ bounds }) => modules.use('cameraController', (controller) => controller.flyToBox(bounds, ARRIVAL_MARGIN));

    function clearSelection() {
        if (selection.tag)
            selectTag(null);
        else if (session.params.selected)
            session.setParams({ selected: null });
    }

    function fitView() {
        const chosen = session.model?.asset(session.params.selected);
        if (chosen)
            flyToAsset(chosen);
        else if (session.model)
            modules.use('cameraController', (cameraController) => cameraController.flyToBox(session.model.plant.bounds));
    }

    const opens = (name) => (event) => modules.use(name, (part) => part.toggle(event), 'toggle');

    // On a phone, closes the panels that would cover the alarm list or the equipment list.
    function closeSheetsBut(name) {
        const parts = ['alarms', 'assets', 'engineer', 'import', 'place', 'views', 'picture', 'trends'].filter((one) => one !== name)
            .map((one) => modules.there(one)).filter((part) => part && part.open !== false);
        parts.forEach((part) => (part.close ? part.close() : part.setOpen(false)));
        modules.there('toolbarOverflow')?.display.set(false);
        selectTag(null);
    }

    // Opens or closes a list. On a phone, an open list that another panel covers is shown instead of closed.
    const opensList = (name) => () => modules.use(name, (list) => {
        const opens = !list.open || !byId(name).checkVisibility();
        if (opens && phone.matches)
            closeSheetsBut(name);
        if (opens !== list.open)
            list.setOpen(opens);
    }, 'toggle');
    const ofViews = (f) => () => modules.use('views', f);

    const tagAt = (x, y, kind) =>
        nearestMarker(overlay.markers, x / overlay.unit, y / overlay.unit, REACH_PX[kind] ?? REACH_PX.mouse)?.tag ?? null;

    function click(x, y, kind) {
        if (modules.there('engineer')?.takesClick(x, y))
            return;
        if (modules.there('measure')?.on) {
            modules.there('measure').click(x, y);
            return;
        }
        const tag = tagAt(x, y, kind);
        selectTag(tag);
        if (!tag) {
            openPlace(x, y, session.camera);
            return;
        }
        modules.there('place')?.close();
        makeRoom();
    }

    // Closes the panels below the toolbar, but not those in `kept`.
    function closePanels(kept = []) {
        for (const one of ['display', 'more'])
            modules.there('toolbarOverflow')?.[one].set(false);
        for (const name of ['views', 'picture'].filter((one) => !kept.includes(one)))
            modules.there(name)?.close();
    }

    // Closes the panels if they leave no room for the card of a sensor or point that the user has pressed. On a phone, panels are sheets,
    // which cover the card's sheet. The panel of views stays open while a note is written in it: the press chooses the note's place.
    function makeRoom() {
        if (phone.matches || !hasRoom(viewport))
            closePanels(modules.there('notes')?.isWriting ? ['views'] : []);
    }

    // Opens the card of a clicked point, unless the camera has moved since the click: another point is under the pointer then.
    const openPlace = (x, y, camera) => modules.use('place', (place) => camera === session.camera && place.open(x, y));

    function point(place) {
        const tag = place ? tagAt(place.x, place.y, 'mouse') : null;
        byId('viewport').classList.toggle('pointing', tag !== null);
        if (tag !== selection.hover) {
            selection.hover = tag;
            if (tag)
                modules.get('card');
            refresh();
        }
    }

    // Returns the picture parameters for showing values of the kind `show` (value, distance, difference, ...). A distance also
    // needs a sensor: the selected one, else the first of the group. A difference needs a baseline (saved readings); if there
    // is none, the present readings become the baseline.
    function showParams(show) {
        const { model, params } = session;
        const chosen = [selection.tag, params.sensor].map((name) => model.tag(name)).find((tag) => tag?.group === params.group);
        const sensor = chosen ?? sensorsOf(session)[0];
        if (show === 'distance')
            return sensor ? { show, sensor: sensor.name } : {};
        return show === 'difference' && !params.baseline ? { show, baseline: 'now' } : { show };
    }

    function rampParams(value) {
        const breaks = value === 'chosen' ? session.params.breaks : bandsOf(session)[value];
        return breaks ? { breaks, ramp_interval: 0 } : { ramp_interval: Number(value), breaks: null };
    }

    function group(index) {
        const chosen = session.model?.groups[index];
        if (chosen && chosen.id !== session.params.group)
            session.setParams({ group: chosen.id });
    }

    return {
        selectTag, showTag, flyToTag, selectAsset, fitView, click, makeRoom, point, group,
        show: (value) => session.setParams(showParams(value)),
        ramp: (value) => session.setParams(rampParams(value)),
        showTrend: (tag) => modules.use('trends', (trends) => trends.only(tag)),
        addTrend: (tag) => modules.use('trends', (trends) => trends.add(tag)),
        showAsset: (how, asset) => modules.use('views', (views) => views.show(how, asset.id)),
        engineer: opens('engineer'),
        import: opens('import'),
        fit: fitView,
        back: () => modules.there('cameraController')?.goBack(),
        home: () => session.model && modules.use('cameraController', (cameraController) => cameraController.flyHome()),
        account: () => modules.use('account', (account) => account.open()),
        help: () => modules.use('help', (help) => help.open()),
        timings: opens('timings'),
        alarms: opensList('alarms'),
        past: () => session.recorded && opens('timeline')(),
        live: () => session.time.atUs !== null && travel(session, null),
        assets: opensList('assets'),
        search: () => modules.use('assets', (assets) => {
            if (phone.matches)
                closeSheetsBut('assets');
            assets.setOpen(true);
            assets.search.focus();
            assets.search.select();
        }),
        top: ofViews((views) => views.lookFrom('top')),
        corner: ofViews((views) => views.lookFrom('iso')),
        projection: ofViews((views) => views.toggleProjection()),
        views: opens('views'),
        picture: opens('picture'),
        hide: ofViews((views) => views.show('hide')),
        ghost: ofViews((views) => views.show('ghost')),
        only: ofViews((views) => views.show('only')),
        showAll: ofViews((views) => views.showAll()),
        hold: () => session.recorded && travel(session, session.time.atUs === null ? session.clockUs() - HELD_US : null),
        display: (event) => modules.use('toolbarOverflow', ({ display }) => display.toggle(event), 'display'),
        more: (event) => modules.use('toolbarOverflow', ({ more }) => more.toggle(event), 'more'),
        split: opens('split'),
        measure: opens('measure'),
        snapshot: () => modules.use('snapshot', (snapshot) => snapshot.save()),
        share: () => modules.use('share', (share) => share.open()),
        theme: () => session.setParams({ backdrop: changeTheme() }),
        escape() {
            modules.giveUp();
            closePanels();
            const [alarms, measure, place] = ['alarms', 'measure', 'place'].map((name) => modules.there(name));
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
}
