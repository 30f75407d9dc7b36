// SPDX-License-Identifier: GPL-3.0-or-later
// A display that shows one tile of a picture across many displays: its part of the picture without a border, dots at readings,
// alarm labels, notes, and the position that a user at another computer points at. Title and legend appear once on the wall.
// One display, the leading one, chooses the view for all displays.
import { isGone } from '../core/alarms.js';
import { projector } from '../core/camera.js';
import { Connection } from '../core/connection.js';
import { browserDecoding } from '../core/decoding.js';
import { ageText, unitText, valueText } from '../core/format.js';
import { simulatedText } from '../core/health.js';
import { quantityText } from '../core/model.js';
import { newView, viewOf } from '../core/named_views.js';
import { inForce, placeOf as placeOfNote } from '../core/notes.js';
import { refusalText } from '../core/refusals.js';
import { SPREAD_MS } from '../core/wall.js';
import { say } from '../core/words.js';
import { badge, timeOf } from '../app/alarms/alarm_bar.js';
import { clock } from '../app/common/clock.js';
import { make, setText, setVariable } from '../app/common/dom.js';
import { Legend } from '../app/viewport/legend.js';
import { onPixelRatio } from '../app/viewport/pixel_ratio.js';
import { TileSession } from './tile_session.js';

// SMALLEST: minimum font scale of a title that is too long for one line
const UPRIGHT = { matches: false, addEventListener() {} }, SMALLEST = 0.6;
// REACH: a label may begin on the neighbouring tile, up to this fraction of a tile's width beyond the edge
const OLD_MS = 3000, POINTS_MS = 4000, REACH = 0.35;

