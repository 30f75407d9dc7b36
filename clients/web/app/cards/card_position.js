// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the position of a card over the picture: next to the point that the card describes, never over it, and over as few other markers
// as possible.
import { projector } from '../../core/camera.js';
import { halves } from '../../core/split_view.js';
import { byId } from '../common/dom.js';

const AWAY_PX = 16, RIM_PX = 8, TALLEST_PX = 280, LEAST_PX = 200; // LEAST_PX: width below which a card is not readable
// PANELS: panels that lie over the picture's right side; BARS: bars along its lower edge
const PANELS = ':is(.panel, .display, .more).open', BARS = '#moment:not([hidden]), .split-bar:not([hidden])';
const LEGEND_PX = 12; // distance of the legend from the picture's edge
// RING_PX: half the width of an alarm ring; RING_COST: a covered ring counts as this many covered markers
const RING_PX = 14, RING_COST = 3;

// Returns the card's { left, top, most (maximum height) } for the point `at` ([x, y]; null: none) within the free part of the
// picture (left, top, right, bottom). marks: other markers, [x, y, isRing]. last: the previous position, which the card leaves
// only for one that covers less. Among positions that cover equally much, the card takes the side with more room; if neither
// side is wide enough, a position above or below the point. Has no side effects.
export function cardPlace(card, free, at, marks = [], last = null) {
    const tall = Math.min(card.tall, TALLEST_PX, free.bottom - free.top), covers = ({ left, top }) => marks.reduce((sum, [x, y, isRing]) =>
        (x > left - RING_PX && x < left + card.wide + RING_PX && y > top - RING_PX && y < top + tall + RING_PX
            ? sum + (isRing ? RING_COST : 1) : sum), 0);
    const places = placesOf(card.wide, tall, free, at).map((place) => ({ ...place, cost: covers(place) }));
    const [best] = [...places].sort((a, b) => a.cost - b.cost), same = places.find(({ side }) => side === last?.side);
    return same && same.cost <= best.cost ? same : best;
}

// Returns all positions for a card of this width and height in CSS pixels, preferred ones first: { side, left, top, most
// (maximum height) }. left, top, right, bottom: edges of the free part of the picture; at: the point that the card describes,
// or null.
function placesOf(wide, tall, { left, top, right, bottom }, at) {
    const within = (low, n, high) => Math.round(Math.max(low, Math.min(high, n))), full = Math.min(TALLEST_PX, bottom - top);
    const place = (side, x, y, most = full) => ({ side, left: within(left, x, right - wide), top: within(top, y, bottom - tall), most });
    if (!at)
        return [place('corner', left, bottom)];
    const [x, y] = at, isOutside = x < left - AWAY_PX || x > right + AWAY_PX;
    const rooms = { left: x - AWAY_PX - left, right: right - x - AWAY_PX, above: y - AWAY_PX - top, below: bottom - y - AWAY_PX };
    const sides = ['right', 'left'].sort((a, b) => rooms[b] - rooms[a]).filter((side, i) => rooms[side] >= wide || (isOutside && i === 0));
    const beside = sides.flatMap((side) => [y - tall / 2, y - AWAY_PX, y + AWAY_PX - tall].map((up, i) =>
        place(`${side}${i}`, side === 'right' ? x + AWAY_PX : x - AWAY_PX - wide, up)));
    const [high, low] = rooms.above > rooms.below ? ['above', 'below'] : ['below', 'above'];
    const levels = [high, low].filter((level, i) => rooms[level] >= tall || (i === 0 && beside.length === 0));
    return [...beside, ...levels.flatMap((level) => [x - wide / 2, x - AWAY_PX, x + AWAY_PX - wide].map((along, i) => {
        const most = Math.min(TALLEST_PX, rooms[level]), height = Math.min(tall, most);
        return { ...place(`${level}${i}`, along, 0, most), top: Math.round(level === 'below' ? y + AWAY_PX : y - AWAY_PX - height) };
    }))];
}

