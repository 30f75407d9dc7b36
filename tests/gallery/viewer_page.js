// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a glTF model with three.js, and compares another program's picture of the same model with that. The plant's x, y and z
// axes are glTF's x, -z and y.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { HDRLoader } from 'three/addons/loaders/HDRLoader.js';

const SKY_LIGHT = 0.55, SUN_LIGHT = 0.78; // as in shaders/environment.glsl
const FOV = 40, RIM_PX = 2, OPEN_RAYS = 48;
const toThree = ([x, y, z]) => new THREE.Vector3(x, z, -y);
const toPlant = ({ x, y, z }) => [x, -z, y];

const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
renderer.toneMapping = THREE.NeutralToneMapping; // Khronos neutral tone mapping, as in shaders/light.glsl
renderer.setClearColor(0, 0);
renderer.shadowMap.enabled = true;
document.body.append(renderer.domElement);
let drawn = null; // last drawn picture: { rgba, shadowless, width, height }

function pixels(source, width, height) {
    const canvas = new OffscreenCanvas(width, height), c = canvas.getContext('2d', { willReadFrequently: true });
    c.drawImage(source, 0, 0, width, height);
    return c.getImageData(0, 0, width, height).data;
}

async function load(name) {
    const { scene } = await new GLTFLoader().loadAsync(`/models/${name}.glb`);
    scene.traverse((node) => {
        if (node.isLine || node.isPoints)
            node.visible = false; // hide lines and points, which Plantcast does not draw
        else if (node.isMesh && !node.geometry.attributes.normal)
            node.geometry.computeVertexNormals();
        node.castShadow = node.receiveShadow = true;
    });
    return scene;
}

async function surroundings() {
    const texture = await new HDRLoader().loadAsync('/out/surroundings.hdr');
    texture.mapping = THREE.EquirectangularReflectionMapping;
    return texture;
}

function sunLight(sun, ball) {
    const light = new THREE.DirectionalLight(0xffffff, SUN_LIGHT * Math.PI), { left, right } = { left: -ball.radius, right: ball.radius };
    light.position.copy(ball.center).addScaledVector(toThree(sun).normalize(), 2 * ball.radius);
    light.target.position.copy(ball.center);
    Object.assign(light.shadow.camera, { left, right, bottom: left, top: right, near: ball.radius * 0.9, far: ball.radius * 3.1 });
    light.castShadow = true;
    light.shadow.mapSize.set(4096, 4096);
    light.shadow.normalBias = ball.radius / 500;
    return light;
}

// Returns each pixel's openness: the share of the directions above its surface in which no geometry hides the sky. Computes it
// from depth pictures of the model in OPEN_RAYS directions.
function openness(scene, model, ball, camera, width, height) {
    const target = new THREE.WebGLRenderTarget(width, height, { type: THREE.FloatType }), sum = new Float32Array(width * height);
    const light = new THREE.DirectionalLight(0xffffff, Math.PI);
    const plain = new THREE.MeshLambertMaterial({ color: 0xffffff, side: THREE.FrontSide });
    const room = new THREE.Scene(), all = new Float32Array(width * height), read = new Float32Array(4 * all.length);
    const draw = (shadows, into) => {
        light.castShadow = shadows;
        renderer.setRenderTarget(target);
        renderer.clear();
        renderer.render(room, camera);
        renderer.readRenderTargetPixels(target, 0, 0, width, height, read);
        for (let i = 0; i < into.length; i++)
            into[i] += read[4 * i];
    };
    light.shadow.mapSize.set(1024, 1024);
    light.shadow.normalBias = ball.radius / 150;
    Object.assign(light.shadow.camera, { left: -ball.radius, right: ball.radius, bottom: -ball.radius, top: ball.radius,
        near: ball.radius * 0.5, far: ball.radius * 3.5 });
    light.target.position.copy(ball.center);
    room.overrideMaterial = plain;
    room.add(model, light, light.target);
    for (let i = 0; i < OPEN_RAYS; i++) { // evenly over the whole sphere
        const y = 1 - (2 * i + 1) / OPEN_RAYS, turn = i * 2.39996, flat = Math.sqrt(1 - y * y);
        const towards = new THREE.Vector3(flat * Math.cos(turn), y, flat * Math.sin(turn));
        light.position.copy(ball.center).addScaledVector(towards, 2 * ball.radius);
        draw(true, sum);
        draw(false, all);
    }
    renderer.setRenderTarget(null);
    target.dispose();
    scene.add(model);
    return sum.map((value, i) => value / Math.max(all[i], 1e-6));
}

