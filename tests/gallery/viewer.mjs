// SPDX-License-Identifier: GPL-3.0-or-later
// Draws real models with their materials in Plantcast and in three.js, with the same camera, sun, surroundings and tone mapping: side by
// side, with their difference in CIELAB. usage: node tests/gallery/viewer.mjs BIN FOLDER
// Writes FOLDER/viewer_MODEL.png and viewer.json; the exit code is 1 if the difference exceeds its limit.
//
// Light and materials are compared only at pixels without occlusion, because three.js has no ambient occlusion and different shadows.
// three.js finds these pixels itself, from pictures lit from all directions.
import { execFileSync } from 'node:child_process';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { extname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const { chromium } = createRequire(new URL('../e2e/package.json', import.meta.url))('playwright-core');
const HERE = fileURLToPath(new URL('.', import.meta.url)), MODELS = resolve(HERE, '../../../shared/data/models');
const [bin, folder] = process.argv.slice(2).map((path) => resolve(path));
const WIDTH = 800, HEIGHT = 600, SUN = [-0.45, -0.6, 0.66], MOST_MEAN = 3;
const NAMES = ['industrial_tanker', 'cookie_factory_mixer', 'cookie_factory_water_tank', 'plm_plant_equipment'];
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript' };

// --- surroundings: a hall with a bright ceiling light, a window to one side and a floor

const ENV_WIDTH = 512, ENV_HEIGHT = 256;

function radiance(turn, height) {
    const grey = height > 0 ? 0.55 + 0.5 * height : 0.35;
    const window = Math.abs(turn + 2) < 0.5 && height > 0.1 && height < 0.55 ? 3 : 0;
    const lamp = height > 0.85 ? 2.5 : 0;
    return grey + window + lamp;
}

// Scales the surroundings so that a horizontal white surface reflects 1, which is Plantcast's exposure.
function surroundings() {
    const pixels = new Float32Array(ENV_WIDTH * ENV_HEIGHT);
    let level = 0;
    for (let y = 0; y < ENV_HEIGHT; y++) {
        const height = Math.cos((Math.PI * (y + 0.5)) / ENV_HEIGHT);
        const weight = ((2 * Math.PI) / ENV_WIDTH) * (Math.cos((Math.PI * y) / ENV_HEIGHT) - Math.cos((Math.PI * (y + 1)) / ENV_HEIGHT));
        for (let x = 0; x < ENV_WIDTH; x++) {
            const value = radiance((2 * Math.PI * (x + 0.5)) / ENV_WIDTH - Math.PI, height);
            pixels[y * ENV_WIDTH + x] = value;
            level += (weight * Math.max(height, 0) * value) / Math.PI;
        }
    }
    return pixels.map((value) => value / level);
}

// Radiance RGBE, grey, not compressed.
function hdr(pixels) {
    const bytes = Buffer.alloc(4 * pixels.length);
    pixels.forEach((value, i) => {
        const exponent = Math.ceil(Math.log2(value)) + 1, mantissa = Math.min(255, Math.round((value * 256) / 2 ** exponent));
        bytes.set([mantissa, mantissa, mantissa, exponent + 128], 4 * i);
    });
    return Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${ENV_HEIGHT} +X ${ENV_WIDTH}\n`), bytes]);
}

// --- both pictures

function plantcast(name, camera) {
    const plant = join(folder, 'viewer', `${name}.yaml`), out = join(folder, 'viewer', `${name}.png`);
    writeFileSync(join(folder, 'viewer', 'none.csv'), 'Tag Name,Group,Asset,Node,X,Y,Z\n');
    writeFileSync(plant, `plant: { name: ${name} }\nassets: [{ id: A, model: ${join(MODELS, `${name}.glb`)} }]\n` +
        'groups: [{ id: none, unit: K, min: 0, max: 1 }]\nenvironment: surroundings.hdr\ntags: none.csv\n');
    execFileSync(join(bin, 'plantcast-prep'), [plant], { stdio: 'ignore' });
    execFileSync(join(bin, 'plantcast'), ['snapshot', plant, '-o', out, '--size', `${WIDTH}x${HEIGHT}`, '--look', 'materials',
        '--no-overlay', `--camera=${[...camera.eye, ...camera.target, camera.fov].join(',')}`, `--light=${SUN.join(',')}`,
        '--environment', 'surroundings'], { stdio: 'ignore' });
    return out;
}

function serve() {
    const three = join(HERE, 'node_modules/three');
    const server = createServer((request, response) => {
        const { pathname } = new URL(request.url, 'http://localhost');
        const path = [['/three/', three], ['/models/', MODELS], ['/out/', join(folder, 'viewer')], ['/', HERE]]
            .filter(([prefix]) => pathname.startsWith(prefix)).map(([prefix, root]) => join(root, pathname.slice(prefix.length)))[0];
        if (!existsSync(path) || pathname.includes('..')) {
            response.writeHead(404).end();
            return;
        }
        response.writeHead(200, { 'content-type': TYPES[extname(path)] ?? 'application/octet-stream' }).end(readFileSync(path));
    });
    return new Promise((done) => server.listen(0, '127.0.0.1', () => done(server)));
}

mkdirSync(join(folder, 'viewer'), { recursive: true });
writeFileSync(join(folder, 'viewer', 'surroundings.hdr'), hdr(surroundings()));
const server = await serve();
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'] });
const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
page.on('pageerror', (error) => console.error(String(error)));
await page.goto(`http://127.0.0.1:${server.address().port}/viewer.html`);
const results = {};
let bad = 0;
for (const name of NAMES.filter((one) => existsSync(join(MODELS, `${one}.glb`)))) {
    const camera = await page.evaluate(([model, width, height, sun]) => globalThis.viewer.draw(model, width, height, sun),
        [name, WIDTH, HEIGHT, SUN]);
    plantcast(name, camera);
    const { png, ...numbers } = await page.evaluate((model) => globalThis.viewer.compare(`/out/${model}.png`), name);
    writeFileSync(join(folder, `viewer_${name}.png`), Buffer.from(png.split(',')[1], 'base64'));
    results[name] = numbers;
    bad += numbers.open.mean > MOST_MEAN;
    const { open, all } = numbers;
    console.log(`viewer: ${name}: delta E, mean ${open.mean} (median ${open.median}, 95 % below ${open.p95}) where nothing stands in ` +
        `the way (${open.part} % of the model); mean ${all.mean} over all of it`);
}
writeFileSync(join(folder, 'viewer.json'), `${JSON.stringify(results, null, 1)}\n`);
await browser.close();
server.close();
process.exitCode = bad > 0 ? 1 : 0;
