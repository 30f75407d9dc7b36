// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the field (values interpolated from sensors) with the temperatures of a heat conduction simulation in a bent pipe of
// coarse elements. The other parts and cases are in tests/validation.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { before, test } from 'node:test';
import { folderOfTests } from './support/folders.mjs';
import { BIN } from './support/tiny_plant.mjs';

const OUT = resolve(process.env.PLANTCAST_OUT ?? 'build/release');
const absent = [['gmsh', 'gmsh'], ['ccx', 'calculix-ccx']].filter(([program]) => spawnSync('which', [program]).status !== 0);
const needed = [join(BIN, 'plantcast-prep'), join(OUT, 'tests/validation/compare')].filter((path) => !existsSync(path));
const skip = absent.length > 0 ? `not installed: ${absent.map(([, name]) => name).join(', ')}` :
    needed.length > 0 ? `not built: ${needed}` : false;
const folder = skip ? null : folderOfTests();
let part;

before(() => {
    if (skip)
        return;
    const { status, stderr } = spawnSync('tests/validation/run', [OUT, BIN, '--folder', folder, '--parts', 'bent', '--sensors', '5,20',
        '--coarser', '2.5', '--prepare', 'harmonic, fin, gp', '--no-pictures'], { encoding: 'utf8', timeout: 240000 });
    assert.equal(status, 0, stderr);
    [part] = JSON.parse(readFileSync(join(folder, 'validation.json'), 'utf8'));
});

const errors = (sensors, interpolation, distance = '') => part.rows.find((row) => row.sensors === sensors &&
    row.interpolation === interpolation && row.distance === distance).outside;

// The simulation with CalculiX fixes one temperature at 200 °C, and the surroundings are cooler. So the highest temperature must be 200
// °C, and the lowest must lie between that of the surroundings and 40 °C.
test('the reference temperatures of CalculiX are within the given limits', { skip }, () => {
    assert.ok(part.nodes > 2000 && part.triangles > 4000, `only ${part.nodes} nodes`);
    assert.ok(Math.abs(part.high - 200) < 0.01 && part.low > 20 && part.low < 40, `temperatures from ${part.low} to ${part.high}`);
});

// [number of sensors, interpolation, distance, limit of the mean error, limit of the 95th percentile], errors in kelvin. The
// part's temperatures span 180 K. Each limit is a third above the error that was measured.
for (const [sensors, interpolation, distance, mean, p95] of [
    [20, 'shepard', 'geodesic', 6.3, 18.6], [20, 'harmonic', '', 4.6, 13], [20, 'fin', '', 4.8, 27], [5, 'fin', '', 11.8, 54],
    [20, 'gp', '', 3.3, 6.8], [5, 'gp', '', 21.7, 93],
]) {
    test(`${interpolation} from ${sensors} sensors has an error within its limits`, { skip }, () => {
        const { mean: is, p95: high, unknown } = errors(sensors, interpolation, distance);
        assert.ok(is <= mean && high <= p95, `mean error ${is} K (limit ${mean}), 95th percentile ${high} K (limit ${p95})`);
        assert.ok(unknown < 0.02, `${100 * unknown} % of the surface is unknown`);
    });
}

// The gap between the pipe's two legs is only as wide as the pipe is thick. Straight-line distances across the gap mix the values
// of a hot leg and a cold one, so distances along the surface must give smaller errors.
test('distances along the surface give smaller errors than straight ones across the gap', { skip }, () => {
    const along = errors(20, 'shepard', 'geodesic').mean, straight = errors(20, 'shepard', 'euclidean').mean;
    assert.ok(along < 0.85 * straight, `mean error ${along} K along the surface, ${straight} K straight`);
});
