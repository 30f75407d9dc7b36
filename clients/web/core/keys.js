// SPDX-License-Identifier: GPL-3.0-or-later
// Assigns camera motions and commands to the keys of the keyboard, and computes steady camera motion while a key is held.

// camera speed for each key, per second: orbit [right, up] in degrees, pan [right, up] in picture heights, zoom as a natural logarithm
const MOTIONS = {
    ArrowLeft: { orbit: [-45, 0] }, ArrowRight: { orbit: [45, 0] }, ArrowUp: { orbit: [0, 45] }, ArrowDown: { orbit: [0, -45] },
    KeyA: { pan: [-0.5, 0] }, KeyD: { pan: [0.5, 0] }, KeyW: { pan: [0, 0.5] }, KeyS: { pan: [0, -0.5] },
    '+': { zoom: -1 }, '-': { zoom: 1 },
};
const SHIFTED = { ArrowLeft: 'KeyA', ArrowRight: 'KeyD', ArrowUp: 'KeyW', ArrowDown: 'KeyS' };
const COMMANDS = {
    f: 'fit', h: 'home', '?': 'help', b: 'assets', '/': 'search', Escape: 'escape', Backspace: 'back',
    t: 'top', i: 'corner', o: 'projection', v: 'views', p: 'picture', x: 'hide', g: 'ghost', l: 'only', u: 'showAll', m: 'timings',
    e: 'alarms', y: 'past', n: 'live', ' ': 'hold', r: 'measure', c: 'snapshot', k: 'share', z: 'theme', j: 'split',
};
// seconds of motion that each press of a key causes immediately; a key held for longer than HOLD_S then moves steadily
export const TAP_S = 1 / 15;
export const HOLD_S = 0.25;

function motionName({ key, code, shiftKey }) {
    if (key === '+' || key === '=')
        return '+';
    if (key === '-' || key === '_')
        return '-';
    if (shiftKey && SHIFTED[code])
        return SHIFTED[code];
    return MOTIONS[code] ? code : null;
}

// Returns what a key does: { motion }, { command }, { group: index from 0 } or null. Keys with ctrl, alt or meta are left to the browser.
export function keyMeaning(event) {
    if (event.ctrlKey || event.altKey || event.metaKey)
        return null;
    const motion = motionName(event);
    if (motion)
        return { motion };
    if (/^Digit[1-9]$/.test(event.code ?? '') && !event.shiftKey)
        return { group: Number(event.code.slice(5)) - 1 };
    const command = COMMANDS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    return command ? { command } : null;
}

function scaled(name, seconds) {
    const { orbit, pan, zoom } = MOTIONS[name];
    const move = {};
    if (orbit)
        move.orbitDeg = orbit.map((x) => x * seconds);
    if (pan)
        move.panHeights = pan.map((x) => x * seconds);
    if (zoom)
        move.zoom = Math.exp(zoom * seconds);
    return move;
}

export class HeldKeys {
    constructor() {
        this.held = new Map(); // motion -> seconds held
    }

    get moving() {
        return this.held.size > 0;
    }

    press(motion) {
        if (this.held.has(motion))
            return []; // ignores the keyboard's key repeat
        this.held.set(motion, 0);
        return [scaled(motion, TAP_S)];
    }

    release(event) {
        // forgets the key under its names with and without shift, because shift may have been pressed or released since
        const names = new Set([motionName(event), event.code, SHIFTED[event.code]]);
        for (const name of names)
            this.held.delete(name);
    }

    clear() {
        this.held.clear();
    }

    step(seconds) {
        const moves = [];
        for (const [name, before] of this.held) {
            const after = before + seconds;
            this.held.set(name, after);
            const moving = Math.min(seconds, after - HOLD_S);
            if (moving > 0)
                moves.push(scaled(name, moving));
        }
        return moves;
    }
}
