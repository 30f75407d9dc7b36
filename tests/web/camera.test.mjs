// SPDX-License-Identifier: GPL-3.0-or-later
// The camera's mathematics: the point under the pointer stays there while the camera moves, the horizon stays level, and boxes
// are fitted into the picture.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { basis, besideLegend, home, LEAST_M, projector, same, valid } from '../../clients/web/core/camera.js';
import { flight, FLIGHT_MS } from '../../clients/web/core/camera_flight.js';
import {
    depthAt, depthOf, distance, elevation, enterBox, face, fit, lookAround, MAX_ELEVATION_DEG, orbit, pan, sight, toParallel,
    toPerspective, USUAL_LIMITS, wholeOf, zoom, zoomLimits,
} from '../../clients/web/core/camera_moves.js';
import { along, dot, length, subtract } from '../../clients/web/core/vector.js';
import { randomNumbers } from './random.mjs';

const random = randomNumbers();

const camera = { eye: [35, -42, 24], target: [1, 0.5, 6], up: [0, 0, 1], fov: 45 };
const close = (a, b, tolerance = 1e-9) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
const closeTo = (a, b, tolerance = 1e-9) => a.forEach((x, i) => close(x, b[i], tolerance));

test('projection: the target is in the middle, a point above it above, a point behind the eye nowhere', () => {
    const project = projector(camera, 1600, 1000);
    closeTo(project(camera.target), [800, 500, distance(camera)], 1e-9);
    const above = project([1, 0.5, 8]);
    close(above[0], 800);
    assert.ok(above[1] < 500);
    assert.equal(project(along(camera.eye, basis(camera).forward, -1)), null);
});

test('projection agrees with the field of view: the field\'s edge is at the picture\'s edge', () => {
    const looking = { eye: [0, -10, 0], target: [0, 0, 0], up: [0, 0, 1], fov: 90 };
    const project = projector(looking, 2000, 1000);
    closeTo(project([0, 0, 10]), [1000, 0, 10]);
    closeTo(project([20, 0, 0]), [2000, 500, 10]);
});

test('a ray through a pixel projects back to that pixel at every depth', () => {
    const project = projector(camera, 1608, 996);
    for (let n = 0; n < 200; n++) {
        const x = random(0, 1608), y = random(0, 996), depth = random(0.1, 500);
        closeTo(project(along(camera.eye, sight(camera, x, y, 1608, 996).direction, depth)), [x, y, depth], 1e-6);
    }
});

test('orbit keeps the distance, the target and a level horizon, after any earlier moves', () => {
    let c = camera;
    for (let n = 0; n < 2000; n++)
        c = orbit(c, random(-90, 90), random(-60, 60));
    close(distance(c), distance(camera), 1e-6);
    closeTo(c.target, camera.target, 1e-9);
    close(dot(basis(c).right, [0, 0, 1]), 0, 1e-12);
    assert.ok(valid(c));
});

test('orbit stops short of straight down, and comes straight back', () => {
    const down = orbit(camera, 0, 500);
    close(elevation(down), MAX_ELEVATION_DEG, 1e-6);
    close(elevation(orbit(camera, 0, -500)), -MAX_ELEVATION_DEG, 1e-6);
    close(elevation(orbit(down, 0, -40)), MAX_ELEVATION_DEG - 40, 1e-6);
    closeTo(basis(down).right, basis(camera).right, 1e-9);
});

test('orbit by four quarter turns returns to the start', () => {
    let c = camera;
    for (let n = 0; n < 4; n++)
        c = orbit(c, 90, 0);
    closeTo(c.eye, camera.eye, 1e-9);
});

test('orbit about another point keeps that point fixed in the picture, and the horizon level', () => {
    for (const start of [camera, toParallel(camera)]) {
        for (let n = 0; n < 200; n++) {
            const pivot = [random(-5, 15), random(-5, 10), random(0, 9)];
            const turned = orbit(start, random(-180, 180), random(-90, 90), pivot);
            closeTo(projector(turned, 1608, 996)(pivot), projector(start, 1608, 996)(pivot), 1e-6);
            close(depthOf(turned, pivot), depthOf(start, pivot), 1e-9);
            close(dot(basis(turned).right, [0, 0, 1]), 0, 1e-12);
        }
    }
    close(elevation(orbit(camera, 30, 10, [4, 3, 2])), elevation(camera) + 10, 1e-6);
});

