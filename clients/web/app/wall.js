// SPDX-License-Identifier: GPL-3.0-or-later
// The page on a control room's wall: larger, with nothing to press, and the screen stays on.
import { readWall, wallScale } from '../core/wall.js';
import { setVariable, styled } from './dom.js';

// page.unit from now on: how large a unit of the page is; page.onUnit() where that changes.
export async function hangOnWall(search, page) {
    const wall = readWall(search), fit = () => {
        page.unit = wallScale(wall, window.screen);
        setVariable(document.body, '--wall', page.unit);
        page.onUnit();
    };
    await styled('wall');
    document.body.classList.add('wall');
    window.addEventListener('resize', fit);
    fit();
    const stayOn = () => !document.hidden && navigator.wakeLock?.request('screen').catch(() => {}); // where the browser lets us
    document.addEventListener('visibilitychange', stayOn);
    stayOn();
}
