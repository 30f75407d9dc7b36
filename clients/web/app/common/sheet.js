// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets: on a phone, panels and cards are below the picture or at its side instead of over it (common/sheet.css). The style sheet
// defines two heights of a sheet; the class `other-sheet` on the root element selects the second. A tap or a drag on the
// sheet's grip toggles the class. This file also expands the legend's strip on a tap, and adds a button for the alarm list at the
// lower edge of the screen.
import { byId, make, makeSvg, phone } from './dom.js';

const GRIP_PX = 24, SLOP_PX = 8;
const BELL = 'M10 3a4.5 4.5 0 0 1 4.5 4.5c0 4 1.5 5.5 1.5 5.5H4s1.5-1.5 1.5-5.5A4.5 4.5 0 0 1 10 3M8.5 16a1.5 1.5 0 0 0 3 0';
// true if sheets are below the picture; sheets at its side have one height and no grip
const isBelow = window.matchMedia('(max-width: 719px) and (min-height: 481px), (max-width: 480px)');
const SHEETS = '.panel.open, .display.open, .alarms, .engineer, .assets, .stage > .card', CARDS = ['card', 'place'].map(byId);

// Does the same as the alarm strip, which is at the top of the screen, where the thumb of the hand that holds the phone does not reach.
const strip = byId('alarm-strip'), bell = make('button', { class: 'icon', id: 'alarms-toggle', 'aria-controls': 'alarms',
    onclick: () => strip.click() }, makeSvg('svg', { 'aria-hidden': 'true' }, makeSvg('path', { d: BELL })));

// Gives the button the strip's state and text, and the number of active alarms.
function copyStrip() {
    const { kind, active = '0' } = strip.dataset, words = byId('alarm-words').textContent;
    Object.assign(bell.dataset, { kind, count: active === '0' ? '' : active });
    bell.setAttribute('aria-expanded', strip.getAttribute('aria-expanded'));
    bell.setAttribute('aria-label', words);
    bell.title = words;
}

let drag = null; // drag: { y (where the drag began), moved (pixels so far, downwards) }; null: no drag

function stand() {
    const parent = phone.matches ? document.querySelector('.stage') : byId('viewport');
    CARDS.filter((card) => card.parentElement !== parent).forEach((card) => parent.append(card));
    if (!phone.matches) {
        ['legend', 'legend-right'].forEach((id) => byId(id).classList.remove('whole'));
        bell.remove();
    } else if (isBelow.matches) {
        if (byId('groups').nextElementSibling !== bell) // an element that is moved loses the focus
            byId('groups').after(bell); // in the row above the tools
    } else if (byId('more-toggle').previousElementSibling !== bell)
        byId('more-toggle').before(bell); // in the column of tools
}

const { documentElement: root } = document;
const sheetHeight = () => parseFloat(getComputedStyle(root).getPropertyValue('--sheet'));

// Switches sheets to their other height. grows: drag direction; true: only if the other height is larger; false: only if it is
// smaller; null: a tap, which always switches.
function changeHeight(grows = null) {
    const before = sheetHeight();
    root.classList.toggle('other-sheet');
    if (grows !== null && grows !== sheetHeight() > before)
        root.classList.toggle('other-sheet');
}

// Returns true if a press is on a sheet's grip. The event's target cannot tell, because browsers assign a touch to a nearby
// control.
const isGrip = ({ clientX: x, clientY: y }) => [...document.querySelectorAll(SHEETS)].some((sheet) => {
    const { left, right, top, width } = sheet.getBoundingClientRect();
    return width > 0 && x >= left && x <= right && y >= top && y < top + GRIP_PX;
});

document.addEventListener('pointerdown', (event) => {
    if (!isBelow.matches || !isGrip(event) || event.target.closest('button, input'))
        return;
    drag = { y: event.clientY, moved: 0 };
    event.stopPropagation();
}, true);
document.addEventListener('pointermove', (event) => {
    if (drag)
        drag.moved = event.clientY - drag.y;
});
// Prevents the sheet from scrolling while its grip is dragged.
document.addEventListener('touchmove', (event) => drag && event.preventDefault(), { passive: false });
document.addEventListener('pointerup', (event) => {
    if (!drag)
        return;
    changeHeight(Math.abs(drag.moved) < SLOP_PX ? null : drag.moved < 0);
    drag = null;
    event.stopPropagation();
}, true);
document.addEventListener('pointercancel', () => { drag = null; });
for (const id of ['legend', 'legend-right'])
    byId(id).addEventListener('click', () => byId(id).classList.toggle('whole', phone.matches && !byId(id).classList.contains('whole')));
// Returns sheets to their usual height when the time bar opens or closes, because the time bar changes the room for sheets.
new MutationObserver(() => root.classList.remove('other-sheet'))
    .observe(byId('timeline'), { attributes: true, attributeFilter: ['hidden'] });
new MutationObserver(copyStrip)
    .observe(strip, { attributeFilter: ['data-kind', 'data-active', 'aria-expanded'], childList: true, subtree: true });
copyStrip();
for (const screen of [phone, isBelow])
    screen.addEventListener('change', stand);
stand();
