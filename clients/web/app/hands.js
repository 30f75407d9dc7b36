// SPDX-License-Identifier: GPL-3.0-or-later
// What hands do over the picture, and on the keyboard, is told to the pilot. It is loaded when they first come near the page, and hears
// then what they did meanwhile.
const ON_PICTURE = ['pointerdown', 'pointermove', 'pointerup', 'pointercancel', 'pointerleave', 'wheel'];
const ON_PAGE = ['keydown', 'keyup'];
const NEAR = ['pointerover', 'focusin', 'keydown'];
const STALE_MS = 2000; // what was done so long ago nobody means any more

// Controls that lie over the picture keep their own clicks.
export const isOnPicture = (event) => !event.target.closest('button, .card, .banner, .legend');

// Who does that waits for something to happen.
const isMeant = ({ type, key, target }) => type === 'pointerdown' || type === 'wheel' ||
    (type === 'keydown' && /^(.|Arrow.*)$/.test(key) && !target.closest('input, select, textarea'));

// What cannot wait for the pilot.
function takeAtOnce(event, element) {
    if (event.type === 'wheel' || event.button === 1)
        event.preventDefault(); // it would scroll
    if (event.type === 'pointerdown' && isOnPicture(event)) {
        element.setPointerCapture(event.pointerId);
        element.focus({ preventScroll: true });
    }
}

export function listenToHands(element, parts) {
    let untold = [], drag = { from: Infinity, to: 0 }; // a drag is as fresh as its end

    function hear(event) {
        takeAtOnce(event, element);
        const pilot = parts.there('pilot');
        if (pilot) {
            pilot.hear(event);
            return;
        }
        const { type, timeStamp } = event;
        untold = [...untold.filter(isFresh), event];
        if (type === 'pointerdown' && drag.to < Infinity)
            drag = { from: timeStamp, to: Infinity };
        else if (/^pointer[uc]/.test(type))
            drag.to = timeStamp;
        (isMeant(event) ? parts.get('pilot') : parts.prepare('pilot')).then(tellAll);
    }

    function tellAll(pilot) {
        untold.filter(isFresh).forEach((event) => pilot.hear(event));
        untold = [];
    }

    const near = () => ['pilot', 'commands'].forEach((name) => parts.prepare(name));
    const isFresh = ({ timeStamp: at }) => performance.now() - (at >= drag.from ? Math.max(at, drag.to) : at) < STALE_MS;
    const listen = (on, names) => names.forEach((name) => on.addEventListener(name, hear, { passive: false }));
    listen(element, ON_PICTURE);
    listen(document, ON_PAGE);
    for (const name of ['contextmenu', 'auxclick'])
        element.addEventListener(name, (event) => event.preventDefault());
    for (const name of NEAR)
        document.addEventListener(name, near, { once: true, capture: true, passive: true });
}
