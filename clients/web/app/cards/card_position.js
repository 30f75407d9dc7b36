// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the position of a card over the picture, next to the point that the card describes and never over it.
import { byId } from '../common/dom.js';

const AWAY_PX = 16, RIM_PX = 8, TALLEST_PX = 280;

// Returns the card's { left, top, most (largest height) } for the point `at` ([x, y]; null: none) within the free part of the picture
// (left, top, right, bottom). The card stands on the side with more room; if neither side is wide enough, above or below the point. Pure.
export function cardPlace({ wide, tall }, { left, top, right, bottom }, at) {
    const within = (low, n, high) => Math.round(Math.max(low, Math.min(high, n))), height = Math.min(tall, TALLEST_PX, bottom - top);
    if (!at)
        return { left, top: within(top, bottom, bottom - height), most: Math.min(TALLEST_PX, bottom - top) };
    const [x, y] = at, rooms = [x - AWAY_PX - left, right - x - AWAY_PX], most = Math.max(...rooms);
    if (most >= wide || (x < left - AWAY_PX || x > right + AWAY_PX)) {
        const beside = rooms[1] >= rooms[0] ? x + AWAY_PX : x - AWAY_PX - wide;
        return { left: within(left, beside, right - wide), top: within(top, y - height / 2, bottom - height),
            most: Math.min(TALLEST_PX, bottom - top) };
    }
    const above = y - AWAY_PX - top, below = bottom - y - AWAY_PX, room = Math.max(above, below);
    const low = Math.min(height, room);
    return { left: within(left, x - wide / 2, right - wide), top: Math.round(below >= above ? y + AWAY_PX : y - AWAY_PX - low),
        most: Math.min(TALLEST_PX, room) };
}

// Positions the card next to the point `at` ([x, y] in CSS pixels), clear of the status banner and the legend. If `at` is null, the card
// stands in a corner.
export function standBeside(element, { width, height }, at) {
    const banner = byId('banner'), legend = byId('legend'), lies = legend.offsetWidth > width / 2;
    const above = banner.hidden ? 0 : banner.offsetTop + banner.offsetHeight, strip = lies ? legend.offsetTop + legend.offsetHeight : 0;
    const beside = lies || legend.hidden || legend.offsetLeft <= 0 ? width : legend.offsetLeft;
    const free = { left: RIM_PX, top: RIM_PX + Math.max(above, strip), right: beside - RIM_PX, bottom: height - RIM_PX };
    element.style.maxHeight = '';
    const place = cardPlace({ wide: element.offsetWidth, tall: element.offsetHeight }, free, at);
    element.style.maxHeight = `${Math.max(0, place.most)}px`;
    element.style.transform = `translate(${place.left}px, ${place.top}px)`;
}