test('looking around: the eye stays, and the point in the middle follows the pointer', () => {
    const [dx, dy] = [60, 25], looked = lookAround(camera, dx, dy, 996);
    closeTo(looked.eye, camera.eye, 1e-9);
    const [x, y] = projector(looked, 1608, 996)(camera.target);
    assert.ok(Math.abs(x - 804 - dx) < 8 && Math.abs(y - 498 - dy) < 8, `the middle moved to ${x}, ${y}`);
    assert.ok(valid(lookAround(toParallel(camera), dx, dy, 996)));
});

test('a plan with north at the top turns about the plant\'s vertical, and gets a level horizon once it is tilted', () => {
    const plan = { eye: [1, 2, 90], target: [1, 2, 0], up: [0, 1, 0], fov: 45 }, up = [0, 0, 1];
    const east = orbit(plan, 90, 0, plan.target, up);
    closeTo(east.eye, plan.eye);
    closeTo(east.up, [-1, 0, 0]);
    const tilted = orbit(east, 0, -30, plan.target, up);
    closeTo(tilted.up, up);
    closeTo(basis(tilted).right, basis(east).right);
    close(elevation(tilted, up), 60, 1e-6);
    const slightly = orbit(plan, 0, -0.5, plan.target, up);
    closeTo(basis(slightly).right, [1, 0, 0]);
    assert.ok(slightly.up[1] > 0.99, 'near the vertical the plan keeps its north');
    for (const one of [plan, toParallel(plan)]) {
        const around = lookAround(one, 40, 0, 996, up);
        close(elevation(around, up), 90, 1e-5);
        assert.notDeepEqual(around.up, plan.up);
        for (const point of [[4, 2, 0.5], [1, 2, 5]]) { // beside and above the middle of the box
            const seen = face(one, point, { min: [-2, -2, 0], max: [4, 6, 1] }, 5, 20, up);
            close(elevation(seen, up), 20, 1e-6);
            closeTo(seen.up, up);
        }
    }
});

test('orbit works with Y up', () => {
    const lying = { eye: [10, 5, 10], target: [0, 0, 0], up: [0, 1, 0], fov: 40 };
    const turned = orbit(lying, 90, 0);
    close(turned.eye[1], 5, 1e-9);
    close(elevation(orbit(lying, 0, 200)), MAX_ELEVATION_DEG, 1e-6);
});

test('pan: the point at the target follows the pointer by the pixel', () => {
    const moved = pan(camera, 120, -75, 996);
    const [x, y] = projector(moved, 1608, 996)(camera.target);
    closeTo([x, y], [804 + 120, 498 - 75], 1e-9);
    const near = along(camera.eye, sight(camera, 300, 200, 1608, 996).direction, 7);
    closeTo(projector(pan(camera, 120, -75, 996, 7), 1608, 996)(near), [420, 125, 7], 1e-6);
});

test('zoom keeps the point under the cursor fixed, at any depth, and is exactly reversible', () => {
    for (let n = 0; n < 200; n++) {
        const x = random(0, 1608), y = random(0, 996), depth = random(5, 80);
        const point = along(camera.eye, sight(camera, x, y, 1608, 996).direction, depth);
        const nearer = zoom(camera, 0.5, x, y, 1608, 996, depth);
        closeTo(projector(nearer, 1608, 996)(point), [x, y, depth / 2], 1e-6);
        close(distance(nearer), depth / 2, 1e-6);
        const back = zoom(nearer, 2, x, y, 1608, 996);
        closeTo(back.eye, camera.eye, 1e-6);
    }
});

test('zoom never passes through the target', () => {
    let c = camera;
    for (let n = 0; n < 500; n++)
        c = zoom(c, 0.8, 804, 498, 1608, 996);
    close(distance(c), USUAL_LIMITS.near_m, 1e-9);
    assert.ok(valid(c));
});

