// SPDX-License-Identifier: GPL-3.0-or-later
// The kinds of panes (areas) on a video wall's display. Each pane is { element, tick(now) }. Panes with views and trends
// contain the normal page in an iframe.
import { byEquipment } from '../core/alarm_call.js';
import { isGone, isWaiting } from '../core/alarms.js';
import { ageText, qualityText, unitText, valueText, zoneClock } from '../core/format.js';
import { health } from '../core/health.js';
import { quantityText } from '../core/model.js';
import { newView } from '../core/named_views.js';
import { refusalText } from '../core/refusals.js';
import { say } from '../core/words.js';
import { clock } from '../app/common/clock.js';
import { make, setText, setVariable } from '../app/common/dom.js';
import { badge, limitText, timeOf, todayOf } from '../app/alarms/alarm_bar.js';
import { SnapshotPane } from './snapshot_pane.js';

// LEAST_PART: smallest scale to which the letters shrink so that a pane's content fits; LATEST_MS: time after which an alarm's
// picture is shown even if it does not contain the alarm's tag
const LEAST_PART = 0.4, LATEST_MS = 30000;
const KINDS = { views: ViewsPane, trend: TrendPane, alarms: AlarmsPane, tiles: TilesPane, clock: ClockPane, text: TextPane,
    snapshot: SnapshotPane };

// Returns an area's name as a valid CSS identifier for the grid.
export const areaOf = (name) => (name === '.' ? name : `area-${name.replace(/\./g, '_')}`);

export function paneOf(pane, context) {
    const title = make('h2', {}, pane.title ?? ''), body = make('div', { class: 'body' });
    const element = make('section', { class: `pane ${pane.kind}` }, title, body);
    element.style.gridArea = areaOf(pane.area);
    const { tick = () => {} } = KINDS[pane.kind](pane, { ...context, title, body, element });
    return { element, kind: pane.kind, tick };
}

// Returns an alarm's values as in the alarm bar, but without the present value while the server sends no messages.
const nowText = (session, alarm) => limitText(session, alarm, !['lost', 'silent'].includes(health(session, clock.now()).kind));

const ageOf = (ms) => say('walls.age', { age: ms === null ? '–' : ageText(ms) });

// Returns the age of the oldest usable reading of these tags; null: none is usable.
function oldestMs({ model }, names) {
    const good = names.map((name) => model.tag(name)).filter((tag) => tag && model.readings[tag.index].quality !== 'bad');
    const ages = good.map(({ index }) => model.ageMs(index, clock.now())).filter((ms) => ms !== null);
    return ages.length > 0 ? Math.max(...ages) : null;
}

// Returns a text with the quantities of these tags, and the age of the oldest usable reading.
function aboutTags(session, names) {
    const { model } = session, groups = [...new Set(names.map((name) => model.group(model.tag(name)?.group)))].filter(Boolean);
    return [groups.map(quantityText).join(', '), ageOf(oldestMs(session, names))].filter(Boolean).join(' · ');
}

// Returns a tag's present value and its unit as texts. `known` false: there is no usable value.
function valueOf({ model }, tag) {
    const { value, quality } = model.readings[tag.index], group = model.group(tag.group);
    const known = quality !== 'bad' && value !== null;
    return known ? { known, text: valueText(group, value), unit: unitText(tag.unit || group?.unit) }
        : { known, text: qualityText('bad'), unit: '' };
}

// Returns the age of the oldest reading in the shown picture, for sessions that receive no readings themselves.
function pictureAgeMs(session) {
    const { picture } = session;
    if (!picture || picture.oldestAgeMs === null)
        return null;
    return picture.oldestAgeMs + Math.max(0, session.clockUs() - picture.sentTimeUs) / 1000;
}

// Adds the normal page in an iframe, without controls. Returns an object whose member `page` is the global object `plantcast` of the page
// in the iframe, or null until that is loaded.
function pageIn({ wall, theme, lang, body }, kind, place) {
    const query = new URLSearchParams({ wall: `${wall.inches},${wall.distance_m}`, pane: kind, hangs: place, ...(theme ? { theme } : {}),
        ...(lang ? { lang } : {}) });
    const frame = make('iframe', { src: `./?${query}`, tabindex: -1 });
    body.append(frame);
    return {
        get page() { return frame.contentWindow?.plantcast ?? null; },
        get note() { return frame.contentDocument?.getElementById('trend-note')?.textContent ?? ''; },
    };
}

