// SPDX-License-Identifier: GPL-3.0-or-later
// Tells whether the browser draws with a GPU.

// WebKit gives every renderer this name. On computers that are not Apple's, it may hide an emulation on the processor.
const MASKED = 'Apple GPU';
// A square of PROOF_SIDE pixels with PROOF_STEPS steps of calculation each takes a small GPU about 1 ms, and two processor
// cores 20 ms. A renderer that needs more than MOST_MS is as slow as an emulation.
const PROOF_SIDE = 512, PROOF_STEPS = 128, MOST_MS = 6, TRIES = 3;
const PROOF = [`#version 300 es
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`, `#version 300 es
precision highp float;
out vec4 colour;
void main() {
    float value = gl_FragCoord.x;
    for (int i = 0; i < ${PROOF_STEPS}; i++)
        value = fract(value * 1.7 + gl_FragCoord.y);
    colour = vec4(value);
}`];

// Returns the shortest time in milliseconds of TRIES drawings. The first drawing also compiles the shaders.
function drawMs(gl, now) {
    const program = gl.createProgram(), pixel = new Uint8Array(4), times = [];
    [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((type, i) => {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, PROOF[i]);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    gl.useProgram(program);
    for (let n = 0; n < TRIES; n++) {
        const start = now();
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits until the drawing is complete
        times.push(now() - start);
    }
    return Math.min(...times);
}

// Returns false if the browser has no WebGL 2, or emulates it on the processor. canvas: a new canvas, which is not used
// afterwards; platform: navigator.platform; now: returns milliseconds.
export function hasGpu(canvas, platform = globalThis.navigator?.platform ?? '', now = () => performance.now()) {
    const gl = canvas.getContext('webgl2', { powerPreference: 'high-performance' });
    const name = gl?.getParameter(gl.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
    const isEmulated = gl === null || /swiftshader|llvmpipe|softpipe|basic render|software/i.test(name);
    let isSlow = false;
    if (!isEmulated && name === MASKED && !/^(Mac|iP)/.test(platform)) {
        canvas.width = canvas.height = PROOF_SIDE;
        gl.viewport(0, 0, PROOF_SIDE, PROOF_SIDE);
        isSlow = drawMs(gl, now) > MOST_MS;
    }
    gl?.getExtension('WEBGL_lose_context')?.loseContext();
    return !isEmulated && !isSlow;
}