test('zoom and fit work for a plant of 5 mm, and for one with a stray part 5,300 km away', () => {
    const box = (...size) => ({ min: [0, 0, 0], max: size }), plant = (bounds, ...assets) => ({ plant: { bounds },
        assets: [bounds, ...assets].map((one) => ({ bounds: one })) });
    const small = plant(box(0.005, 0.004, 0.003)), limits = zoomLimits(small);
    for (const one of [camera, toParallel(camera)]) {
        let c = fit(one, small.plant.bounds, 1.6);
        const project = projector(c, 1600, 1000);
        const [x, y] = project([0.005, 0.004, 0.003]);
        assert.ok(x > 0 && y > 0 && x < 1600 && y < 1000 && Math.hypot(x - 800, y - 500) > 100);
        for (let n = 0; n < 100; n++)
            c = zoom(c, 0.8, 800, 500, 1600, 1000, undefined, limits);
        close(c.height_m ?? distance(c), limits.near_m, 1e-9);
        assert.ok(valid(c) && limits.near_m < 0.0001 && limits.near_m >= LEAST_M);
    }
    const strays = plant(box(40, 20, 10), { min: [-2e5, 5e6, 0], max: [-2e5 + 1, 5.3e6, 1] }), whole = wholeOf(strays);
    assert.deepEqual(whole, { min: [-2e5, 0, 0], max: [40, 5.3e6, 10] });
    const seen = projector(fit(camera, whole, 1.6), 1600, 1000)([40, 0, 0]);
    assert.ok(seen[0] >= 0 && seen[0] <= 1600 && seen[1] >= 0 && seen[1] <= 1000);
    assert.ok(zoomLimits(strays).far_m > 9e6);
});

test('rays hit boxes from outside, miss, start inside, and run parallel to a face', () => {
    const box = { min: [-1, -1, -1], max: [1, 1, 1] };
    assert.equal(enterBox([-5, 0, 0], [1, 0, 0], box), 4);
    assert.equal(enterBox([-5, 0, 0], [2, 0, 0], box), 2);
    assert.equal(enterBox([-5, 3, 0], [1, 0, 0], box), null);
    assert.equal(enterBox([-5, 0, 0], [-1, 0, 0], box), null);
    assert.equal(enterBox([0, 0, 0], [1, 0, 0], box), null);
    assert.equal(enterBox([-5, 1, 0], [1, 0, 0], box), 4);
});

test('the depth under the cursor is the nearest box\'s, or none', () => {
    const looking = { eye: [0, -10, 0], target: [0, 0, 0], up: [0, 0, 1], fov: 60 };
    const near = { min: [-1, -4, -1], max: [1, -2, 1] }, far = { min: [-5, 4, -5], max: [5, 6, 5] };
    close(depthAt(looking, 500, 500, 1000, 1000, [far, near]), 6);
    close(depthAt(looking, 800, 500, 1000, 1000, [far, near]), 14);
    assert.equal(depthAt(looking, 5, 5, 1000, 1000, [near]), null);
});

test('fit: all eight corners are inside, one side touches the margin, the direction is kept', () => {
    for (let n = 0; n < 200; n++) {
        const min = [random(-50, 0), random(-50, 0), random(-5, 0)];
        const box = { min, max: min.map((x) => x + random(0.5, 40)) };
        const aspect = random(0.4, 2.5);
        const from = orbit(camera, random(0, 360), random(-80, 80));
        const c = fit(from, box, aspect, 1);
        const project = projector(c, 1000 * aspect, 1000);
        let most = 0;
        for (let corner = 0; corner < 8; corner++) {
            const [x, y] = project([0, 1, 2].map((i) => (corner & (1 << i) ? box.max[i] : box.min[i])));
            most = Math.max(most, Math.abs(x / (500 * aspect) - 1), Math.abs(y / 500 - 1));
        }
        close(most, 1, 1e-6);
        closeTo(basis(c).forward, basis(from).forward, 1e-6);
    }
});

test('a tag is viewed from its own side, level, a little from above', () => {
    const box = { min: [-8, -1, 0], max: [12, 9, 10] };
    const north = face(camera, [2, 9, 3], box, 4);
    closeTo(north.eye, [2, 9 + 4 * Math.cos(Math.PI / 9), 3 + 4 * Math.sin(Math.PI / 9)]);
    closeTo(north.target, [2, 9, 3]);
    const side = face(camera, [8, 8, 5], box, 4); // the camera must look at the long side of the box, at a point near that side's end
    assert.ok(side.eye[1] - 8 > 2 * (side.eye[0] - 8));
    const above = face(camera, [2, 4, 9], box, 4);
    assert.ok(valid(above) && dot(subtract(above.eye, above.target), subtract(camera.eye, camera.target)) > 0,
        'a tag on top is viewed from the user\'s side');
});

