// SPDX-License-Identifier: GPL-3.0-or-later
// Watches the page's main thread from a worker. When the thread has been silent for 10 s, the worker draws a warning over the
// page. If the page is shown on a video wall in Chromium, a frame in another process (keeper/) can then also reload the page.
import { learnWords, say } from '../../core/words.js';
import { make } from './dom.js';

const BEAT_MS = 1000, BAND_PX = 92;

// scale() returns the size of the warning's letters relative to a desktop page. reloads true: a page that hangs is reloaded,
// because it is on a video wall, where no user could reload it.
export async function watchMainThread({ scale = () => 1, reloads = false } = {}) {
    if (!('transferControlToOffscreen' in HTMLCanvasElement.prototype))
        return;
    await learnWords('watchdog');
    const worker = new Worker(new URL('watchdog_worker.js', import.meta.url)), { port1, port2 } = new MessageChannel();
    const element = addCanvas('0', '100%'), veil = element.transferControlToOffscreen();
    const line = addCanvas(`calc(50% - ${BAND_PX / 2}px)`, `${BAND_PX}px`), band = line.transferControlToOffscreen();
    const words = { title: say('hangs'), more: say(reloads ? 'hangs.reloads' : 'hangs.reload', { n: '{n}' }) };
    worker.postMessage({ veil, band, words, keeper: reloads ? port1 : null }, reloads ? [veil, band, port1] : [veil, band]);
    if (reloads)
        addKeeper(port2);
    const fit = () => {
        const larger = scale(), height = BAND_PX * larger;
        Object.assign(line.style, { top: `calc(50% - ${height / 2}px)`, height: `${height}px` });
        worker.postMessage({ width: innerWidth, height, scale: larger });
    };
    const beat = () => worker.postMessage(document.hidden ? 'rest' : 'beat');
    window.addEventListener('resize', fit);
    document.addEventListener('visibilitychange', beat);
    worker.onmessage = () => requestAnimationFrame(() => requestAnimationFrame(() => line.classList.add('watches')));
    fit();
    beat();
    setInterval(beat, BEAT_MS);
}

function addCanvas(top, height) {
    const element = make('canvas', { class: 'watchdog', width: 1, height: 1, 'aria-hidden': 'true' });
    Object.assign(element.style, { position: 'fixed', left: 0, top, width: '100%', height, zIndex: 99, pointerEvents: 'none' });
    document.body.append(element);
    return element;
}

function addKeeper(port) {
    const src = new URL('../../keeper/keeper.html', import.meta.url).href;
    const frame = make('iframe', { src, sandbox: 'allow-scripts allow-top-navigation', hidden: true, title: 'keeper' });
    window.addEventListener('message', ({ source, data }) => source === frame.contentWindow && data === 'kept' &&
        frame.contentWindow.postMessage(location.href, '*', [port]), { once: true });
    document.body.append(frame);
}
