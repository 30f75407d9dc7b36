// SPDX-License-Identifier: GPL-3.0-or-later
// Area, volume and size of triangles, for comparing readers of models.

const minus = (a, b) => a.map((v, i) => v - b[i]);
const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];

// Returns { add, result }: add(a, b, c) takes a triangle's corners, result() returns { area, volume, extent: [x, y, z] }.
// Without triangles, the area is 0.
export function triangleSums() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    let area = 0, volume = 0;
    const add = (...corners) => {
        const [a, b, c] = corners, normal = cross(minus(b, a), minus(c, a));
        volume += normal.reduce((sum, v, axis) => sum + v * a[axis], 0) / 6;
        area += Math.hypot(...normal) / 2;
        for (const p of corners)
            p.forEach((v, axis) => { low[axis] = Math.min(low[axis], v); high[axis] = Math.max(high[axis], v); });
    };
    return { add, result: () => ({ area, volume, extent: minus(high, low) }) };
}
