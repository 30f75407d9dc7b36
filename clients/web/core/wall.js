// SPDX-License-Identifier: GPL-3.0-or-later
// Computes size, brightness and layout of the page on a control room's video wall, so that text is readable from where people
// sit.

// visual angle of a capital letter's height. ISO 9241-303: a capital letter is comfortable to read from 20 minutes of arc on; it needs at
// least 16.
export const MINUTES = 16;
const CAPITAL = 0.72;  // height of a capital letter, relative to the font size
const SMALLEST_PX = 12.5; // minimum font size of the page in pixels, before the page is enlarged for a video wall
export const USUAL = { inches: 55, metres: 3 };

// Parses ?wall, ?wall=65 (inches of the screen's diagonal), ?wall=65,4 (and metres of distance). Returns null if there is no ?wall.
export function readWall(search) {
    const text = new URLSearchParams(search).get('wall');
    if (text === null)
        return null;
    const [inches, metres] = text.split(',').map(Number);
    const sane = (n, low, high, usual) => (n >= low && n <= high ? n : usual);
    return { inches: sane(inches, 10, 400, USUAL.inches), metres: sane(metres, 0.5, 50, USUAL.metres) };
}

// Returns how many times larger the page must be than on an ordinary screen. screen: size in CSS pixels; with the diagonal in
// inches it gives the size of a pixel.
export function wallScale({ inches, metres }, screen) {
    const needed = metres * 1000 * Math.tan((MINUTES / 60) * (Math.PI / 180));
    const larger = needed / (CAPITAL * SMALLEST_PX * millimetresPerPx(inches, screen));
    return larger > 1 && larger < Infinity ? larger : 1;
}

export const millimetresPerPx = (inches, { width, height }) => (inches * 25.4) / Math.hypot(width, height);

// minimum page size, in pixels before scaling, that has room for name, alarms, picture, legend, clock and age
export const LEAST = { width: 440, height: 250 };

// Returns { scale, metres }. scale: the required factor, or a smaller one at which everything fits; metres: largest distance
// from which the text is then readable.
export function wallFit(wall, screen, { width, height }, least = LEAST) {
    const needed = wallScale(wall, screen), fits = Math.min(needed, width / least.width, height / least.height);
    const scale = fits > 0.5 ? fits : 0.5;
    return { scale, metres: scale < needed ? (wall.metres * scale) / needed : wall.metres };
}

// All displays of a video wall lose the server at the same time, so each waits for a random time up to this many milliseconds
// before it reconnects.
export const SPREAD_MS = 2000;

// Returns a display's brightness: 1, or less within its dimming hours. minute: minute of the day; calls true: an unacknowledged
// alarm is shown, which requires full brightness.
export function brightness(dim, minute, calls) {
    const { from_min: from, to_min: to, percent } = dim ?? { from_min: 0, to_min: 0 };
    const within = from <= to ? minute >= from && minute < to : minute >= from || minute < to;
    return within && !calls ? percent / 100 : 1;
}

// Offsets [right, down] in pixels for the content of a video wall. To prevent burn-in, the content moves from one offset to the
// next, by the plant's clock.
const SHIFT_US = 180e6, SHIFTS = [[0, 0], [2, 1], [3, -1], [1, -3], [-1, -2], [-3, 0], [-2, 2], [0, 3]];
export const burnShift = (us) => SHIFTS[Math.floor(us / SHIFT_US) % SHIFTS.length] ?? SHIFTS[0];

// Returns true if legends lie below the picture, false if they are at its side. width, height: size of the wall's page in its units
// (page.unit).
export const legendsLie = (width, height, split) => width < height || (split && width < 800);
