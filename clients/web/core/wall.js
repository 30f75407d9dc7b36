// SPDX-License-Identifier: GPL-3.0-or-later
// How large everything on a control room's wall must be to be read from where people sit, how bright, and where it lies.

// ISO 9241-303: a capital letter is well read from 20 minutes of arc on, and no smaller than 16.
export const MINUTES = 16;
const CAPITAL = 0.72;  // of a letter's size, in the fonts of the page
const SMALLEST_PX = 12.5; // what is written in the page, before it is enlarged
export const USUAL = { inches: 55, metres: 3 };

// ?wall, ?wall=65 (inches of the screen), ?wall=65,4 (and metres to it). null: no wall.
export function readWall(search) {
    const text = new URLSearchParams(search).get('wall');
    if (text === null)
        return null;
    const [inches, metres] = text.split(',').map(Number);
    const sane = (n, low, high, usual) => (n >= low && n <= high ? n : usual);
    return { inches: sane(inches, 10, 400, USUAL.inches), metres: sane(metres, 0.5, 50, USUAL.metres) };
}

// How much larger than on a desk: screen in CSS pixels, which its diagonal holds.
export function wallScale({ inches, metres }, screen) {
    const needed = metres * 1000 * Math.tan((MINUTES / 60) * (Math.PI / 180));
    const larger = needed / (CAPITAL * SMALLEST_PX * millimetresPerPx(inches, screen));
    return larger > 1 && larger < Infinity ? larger : 1;
}

export const millimetresPerPx = (inches, { width, height }) => (inches * 25.4) / Math.hypot(width, height);

// The least that everything fits into, in units of a desk's pixels: name, alarms, picture, legend, clock and age.
export const LEAST = { width: 440, height: 250 };

// { scale, metres }: as large as is needed, or as all of it fits into the window; read from so far.
export function wallFit(wall, screen, { width, height }, least = LEAST) {
    const needed = wallScale(wall, screen), fits = Math.min(needed, width / least.width, height / least.height);
    const scale = fits > 0.5 ? fits : 0.5;
    return { scale, metres: scale < needed ? (wall.metres * scale) / needed : wall.metres };
}

// Displays of walls come back all at once: each waits up to so much longer.
export const SPREAD_MS = 2000;

// How bright a display is now: 1, or less within its hours, `minute` of the day. Never less while an alarm calls.
export function brightness(dim, minute, calls) {
    const { from_min: from, to_min: to, percent } = dim ?? { from_min: 0, to_min: 0 };
    const within = from <= to ? minute >= from && minute < to : minute >= from || minute < to;
    return within && !calls ? percent / 100 : 1;
}

// By how much all that a wall shows is moved now, so that nothing burns in: [to the right, down] in pixels, at a time of the plant's clock.
const SHIFT_US = 180e6, SHIFTS = [[0, 0], [2, 1], [3, -1], [1, -3], [-1, -2], [-3, 0], [-2, 2], [0, 3]];
export const burnShift = (us) => SHIFTS[Math.floor(us / SHIFT_US) % SHIFTS.length] ?? SHIFTS[0];

// Whether legends lie below the picture or stand beside it, on a wall so many units wide and high.
export const legendsLie = (width, height, split) => width < height || (split && width < 800);
