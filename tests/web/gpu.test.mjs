// SPDX-License-Identifier: GPL-3.0-or-later
// Which renderers of WebGL count as a GPU.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { hasGpu } from '../../clients/web/core/gpu.js';

// A canvas whose WebGL 2 has this renderer, and takes drawMs for each drawing. name null: the canvas has no WebGL 2.
function canvasOf(name, drawMs = 0) {
    const clock = { ms: 0, draws: 0 };
    const own = { RENDERER: 1, getParameter: () => name, getExtension: () => null,
        drawArrays: () => { clock.ms += drawMs + (clock.draws++ === 0 ? 100 : 0); } }; // the first drawing compiles the shaders
    const gl = new Proxy(own, { get: (given, key) => given[key] ?? (() => ({})) });
    return [{ getContext: () => (name === null ? null : gl) }, clock];
}
const judge = (name, platform, drawMs) => {
    const [canvas, clock] = canvasOf(name, drawMs);
    return [hasGpu(canvas, platform, () => clock.ms), clock.draws > 0];
};

test('a renderer counts as a GPU unless its name says that it emulates one', () => {
    assert.deepEqual(judge('ANGLE (Intel, Mesa Intel(R) UHD Graphics 630)', 'Linux x86_64'), [true, false]);
    assert.deepEqual(judge('ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device))', 'Linux x86_64'), [false, false]);
    assert.deepEqual(judge('llvmpipe, or similar', 'Linux x86_64'), [false, false]);
    assert.deepEqual(judge(null, 'Linux x86_64'), [false, false]);
});

test('a renderer whose name WebKit hides is measured, except on computers by Apple', () => {
    assert.deepEqual(judge('Apple GPU', 'MacIntel', 60), [true, false]);
    assert.deepEqual(judge('Apple GPU', 'iPhone', 60), [true, false]);
    assert.deepEqual(judge('Apple GPU', 'Linux x86_64', 1), [true, true]);
    assert.deepEqual(judge('Apple GPU', 'Linux x86_64', 60), [false, true]);
});
