// SPDX-License-Identifier: GPL-3.0-or-later
// A display that is a tile of one picture over many: the picture without a frame, dots where readings are, labels of alarms; title and
// legend once on the wall. Who leads chooses what all show.
import { isGone } from '../core/alarms.js';
import { Connection } from '../core/connection.js';
import { browserDecoding } from '../core/decoding.js';
import { ageText, decimalsFor, numberText, quantityText, shortNumberText, unitText, zoneClock } from '../core/format.js';
import { colourOf, scaleTicks, valueAt, placeOf } from '../core/legend.js';
import { viewOf } from '../core/named_views.js';
import { SPREAD_MS } from '../core/wall.js';
import { say } from '../core/words.js';
import { badge } from '../app/alarms/alarm_bar.js';
import { clock } from '../app/common/clock.js';
import { make, setText, setVariable } from '../app/common/dom.js';
import { TileSession } from './tile_session.js';

const OLD_MS = 3000, STEPS = 64;

// { element, kind, tick(now) }. pane: of /api/v1/walls, with `tile`; context: as of other panes.
export function tileOf(pane, { session: words, call, wall, display, streamUrl }) {
    const { columns, rows } = pane.tile, canvas = make('canvas', {}), marks = make('div', { class: 'marks' });
    const title = make('h2', {}), legend = make('div', { class: 'tile-legend' }), said = make('p', { class: 'tile-said', hidden: true });
    const element = make('section', { class: 'pane picture' }, canvas, marks, said);
    const connection = new Connection({ url: streamUrl, open: (url, protocol) => new WebSocket(url, protocol), clock });
    const decoding = browserDecoding();
    const session = new TileSession({ connection, now: clock.now, codecs: decoding.codecs, tile: { wall: wall.id, display, columns, rows },
        canvas, decoding });
    const ratio = window.devicePixelRatio || 1;
    element.style.gridArea = 'area-main';
    connection.spreadMs = SPREAD_MS;
    session.token = words.token;
    if (display === 1)
        element.append(title);
    if (display === columns * (rows - 1) + 1)
        element.append(legend);

    const fit = () => session.resize({ width: Math.max(16, Math.round(element.clientWidth * ratio)),
        height: Math.max(16, Math.round(element.clientHeight * ratio)), pixel_ratio: Math.min(8, Math.max(0.25, ratio)) });
    const flush = () => {
        session.flush();
        requestAnimationFrame(flush);
    };
    new ResizeObserver(fit).observe(element);
    decoding.probe().finally(() => {
        fit();
        connection.start();
    });
    requestAnimationFrame(flush);

    // --- what is shown, by who leads

    let refused = '';
    session.on('error', ({ text }) => { refused = text; });

    let at = 0, changedAt = null, shown = null;
    const timeOf = (us) => zoneClock(words.model.plant.time_zone)(us / 1000).time;
    session.on('fitted', (camera) => session.setCamera(camera));

    function look(text) {
        const { camera, params } = viewOf(session, text);
        session.setParams(params);
        session.setCamera(camera);
    }

    function lead(now) {
        const alarms = words.model.alarms.list(), nowUs = words.clockUs();
        const alarm = pane.on_alarm ? call.next(alarms, now, nowUs) : null;
        const order = words.walls?.list.find(({ id }) => id === `${wall.id}/1/main`) ?? null;
        const rests = order || alarms.some(({ waiting }) => waiting) || (pane.on_alarm && call.isFlood(alarms, nowUs));
        const dwell = (pane.stops?.[at].dwell_s ?? pane.every_s) * 1000;
        if (!rests && pane.items.length > 1 && changedAt !== null && now - changedAt >= dwell) {
            at = (at + 1) % pane.items.length;
            shown = null;
        }
        const view = session.views.find(({ id }) => id === pane.items[at]);
        const wanted = alarm ? `${alarm.tag.name}/${alarm.kind}/${isGone(alarm.state)}` : JSON.stringify([at, order, view?.view]);
        if (wanted === shown)
            return;
        if (alarm) {
            const tag = session.model.tag(alarm.tag.name);
            session.setParams({ ...(tag.group ? { group: tag.group } : {}), clip: null, split: null, range: null });
            session.post({ type: 'fit', seq: ++session.fitSeq, id: tag.name });
        } else if (order?.view || view) {
            look(order?.view || view.view);
        }
        [shown, changedAt] = [wanted, now];
    }

    // --- what is said

    function sayTitle() {
        const { model } = session, group = model.group(session.shown.group);
        const alarm = words.model.alarms.list().find(({ waiting }) => waiting);
        const about = group ? [quantityText(group), say('walls.age', { age: ageText(model.oldestAgeMs(group.id, clock.now()) ?? 0) })] : [];
        const order = words.walls?.list.find(({ id }) => id === `${wall.id}/1/main`);
        const view = session.views.find(({ id }) => id === pane.items[at]);
        const name = pane.title ?? order?.title ?? (session.tiles.leads ? view?.title : null) ?? wall.id;
        const parts = [name, ...about].join(' · ');
        title.replaceChildren(...(alarm && pane.on_alarm ? [badge(alarm.priority, isGone(alarm.state)),
            ` ${say(`kind.${alarm.kind}`)} ${alarm.tag.name} · `] : []), parts);
    }

    // Which displays are not there is said by the one that leads; what is wrong with itself, by each.
    function saySelf(now) {
        const own = session.tiles.late.find((one) => one.display === display), { picture } = session;
        const silent = session.freshAt !== null && now - session.freshAt > OLD_MS;
        const others = session.tiles.missing.concat(session.tiles.late.map((one) => one.display)).sort((a, b) => a - b);
        const text = refused && !session.welcomed ? refused : own ? say('walls.late', { time: timeOf(own.since_us) })
            : silent ? say('walls.lost', { time: timeOf(words.clockUs(session.freshAt)) })
                : session.tiles.leads && others.length > 0 ? say('walls.missing', { displays: others.join(', ') }) : '';
        said.hidden = text === '';
        said.classList.toggle('card', Boolean(own || silent || (refused && !session.welcomed)));
        element.classList.toggle('blank', Boolean(own || silent || !picture));
        setText(said, text);
    }

    let legendOf = '';
    function drawLegend() {
        const { model, shown: params } = session, group = model.group(params.group), [min, max] = session.rangeOf(params);
        const key = JSON.stringify([params.group, params.colormap, params.ramp_interval, params.scale, params.breaks, min, max]);
        if (!group || key === legendOf)
            return;
        legendOf = key;
        const breaks = params.breaks === 'group' ? group.breaks : Array.isArray(params.breaks) ? params.breaks : [];
        const map = model.colormap(params.colormap), log = params.scale === 'log';
        const scale = { map, min, max, log, interval: params.ramp_interval, breaks };
        const css = (value) => `rgb(${colourOf(scale, value).join(' ')})`, band = 100 / STEPS;
        const stops = Array.from({ length: STEPS }, (_, i) => `${css(valueAt(scale, (i + 0.5) / STEPS))} ${i * band}% ${(i + 1) * band}%`);
        const bar = make('div', { class: 'colours' }), ticks = make('div', { class: 'ticks' }), decimals = decimalsFor(max - min);
        bar.style.background = `linear-gradient(to top, ${stops.join(', ')})`;
        for (const value of scaleTicks(scale, [], 6)) {
            const tick = make('span', {}, shortNumberText(value, decimals));
            setVariable(tick, '--at', `${100 * placeOf(scale, value)}%`);
            ticks.append(tick);
        }
        legend.replaceChildren(make('b', {}, `${quantityText(group)} `, make('span', {}, unitText(group.unit))),
            make('div', { class: 'scale' }, bar, ticks));
    }

    session.on('presented', ({ frame }) => {
        const alarms = words.model?.alarms.list().filter(({ state, waiting }) => waiting || !isGone(state)) ?? [];
        const by = new Map(alarms.map((one) => [one.tag.index, one])), known = session.markersOf(frame.seq);
        marks.replaceChildren(...(session.places ?? []).filter(([, , , occluded]) => !occluded).map(([index, x, y, , half = 0]) => {
            const value = known?.get(`${index}/${half}`)?.value;
            const alarm = by.get(index), tag = words.model?.tags[index], group = words.model?.group(tag?.group);
            const mark = make('i', { class: alarm ? 'alarm' : 'dot' });
            if (alarm)
                mark.append(badge(alarm.priority, isGone(alarm.state)), ` ${tag.name} ${value === null || value === undefined || !group ? ''
                    : `${numberText(value, decimalsFor(group.max - group.min))} ${unitText(tag.unit || group.unit)}`}`);
            setVariable(mark, '--x', `${(100 * x) / frame.fullWidth}%`);
            setVariable(mark, '--y', `${(100 * y) / frame.fullHeight}%`);
            return mark;
        }));
    });

    session.on('welcome', () => {
        shown = null;
        session.post({ type: 'display', wall: wall.id, display });
    });
    session.on('tiles', () => { shown = null; });
    const close = () => connection.stop?.();
    return { element, kind: pane.kind, session, close, tick(now) {
        if (!session.model || !words.model)
            return;
        if (session.tiles.leads && session.views.length > 0)
            lead(now);
        if (display === 1)
            sayTitle();
        if (legend.isConnected)
            drawLegend();
        saySelf(now);
    } };
}