// a pane with views; during an alarm it shows the alarm's position

function ViewsPane(pane, context) {
    const { session, call, title, element, wall, display } = context, place = `${wall.id}/${display}/${pane.area}`;
    const inner = pageIn(context, 'view', place), remembered = `plantcast.at.${place}`;
    let at = (Number(sessionStorage.getItem(remembered)) || 0) % pane.items.length, changedAt = null, shown = null, shownIn = null;
    // the views that the pane may show: those permitted to the display's token, if it is limited to some; else all saved views
    const viewsOf = ({ model, views }) => model?.plant.only ?? views;
    const titleOf = (id) => pane.title ?? viewsOf(session).find((view) => view.id === id)?.title ?? id;
    // the heading of a view whose picture has not arrived yet: until then, the heading must name the previous view, which is
    // still in the picture
    let due = null, isOpened = false;
    let isDone = false; // true: showView() or showAlarm() has succeeded for `shown`; after an error, the next tick tries again
    let sender = null; // the part of the heading that byWhom() states; its text also changes at midnight
    const words = make('span', { class: 'said' }), about = make('span', { class: 'about' }), why = make('p', { class: 'why' });
    title.append(words, about);
    context.body.append(why);

    // Returns a text that names the user who sent the view to the pane or holds the pane on it, and the time since then.
    function byWhom({ desk, by, held, time_us: us }) {
        const who = [desk, by].filter(Boolean).join(', '), time = timeOf(session, us);
        return say(held ? 'walls.held' : 'walls.sent', { who, time });
    }

    // Shows a view. wrong: names in the view that the plant does not have. The pane lists such names instead of the picture, because
    // another picture would mislead.
    function showView(page, order, wrong) {
        const id = pane.items[at];
        isOpened = Boolean(wrong || (page.session.model.plant.only && !order?.view));
        if (wrong)
            setText(why, say('named.wrong', { why: refusalText(wrong.wrong, wrong.refusal) }));
        else if (isOpened)
            page.session.post({ type: 'look', seq: 1, named: id });
        else
            page.modules.use('views', (views) => {
                if (order?.view)
                    views.lookAt(order.view);
                else
                    views.openNamed(id, false);
                page.modules.use('namedViews', () => { isOpened = true; }, 'opened');
            });
        const known = viewsOf(page.session).some((view) => view.id === id);
        const own = known ? titleOf(id) : say('named.unknown', { id });
        sender = order ? make('i', {}) : null;
        const said = !order && pane.stops?.[at].text;
        due = [order?.view ? order.title : own, ...(said ? [make('span', {}, ` · ${said}`)] : []), ...(order ? [' ', sender] : [])];
    }

    // Returns true if the picture shows the view that was opened last.
    function hasArrived({ session: { picture, paramsSeq, cameraSeq, cameraNews } }, now) {
        const isNew = picture?.paramsSeq === paramsSeq && picture.cameraSeq === cameraSeq && !cameraNews;
        return (isOpened && isNew) || now - changedAt > LATEST_MS;
    }

    // Returns true if the picture does not show the alarm yet: it shows another sensor group, or the alarm's tag is outside the picture.
    function isComing({ session: { model, shown: params }, overlay }, alarm, now) {
        const tag = model.tag(alarm.tag.name), isOther = Boolean(tag?.group) && params.group !== tag.group;
        return isOther || (now - changedAt < LATEST_MS && !overlay.marker(tag));
    }

    // Shows the alarm's state, its tag's other unacknowledged alarms, and the present value. All may change while the pane shows the
    // alarm's position.
    function sayNow(alarm) {
        const others = alarm.others.filter(({ state }) => isWaiting(state))
            .map(({ kind, state }) => `${say(`kind.${kind}`)}: ${say(`state.${state}`)}`);
        setText(words.querySelector('.now'), [say(`state.${alarm.state}`), ...isWaiting(alarm.state) ? [] : others, nowText(session, alarm),
            say('walls.since', { time: timeOf(session, alarm.raisedUs) })].filter(Boolean).join(' · '));
    }

    function showAlarm(page, alarm) {
        const tag = page.session.model.tag(alarm.tag.name);
        // the parameters of a new view: those of the pane's view could hide the equipment, or not show readings
        page.session.setParams(newView(page.session, tag));
        page.flyToTag(tag);
        setVariable(element, '--called', `var(--p${alarm.priority})`);
        due = null;
        words.replaceChildren(badge(alarm.priority, isGone(alarm.state)), make('b', {}, ` ${say(`kind.${alarm.kind}`)} ${tag.name} `),
            make('span', { class: 'now' }));
        sayNow(alarm);
    }

    return { tick(now) {
        const { page } = inner;
        if (!page?.session.model || page.session.views.length === 0 && session.views.length > 0)
            return;
        const { model } = page.session, group = model.group(page.session.shown.group);
        const ageMs = model.plant.only ? pictureAgeMs(page.session) : group && model.oldestAgeMs(group.id, clock.now());
        setText(about, group ? [quantityText(group), ageOf(ageMs)].join(' · ') : '');
        const alarms = session.model.alarms.list(), nowUs = session.clockUs();
        const alarm = pane.on_alarm ? call.next(alarms, now, nowUs) : null;
        if (alarm && !model.tag(alarm.tag.name))
            return; // after a reload of the plant, the page in the iframe does not know a new tag until it has connected again
        const order = session.walls?.list.find(({ id }) => id === place) ?? null;
        const rests = order || alarms.some(({ waiting }) => waiting) || (pane.on_alarm && call.isFlood(alarms, nowUs));
        if (!rests && pane.items.length > 1 && changedAt !== null && now - changedAt >= (pane.stops?.[at].dwell_s ?? pane.every_s) * 1000) {
            at = (at + 1) % pane.items.length;
            sessionStorage.setItem(remembered, at); // stores which view is shown, so that a reloaded display continues with it
            shown = null;
        }
        const { view, wrong, refusal } = viewsOf(page.session).find(({ id }) => id === pane.items[at]) ?? {};
        const { width, height } = page.session.size;
        const wanted = alarm ? `${alarm.tag.name}/${alarm.kind}/${isGone(alarm.state)}`
            : JSON.stringify([at, order, view, wrong, width, height]);
        const unshown = alarm || order?.view || !wrong ? null : { wrong, refusal };
        element.classList.toggle('unshown', Boolean(unshown));
        element.classList.toggle('called', Boolean(alarm));
        const isNew = wanted !== shown || page !== shownIn;
        if (isNew)
            [shown, shownIn, changedAt, isDone] = [wanted, page, now, false];
        // hides the old picture and its legend until the alarm's picture arrives
        element.classList.toggle('coming', Boolean(alarm) && isComing(page, alarm, now));
        if (isDone && alarm)
            sayNow(alarm);
        else if (!isDone && alarm)
            showAlarm(page, alarm);
        else if (!isDone)
            showView(page, order, unshown);
        isDone = true;
        if (order && sender)
            setText(sender, byWhom(order));
        if (due && (unshown || hasArrived(page, now))) {
            words.replaceChildren(...due);
            due = null;
        }
    } };
}

