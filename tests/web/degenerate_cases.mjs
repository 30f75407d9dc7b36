// SPDX-License-Identifier: GPL-3.0-or-later
// Lists the page's pure functions with valid arguments, which degenerate.mjs corrupts. ends: the function need only return,
// because it formats or compares values that its callers have checked. All other functions must return only finite numbers.
import * as address from '../../clients/web/core/address.js';
import * as approach from '../../clients/web/core/approach.js';
import * as callouts from '../../clients/web/core/callouts.js';
import * as camera from '../../clients/web/core/camera.js';
import * as cameraFlight from '../../clients/web/core/camera_flight.js';
import * as cameraMoves from '../../clients/web/core/camera_moves.js';
import * as clipGizmo from '../../clients/web/core/clip_gizmo.js';
import * as declutter from '../../clients/web/core/declutter.js';
import * as format from '../../clients/web/core/format.js';
import * as gestures from '../../clients/web/core/gestures.js';
import * as history from '../../clients/web/core/history.js';
import * as instant from '../../clients/web/core/instant.js';
import * as labels from '../../clients/web/core/labels.js';
import * as legend from '../../clients/web/core/legend.js';
import * as limitNames from '../../clients/web/core/limit_names.js';
import * as listWindow from '../../clients/web/core/list_window.js';
import * as measure from '../../clients/web/core/measure.js';
import * as meters from '../../clients/web/core/meters.js';
import * as nearest from '../../clients/web/core/nearest.js';
import * as patterns from '../../clients/web/core/patterns.js';
import * as pins from '../../clients/web/core/pins.js';
import * as query from '../../clients/web/core/query.js';
import * as scroll from '../../clients/web/core/scroll.js';
import * as section from '../../clients/web/core/section.js';
import * as splitView from '../../clients/web/core/split_view.js';
import * as sun from '../../clients/web/core/sun.js';
import * as timings from '../../clients/web/core/timings.js';
import * as trendRange from '../../clients/web/core/trend_range.js';
import * as trendValues from '../../clients/web/core/trend_values.js';
import * as vector from '../../clients/web/core/vector.js';
import * as wall from '../../clients/web/core/wall.js';
import * as wire from '../../clients/web/core/wire.js';

import * as alarmBar from '../../clients/web/app/alarms/alarm_bar.js';
import * as chartStyle from '../../clients/web/app/trends/chart_style.js';
import * as drift from '../../clients/web/app/cards/drift.js';
import * as toolbar from '../../clients/web/app/toolbar/toolbar.js';

const MODULES = { address, approach, callouts, camera, camera_flight: cameraFlight, camera_moves: cameraMoves, clip_gizmo: clipGizmo,
    declutter, format, gestures, history, instant, labels, legend, limit_names: limitNames, list_window: listWindow, measure, meters,
    nearest, patterns, pins, query, scroll, section, split_view: splitView, sun, timings, trend_range: trendRange,
    trend_values: trendValues, vector, wall, wire,
    'app/alarm_bar': alarmBar, 'app/chart_style': chartStyle, 'app/drift': drift, 'app/toolbar': toolbar };
globalThis.devicePixelRatio = 1; // needed by charts, which draw in device pixels
export const CASES = [];
const called = new Set();

// Adds a case: MODULES[module][name] is called with args. call: the function to call instead; ends: see above.
function add(module, name, args, { ends = false, call = MODULES[module][name] } = {}) {
    called.add(`${module}.${name}`);
    CASES.push({ name: `${module}.js: ${name}`, call, args, ends });
}

const ENDS = { ends: true };
const eye = { eye: [4, 3, 2], target: [0.5, 0, 1], up: [0, 0, 1], fov: 45 }, flat = { ...eye, height_m: 3 };
const box = { min: [-1, -1, 0], max: [1, 2, 3] }, point = [0.5, 0.2, 1], origin = [3, 3, 3], direction = [-1, -0.9, -0.8];
const area = { left: 0, top: 0, right: 300, bottom: 200 };
const rings = [[20, 30], [24, 36], [150, 90], [155, 95], [290, 190], [80, 150]].map(([x, y], id) => ({ id, x, y, width: 60, height: 20,
    rank: id < 4 ? 3 : 1, depth: 4 + id, held: id === 2 ? 3 : undefined, ring: id < 4, callout: id < 2 ? 0 : undefined }));
