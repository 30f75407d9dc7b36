// SPDX-License-Identifier: GPL-3.0-or-later
// Tells whether the browser draws with a GPU.

// Returns false if the browser has no WebGL 2, or emulates it on the processor. canvas: a new canvas, which is not used afterwards.
export function hasGpu(canvas) {
    const gl = canvas.getContext('webgl2', { powerPreference: 'high-performance' });
    const name = gl?.getParameter(gl.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
    gl?.getExtension('WEBGL_lose_context')?.loseContext();
    return gl !== null && !/swiftshader|llvmpipe|softpipe|basic render|software/i.test(name);
}
