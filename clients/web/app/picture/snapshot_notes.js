// SPDX-License-Identifier: GPL-3.0-or-later
// Adds notes to a saved picture: numbered discs next to their places, and below the picture a list of the notes in the page's colours.
import { projector } from '../../core/camera.js';
import { aboutText, placeOf } from '../../core/notes.js';

const FONT_PX = 13, LINE = 1.45, DISC_PX = 9; // at 1280x720
// distances from a note's position to its disc (AWAY_PX) and to the start of the disc's line (RING_PX), so that a marker with
// its alarm ring there stays visible
const AWAY_PX = 20, RING_PX = 9;

// Splits a text into lines that fit the width. Lines end at blanks, or within a word that is longer than a line.
export function wrapped(pen, text, width) {
    const lines = [], fits = (line) => pen.measureText(line).width <= width;
    let line = '';
    for (const word of text.split(' ')) {
        const longer = `${line} ${word}`.trim();
        if (fits(longer)) {
            line = longer;
            continue;
        }
        if (line)
            lines.push(line);
        line = '';
        for (const character of word) {
            if (line && !fits(line + character)) {
                lines.push(line);
                line = '';
            }
            line += character;
        }
    }
    return [...lines, line];
}

function drawDisc(pen, number, [x, y], unit) {
    const [to, down] = [x - AWAY_PX * unit, y + AWAY_PX * unit];
    for (const [style, width] of [['#fff', 3.5], ['#1d252d', 1.5]]) {
        Object.assign(pen, { strokeStyle: style, lineWidth: width * unit });
        pen.beginPath();
        pen.moveTo(x - RING_PX * unit, y + RING_PX * unit);
        pen.lineTo(to, down);
        pen.stroke();
    }
    pen.beginPath();
    pen.arc(to, down, DISC_PX * unit, 0, 2 * Math.PI);
    Object.assign(pen, { fillStyle: '#1d252d', strokeStyle: '#fff', lineWidth: 1.5 * unit });
    pen.fill();
    pen.stroke();
    Object.assign(pen, { fillStyle: '#fff', textAlign: 'center', textBaseline: 'middle' });
    pen.fillText(number, to, down);
}

// Returns a promise of a PNG file: the picture with its notes. half: { left, width } of the part of the picture to which
// `camera` and the notes' positions belong: the left half of a split view, else the whole picture.
export async function addNotes(blob, notes, { model, camera, half }) {
    const picture = await createImageBitmap(blob), { width, height } = picture;
    const unit = Math.min(Math.max(Math.min(width / 1280, height / 720), 0.7), 8), size = FONT_PX * unit, indent = 2 * size;
    const canvas = Object.assign(document.createElement('canvas'), { width, height }), pen = canvas.getContext('2d');
    const family = getComputedStyle(document.body).fontFamily, color = (name) => getComputedStyle(document.documentElement)
        .getPropertyValue(name);
    const choose = (weight, scale) => { pen.font = `${weight} ${scale * size}px ${family}`; };
    const rows = notes.flatMap((note, i) => [[600, 1, '--ink', note.text, i + 1], [400, 0.9, '--ink-2', aboutText(model, note)]]);
    const lines = rows.flatMap(([weight, scale, ink, text, number]) => {
        choose(weight, scale);
        return wrapped(pen, text, width - indent - size).map((line, i) => [weight, scale, ink, line, i ? null : number]);
    });
    canvas.height = height + Math.ceil((lines.length * LINE + 1) * size);
    pen.drawImage(picture, 0, 0);
    pen.fillStyle = color('--surface');
    pen.fillRect(0, height, width, canvas.height - height);
    lines.forEach(([weight, scale, ink, line, number], i) => {
        const y = height + (i * LINE + 1.4) * size;
        choose(weight, scale);
        pen.fillStyle = color(ink);
        pen.fillText(line, indent, y);
        if (number)
            pen.fillText(number, 0.7 * size, y);
    });
    choose(600, 0.85);
    const project = projector(camera, half.width, height);
    notes.forEach((note, i) => {
        const place = placeOf(model, note), at = place && project(place);
        if (at && at[0] >= 0 && at[0] <= half.width && at[1] >= 0 && at[1] <= height)
            drawDisc(pen, i + 1, [half.left + at[0], at[1]], unit);
    });
    return new Promise((done) => { canvas.toBlob(done, 'image/png'); });
}
