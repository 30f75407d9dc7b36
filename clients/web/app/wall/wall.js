// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the page on a control room's video wall: enlarged, without controls, and with the screen kept on.
import { learnWords, say } from '../../core/words.js';
import { numberText } from '../../core/format.js';
import { legendsLie, readWall, SPREAD_MS, wallFit } from '../../core/wall.js';
import { byId, make, setVariable, styled } from '../common/dom.js';
import { keepScreenOn } from './keep_screen_on.js';

const FAR_MS = 60000; // milliseconds for which the page tells the installer from which distance its text is readable
// smallest height of the picture as a fraction of the window's height; the whole page shrinks rather than the picture
const LEAST_PICTURE = 0.3;
const TIGHT = 620; // width of the display, in units of page.unit, below which the date has no room next to the time

// Shows the page on a video wall. Sets page.unit (factor by which the page is enlarged) and calls page.onUnit() when it
// changes. Sets page.lying, used like a media query: page.lying.matches says whether legends lie below the picture instead of
// standing at its side. Legends and the note on simulated values have space of their own, so that they cover no reading.
export async function hangOnWall(search, page) {
    const pane = new URLSearchParams(search).get('pane'), wall = readWall(search);
    const hear = [], legends = make('div', { class: 'legends' }), { classList } = byId('viewport');
    page.lying = { matches: false, addEventListener: (_, f) => hear.push(f) };
    const hang = (scale) => {
        const { innerWidth: width, innerHeight: height } = window;
        const lies = legendsLie(width / scale, height / scale, classList.contains('split')), turned = lies !== page.lying.matches;
        page.unit = scale;
        page.lying.matches = lies;
        setVariable(document.body, '--wall', scale);
        document.body.classList.toggle('lying', lies);
        document.body.classList.toggle('tight', width / scale < TIGHT);
        if (turned)
            hear.forEach((f) => f());
    };
    // Scales the page to the window. Returns the greatest distance from which the text is readable.
    const fit = () => {
        const { innerWidth: width, innerHeight: height } = window, { scale, metres } = wallFit(wall, window.screen, { width, height });
        hang(scale);
        while (pane !== 'trend' && byId('viewport').clientHeight < LEAST_PICTURE * height && page.unit > 0.5)
            hang(page.unit * 0.95);
        page.onUnit();
        return (metres * page.unit) / scale;
    };
    await styled('wall/wall');
    document.body.classList.add('wall');
    document.body.classList.toggle('pane', pane !== null);
    document.body.classList.toggle('pane-trend', pane === 'trend');
    legends.append(byId('legend'), byId('legend-right'));
    byId('viewport').after(legends);
    byId('status').before(byId('simulated'));
    page.hangs = new URLSearchParams(search).get('hangs');
    page.onTell = async (tell) => {
        const [name, display] = page.hangs?.split('/') ?? [], { session } = page;
        if (name)
            session.connection.spreadMs = SPREAD_MS;
        if (name) // tells the server which pane of which display this page is
            session.greeted(() => session.model.plant.only || session.post({ type: 'display', wall: name, display: Number(display) }));
        const metres = fit();
        if (metres < wall.metres && await learnWords().then(() => true, () => false))
            tell(say('wall.far', { metres: numberText(metres, 1), wanted: wall.metres }), FAR_MS);
    };
    window.addEventListener('resize', fit);
    new MutationObserver(fit).observe(byId('viewport'), { attributeFilter: ['class'] });
    const observer = new ResizeObserver(fit);
    for (const element of [byId('simulated'), byId('status'), ...legends.children])
        observer.observe(element);
    fit();
    keepScreenOn();
}