async function draw(name, width, height, sun) {
    const scene = new THREE.Scene(), model = await load(name);
    scene.add(model);
    model.updateMatrixWorld(true);
    const ball = new THREE.Box3().setFromObject(model).getBoundingSphere(new THREE.Sphere());
    const towards = toThree([-0.55, -0.75, 0.4]).normalize();
    const camera = new THREE.PerspectiveCamera(FOV, width / height, ball.radius / 20, ball.radius * 20);
    camera.position.copy(ball.center).addScaledVector(towards, (0.9 * ball.radius) / Math.sin((FOV * Math.PI) / 360));
    camera.lookAt(ball.center);
    renderer.setSize(width, height, false);
    const open = openness(scene, model, ball, camera, width, height);
    scene.environment = await surroundings();
    scene.environmentIntensity = SKY_LIGHT;
    const light = sunLight(sun, ball);
    scene.add(light, light.target);
    renderer.render(scene, camera);
    const rgba = pixels(renderer.domElement, width, height);
    light.castShadow = false;
    renderer.render(scene, camera);
    drawn = { rgba, shadowless: pixels(renderer.domElement, width, height), open, width, height };
    return { eye: toPlant(camera.position), target: toPlant(ball.center), fov: FOV };
}

// --- comparison

function lab([r, g, b]) {
    const [x, y, z] = [r, g, b].map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    const f = (t) => (t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 * t + 16) / 116);
    const fx = f((0.4124 * x + 0.3576 * y + 0.1805 * z) / 0.95047), fy = f(0.2126 * x + 0.7152 * y + 0.0722 * z);
    const fz = f((0.0193 * x + 0.1192 * y + 0.9505 * z) / 1.08883);
    return [116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)];
}

const at = (rgba, i) => rgba.subarray(4 * i, 4 * i + 3);

// Returns whether a pixel is well inside the model: neither at a silhouette, which the two programs antialias differently, nor
// at an edge that Plantcast draws.
function inside(x, y) {
    const { rgba, width, height } = drawn;
    for (let dy = -RIM_PX; dy <= RIM_PX; dy++) {
        for (let dx = -RIM_PX; dx <= RIM_PX; dx++) {
            const i = (y + dy) * width + x + dx;
            if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height || rgba[4 * i + 3] < 255)
                return false;
        }
    }
    return true;
}

function summary(list, of) {
    const sorted = [...list].sort((a, b) => a - b), round = (x) => Math.round(x * 100) / 100;
    return { mean: round(list.reduce((a, b) => a + b, 0) / list.length), median: round(sorted[sorted.length >> 1]),
        p95: round(sorted[Math.floor(sorted.length * 0.95)]), part: Math.round((100 * list.length) / of) };
}

async function compare(path) {
    const { rgba, shadowless, open, width, height } = drawn;
    const ours = pixels(await createImageBitmap(await (await fetch(path)).blob()), width, height);
    const all = [], free = [], sheet = new OffscreenCanvas(3 * width, height), c = sheet.getContext('2d');
    const theirs = c.createImageData(width, height), difference = c.createImageData(width, height);
    for (let i = 0; i < width * height; i++) {
        const x = i % width, y = Math.floor(i / width), a = lab(at(ours, i)), b = lab(at(rgba, i));
        const delta = Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), alpha = rgba[4 * i + 3] / 255;
        const lit = at(rgba, i).every((v, k) => Math.abs(v - at(shadowless, i)[k]) < 2) && open[(height - 1 - y) * width + x] > 0.97;
        const counts = inside(x, y), grey = counts ? Math.min(255, 12 * delta) : 0;
        difference.data.set(counts && lit ? [grey, grey, grey, 255] : [grey * 0.4, grey * 0.4, grey * 0.7, 255], 4 * i);
        theirs.data.set([0, 1, 2].map((k) => rgba[4 * i + k] * alpha + 235 * (1 - alpha)).concat(255), 4 * i);
        if (counts)
            all.push(delta);
        if (counts && lit)
            free.push(delta);
    }
    c.putImageData(new ImageData(ours, width, height), 0, 0);
    c.putImageData(theirs, width, 0);
    c.putImageData(difference, 2 * width, 0);
    c.font = '20px sans-serif';
    ['Plantcast', `three.js ${THREE.REVISION}`, 'delta E times 12; blue: something stands in the way'].forEach((text, i) => {
        c.fillStyle = i < 2 ? '#333' : '#fff';
        c.fillText(text, i * width + 12, height - 14);
    });
    const blob = await sheet.convertToBlob(), reader = new FileReader();
    const png = await new Promise((done) => {
        reader.onload = () => done(reader.result);
        reader.readAsDataURL(blob);
    });
    return { png, all: summary(all, all.length), open: summary(free, all.length) };
}

globalThis.viewer = { draw, compare };