// Returns how much of the window the points fill along that axis (x or y) along which they fill most, and the edges of the
// window on that axis.
function filled(view, points, [width, height], { left = -1, right = 1, bottom = -1, top = 1 }) {
    const project = projector(view, width, height), at = points.map((point) => project(point));
    const across = at.map(([x]) => (2 * x) / width - 1), up = at.map(([, y]) => 1 - (2 * y) / height);
    return [[across, left, right], [up, bottom, top]].map(([list, low, high]) => {
        const [a, b] = [Math.min(...list), Math.max(...list)];
        return { fills: (b - a) / (high - low), rims: [(a - low) / (high - low), (high - b) / (high - low)] };
    }).sort((a, b) => b.fills - a.fills)[0];
}

test('the first view: the plant fills the area that the legend leaves free, on any screen', () => {
    for (let round = 0; round < 200; round++) {
        const size = [0, 1, 2].map(() => 2 + 60 * Math.random()), outline = Array.from({ length: 40 }, () =>
            size.map((m) => 5e5 + m * Math.random()));
        const plant = { home: { eye: [5e5 - 30, 5e5 - 40, 5e5 + 25], target: [5e5, 5e5, 5e5], up: [0, 0, 1], fov: 45 }, outline };
        const screen = [300 + 1700 * Math.random(), 200 + 900 * Math.random()], lies = screen[0] < 720;
        const window = besideLegend(...screen, lies), { fills, rims } = filled(home(plant, ...screen, window), outline, screen, window);
        assert.ok(fills >= 0.7 && fills <= 1 && rims.every((rim) => rim >= 0 && rim <= 0.1), `${screen}: ${fills}, ${rims}`);
    }
});

test('a configured view is unchanged if everything fits, and steps back where a legend covers part of it', () => {
    // the last point, 400 m away, is outside the view
    const outline = [[-10, -10, 0], [10, -10, 0], [-10, 10, 0], [10, 10, 6], [0, 0, 9], [400, 0, 0]];
    const given = { eye: [-20, -30, 15], target: [0, 0, 2], up: [0, 0, 1], fov: 50, given: true }, { given: _, ...view } = given;
    const plant = { home: given, outline };
    assert.ok(same(home(plant, 1600, 900), view));
    const wide = home(plant, 1600, 900, { right: 0.1 }), narrow = home(plant, 400, 800, besideLegend(400, 800, true));
    for (const [camera_, screen, window] of [[wide, [1600, 900], { right: 0.1 }], [narrow, [400, 800], besideLegend(400, 800, true)]]) {
        const { fills, rims } = filled(camera_, outline.slice(0, 5), screen, window);
        assert.ok(fills > 0.7 && rims.every((rim) => rim >= 0), `${screen}: ${fills}, ${rims}`);
        assert.ok(dot(subtract(camera_.target, camera_.eye), subtract(view.target, view.eye)) > 0);
    }
});

test('valid() refuses the cameras that the server refuses', () => {
    assert.ok(valid(camera));
    assert.ok(valid({ ...camera, eye: [412345, 5512345, 120], target: [412355, 5512345, 118] }), 'survey coordinates are valid');
    for (const bad of [
        null, {}, { ...camera, eye: [NaN, 0, 0] }, { ...camera, eye: [1, 2] }, { ...camera, eye: camera.target }, { ...camera, fov: 0.5 },
        { ...camera, fov: 121 }, { ...camera, eye: [2e7, 0, 0] }, { ...camera, up: [0, 0, 0] }, { ...camera, eye: [1, 0.5, 20] },
    ])
        assert.ok(!valid(bad), JSON.stringify(bad));
});

test('a flight starts and ends as requested, stays level, and turns by the shorter way', () => {
    const to = { eye: [30, 40, 10], target: [5, 5, 2], up: [0, 0, 1], fov: 45 };
    const path = flight(camera, to);
    closeTo(path(0).eye, camera.eye, 1e-9);
    assert.equal(path(FLIGHT_MS), to);
    assert.equal(path(Infinity), to);
    let eastMost = -Infinity;
    for (let ms = 0; ms <= FLIGHT_MS; ms += 20) {
        const c = path(ms);
        assert.ok(valid(c));
        close(dot(basis(c).right, [0, 0, 1]), 0, 1e-9);
        eastMost = Math.max(eastMost, c.eye[0]);
    }
    assert.ok(eastMost > 40, 'the flight turns by the east, not around by the west');
});

