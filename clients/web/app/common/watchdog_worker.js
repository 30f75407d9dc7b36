// SPDX-License-Identifier: GPL-3.0-or-later
// Worker of watchdog.js. When the page's main thread hangs, the worker draws a warning over the page. If the page is on a video
// wall, the worker also tells the keeper (a frame in another process) to reload the page. Messages from the page: first { veil,
// band (canvases), words, keeper }; later { width, height, scale } of the band; 'beat' at intervals while the page runs; 'rest'
// when the page is hidden, because timers are then slow.
'use strict';

// Silence is counted in ticks and not by a clock, because neither this worker nor the page runs while the machine sleeps. The warning is
// shown for some ticks before the reload, so that people can read it.
const TICK_MS = 1000, SILENT_TICKS = 10, RELOAD_TICKS = 13;
let veil = null, band = null, words = null, keeper = null, scale = 1;
let silent = 0, rests = false, isSaid = false;

onmessage = ({ data }) => {
    if (data.band)
        ({ veil, band, words, keeper } = data);
    if (data.width) {
        ({ scale } = data);
        [band.width, band.height] = [data.width, data.height];
    }
    // Only the messages 'beat' and 'rest' change `rests` (the page is hidden, so its silence is no fault). A hidden page may send its new
    // size, but remains hidden.
    if (typeof data === 'string')
        rests = data === 'rest';
    silent = 0;
    // Redraws without the warning when the page runs again. Also draws at the start, because the canvas's first frame, its size
    // and the font need the main thread, which may hang later.
    if (isSaid || data.width)
        draw();
    if (data.width)
        // tells the page that the worker is ready, after the canvas has shown its first frame
        requestAnimationFrame(() => postMessage('watches'));
};

setInterval(() => {
    silent++;
    if (rests || silent < SILENT_TICKS)
        return;
    if (silent === RELOAD_TICKS)
        keeper?.postMessage('reload');
    draw();
}, TICK_MS);

// Draws a translucent veil over the whole page, so that nobody takes a frozen picture for a live one, and a band with the warning.
function draw() {
    const { width, height } = band, shade = veil.getContext('2d'), c = band.getContext('2d');
    isSaid = silent >= SILENT_TICKS;
    for (const [context, colour] of [[shade, 'rgb(60 66 72 / 0.6)'], [c, '#8f1320']]) {
        context.clearRect(0, 0, width, height);
        context.fillStyle = isSaid ? colour : 'transparent';
        context.fillRect(0, 0, width, height);
    }
    c.fillStyle = isSaid ? '#fff' : 'transparent';
    c.textAlign = 'center';
    for (const [text, weight, px, y] of [[words.title, 700, 28, 40], [words.more.replace('{n}', silent), 400, 17, 72]]) {
        c.font = `${weight} ${px * scale}px sans-serif`;
        c.font = `${weight} ${px * scale * Math.min(1, 0.95 * width / c.measureText(text).width)}px sans-serif`;
        c.fillText(text, width / 2, y * scale);
    }
}