const placed = (items, where, unit, blocked, size) => {
    const all = labels.placeLabels(items, { area: where, unit, blocked, rings: callouts.placeRings, measure: () => size });
    return [...all.values()].map(({ left, top, slot, width = 1, height = 1 }) => [left, top, slot, width, height]);
};
const free = { meets: () => false };
const map = { rgb: new Uint8Array(768), below: [1, 2, 3], above: [4, 5, 6] };
const scale = { min: 10, max: 90, log: false, interval: 10, breaks: [20, 40] };
const { breaks, ...ramp } = scale, log = { ...ramp, log: true, interval: 0 };
const series = { step: false, bucket_us: 0, points: [[1e6, 3, 0], [2e6, 4, 0], [9e6, 5, 2 ** 31]] };
const buckets = { step: false, bucket_us: 1e6, points: [[1e6, 1, 5, 3, 2, 4, 0, 0], [2e6, 1, 5, 3, 2, 4, 10, 0]] };
const clip = { planes: [[1, 0, 0, -0.2], [0, 0.7, 0.7, -0.1]] }, boxed = { box: { min: [-0.5, -0.5, 0.5], max: [0.5, 1, 2] } };
const picture = { data: true, sentTimeUs: 5e6, waitUs: 1, fieldUs: 2, renderUs: 3, encodeUs: 4, at: 90, bytes: 5000 };
const HD = { width: 1920, height: 1080 };
const sight = { origin, direction }, shown = { carried: { range: [1, 2], clip }, camera: eye, size: HD, time: { atUs: 1e15 } };
const recent = [{ picture, decodeMs: 2, hereUs: 6e6 }, { picture, decodeMs: 3, hereUs: 7e6 }];
const marks = [{ us: 1e6, priority: 2 }, { us: 2e6, priority: 1 }];

// Functions that place the overlay's labels, call-outs and markers.
add('callouts', 'placeRings', [rings, area, 1, { width: 90, height: 36 }], { call: (order, where, unit, size) =>
    callouts.placeRings(order, { area: where, unit, taken: free, measure: () => size }).map(({ box: at, slot }) => ({ at, slot })) });
add('labels', 'placeLabels', [rings, area, 1, [{ left: 0, top: 0, right: 40, bottom: 20 }], { width: 90, height: 36 }], { call: placed });
add('labels', 'boxAt', [rings[0], 3, 1], ENDS);
add('labels', 'leaderLine', [rings[0], { left: 60, top: 40 }, 5], ENDS);
add('labels', 'awayFrom', [rings[0], area, 3, 4], ENDS);
add('labels', 'meets', [area, area], ENDS);
add('labels', 'grow', [area, 3], ENDS);
add('labels', 'hasArea', [area], ENDS);
add('pins', 'placePin', [{ x: 20, y: 30, wide: 60, high: 20 }, area, [{ left: 0, top: 0, right: 40, bottom: 20 }],
    [{ left: 10, top: 20, right: 36, bottom: 46 }]], ENDS);
add('declutter', 'thinOut', [rings.map(({ x, y, depth }) => ({ x, y, depth, occluded: false, kept: false, held: true })), 1],
    { call: (items, unit) => declutter.thinOut(items, unit).length });
add('nearest', 'halfAt', [{ split: {} }, 640, 100], ENDS);
add('nearest', 'nearestMarker', [rings, 30, 30, 12], ENDS);
add('split_view', 'halves', [{ split: {} }, 641], ENDS);

