// SPDX-License-Identifier: GPL-3.0-or-later
// What clicks, keys and buttons do: the selection, the flight to what is chosen, and the parts of the page that they open. Loaded when
// hands first come near.
import { byId } from './dom.js';
import { changeTheme } from './theme.js';

const ARRIVAL_MARGIN = 1.7; // around one piece of equipment

export class Commands {
    constructor(page) {
        Object.assign(this, commandsOf(page));
    }
}

// By name; those of the page, and those of keys (core/keys.js).
function commandsOf({ session, parts, selection, overlay, toolbar, tools, saveAddress, refresh }) {
    function selectTag(tag) {
        selection.tag = tag?.name ?? null;
        selection.hover = null;
        if (tag) {
            parts.there('trends')?.follow(tag);
            parts.get('card');
        }
        parts.there('assets')?.mark();
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

    function fitView() {
        const chosen = session.model?.asset(session.params.selected);
        if (chosen)
            flyToAsset(chosen);
        else if (session.model)
            parts.use('pilot', (pilot) => pilot.flyToBox(session.model.plant.bounds));
    }

    const opens = (name) => (event) => parts.use(name, (part) => part.toggle(event), 'toggle');
    const ofViews = (f) => () => parts.use('views', f);

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

    return {
        selectTag, showTag, flyToTag, selectAsset, fitView, click, point,
        showTrend: (tag) => parts.use('trends', (trends) => trends.add(tag)),
        showAsset: (how, asset) => parts.use('views', (views) => views.show(how, asset.id)),
        engineer: opens('engineer'),
        fit: fitView,
        home: () => session.model && parts.use('pilot', (pilot) => pilot.flyHome()),
        help: () => parts.use('help', (help) => help.open()),
        timings: opens('timings'),
        alarms: opens('alarms'),
        past: () => session.recorded && opens('timeline')(),
        live: () => session.time.atUs !== null && session.travel(null),
        assets: () => parts.use('assets', (assets) => assets.setOpen(!assets.open), 'toggle'),
        search: () => parts.use('assets', (assets) => assets.openSearch()),
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
}
