// SPDX-License-Identifier: GPL-3.0-or-later
// The page on a control room's wall: larger, with nothing to press, and the screen stays on.
import { wallScale } from '../core/wall.js';
import { setVariable } from './dom.js';

// wall: as core/wall.js reads it.
export function hangOnWall(wall, { overlay, refresh }) {
    const fit = () => {
        overlay.unit = wallScale(wall, window.screen);
        setVariable(document.body, '--wall', overlay.unit);
        refresh();
    };
    document.body.classList.add('wall');
    window.addEventListener('resize', fit);
    fit();
    const stayOn = () => !document.hidden && navigator.wakeLock?.request('screen').catch(() => {}); // where the browser lets us
    document.addEventListener('visibilitychange', stayOn);
    stayOn();
}
