// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings over the picture during an import: boxes around the assets that a tag may belong to, and a person 1.8 m tall, for
// scale.
import { basis, projector } from '../../core/camera.js';
import { halves } from '../../core/split_view.js';
import { say } from '../../core/words.js';

const INK = '#1d252d', LIGHT = '#ffffff', LIT = '#2a5f8f', LEAST_PERSON_PX = 12, BESIDE_M = 0.8;
const FACES = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
// Outline of a person as a list of [metres to the right of the middle, metres above the ground].
const BODY = [[-0.2, 1.42], [0.2, 1.42], [0.3, 0.82], [0.23, 0.8], [0.17, 1.15], [0.16, 0.82], [0.14, 0], [0.03, 0], [0, 0.75],
    [-0.03, 0], [-0.14, 0], [-0.16, 0.82], [-0.17, 1.15], [-0.23, 0.8], [-0.3, 0.82]];
const HEAD = Array.from({ length: 16 }, (_, i) => [0.1 * Math.sin(i * Math.PI / 8), 1.66 + 0.14 * Math.cos(i * Math.PI / 8)]);

const corners = ({ min, max }) => Array.from({ length: 8 }, (_, i) => [0, 1, 2].map((axis) => (i >> axis & 1 ? max : min)[axis]));

export class Highlights {
    constructor({ session, overlay, refresh }) {
        Object.assign(this, { session, overlay, refresh, assets: [], person: false });
        overlay.drawMore = () => this.draw();
    }

    // assets: those that a tag may belong to, the chosen one first. person: true: draw the person.
    show({ assets = this.assets, person = this.person }) {
        Object.assign(this, { assets, person });
        this.refresh();
    }

    draw() {
        const { model, picture, shown } = this.session, { overlay } = this;
        if (!model || !picture || (this.assets.length === 0 && !this.person))
            return;
        const scale = [overlay.wide / picture.shownWidth, overlay.high / picture.fullHeight];
        for (const half of halves(shown, picture.shownWidth)) {
            const project = projector(picture.camera, half.width, picture.fullHeight);
            const at = (point) => {
                const place = project(point);
                return place && [(half.left + place[0]) * scale[0], place[1] * scale[1]];
            };
            const tops = this.assets.toReversed().map((asset, i) => this.drawBox(asset, at, i === this.assets.length - 1)).reverse();
            tops.forEach((top, i) => top && this.write(this.nameOf(i), top[0], top[1] - 8));
            if (this.person)
                this.drawPerson(model.plant.bounds, picture.camera, at);
        }
    }

    trace(points) {
        const c = this.overlay.context;
        c.beginPath();
        points.forEach(([x, y], i) => (i === 0 ? c.moveTo(x, y) : c.lineTo(x, y)));
        c.closePath();
    }

    nameOf(i) {
        const { tag, id } = this.assets[i];
        return this.assets.length > 1 ? `${i + 1}  ${tag || id}` : tag || id;
    }

    // Draws the box of an asset. Returns its topmost corner on the screen, where the asset's name is written; null if the box
    // is partly behind the camera.
    drawBox(asset, at, chosen) {
        const points = corners(asset.bounds).map(at), c = this.overlay.context;
        if (points.includes(null))
            return null;
        for (const face of FACES) {
            this.trace(face.map((i) => points[i]));
            c.fillStyle = chosen ? 'rgb(42 95 143 / 0.16)' : 'rgb(42 95 143 / 0.05)';
            c.fill();
        }
        for (const [style, width] of [[LIGHT, 4], [LIT, 2]])
            for (const face of FACES) {
                this.trace(face.map((i) => points[i]));
                Object.assign(c, { strokeStyle: style, lineWidth: chosen ? width + 1 : width });
                c.setLineDash(chosen ? [] : [6, 4]);
                c.stroke();
            }
        c.setLineDash([]);
        return points.reduce((a, b) => (b[1] < a[1] ? b : a));
    }

    write(text, x, y) {
        const c = this.overlay.context;
        if (x < 0 || x > this.overlay.wide || y > this.overlay.high)
            return; // writes no name if the asset is outside the picture
        c.font = `600 13px ${this.overlay.font}`;
        const width = c.measureText(text).width + 10;
        const left = Math.min(Math.max(4, x - width / 2), this.overlay.wide - width - 4), bottom = Math.max(24, y);
        c.fillStyle = LIT;
        c.fillRect(left, bottom - 18, width, 20);
        c.fillStyle = LIGHT;
        c.fillText(text, left + 5, bottom - 4);
    }

    // Draws the person standing on the ground, on the side of the plant nearest to the camera.
    drawPerson({ min, max }, camera, at) {
        const middle = [0, 1].map((axis) => (min[axis] + max[axis]) / 2), { right } = basis(camera);
        const sides = [[min[0] - BESIDE_M, middle[1]], [max[0] + BESIDE_M, middle[1]], [middle[0], min[1] - BESIDE_M],
            [middle[0], max[1] + BESIDE_M]];
        const away = ([x, y]) => Math.hypot(x - camera.eye[0], y - camera.eye[1]);
        const [x, y] = sides.reduce((a, b) => (away(b) < away(a) ? b : a));
        const place = ([across, up]) => at([x + right[0] * across, y + right[1] * across, min[2] + up]);
        const parts = [BODY, HEAD].map((part) => part.map(place)), feet = place([0, 0]), top = place([0, 1.8]), c = this.overlay.context;
        if (parts.flat().includes(null) || !feet || !top)
            return;
        for (const part of parts) {
            this.trace(part);
            Object.assign(c, { strokeStyle: LIGHT, lineWidth: 3, lineJoin: 'round', fillStyle: INK });
            c.stroke();
            c.fill();
        }
        if (feet[1] - top[1] < LEAST_PERSON_PX) { // the person would be too small to see: draws a circle in place of the figure
            c.beginPath();
            c.arc(feet[0], feet[1], LEAST_PERSON_PX, 0, 2 * Math.PI);
            Object.assign(c, { strokeStyle: LIT, lineWidth: 2 });
            c.stroke();
        }
        if (feet[1] > 0)
            this.write(say('import.person.label'), top[0], Math.min(top[1], feet[1] - LEAST_PERSON_PX) - 6);
    }
}