// Returns the position in CSS pixels of a point of the plant in the picture on the screen; null: it is behind the camera. half:
// half of a split view, 0 left, 1 right.
export function placeInPicture({ picture, shown }, { width, height }, position, half = 0) {
    const part = picture && halves(shown, picture.shownWidth)[half];
    const at = part && projector(picture.camera, part.width, picture.fullHeight)(position);
    return at ? [((part.left + at[0]) * width) / picture.shownWidth, (at[1] * height) / picture.fullHeight] : null;
}

// Returns the left and right edge of the part of the picture that the legend and the open panels leave free, and the lower edge of a legend
// that lies across the top of the picture. An open panel may have moved the legend to the left edge (common/panel.css). A legend that
// would leave too little room by itself is ignored: the card may cover it. On walls, the legend is next to the picture.
function freeBeside(width) {
    const viewport = byId('viewport'), legend = byId('legend'), { offsetLeft: left, offsetWidth: wide } = legend;
    const isOver = viewport.contains(legend) && !legend.hidden && wide > 0, lies = isOver && wide > width / 2;
    const beside = left <= LEGEND_PX ? { left: left + wide, right: width } : { left: 0, right: left };
    const hasSpace = isOver && !lies && beside.right - beside.left >= LEAST_PX + 2 * RIM_PX;
    const free = hasSpace ? beside : { left: 0, right: width };
    const picture = viewport.getBoundingClientRect();
    for (const box of [...document.querySelectorAll(PANELS)].map((panel) => panel.getBoundingClientRect()))
        if (box.left < picture.right && box.right > picture.left && box.top < picture.bottom && box.bottom > picture.top)
            free.right = Math.min(free.right, box.left - picture.left);
    return { left: free.left + RIM_PX, right: free.right - RIM_PX, below: lies ? legend.offsetTop + legend.offsetHeight : 0 };
}

// Returns whether the picture has room for a card between the legend and the open panels.
export function hasRoom({ width }) {
    const { left, right } = freeBeside(width);
    return right - left >= LEAST_PX;
}

// Positions the card next to the point `at` ([x, y] in CSS pixels; null: in a corner), clear of the status banner, the legend, open panels,
// the bar of a split view and the name of the alarm whose moment is shown. Leaves other visible markers of `overlay` uncovered where there
// is room. Hides the card while there is no room for it. On phones, the card is a sheet (common/sheet.css), and has no position.
const places = new WeakMap(); // card's element -> { of (the object that the card describes), place (the card's last position) }
export function standBeside(element, { width, height }, at, overlay, of) {
    Object.assign(element.style, { maxWidth: '', maxHeight: '' });
    element.classList.remove('no-room');
    if (!byId('viewport').contains(element))
        return;
    const banner = byId('banner'), { left, right, below } = freeBeside(width);
    const above = banner.hidden ? 0 : banner.offsetTop + banner.offsetHeight;
    const low = [...document.querySelectorAll(BARS)].map(({ offsetTop }) => offsetTop).filter((top) => top > above + TALLEST_PX);
    const free = { left, top: RIM_PX + Math.max(above, below), right, bottom: Math.min(height, ...low) - RIM_PX };
    if (right - left < LEAST_PX) {
        element.classList.add('no-room');
        return;
    }
    const marks = overlay.markers.filter(({ tag, occluded, alarm }) => tag !== of && (alarm || !occluded)).map((marker) => {
        const { x, y } = overlay.placeOf(marker);
        return [x, y, Boolean(marker.alarm)];
    });
    element.style.maxWidth = `${right - left}px`;
    const last = places.get(element), card = { wide: element.offsetWidth, tall: element.offsetHeight };
    const place = cardPlace(card, free, at, marks, last?.of === of ? last.place : null);
    places.set(element, { of, place });
    element.style.maxHeight = `${Math.max(0, place.most)}px`;
    element.style.transform = `translate(${place.left}px, ${place.top}px)`;
}
