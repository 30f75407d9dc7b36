// SPDX-License-Identifier: GPL-3.0-or-later
// Converts between the sun's azimuth (from north through east) and elevation in degrees, and the server's direction vector. North is y if
// the plant's vertical is Z, -z if it is Y.
import { say } from './words.js';

const WINDS = ['N', 'NE', 'E', 'SE', 'S', 'SW', 'W', 'NW'];
const radians = (degrees) => (degrees * Math.PI) / 180, degrees = (angle) => (angle * 180) / Math.PI;

export function towardsSun({ turn, height }, isYUp) {
    const flat = Math.cos(radians(height)), east = flat * Math.sin(radians(turn)), north = flat * Math.cos(radians(turn));
    const up = Math.sin(radians(height));
    return isYUp ? [east, up, -north] : [east, north, up];
}

export function sunOf([x, y, z], isYUp) {
    const north = isYUp ? -z : y, up = isYUp ? y : z;
    const turn = (Math.round(degrees(Math.atan2(x, north))) + 360) % 360;
    return { turn, height: Math.round(degrees(Math.atan2(up, Math.hypot(x, north)))) };
}

export const sunText = ({ turn, height }) => say('sun', { wind: say(`wind.${WINDS[Math.round(turn / 45) % 8]}`), height });
