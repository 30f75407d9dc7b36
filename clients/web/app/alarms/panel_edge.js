// SPDX-License-Identifier: GPL-3.0-or-later
// The left edge of the alarm list. Dragging it, or arrow keys while it has the focus, change the widths of picture and list. A double click
// restores the usual width.
import { say } from '../../core/words.js';
import { make, setVariable } from '../common/dom.js';
import { store, stored } from '../common/storage.js';

// LEAST_PX, PICTURE_PX: smallest widths of list and picture; STEP_PX: step of the arrow keys
const LEAST_PX = 400, PICTURE_PX = 280, STEP_PX = 40;

export function addEdge(panel) {
    const setWidth = (px) => {
        const width = px === null ? null : Math.round(Math.max(LEAST_PX, Math.min(innerWidth - PICTURE_PX, px)));
        setVariable(panel, '--wide', width === null ? '' : `${width}px`);
        edge.setAttribute('aria-valuenow', Math.round((100 * panel.offsetWidth) / innerWidth));
        return width;
    };
    const choose = (px) => store('alarmsWidth', String(setWidth(px) ?? ''));
    const move = ({ clientX }) => choose(panel.getBoundingClientRect().right - clientX);
    const edge = make('div', { class: 'edge', role: 'separator', tabindex: 0, 'aria-orientation': 'vertical', 'aria-valuenow': 66,
        'aria-label': say('alarms.edge'), title: say('alarms.edge'), ondblclick: () => choose(null),
        onpointerdown: ({ pointerId }) => edge.setPointerCapture(pointerId),
        onpointermove: (event) => edge.hasPointerCapture(event.pointerId) && move(event), onkeydown: (event) => {
            const sign = { ArrowLeft: 1, ArrowRight: -1 }[event.key];
            if (sign) {
                event.preventDefault();
                choose(panel.offsetWidth + sign * STEP_PX);
            }
        } });
    panel.prepend(edge);
    if (Number(stored('alarmsWidth')) > 0)
        setWidth(Number(stored('alarmsWidth')));
}
