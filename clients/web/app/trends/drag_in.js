// SPDX-License-Identifier: GPL-3.0-or-later
// Drags a tag from the equipment list, or a marker in the picture, into the open trend.
import { nearestMarker } from '../../core/nearest.js';
import { byId, make, setVariable } from '../common/dom.js';

const REACH_PX = 8, STARTED_PX = 5;

// trends: its add(tag) receives the dragged tag. handlers.click(x, y, kind): called when a marker is pressed and released
// without a drag.
export function listenToDrags({ trends, session, overlay, handlers }) {
    // the current drag of a tag: { tag, x, y (of the press), ghost (label at the pointer), marker (position in the picture, or
    // null) }; null: none
    let drag = null;

    function tagUnder({ target, clientX, clientY }) {
        const row = target.closest('.reading[data-row^="tag/"]');
        if (row)
            return { tag: session.model.tags[Number(row.dataset.row.slice(4))], marker: null };
        const picture = target.id === 'viewport' || target.closest('#viewport') ? byId('viewport').getBoundingClientRect() : null;
        if (!picture || target.closest('button, .card, .banner, .legend'))
            return null;
        const x = clientX - picture.left, y = clientY - picture.top;
        const found = nearestMarker(overlay.markers, x / overlay.unit, y / overlay.unit, REACH_PX);
        return found ? { tag: found.tag, marker: { x, y } } : null;
    }

    document.addEventListener('pointerdown', (event) => {
        const isPlain = event.button === 0 && event.pointerType === 'mouse' && !event.shiftKey && !event.ctrlKey;
        const found = trends.isOpen && isPlain && session.model ? tagUnder(event) : null;
        if (!found?.tag)
            return;
        drag = { ...found, x: event.clientX, y: event.clientY, ghost: null };
        if (found.marker)
            event.stopPropagation(); // stops the event, which would otherwise rotate the camera
    }, { capture: true });

    document.addEventListener('pointermove', ({ clientX, clientY }) => {
        if (!drag || (!drag.ghost && Math.hypot(clientX - drag.x, clientY - drag.y) < STARTED_PX))
            return;
        if (!drag.ghost) {
            drag.ghost = make('div', { class: 'drag-ghost' }, drag.tag.name);
            document.body.append(drag.ghost);
        }
        setVariable(drag.ghost, '--left', `${clientX}px`);
        setVariable(drag.ghost, '--top', `${clientY}px`);
        trends.element.classList.toggle('takes', isOverTrends(clientX, clientY) && trends.takes(drag.tag));
    }, { capture: true });

    const isOverTrends = (x, y) => Boolean(document.elementFromPoint(x, y)?.closest('#trends'));
    const end = (event, isDone) => {
        const { tag, marker, ghost } = drag ?? {};
        drag = null;
        ghost?.remove();
        trends.element.classList.remove('takes');
        if (!isDone || !tag)
            return;
        if (ghost && isOverTrends(event.clientX, event.clientY))
            trends.add(tag);
        else if (!ghost && marker)
            handlers.click(marker.x, marker.y, 'mouse');
        if (ghost)
            swallowClick();
    };
    // Suppresses the click event after a drag; it would select the object under the pointer.
    function swallowClick() {
        const stop = (click) => click.stopPropagation();
        document.addEventListener('click', stop, { capture: true, once: true });
        setTimeout(() => document.removeEventListener('click', stop, { capture: true }));
    }

    document.addEventListener('pointerup', (event) => end(event, true), { capture: true });
    document.addEventListener('pointercancel', (event) => end(event, false), { capture: true });
    document.addEventListener('dragstart', (event) => drag && event.preventDefault(), { capture: true });
}
