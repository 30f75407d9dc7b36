// SPDX-License-Identifier: GPL-3.0-or-later
// Handles wheel, touch and keys on the trend charts: zooms, pans and moves the crosshair. (plot.js handles the mouse drag that
// zooms.)
import { pointAtInstant } from '../common/crosshair.js';

const WHEEL = 0.0016, LINE_PX = 16, PAN_PX = 0.0025, KEY_ZOOM = 1.5, KEY_PAN = 0.25, STEPS = 120, BIG = 10;

// view: the trends (trends.js). range: [from, to] in us; zoomBy(factor, at): multiplies the range by factor around the instant `at`;
// pan(part): moves by this fraction of the range; live(): back to now; travel(us): shows the plant at this instant; crosshairUs: instant of
// the crosshair. element: holds the charts.
export function listenToGestures(view, element) {
    const fingers = new Map(); // pointer id -> x
    let dragged = null; // pointer's x at the last event of a panning mouse drag; null: no such drag
    const over = () => element.querySelector('.u-over')?.getBoundingClientRect() ?? element.getBoundingClientRect();
    const instantAt = (x) => {
        const { left, width } = over(), [from, to] = view.range;
        return from + ((to - from) * (x - left)) / width;
    };
    const part = (px) => px / over().width;

    element.addEventListener('wheel', (event) => {
        event.preventDefault();
        const { deltaX, deltaY, deltaMode, shiftKey } = event, scale = deltaMode === 1 ? LINE_PX : 1;
        const along = shiftKey && deltaX === 0 ? deltaY : deltaX;
        if (shiftKey || Math.abs(deltaX) > Math.abs(deltaY))
            view.pan(along * scale * PAN_PX);
        else
            view.zoomBy(Math.exp(deltaY * scale * WHEEL), instantAt(event.clientX));
    }, { passive: false });

    element.addEventListener('pointerdown', (event) => {
        if (event.pointerType === 'touch')
            fingers.set(event.pointerId, event.clientX);
        else if (event.shiftKey || event.button === 1 || event.target.closest('.u-axis'))
            dragged = event.clientX;
        if (event.button === 1)
            event.preventDefault();
        if (dragged !== null || fingers.size > 0)
            element.setPointerCapture(event.pointerId);
    });
    element.addEventListener('pointermove', ({ pointerId, clientX }) => {
        if (dragged !== null) {
            view.pan(-part(clientX - dragged));
            dragged = clientX;
        } else if (fingers.size === 1 && fingers.has(pointerId)) {
            view.pan(-part(clientX - fingers.get(pointerId)));
            fingers.set(pointerId, clientX);
        } else if (fingers.size === 2 && fingers.has(pointerId)) {
            const spread = () => { const [a, b] = [...fingers.values()]; return [Math.max(8, Math.abs(a - b)), (a + b) / 2]; };
            const [before] = spread();
            fingers.set(pointerId, clientX);
            const [after, middle] = spread();
            view.zoomBy(before / after, instantAt(middle));
        }
    });
    for (const name of ['pointerup', 'pointercancel'])
        element.addEventListener(name, ({ pointerId }) => {
            fingers.delete(pointerId);
            dragged = null;
        });

    element.addEventListener('keydown', (event) => {
        if (event.ctrlKey || event.altKey || event.metaKey)
            return;
        const [from, to] = view.range, at = view.crosshairUs ?? (from + to) / 2;
        const step = ((to - from) / STEPS) * (event.shiftKey ? BIG : 1), zoom = (factor) => view.zoomBy(factor, at);
        const cross = (us) => pointAtInstant(Math.min(to, Math.max(from, us)), null);
        const action = {
            ArrowLeft: () => cross(at - step), ArrowRight: () => cross(at + step), PageUp: () => view.pan(-KEY_PAN),
            PageDown: () => view.pan(KEY_PAN), '+': () => zoom(1 / KEY_ZOOM), '=': () => zoom(1 / KEY_ZOOM), '-': () => zoom(KEY_ZOOM),
            Home: () => view.back(), Enter: () => view.travel(at),
        }[event.key];
        if (!action)
            return;
        event.preventDefault();
        action();
    });
}
