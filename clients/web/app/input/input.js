// SPDX-License-Identifier: GPL-3.0-or-later
// Passes pointer and keyboard input to the camera controller. The first input loads the controller; input until then is queued and
// replayed.
const ON_PICTURE = ['pointerdown', 'pointermove', 'pointerup', 'pointercancel', 'pointerleave', 'wheel'];
const ON_PAGE = ['keydown', 'keyup'];
const NEAR = ['pointerover', 'focusin', 'keydown'];
const STALE_MS = 2000; // longest time in milliseconds that input stays queued; older input is dropped

// Returns true if an event is meant for the picture, not for a control over it.
export const isOnPicture = (event) => !event.target.closest('button, .card, .banner, .legend');

// Returns true if the event calls for a reaction, unlike mere motion of the pointer.
const isMeant = ({ type, key, target }) => type === 'pointerdown' || type === 'wheel' ||
    (type === 'keydown' && /^(.|Arrow.*)$/.test(key) && !target.closest('input, select, textarea'));

// Does at once what cannot wait for the camera controller to load, such as preventDefault().
function takeAtOnce(event, element) {
    if (event.type === 'wheel' || event.button === 1)
        event.preventDefault(); // prevents the browser from scrolling
    if (event.type === 'pointerdown' && isOnPicture(event)) {
        element.setPointerCapture(event.pointerId);
        element.focus({ preventScroll: true });
    }
}

export function listenToInput(element, modules) {
    // drag: times of the first and last event of the queued drag. The drag is dropped only if its last event is too old.
    let pending = [], drag = { from: Infinity, to: 0 };

    function handle(event) {
        takeAtOnce(event, element);
        const cameraController = modules.there('cameraController');
        if (cameraController) {
            cameraController.handle(event);
            return;
        }
        const { type, timeStamp } = event;
        pending = [...pending.filter(isFresh), event];
        if (type === 'pointerdown' && drag.to < Infinity)
            drag = { from: timeStamp, to: Infinity };
        else if (/^pointer[uc]/.test(type))
            drag.to = timeStamp;
        (isMeant(event) ? modules.get('cameraController') : modules.prepare('cameraController')).then(flush);
    }

    function flush(cameraController) {
        pending.filter(isFresh).forEach((event) => cameraController.handle(event));
        pending = [];
    }

    const near = () => ['cameraController', 'commands'].forEach((name) => modules.prepare(name));
    const isFresh = ({ timeStamp: at }) => performance.now() - (at >= drag.from ? Math.max(at, drag.to) : at) < STALE_MS;
    const listen = (on, names) => names.forEach((name) => on.addEventListener(name, handle, { passive: false }));
    listen(element, ON_PICTURE);
    listen(document, ON_PAGE);
    for (const name of ['contextmenu', 'auxclick'])
        element.addEventListener(name, (event) => event.preventDefault());
    for (const name of NEAR)
        document.addEventListener(name, near, { once: true, capture: true, passive: true });
}