// --- trend panes

function TrendPane(pane, context) {
    const { session, wall, display, title, element } = context, inner = pageIn(context, 'trend', `${wall.id}/${display}/${pane.area}`);
    const about = make('span', { class: 'about' }), why = make('p', { class: 'why' });
    context.body.append(why);
    // the page in the iframe in which the trend was opened; a reloaded iframe has a new page, which must open the trend again
    let begun = null;
    title.replaceChildren(pane.title ?? pane.items.join(', '), about);
    return { tick() {
        const { page } = inner;
        setText(about, aboutTags(session, pane.items));
        // says why the pane is empty; errors of the trend itself are shown by the page in the iframe
        const isUnknown = (name) => Boolean(session.model) && !session.model.tag(name);
        const unknown = pane.items.filter(isUnknown), awaited = pane.items.filter((name) => !isUnknown(name));
        const isEmpty = !(page?.trends?.plots.length > 0 || inner.note);
        element.classList.toggle('unshown', awaited.length === 0 || isEmpty);
        setText(why, [['walls.untrended', awaited], ['trends.unknown', unknown]].filter(([, names]) => names.length > 0)
            // replaces hyphens by non-breaking ones, so that lines do not break within names
            .map(([key, names]) => say(key, { tags: names.join(', ').replaceAll('-', '\u2011') }))
            .join(' · '));
        if (begun === page || !page?.session.model)
            return;
        page.modules.use('trends', (trends) => trends.compare(pane.items, pane.hours * 3600));
        begun = page;
    } };
}