test('a flight from a plan with north at the top, and back, does not turn the picture at its ends', () => {
    const vertical = [0, 0, 1], plan = { eye: [1, 2, 90], target: [1, 2, 0], up: [0, 1, 0], fov: 45 };
    const below = { ...plan, eye: [1, 2, -90] }, almost = { ...plan, eye: [1.2, 2, 90] };
    for (const one of [plan, below, almost, toParallel(plan)]) {
        const tag = face(one, [4, 2, 0.5], { min: [-2, -2, 0], max: [4, 6, 1] }, 5, 20, vertical);
        const [away, back] = [[one, tag], [tag, one]].map(([from, to]) => flight(from, to, FLIGHT_MS, vertical));
        assert.notEqual(away(0), tag);
        for (const [seen, at] of [[away(0), one], [away(FLIGHT_MS - 0.01), tag], [back(0), tag], [back(FLIGHT_MS - 0.01), one]])
            for (const axis of ['right', 'up', 'forward'])
                assert.ok(dot(basis(seen)[axis], basis(at)[axis]) > 0.999, `${axis} of ${JSON.stringify({ seen, at })}`);
        for (let ms = 0; ms < FLIGHT_MS; ms += 20)
            assert.ok(valid(away(ms)) && away(ms) !== tag);
    }
    const moved = { ...plan, eye: [9, 2, 90], target: [9, 2, 0] };
    closeTo(flight(plan, moved, FLIGHT_MS, vertical)(0).eye, plan.eye, 1e-9);
});

test('orthographic: every metre has its pixels, at any distance', () => {
    const c = { eye: [0, -10, 0], target: [0, 0, 0], up: [0, 0, 1], fov: 45, height_m: 8 };
    const project = projector(c, 1600, 800);
    for (const y of [-50, 0, 300])
        closeTo(project([4, y, 2]).slice(0, 2), [1200, 200]);
    const { origin, direction } = sight(c, 1200, 200, 1600, 800);
    closeTo(origin, [4, -10, 2]);
    closeTo(direction, [0, 1, 0]);
    assert.ok(valid(c) && !valid({ ...c, height_m: 0 }) && !valid({ ...c, height_m: Infinity }));
});

test('orthographic: zoom keeps the point under the pointer fixed, pan follows the pointer', () => {
    let c = toParallel(camera);
    for (let n = 0; n < 200; n++) {
        const x = random(0, 1600), y = random(0, 900), at = sight(c, x, y, 1600, 900).origin;
        const zoomed = zoom(c, random(0.5, 2), x, y, 1600, 900);
        closeTo(projector(zoomed, 1600, 900)(at).slice(0, 2), [x, y], 1e-6);
        const panned = pan(zoomed, 30, -20, 900);
        closeTo(projector(panned, 1600, 900)(at).slice(0, 2), [x + 30, y - 20], 1e-6);
        c = fit(orbit(panned, random(-50, 50), random(-20, 20)), { min: [-3, -1, 0], max: [3, 1, 2] }, 16 / 9);
        assert.ok(valid(c));
    }
});

test('switching the projection shows as much at the target', () => {
    const parallel = toParallel(camera), back = toPerspective(parallel);
    const above = [camera.target[0], camera.target[1], camera.target[2] + 1];
    closeTo(projector(parallel, 1600, 900)(camera.target).slice(0, 2), [800, 450]);
    closeTo(back.eye, camera.eye, 1e-9);
    assert.equal(back.height_m, undefined);
    assert.ok(Math.abs(projector(parallel, 1600, 900)(above)[1] - projector(camera, 1600, 900)(above)[1]) < 2);
});

test('without a duration, as for users who prefer reduced motion, a flight consists of its end alone', () => {
    const from = { eye: [10, 0, 5], target: [0, 0, 0], up: [0, 0, 1], fov: 45 }, to = { ...from, eye: [0, 12, 3] };
    assert.equal(flight(from, to, 0)(0), to);
    assert.notEqual(flight(from, to)(0), to);
});

test('a flight to the other projection ends there, and the server would accept every camera on the way', () => {
    const to = fit(toParallel(camera), { min: [-3, -1, 0], max: [3, 1, 2] }, 1.6);
    for (const [a, b] of [[camera, to], [to, camera], [to, toParallel(camera)]]) {
        const path = flight(a, b);
        for (let ms = 0; ms <= FLIGHT_MS; ms += 50)
            assert.ok(valid(path(ms)));
        assert.ok(same(path(FLIGHT_MS), b));
        closeTo(path(0).target, a.target, 1e-9);
    }
});
