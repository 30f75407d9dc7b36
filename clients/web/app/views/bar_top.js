// SPDX-License-Identifier: GPL-3.0-or-later
// Tells the style sheet of panels (common/panel.css) where the bar of the right half begins, so that no panel covers the bar.
import { byId, setVariable } from '../common/dom.js';

const PANEL_PX = 346; // a panel lies within this distance of the window's right edge

function tell() {
    const bars = [...document.querySelectorAll('.split-bar, .compare-bar')].map((bar) => bar.getBoundingClientRect())
        .filter(({ width, right }) => width > 0 && right > innerWidth - PANEL_PX);
    setVariable(document.body, '--bar-top', bars.length > 0 ? `${Math.min(...bars.map(({ top }) => top))}px` : '');
}

// Keeps panels above a bar at the bottom of the picture from now on.
export function keepPanelsAbove(bar) {
    const observer = new ResizeObserver(tell);
    observer.observe(bar);
    observer.observe(byId('viewport'));
}