// Returns { element, kind, tick(now) }. pane: description of the pane from /api/v1/walls, with `tile`; second argument: the context that
// all panes get (main.js).
export function tileOf(pane, { session: words, call, wall, display, streamUrl }) {
    const { columns, rows } = pane.tile, canvases = [make('canvas', { class: 'front' }), make('canvas')];
    const marks = make('div', { class: 'marks' });
    const title = make('h2', {}), legend = make('div', { class: 'legend' }), said = make('p', { class: 'tile-said', hidden: true });
    const element = make('section', { class: 'pane picture' }, ...canvases, marks, said);
    const connection = new Connection({ url: streamUrl, open: (url, protocol) => new WebSocket(url, protocol), clock });
    const decoding = browserDecoding();
    const session = new TileSession({ connection, now: clock.now, codecs: decoding.codecs, tile: { wall: wall.id, display, columns, rows },
        canvases, decoding });
    element.style.gridArea = 'area-main';
    connection.spreadMs = SPREAD_MS;
    connection.onUnopened = () => import('../core/blocked.js').then(({ explain }) => explain(connection), () => {});
    session.token = words.token;
    if (display === 1)
        element.append(title);
    const hasLegend = display === columns * (rows - 1) + 1, paramsOf = (params) => params;
    const colours = hasLegend ? new Legend({ session, element: legend, paramsOf, lying: UPRIGHT }) : null;
    if (colours)
        element.append(legend);

    const fit = () => {
        const ratio = window.devicePixelRatio || 1, [width, height] = [element.clientWidth, element.clientHeight].map((px) =>
            Math.max(16, Math.round(px * ratio)));
        session.resize({ width, height, pixel_ratio: Math.min(8, Math.max(0.25, ratio)) });
    };
    const flush = () => {
        session.flush();
        requestAnimationFrame(flush);
    };
    new ResizeObserver(fit).observe(element);
    onPixelRatio(fit);
    decoding.probe().finally(() => {
        fit();
        connection.start();
    });
    requestAnimationFrame(flush);

    // --- the view, which the leading display chooses for all displays

    let refused = '';
    session.on('error', ({ text, refusal, code }) => { refused = refusalText(text, refusal, code); });

    // wrong: names in the view that the leading display could not find in the plant; null: none
    let at = 0, changedAt = null, shown = null, called = null, wrong = null;
    session.on('fitted', (camera) => session.setCamera(camera));

    function look(text, id) {
        const { camera, params } = viewOf(session, text, id);
        session.setParams(params);
        session.setCamera(camera);
    }

    const findOrder = () => words.walls?.list.find(({ id }) => id === `${wall.id}/1/main`) ?? null;

    function lead(now) {
        const alarms = words.model.alarms.list(), nowUs = words.clockUs();
        const alarm = pane.on_alarm ? call.next(alarms, now, nowUs) : null, order = findOrder();
        called = alarm;
        const rests = order || alarms.some(({ waiting }) => waiting) || (pane.on_alarm && call.isFlood(alarms, nowUs));
        const dwell = (pane.stops?.[at].dwell_s ?? pane.every_s) * 1000;
        if (!rests && pane.items.length > 1 && changedAt !== null && now - changedAt >= dwell) {
            at = (at + 1) % pane.items.length;
            shown = null;
        }
        const view = session.views.find(({ id }) => id === pane.items[at]);
        const wanted = alarm ? `${alarm.tag.name}/${alarm.kind}/${isGone(alarm.state)}` : JSON.stringify([at, order, view]);
        wrong = !alarm && !order?.view && view?.wrong ? view : null;
        const tag = alarm && session.model.tag(alarm.tag.name);
        if (wanted === shown || (alarm && !tag)) // after a reload of the plant, one of the two sessions may know its new tags first
            return;
        if (alarm) {
            // the parameters of a new view: those of the pane's view could hide the equipment, or not show readings
            session.setParams(newView(session, tag));
            session.post({ type: 'fit', seq: ++session.fitSeq, id: tag.name });
        } else if (order?.view || view) {
            look(order?.view || view.view, order?.view ? undefined : view.id);
        }
        [shown, changedAt] = [wanted, now];
    }

    // --- texts

    // Shows the title. Only the leading display (the first one, unless the picture is shown several times) knows which view is shown.
    function sayTitle() {
        const { model } = session, group = model.group(session.shown.group), { leads } = session.tiles, order = leads ? findOrder() : null;
        const alarms = words.model.alarms.list(), { active, waiting } = words.model.alarms.counts(), alarm = leads ? called : null;
        const view = leads ? session.views.find(({ id }) => id === pane.items[at]) : null;
        const who = order && [order.desk, order.by].filter(Boolean).join(', ');
        const counts = call.isFlood(alarms, words.clockUs()) ? 'walls.flood' : 'walls.counts';
        const parts = [
            alarm ? say('walls.since', { time: timeOf(words, alarm.raisedUs) })
                : order?.view ? order.title : pane.title ?? view?.title ?? wall.id,
            !alarm && order && say(order.held ? 'walls.held' : 'walls.sent', { who, time: timeOf(words, order.time_us) }),
            leads && !alarm && !order && pane.stops?.[at].text,
            active + waiting > 0 && say(counts, { active, waiting }),
            group && quantityText(group),
            group && say('walls.age', { age: ageText(model.oldestAgeMs(group.id, clock.now())) }),
            simulatedText(words),
        ].filter(Boolean).join(' · ');
        title.replaceChildren(...(alarm ? [badge(alarm.priority, isGone(alarm.state)), ` ${say(`kind.${alarm.kind}`)} ${alarm.tag.name} `]
            : []), parts);
        setVariable(title, '--part', 1);
        setVariable(title, '--part', Math.max(SMALLEST, Math.min(1, element.clientWidth / title.scrollWidth)));
    }

    const refusal = () => (session.welcomed ? '' : refused || connection.blocked);

    function tell(text, isCard) {
        said.hidden = text === '';
        said.classList.toggle('card', isCard);
        setText(said, text);
    }

    // Shows faults: the leading display lists the missing displays, and each display reports its own faults.
    function saySelf(now) {
        const own = session.tiles.late.find((one) => one.display === display), { picture } = session;
        const silent = session.freshAt !== null && now - session.freshAt > OLD_MS;
        const others = session.tiles.missing.concat(session.tiles.late.map((one) => one.display)).sort((a, b) => a - b);
        const text = refusal() || (own ? say('walls.late', { time: timeOf(words, own.since_us) })
            : silent ? say('walls.lost', { time: timeOf(words, words.clockUs(session.freshAt)) })
                : words.model.live === false ? say('health.nodata')
                    : session.tiles.leads && others.length > 0 ? say('walls.missing', { displays: others.join(', ') })
                        : session.tiles.leads && wrong ? say('named.wrong', { why: refusalText(wrong.wrong, wrong.refusal) }) : '');
        tell(text, Boolean(own || silent || refusal()));
        element.classList.toggle('blank', Boolean(own || silent || !picture));
    }

    // --- marks in the picture

    // frame: the frame on the screen; pointer: position that a user at another computer points at: { position, by, until }
    let frame = null, pointer = null;

    // Returns a function from a position in the plant to one on this display, as fractions of the display's sides; null: behind the camera,
    // or far outside.
    function placer() {
        const [left, top, width, height] = session.tiles.part ?? [0, 0, 1, 1];
        const project = projector(frame.camera, frame.fullWidth / width, frame.fullHeight / height);
        const isNear = (share) => share > -REACH && share < 1 + REACH;
        return (point) => {
            const to = point && project(point);
            const place = to && [to[0] / frame.fullWidth - left / width, to[1] / frame.fullHeight - top / height];
            return place?.every(isNear) ? place : null;
        };
    }

    function put(element, [x, y]) {
        setVariable(element, '--x', `${100 * x}%`);
        setVariable(element, '--y', `${100 * y}%`);
        return element;
    }

    function markOf(alarm, value, behind) {
        const { tag } = alarm, group = words.model.group(tag.group), mark = make('i', { class: behind ? 'alarm behind' : 'alarm' });
        const said = value === null || value === undefined || !group ? ''
            : `${valueText(group, value)} ${unitText(tag.unit || group.unit)}`;
        mark.append(badge(alarm.priority, isGone(alarm.state)), ` ${tag.name} ${said}`);
        return mark;
    }

    // Draws the marks of readings. An alarm's mark is always drawn, even if its sensor is hidden or its quantity is not shown.
    function drawMarks() {
        const { model } = words, place = placer(), known = session.markersOf(frame.seq), marked = new Set(), out = [];
        const alarms = model.alarms.list().filter(({ state, waiting }) => waiting || !isGone(state));
        const by = new Map(alarms.map((one) => [one.tag.index, one]));
        for (const [index, x, y, occluded, half = 0] of session.places ?? []) {
            const alarm = by.get(index), value = known?.get(`${index}/${half}`)?.value, spot = [x / frame.fullWidth, y / frame.fullHeight];
            if (alarm || !occluded)
                out.push(put(alarm ? markOf(alarm, value, occluded) : make('i', { class: 'dot' }), spot));
            marked.add(index);
        }
        const add = (element, point) => {
            const to = place(point);
            if (to)
                out.push(put(element, to));
        };
        for (const alarm of alarms.filter(({ tag: { index, position } }) => position && !marked.has(index))) {
            const { value, quality } = model.readings[alarm.tag.index];
            add(markOf(alarm, quality === 'bad' ? null : value, true), alarm.tag.position);
        }
        for (const note of inForce(session.notes, words.clockUs(), session.time.atUs))
            add(make('p', { class: 'note' }, make('span', {}, note.text)), placeOfNote(session.model, note));
        if (pointer) {
            add(make('i', { class: 'ring' }), pointer.position);
            add(make('p', { class: 'note pointer' }, make('span', {}, pointer.by)), pointer.position);
        }
        marks.replaceChildren(...out);
    }

    // Redraws the marks when a picture arrives or a marked reading changes.
    let marksOf = '';
    function lookAtMarks() {
        if (pointer && clock.now() > pointer.until)
            pointer = null;
        if (!frame || !words.model || !session.model)
            return;
        const alarms = words.model.alarms.list().map(({ id, state, priority, tag }) => {
            const { value, quality } = words.model.readings[tag.index] ?? {};
            return [id, state, priority, value, quality];
        });
        const now = JSON.stringify([frame.seq, session.tiles.part, pointer, inForce(session.notes, words.clockUs(), session.time.atUs),
            alarms]);
        if (now !== marksOf)
            drawMarks();
        marksOf = now;
    }

    session.on('presented', (presented) => {
        ({ frame } = presented);
        lookAtMarks();
    });
    words.on('pointed', () => {
        const mine = words.pointed.filter((one) => one.wall === wall.id && one.display === 1 && one.area === 'main').at(-1);
        if (mine)
            pointer = mine.position ? { ...mine, until: clock.now() + POINTS_MS } : null;
        lookAtMarks();
    });

    session.on('welcome', () => {
        shown = frame = null;
        session.post({ type: 'display', wall: wall.id, display });
    });
    session.on('tiles', () => { shown = null; });
    const close = () => connection.stop?.();
    return { element, kind: pane.kind, session, close, tick(now) {
        if (!session.model || !words.model) {
            tell(refusal(), true);
            return;
        }
        if (session.tiles.leads && session.views.length > 0)
            lead(now);
        if (display === 1)
            sayTitle();
        colours?.show();
        saySelf(now);
        lookAtMarks();
    } };
}