// Functions that move cameras. If the result would be a camera that the server refuses, they must return the camera unchanged.
for (const one of [eye, flat]) {
    add('camera', 'projector', [one, 640, 360, point], { call: (c, w, h, p) => camera.projector(c, w, h)(p) });
    add('camera_moves', 'fit', [one, box, 1.5, 1.08]);
    add('camera_moves', 'orbit', [one, 20, 10, point]);
    add('camera_moves', 'lookAround', [one, 5, 8, 360]);
    add('camera_moves', 'pan', [one, 5, 8, 360, 4]);
    add('camera_moves', 'zoom', [one, 0.8, 100, 90, 640, 360, 4]);
    add('camera_moves', 'face', [one, point, box, 4, 20]);
    add('camera_moves', 'depthAt', [one, 100, 90, 640, 360, [box, box]]);
    add('camera_flight', 'flight', [eye, one, 700, 350], { call: (from, to, ms, at) => cameraFlight.flight(from, to, ms)(at) });
    for (const name of ['valid', 'validOr', 'basis', 'isParallel', 'cameraMessage', 'cameraOfMessage'])
        add('camera', name, [one], ENDS);
    add('camera', 'heightAt', [one, 4], ENDS);
    add('camera', 'metresPerPixel', [one, 360, 4], ENDS);
    add('camera_moves', 'distance', [one], ENDS);
    add('camera_moves', 'elevation', [one], ENDS);
    add('camera_moves', 'depthOf', [one, point], ENDS);
    add('camera_moves', 'sight', [one, 100, 90, 640, 360], ENDS);
}
add('camera', 'same', [eye, flat], ENDS);
add('camera', 'besideLegend', [640, 360, false, 14]);
add('camera', 'home', [{ home: eye, outline: [[0, 0, 0], [1, 2, 3], [-1, 0, 2]] }, 640, 360, { right: 0.7 }],
    { call: (plant, w, h, window) => { const at = camera.home(plant, w, h, window); return at === plant.home ? null : at; } });
add('camera_moves', 'wholeOf', [{ plant: { bounds: box }, assets: [{ bounds: box }] }], ENDS);
add('camera_moves', 'zoomLimits', [{ plant: { bounds: box }, assets: [{ bounds: box }] }], ENDS);
add('camera_moves', 'toParallel', [eye]);
add('camera_moves', 'toPerspective', [flat]);
add('camera_moves', 'enterBox', [origin, direction, box]);
add('approach', 'distanceBounds', [box], ENDS);
add('approach', 'approachDistance', [box, { least: 0.2, most: 16 }], ENDS);
add('approach', 'atDistance', [eye, 4], { call: (...given) => [approach.atDistance(...given)].filter((at) => at !== given[0]) });
add('approach', 'fillOf', [eye, box, 1.5]);
add('approach', 'silhouetteOf', [eye, box]);
add('approach', 'isRoom', [{ id: 'a', bounds: box }, [{ id: 'b', bounds: box }]], ENDS);
add('approach', 'approaches', [{ camera: eye, point, box, aspect: 1.5, whole: box, solid: true }], { call: (given) =>
    approach.approaches(given).filter((one) => one !== given.camera) });
add('camera_moves', 'corners', [box], ENDS);
for (const name of ['add', 'subtract', 'dot', 'cross', 'middle'])
    add('vector', name, [point, origin], ENDS);
add('vector', 'scale', [point, 2], ENDS);
add('vector', 'along', [point, direction, 2], ENDS);
add('vector', 'mix', [point, origin, 0.5], ENDS);
for (const name of ['length', 'unit', 'finite'])
    add('vector', name, [point], ENDS);

// Clipping and measuring.
for (const one of [clip, boxed]) {
    add('clip_gizmo', 'gripsOf', [one, box]);
    add('clip_gizmo', 'wholeOf', [one]);
    add('clip_gizmo', 'moveGrip', [one, clipGizmo.gripsOf(one, box)[0], 0.4]);
    add('section', 'readCut', [one], ENDS);
    add('section', 'readBox', [one, box]);
}
add('clip_gizmo', 'moveBox', [boxed, [0.1, 0.2, 0.3], box]);
add('clip_gizmo', 'facing', [eye, point, sight]);
add('clip_gizmo', 'spotsOf', [clipGizmo.gripsOf(clip, box)[0]]);
add('clip_gizmo', 'alongSight', [point, [1, 0, 0], sight]);
add('clip_gizmo', 'beforeEye', [eye, point, origin]);
add('section', 'cut', ['y', 0.3, true], ENDS);
add('section', 'boxAround', [box, 0.5], ENDS);
add('section', 'showAsset', [{ hidden: [] }, 'hide', 'A'], ENDS);
add('section', 'showAll', [{ hidden: ['A'] }], ENDS);
add('measure', 'measure', [point, origin, [0, 0, 1]], ENDS);
add('measure', 'metresText', [12], ENDS);
add('measure', 'farText', [12000], ENDS);
add('sun', 'towardsSun', [{ turn: 45, height: 30 }, false], ENDS);
add('sun', 'sunOf', [[0.5, 0.5, 0.7], false], ENDS);

