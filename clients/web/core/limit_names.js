// SPDX-License-Identifier: GPL-3.0-or-later
// Finds places for the names of alarm limits in a chart, at their lines and next to the curves.

// COLUMN_PX: width in device pixels of the columns that store a curve's extent; MOST_PX: maximum width of a chart
const COLUMN_PX = 3, MOST_PX = 30000;

// Extent of one curve and its band: the highest and the lowest position in each column of the chart.
class Extent {
    constructor({ left, width }) {
        this.left = left;
        this.tops = new Array(Math.ceil(width > 0 && width < MOST_PX ? width / COLUMN_PX : 0) + 1).fill(Infinity);
        this.bottoms = this.tops.map(() => -Infinity);
    }

    columns(from, to) {
        const column = (x) => Math.floor((x - this.left) / COLUMN_PX);
        return [Math.max(0, column(from)), Math.min(this.tops.length - 1, column(to))];
    }

    // Adds the straight line between two points [x, y]; the first is not right of the second.
    addLine([left, begin], [right, end]) {
        const slope = right > left ? (end - begin) / (right - left) : 0, [first, last] = this.columns(left, right);
        const at = (x) => begin + slope * (Math.min(right, Math.max(left, x)) - left);
        for (let k = first; k <= last; k++) {
            const x = this.left + k * COLUMN_PX, ys = right > left ? [at(x), at(x + COLUMN_PX)] : [begin, end];
            this.tops[k] = Math.min(this.tops[k], ...ys);
            this.bottoms[k] = Math.max(this.bottoms[k], ...ys);
        }
    }

    isIn({ left, right, top, bottom }) {
        const [first, last] = this.columns(left, right);
        for (let k = first; k <= last; k++)
            if (this.tops[k] <= bottom && this.bottoms[k] >= top)
                return true;
        return false;
    }
}

// Returns the extent of a curve. values: its values at the instants `times`; null breaks the curve, undefined does not. band: stretches of
// [from, to, lowest, highest]. x, y: functions that convert an instant and a value to device pixels.
export function extentOf(bbox, times, values, band, x, y) {
    const extent = new Extent(bbox);
    let before = null;
    values.forEach((value, i) => {
        if (value === undefined)
            return;
        const point = value === null ? null : [x(times[i]), y(value)];
        if (point)
            extent.addLine(before ?? point, point);
        before = point;
    });
    for (const [from, to, low, high] of band.flat())
        [low, high].forEach((value) => extent.addLine([x(from), y(value)], [x(to), y(value)]));
    return extent;
}

// Returns the places of the names in a chart: [{ text, left, right, top, bottom, ...limit }]. limits: [{ y, words, short, ...
// }], with the limit's line and its name in two lengths. A name is at its line, as far left as possible, or else above or below
// the line. A name is omitted if the curves leave no room for it. widthOf: measures a text; height, gap: of names, in device
// pixels.
export function placeNames({ limits, bbox, extents, widthOf, height, gap }) {
    const placed = [], isApart = (box) => placed.every((other) => box.left >= other.right + gap || box.right + gap <= other.left ||
        box.top >= other.bottom || box.bottom <= other.top);
    const isFree = (box) => isApart(box) && !extents.some((extent) => extent.isIn(box));
    const crosses = (box, own) => limits.some(({ y }) => y !== own && y > box.top && y < box.bottom);
    // Returns the first free place whose middle is `away` from the limit's line.
    const placeOf = (limit, text, away) => {
        const highest = bbox.top + height / 2, lowest = bbox.top + bbox.height - height / 2, wide = widthOf(text);
        const middle = Math.min(lowest, Math.max(highest, limit.y + away));
        const columns = Math.min(bbox.width, MOST_PX) / COLUMN_PX;
        for (let k = 0, left = bbox.left + gap; k < columns && left + wide <= bbox.left + bbox.width; k++, left += COLUMN_PX) {
            const box = { ...limit, text, left, right: left + wide, top: middle - height / 2, bottom: middle + height / 2 };
            if (isFree(box) && !(away && crosses(box, limit.y)))
                return box;
        }
        return null;
    };
    for (const limit of limits) {
        const texts = [limit.words, limit.short].filter(Boolean), aways = [0, -height / 2 - 1, height / 2 + 1];
        const box = aways.flatMap((away) => texts.map((text) => [text, away]))
            .reduce((found, [text, away]) => found ?? placeOf(limit, text, away), null);
        if (box)
            placed.push(box);
    }
    return placed;
}