// --- alarms

function AlarmsPane(pane, { session, call, title, body }) {
    let said = '';
    const about = make('span', { class: 'about' });
    const list = make('ol', {}), more = make('p', { class: 'more' });
    body.append(list, more);

    const rowOf = (alarm) => make('li', { class: [alarm.waiting ? 'waiting' : '', isGone(alarm.state) ? 'gone' : ''].join(' ') },
        badge(alarm.priority, isGone(alarm.state)),
        make('b', {}, `${say(`kind.${alarm.kind}`)} `, make('span', { class: 'tag' }, alarm.tag.name)),
        make('span', { class: 'what' }, [nowText(session, alarm), alarm.tag.description].filter(Boolean).join(' · ')),
        make('time', {}, timeOf(session, alarm.raisedUs)));
    // Returns a short row for an alarm: the kind's short name, the tag and its present value, and below them time and description.
    function briefRowOf(alarm) {
        const { tag, kind, raisedUs } = alarm, { text, unit } = tag.index === null ? { text: '', unit: '' } : valueOf(session, tag);
        return make('li', { class: `brief${alarm.waiting ? ' waiting' : ''}` }, badge(alarm.priority, isGone(alarm.state)),
            make('b', {}, `${kind.length > 2 ? say(`kind.${kind}`) : kind} `, make('span', { class: 'tag' }, tag.name)),
            make('b', { class: 'now' }, [text, unit].filter(Boolean).join('\u00a0')),
            make('span', { class: 'what' }, [timeOf(session, raisedUs), tag.description].filter(Boolean).join(' · ')));
    }
    const rowOfMany = ({ asset, count, worst }) => make('li', { class: 'waiting', 'data-count': count }, badge(worst.priority),
        make('b', {}, make('span', { class: 'tag' }, asset ?? worst.tag.name)), make('span', { class: 'what' },
            say('walls.many', { count, worst: `${worst.tag.name} ${worst.kind.length > 2 ? say(`kind.${worst.kind}`) : worst.kind}` })),
        make('time', {}, timeOf(session, worst.raisedUs)));

    const isFull = () => body.scrollHeight > body.clientHeight + 1;

    // Shows as many rows as fit, and the number of alarms left out. brief() makes short rows, used if the normal rows do not
    // all fit; if only the first lines of all short rows fit, only these lines are shown.
    function fill(rows, brief = null) {
        list.replaceChildren(...rows);
        let hidden = 0;
        more.hidden = true;
        list.classList.remove('short');
        if (brief && isFull()) {
            list.replaceChildren(...brief());
            if (isFull()) {
                list.classList.add('short');
                list.classList.toggle('short', !isFull());
            }
        }
        while (list.children.length > 1 && isFull()) {
            hidden += Number(list.lastChild.dataset.count ?? 1);
            list.lastChild.remove();
            more.hidden = false;
            setText(more, say('walls.more', { count: hidden }));
        }
    }

    return { tick() {
        const { alarms } = session.model, all = alarms.list(), flood = call.isFlood(all, session.clockUs());
        setText(about, ageOf(clock.now() - session.freshAt));
        const { active, waiting } = alarms.counts(), now = JSON.stringify([flood, body.clientHeight, todayOf(session), all.map((alarm) =>
            [alarm.id, alarm.state, alarm.priority, alarm.raisedUs, flood ? '' : nowText(session, alarm)])]);
        if (now === said)
            return;
        title.replaceChildren(pane.title ?? say('alarms.title'), make('span', {}, flood ? say('walls.flood', { active, waiting })
            : active === 0 && waiting === 0 ? say('alarms.none') : say('walls.counts', { active, waiting })), about);
        if (flood)
            fill(byEquipment(all.filter(({ state }) => !isGone(state))).map(rowOfMany));
        else
            fill(all.map(rowOf), () => all.map(briefRowOf));
        said = now; // after an error above, the next tick tries again
    } };
}

// --- tiles of numbers with limits in ISA-101 style: grey, with a band for the normal range, a mark at the value, and colour only for
// alarms