// Legends, patterns, charts and lists.
add('legend', 'niceStep', [80, 6], ENDS);
add('legend', 'multiples', [10, 90, 10]);
add('legend', 'ticks', [10, 90, 6], { ends: true });
add('legend', 'spread', [[0.1, 0.12, 0.5], 0.05], ENDS);
add('legend', 'rampChoices', [10, 90]);
for (const one of [scale, ramp, log]) {
    add('legend', 'placeOf', [one, 30], ENDS);
    add('legend', 'valueAt', [one, 0.3], ENDS);
    add('legend', 'edges', [one]);
    add('legend', 'colourOf', [one, 30], { call: (given, value) => legend.colourOf({ ...given, map }, value) });
    add('legend', 'scaleTicks', [one, [30, 50], 9], ENDS);
}
add('patterns', 'patternPeriodPx', [360], ENDS);
add('patterns', 'hatchAt', [3, 4, 360, 8], ENDS);
add('patterns', 'ruleAt', [4, 360, 8], ENDS);
add('patterns', 'stippleAt', [3, 4, 360, 8, [9, 9, 9]], ENDS);
for (const one of [series, buckets]) {
    add('history', 'line', [one, 0, 10e6], ENDS);
    add('history', 'gaps', [one, 0, 10e6]);
    add('history', 'lost', [[one, one], 0, 10e6]);
    add('trend_values', 'bands', [one], ENDS);
    add('trend_values', 'statistics', [one, 0, 10e6], ENDS);
    add('trend_values', 'valueAt', [one, 1.5e6], ENDS);
}
add('trend_values', 'withNewest', [{ min: 1, max: 2, mean: 1.5, known: 1 }, 3], ENDS);
add('history', 'limitLines', [[{ limits: { H: 80, L: 20 } }]], { call: (tags) => history.limitLines(tags, () => 0) });
add('history', 'nextTo', [marks, 1.5e6, false], ENDS);
add('history', 'clustered', [marks, 2e6], ENDS);
add('history', 'density', [marks, 0, 10e6, 20], ENDS);
add('history', 'arrowS', [3600], ENDS);
const plotBox = { left: 10, top: 5, width: 300, height: 90 }, lines = [{ y: 20, words: 'A H 3' }, { y: 30, words: 'A L 1', short: 'L 1' }];
const curve = (...given) => limitNames.extentOf(...given, (s) => s, (value) => value);
add('limit_names', 'extentOf', [plotBox, [10, 50, 300], [20, 60, 40], [[[10, 50, 15, 25]]]], { ends: true, call: curve });
const namesAt = (limits, bbox, x, y, height, gap) =>
    limitNames.placeNames({ limits, bbox, extents: [curve(bbox, x, y, [])], widthOf: (text) => 6 * text.length, height, gap });
