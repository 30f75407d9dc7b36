// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the position of a card over the picture.
import { byId } from '../common/dom.js';

const AWAY_PX = 16, WIDTH_PX = 248, RIM_PX = 8;

// Positions the card next to the point `at` ([x, y] in CSS pixels): on the side where it does not cover the legend, else on the side with
// more room, and below the status banner. If `at` is null, the card stands in a corner.
export function standBeside(element, { width, height }, at) {
    const banner = byId('banner'), top = RIM_PX + (banner.hidden ? 0 : banner.offsetTop + banner.offsetHeight);
    element.style.maxHeight = `${Math.max(0, height - top - RIM_PX)}px`;
    const tall = element.offsetHeight;
    const sides = at && [at[0] + AWAY_PX, at[0] - AWAY_PX - WIDTH_PX], free = byId('legend').offsetLeft || width;
    const clear = sides?.find((left) => left >= RIM_PX && left + WIDTH_PX + RIM_PX <= free);
    const x = !at ? RIM_PX : clear ?? (at[0] < width / 2 ? sides[0] : sides[1]);
    const within = (low, n, high) => Math.round(Math.max(low, Math.min(high, n)));
    const left = within(RIM_PX, x, width - WIDTH_PX - RIM_PX), y = within(top, at ? at[1] - tall / 2 : height, height - tall - RIM_PX);
    element.style.transform = `translate(${left}px, ${y}px)`;
}