function TilesPane(pane, { session, body, title }) {
    const about = make('span', { class: 'about' });
    title.replaceChildren(pane.title ?? '', about);
    const tiles = pane.items.map((name) => {
        const value = make('b', { class: 'value' });
        const bar = make('div', { class: 'bar' }, make('i', { class: 'usual' }), make('i', { class: 'at' }));
        const flag = make('span', { class: 'flag' });
        const element = make('div', { class: 'tile' }, make('span', { class: 'name' }, name), flag, value, bar);
        body.append(element);
        return { name, value, bar, flag, element, limits: '' };
    });

    function mark(tile, tag, group) {
        const text = JSON.stringify([tag.limits ?? {}, group.min, group.max]);
        if (text === tile.limits)
            return;
        tile.bar.querySelectorAll('.limit').forEach((one) => one.remove());
        const limits = Object.entries(tag.limits ?? {}).filter(([, one]) => Number.isFinite(one)), { L, H } = Object.fromEntries(limits);
        const [low, high] = [shareOf(group, L ?? group.min), shareOf(group, H ?? group.max)];
        setVariable(tile.bar, '--low', low);
        setVariable(tile.bar, '--high', Math.max(low, high));
        for (const [name, limit] of limits) {
            const line = make('i', { class: `limit${name.length > 1 ? ' outer' : ''}` });
            setVariable(line, '--at', shareOf(group, limit));
            tile.bar.append(line);
        }
        tile.limits = text;
    }

    // Shows in a tile that the plant does not have the tile's tag.
    function lose(tile) {
        setText(tile.value, say('walls.untagged'));
        Object.assign(tile.element.dataset, { quality: 'bad', alarm: '' });
        flagOf(tile, null);
    }

    // Sets the alarm flag of a tag's tile: its colour shows the priority; hollow means returned to normal but unacknowledged.
    function flagOf(tile, alarm) {
        const text = alarm ? `${alarm.priority} ${alarm.state}` : '';
        if (tile.flag.dataset.shows === text)
            return;
        tile.flag.replaceChildren(...(alarm ? [badge(alarm.priority, isGone(alarm.state))] : []));
        tile.flag.dataset.shows = text;
    }

    let fitted = '';
    return { tick() {
        const room = `${body.clientWidth} ${body.clientHeight} ${getComputedStyle(body.parentNode).fontSize}`;
        setText(about, ageOf(oldestMs(session, pane.items)));
        for (const tile of tiles) {
            const tag = session.model.tag(tile.name), group = session.model.group(tag?.group);
            tile.bar.hidden = !group;
            if (!tag) {
                lose(tile);
                continue;
            }
            const { value, quality } = session.model.readings[tag.index], alarm = session.model.alarms.gravest(tag.index);
            const { known, text, unit } = valueOf(session, tag);
            tile.value.replaceChildren(text, make('span', {}, unit && ` ${unit}`));
            tile.element.dataset.quality = quality;
            tile.element.dataset.alarm = alarm && !isGone(alarm.state) ? alarm.priority : '';
            flagOf(tile, alarm);
            tile.bar.classList.toggle('unknown', !known);
            if (!group)
                continue;
            setVariable(tile.bar, '--value', known ? shareOf(group, value) : 0);
            mark(tile, tag, group);
        }
        if (room !== fitted)
            fitIn(body);
        fitted = room;
    } };
}

// Makes a pane's content fit: first with a compact layout, where values are as large as names, then with smaller letters.
function fitIn(body) {
    body.classList.remove('compact');
    setVariable(body, '--part', 1);
    const fits = () => body.scrollHeight <= body.clientHeight + 1;
    if (fits())
        return;
    body.classList.add('compact');
    for (let part = 1; part > LEAST_PART && !fits(); part *= 0.94)
        setVariable(body, '--part', part);
}

const shareOf = ({ min, max }, value) => Math.max(0, Math.min(1, (value - min) / (max - min)));

// a pane with the plant's time, and a pane with a text

function ClockPane(pane, { session, body, title }) {
    const day = make('span', {}), hour = make('b', {});
    body.append(hour, day);
    return { tick() {
        const { date, time, offset } = zoneClock(session.model.plant.time_zone)(session.clockUs() / 1000);
        setText(title, pane.title ?? session.model.plant.name);
        setText(hour, time);
        setText(day, `${date} ${offset}${session.model.clockSet ? '' : ` · ${say('status.unset', { clock: say('status.clock') })}`}`);
    } };
}

function TextPane(pane, { body }) {
    body.append(...pane.items.map((text) => make('p', {}, text)));
    return {};
}