add('limit_names', 'placeNames', [lines, plotBox, [10, 50, 300], [20, 60, 40], 15, 5], { ends: true, call: namesAt });
add('trend_range', 'zoomed', [[0, 100e6], 0.5, 25e6, 200e6], ENDS);
add('trend_range', 'panned', [[0, 100e6], 0.5, 200e6], ENDS);
add('trend_range', 'newSpanS', [5000], ENDS);
add('list_window', 'stack', [[20, 30, 20]], { ends: true });
add('list_window', 'rowAt', [[0, 20, 50, 70], 30]);
add('list_window', 'rowsInSight', [[0, 20, 50, 70], 10, 30, 2], ENDS);
add('scroll', 'scrollTo', [[0, 20, 50, 70], 2, 10, 30], ENDS);
add('meters', 'RateMeter', [1000, [1, 2, 3], 5], { ends: true, call: (keep, times, now) => {
    const meter = new meters.RateMeter(keep);
    times.forEach((at) => meter.count(at));
    return meter.perSecond(now);
} });
add('meters', 'LatencyMeter', [3000, [1, 2, 3], 5], { ends: true, call: (keep, times, now) => {
    const meter = new meters.LatencyMeter(keep);
    times.forEach((at, seq) => { meter.sent(seq, at); meter.drawn(seq, at); });
    return meter.median(now);
} });
add('timings', 'timingOf', [recent, 'network'], ENDS);
add('timings', 'kbitPerS', [recent, 100, 5000], ENDS);

// Texts, addresses and sizes.
for (const name of ['decimalsFor', 'ageText'])
    add('format', name, [12], ENDS);
for (const name of ['numberText', 'shortNumberText', 'changeText'])
    add('format', name, [12, 2], ENDS);
add('format', 'decimalsOf', [{ min: 0.1, max: 1000, scale: 'log' }, 12], ENDS);
add('format', 'valueText', [{ min: 0.1, max: 1000, scale: 'log' }, 12], ENDS);
add('format', 'dayTime', [1e12], { ends: true, call: (ms) => format.dayTime(format.zoneClock('UTC'), ms) });
add('format', 'dateTime', [1e12], { ends: true, call: (ms) => format.dateTime(format.zoneClock('UTC'), ms) });
add('format', 'timeOrDay', [1e12, 1.1e12], { ends: true, call: (...instants) => format.timeOrDay(format.zoneClock('UTC'), ...instants) });
add('format', 'zoneClock', ['Europe/Berlin', 1e12], { ends: true, call: (zone, ms) => format.zoneClock(zone)(ms) });
add('instant', 'fieldText', [1e15, 'Europe/Berlin'], ENDS);
add('instant', 'ticks', [1e15, 1.0001e15, 6, 'Europe/Berlin', 60]);
add('query', 'numbersText', [[1, 2, 3]], ENDS);
add('query', 'listText', ['range', [1, 2]], ENDS);
add('query', 'instantText', [1e15], ENDS);
add('query', 'clipText', [clip], ENDS);
add('query', 'sensorsText', [{ A: { strength: 1, decay: 2 } }], ENDS);
add('query', 'snapshotQuery', [shown], ENDS);
add('address', 'writeAddress', [{ camera: eye, params: { range: [1, 2], power: 3 }, time: { atUs: 1e15 } }], ENDS);
add('gestures', 'wheelZoom', [{ deltaY: 12, deltaMode: 0 }]);
add('gestures', 'Gestures', [[10, 20], [15, 28], [40, 50], [45, 52]], { ends: true, call: (...points) => {
    const hand = new gestures.Gestures();
    points.forEach(([x, y], id) => hand.down({ id: id % 2, x, y }));
    return points.flatMap(([x, y], id) => hand.move({ id: id % 2, x: x + 9, y }));
} });
add('wall', 'wallScale', [{ inches: 55, metres: 3 }, { width: 1920, height: 1080 }]);
add('wall', 'millimetresPerPx', [55, { width: 1920, height: 1080 }], ENDS);
add('wall', 'wallFit', [{ inches: 55, metres: 3 }, HD, { width: 1900, height: 1000 }, { width: 440, height: 250 }],
    { call: (...given) => wall.wallFit(...given).scale });
add('wall', 'brightness', [{ from_min: 60, to_min: 300, percent: 40 }, 100, false], ENDS);
add('wall', 'burnShift', [1e15], ENDS);
add('wall', 'legendsLie', [640, 360, true], ENDS);
add('wire', 'depthGridOf', [[2, 1, 2, 0]], { call: (bytes) => wire.depthGridOf(Uint8Array.from(bytes).buffer)?.more });
add('wire', 'pictureSize', [640, 360]);

