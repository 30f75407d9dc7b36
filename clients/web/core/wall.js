// SPDX-License-Identifier: GPL-3.0-or-later
// Size, brightness and layout on a control room's wall, so that text is readable from where people sit.

// ISO 9241-303: a capital letter is read comfortably from 20 minutes of arc, and needs at least 16.
export const MINUTES = 16;
const CAPITAL = 0.72;  // height of a capital letter, relative to the font size
const SMALLEST_PX = 12.5; // smallest font size of the page in pixels, before scaling
export const USUAL = { inches: 55, metres: 3 };

// Parses ?wall, ?wall=65 (screen inches), ?wall=65,4 (and metres of distance). Returns null if it is not a wall.
export function readWall(search) {
    const text = new URLSearchParams(search).get('wall');
    if (text === null)
        return null;
    const [inches, metres] = text.split(',').map(Number);
    const sane = (n, low, high, usual) => (n >= low && n <= high ? n : usual);
    return { inches: sane(inches, 10, 400, USUAL.inches), metres: sane(metres, 0.5, 50, USUAL.metres) };
}

// Returns the scale relative to a desk. screen: size in CSS pixels, for its diagonal in inches.
export function wallScale({ inches, metres }, screen) {
    const needed = metres * 1000 * Math.tan((MINUTES / 60) * (Math.PI / 180));
    const larger = needed / (CAPITAL * SMALLEST_PX * millimetresPerPx(inches, screen));
    return larger > 1 && larger < Infinity ? larger : 1;
}

export const millimetresPerPx = (inches, { width, height }) => (inches * 25.4) / Math.hypot(width, height);

// Minimum size in units (pixels of a desk page) that holds name, alarms, picture, legend, clock and age.
export const LEAST = { width: 440, height: 250 };

// Returns { scale, metres }: the needed scale, or less so that everything fits; metres: readable distance.
export function wallFit(wall, screen, { width, height }, least = LEAST) {
    const needed = wallScale(wall, screen), fits = Math.min(needed, width / least.width, height / least.height);
    const scale = fits > 0.5 ? fits : 0.5;
    return { scale, metres: scale < needed ? (wall.metres * scale) / needed : wall.metres };
}

// Displays of a wall reconnect all at once: so each waits longer by a random time up to this.
export const SPREAD_MS = 2000;

// Returns a display's brightness: 1, or less within its dimming hours; minute: of the day. Full brightness while an unacknowledged alarm is
// shown.
export function brightness(dim, minute, calls) {
    const { from_min: from, to_min: to, percent } = dim ?? { from_min: 0, to_min: 0 };
    const within = from <= to ? minute >= from && minute < to : minute >= from || minute < to;
    return within && !calls ? percent / 100 : 1;
}

// Shifts a wall's content over time to prevent burn-in: [right, down] in pixels, by the plant's clock.
const SHIFT_US = 180e6, SHIFTS = [[0, 0], [2, 1], [3, -1], [1, -3], [-1, -2], [-3, 0], [-2, 2], [0, 3]];
export const burnShift = (us) => SHIFTS[Math.floor(us / SHIFT_US) % SHIFTS.length] ?? SHIFTS[0];

// Returns whether legends lie below the picture or stand at its side, for a wall's size in units.
export const legendsLie = (width, height, split) => width < height || (split && width < 800);
