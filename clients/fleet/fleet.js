// SPDX-License-Identifier: GPL-3.0-or-later
// The fleet page: polls its own server every five seconds and shows a card for each plant.
import { chooseLanguage, phrase, readWords } from './core/phrases.js';

const EVERY_MS = 5000, DAY_S = 86400, PRIORITIES = 4;
const { language } = chooseLanguage(location.search, navigator.languages);
const words = readWords((await import(`./words/fleet.${language}.js`)).default);
const say = (key, values) => phrase(words, null, key, values);
const byId = (id) => document.getElementById(id);
const cards = new Map();
let heardMs = Date.now();

const number = new Intl.NumberFormat(language, { maximumFractionDigits: 1 });
const days = new Intl.NumberFormat(language, { style: 'unit', unit: 'day', unitDisplay: 'long', maximumFractionDigits: 0 });
const size = (bytes) => `${number.format(bytes / 1e9)} GB`;
const ago = new Intl.RelativeTimeFormat(language, { numeric: 'auto' });
function time(us) {
    const date = new Date(us / 1000), today = date.toDateString() === new Date().toDateString();
    const form = { hour: '2-digit', minute: '2-digit', ...(today ? {} : { month: 'short', day: 'numeric' }) };
    return date.toLocaleString(language, form);
}
const since = (s) => (s < DAY_S ? ago.format(-Math.round(s / 3600), 'hour') : ago.format(-Math.round(s / DAY_S), 'day'));

function element(name, properties = {}, ...children) {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
}

function counts(alarms) {
    const chip = (count, i) => element('span', { className: `count p${i + 1}`, title: say('priority', { priority: i + 1 }) },
        element('small', {}, `P${i + 1}`), number.format(count));
    return alarms.map((count, i) => count > 0 && chip(count, i)).filter(Boolean);
}

// Returns the lines of a plant's card, each as [name, value, true if it is a problem].
function facts(plant, nowS) {
    const left = plant.certificate_s - nowS;
    return [
        ['links', plant.links_down > 0 ? say('down', { down: plant.links_down, all: plant.links }) : say('up', { all: plant.links }),
            plant.links_down > 0],
        ['recorded', say(plant.recorded ? 'works' : 'broken'), !plant.recorded],
        ...(plant.reloaded ? [] : [['configuration', say('refused'), true]]),
        ['certificate', !plant.certificate_s ? say('off') : left < 0 ? say('expired') : days.format(Math.floor(left / DAY_S)),
            plant.certificate_s > 0 && left < 14 * DAY_S],
        ['disk', plant.free_bytes ? size(plant.free_bytes) : say('unknown'), plant.free_bytes > 0 && plant.free_bytes < 2e9],
        ['backup', plant.backup_s ? since(nowS - plant.backup_s) : say('unknown'), plant.backup_s > 0 && nowS - plant.backup_s > 2 * DAY_S],
        ['version', plant.version || say('unknown'), false],
    ];
}

const needsAttention = (plant, nowS) => !plant.answers || plant.alarms.some((count) => count > 0) ||
    facts(plant, nowS).some(([, , wrong]) => wrong);

function makeCard(plant) {
    const image = element('img', { alt: '', hidden: true }), away = element('p', { className: 'away' });
    const link = element('a', { href: plant.url, target: '_blank', rel: 'noopener noreferrer' },
        element('span', { className: 'picture' }, image, away), element('h2', {}, plant.name));
    const card = { image, away, alarms: element('p', { className: 'alarms' }), list: element('dl'),
        item: element('li', { className: 'plant' }, link) };
    card.item.append(card.alarms, card.list);
    card.item.dataset.plant = plant.id;
    byId('plants').append(card.item);
    cards.set(plant.id, card);
    return card;
}

function show(plant, nowS) {
    const card = cards.get(plant.id) ?? makeCard(plant), known = plant.answered_us > 0;
    card.item.classList.toggle('silent', !plant.answers);
    card.item.hidden = byId('only').checked && !needsAttention(plant, nowS);
    card.away.hidden = plant.answers;
    card.away.textContent = plant.answers ? ''
        : known ? say('since', { time: time(plant.answered_us) }) : say(plant.why ? 'never' : 'first');
    card.away.title = plant.why;
    if (plant.picture && card.picture !== plant.picture) {
        card.picture = plant.picture;
        card.image.src = `picture/${plant.id}?${plant.picture}`;
    }
    card.image.hidden = !plant.picture;
    const shown = known ? counts(plant.alarms) : [];
    const open = plant.unacknowledged > 0 ? say('acknowledge', { count: plant.unacknowledged }) : '';
    const rest = !known ? '' : shown.length === 0 ? say('none') : open;
    card.alarms.replaceChildren(...shown, rest);
    card.list.hidden = !known;
    card.list.replaceChildren(...(known ? facts(plant, nowS) : []).flatMap(([key, value, wrong]) =>
        [element('dt', {}, say(key)), element('dd', { className: wrong ? 'wrong' : '' }, value)]));
}

function showAll({ name, time_us: timeUs, plants }) {
    const nowS = timeUs / 1e6, sum = Array.from({ length: PRIORITIES }, (_, i) =>
        plants.reduce((all, plant) => all + (plant.answers ? plant.alarms[i] : 0), 0));
    document.title = name;
    byId('name').textContent = name;
    const answering = plants.filter(({ answers }) => answers).length;
    byId('totals').replaceChildren(element('li', {}, say('answer', { count: answering, all: plants.length })),
        ...counts(sum).map((count) => element('li', {}, count)));
    for (const plant of plants)
        show(plant, nowS);
}

let last = null;
async function ask() {
    try {
        const answer = await fetch('fleet.json', { signal: AbortSignal.timeout(EVERY_MS * 2) });
        last = await answer.json();
        heardMs = Date.now();
        byId('stale').hidden = true;
        showAll(last);
    } catch {
        byId('stale').hidden = false;
        byId('stale').textContent = say('stale', { time: time(heardMs * 1000) });
    }
    setTimeout(ask, EVERY_MS);
}

document.documentElement.lang = language;
byId('only-label').textContent = say('only');
byId('only').addEventListener('change', () => last && showAll(last));
ask();