// Cases of modules that draw charts and curves: the test records the coordinates that they draw.
function drawing(draw, ...given) {
    const at = [], note = (...numbers) => { at.push(numbers); };
    const ctx = { canvas: HD, moveTo: note, lineTo: note, fillRect: note };
    for (const name of ['save', 'restore', 'beginPath', 'rect', 'clip', 'stroke', 'fill', 'closePath'])
        ctx[name] = () => {};
    draw(ctx, ...given, '#000');
    return at;
}
for (const name of ['toCss', 'toPixels', 'textSize'])
    add('app/chart_style', name, [12], ENDS);
add('app/chart_style', 'hatchAlong', [[10, 20], [300, 90]],
    { ends: true, call: (...given) => drawing(chartStyle.hatchAlong, ...given).length });
add('app/chart_style', 'triangle', [10, 20], { ends: true, call: (...given) => drawing(chartStyle.triangle, ...given).length });
add('app/chart_style', 'hatch', [10, 20, 300, 90], { ends: true, call: (...given) => drawing(chartStyle.hatch, ...given).length });
add('app/drift', 'residuals', [[[0, 3, 2], [1, 4, 4]]], ENDS);
add('app/drift', 'stretches', [[1, 2, 3, 2], 0.5], { call: (values, sigma) =>
    drift.stretches(values.filter(Number.isFinite), sigma).join(' ').split(/[ ,]/).filter(Boolean).map(Number) });
add('app/toolbar', 'bandsOf', [{ group: { limits: { H: 3, L: 1 }, breaks: [1, 2] } }], ENDS);
const reading = { value: 4, quality: 'good' }, model = { readings: [reading], group: () => ({ min: 0, max: 10, unit: 'K' }) };
add('app/alarm_bar', 'heldSince', [{ model: { readings: [{ quality: 'bad' }], plant: { time_zone: 'UTC' }, ageMs: (_, now) => now },
    time: { atUs: null }, clockUs: () => 1e15, now: () => 1000 }, { tag: { index: 0 }, kind: 'HH' }], ENDS);
add('app/alarm_bar', 'todayOf', [{ model: { plant: { time_zone: 'UTC' } }, clockUs: () => 1e15 }]);
add('app/alarm_bar', 'timeOf', [{ model: { plant: { time_zone: 'UTC' } }, clockUs: () => 1e15 }, 9e14], ENDS);
add('app/alarm_bar', 'limitText', [{ model, time: { atUs: null } }, { tag: { index: 0, unit: 'K' }, value: 5, limit: 4 }, true], ENDS);

// Functions and classes that are not called here, because they take texts, messages or objects of the page, or represent a
// session.
const OTHERS = ['address.addressOf', 'address.readAddress', 'format.unitText', 'format.zoneOf', 'format.qualityText',
    'history.witnesses', 'history.raised', 'history.severityOf',
    'trend_range.readRange', 'trend_values.alarmSpans', 'app/chart_style.strokeAlong',
    'app/chart_style.setChartUnit', 'instant.fieldInstant',
    'query.readInstant', 'query.readNumbers', 'query.readSensors',
    'sun.sunText', 'wall.readWall', 'wire.WireError', 'wire.decodeFrame', 'wire.isGivenUp',
    'app/alarm_bar.AlarmBar', 'app/alarm_bar.asOf', 'app/alarm_bar.badge', 'app/drift.driftCurve', 'app/drift.driftOf',
    'app/drift.driftText',
    'app/toolbar.Toolbar', 'wire.isWhole', 'wire.decodeMessage', 'wire.decodeBase64'];

// Exported functions of MODULES that are neither called by a case nor listed in OTHERS; the test fails if there are any.
export const forgotten = Object.entries(MODULES).flatMap(([module, all]) => Object.entries(all)
    .filter(([name, value]) => typeof value === 'function' && !called.has(`${module}.${name}`) && !OTHERS.includes(`${module}.${name}`))
    .map(([name]) => `${module}.js: ${name}`));
export const modules = Object.keys(MODULES);
