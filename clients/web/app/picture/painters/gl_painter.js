// SPDX-License-Identifier: GPL-3.0-or-later
// Draws warped pictures with WebGL 2, for warp.js.
import { FLOATS } from '../../../core/warp_mesh.js';

export const MESH = `#version 300 es
in vec4 vertex;
uniform mat4 warp;
out vec2 at;
flat out float kind;
void main() {
    at = vertex.xy;
    kind = vertex.w;
    gl_Position = warp * vec4(vertex.xyz, 1.0);
}`;
// Draws the picture on its depth mesh. Interpolates between neighbouring pixels of the picture, but only if their colours are
// alike, because users would read a mixture of two colours as the value between them. For two colours of one of the product's
// maps, the limits keep the mixture's value within 4.3 % of the range from one of the two values. LIKE_HUE: largest difference
// of red - green, and of green - blue; LIKE: largest difference of red, green or blue. If a step in depth divides a cell, pixels
// of its two sides are not mixed, and edge pixels of the farther surface, which contain a part of the nearer surface's colour,
// become grey.
export const PICTURE = `#version 300 es
precision highp float;
in vec2 at;
flat in float kind;
uniform sampler2D picture, masks;
uniform vec2 origin, extent, size;
uniform float bit;
out vec4 colour;
const float LIKE_HUE = 8.5 / 255.0, LIKE = 48.5 / 255.0;
vec3 pixelAt(vec2 place) {
    return texelFetch(picture, ivec2((origin + place) / size * vec2(textureSize(picture, 0))), 0).rgb;
}
bool areAlike(vec3 a, vec3 b) {
    vec3 by = abs(a - b);
    vec2 hue = abs(a.rg - a.gb - b.rg + b.gb);
    return max(hue.x, hue.y) <= LIKE_HUE && max(by.r, max(by.g, by.b)) <= LIKE;
}
bool isNear(float x, float y) {
    return texelFetch(masks, ivec2(vec2(x, y) / bit), 0).r > 0.5;
}
void main() {
    if (kind > 0.5 && isNear(at.x, at.y) != (kind < 1.5))
        discard;
    vec3 own = pixelAt(clamp(at, vec2(0.5), extent - 0.5));
    vec2 corner = floor(at - 0.5), share = at - 0.5 - corner;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        vec2 offset = vec2(i & 1, i >> 1), place = clamp(corner + offset + 0.5, vec2(0.5), extent - 0.5);
        vec3 pixel = pixelAt(place);
        vec2 part = mix(1.0 - share, share, offset);
        bool isOther = kind > 0.5 && isNear(place.x, place.y) != (kind < 1.5);
        sum += isOther || !areAlike(pixel, own) ? vec4(0.0) : part.x * part.y * vec4(pixel, 1.0);
    }
    colour = sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : vec4(own, 1.0);
    if (kind > 1.5 && (isNear(at.x - bit, at.y) || isNear(at.x + bit, at.y) || isNear(at.x, at.y - bit) || isNear(at.x, at.y + bit)))
        colour.rgb = vec3(dot(colour.rgb, vec3(0.299, 0.587, 0.114)));
}`;
const BEHIND = `#version 300 es
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 1.0, 1.0);
}`;
// Places that the picture does not show become grey. This shader computes, from a reduced picture (fast even without a GPU),
// the grey around such places and how wide they are.
const AROUND = `#version 300 es
precision highp float;
uniform sampler2D drawn;
uniform vec2 size;
out vec4 colour;
void main() {
    vec2 at = gl_FragCoord.xy / size;
    vec4 sum = vec4(0.0);
    for (int level = 0; level < 12 && sum.a < 0.98; level++)
        sum += (1.0 - sum.a) * textureLod(drawn, at, float(level));
    float grey = sum.a > 0.0 ? dot(sum.rgb, vec3(0.299, 0.587, 0.114)) / sum.a : 0.5;
    colour = vec4(vec3(grey), smoothstep(0.35, 0.65, 1.0 - textureLod(drawn, at, 3.0).a));
}`;
const UNDRAWN = `#version 300 es
precision highp float;
uniform sampler2D around;
uniform vec2 size;
uniform float period;
out vec4 colour;
void main() {
    vec4 near = texture(around, gl_FragCoord.xy / size);
    vec2 line = mod(vec2(gl_FragCoord.x + gl_FragCoord.y, gl_FragCoord.x - gl_FragCoord.y), period);
    float mark = min(line.x, line.y) < 0.1 * period ? 0.08 * near.a : 0.0;
    colour = vec4(vec3(near.r > 0.4 ? near.r - mark : near.r + mark), 1.0);
}`;
// Fades out the warped picture by discarding more and more pixels, in a dither pattern, so that the server's picture below shows. Users
// would read a mixture of both colours as the value between them.
const GONE = `#version 300 es
precision highp float;
uniform float gone;
out vec4 colour;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy) & 3;
    int odd = at.x ^ at.y;
    if (float(4 * (2 * (odd & 1) + (at.y & 1)) + (odd & 2) + (at.y >> 1)) > gone * 16.0 - 0.5)
        discard;
    colour = vec4(0.0);
}`;
// each block of REDUCED x REDUCED pixels becomes one pixel of the reduced picture, from which the greys of places that the picture does not
// show are computed
const REDUCED = 4;

// Returns { program, at(name) }; at() returns the location of a uniform.
export function programOf(gl, ...sources) {
    const program = gl.createProgram();
    [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((type, i) => {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, sources[i]);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
    });
    gl.bindAttribLocation(program, 0, 'vertex');
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
        throw new Error(gl.getProgramInfoLog(program));
    return { program, at: (name) => gl.getUniformLocation(program, name) };
}

export class GlPainter {
    // Throws if a shader program does not compile.
    constructor(gl) {
        this.gl = gl;
        // the parts of the picture (halves of a split view, or the whole picture) whose meshes and masks are loaded into WebGL
        this.loaded = null;
        // for each part in `loaded`: { buffers (its mesh), masks (texture: which pixels belong to the nearer of two surfaces) }
        this.uploaded = [];
        this.mesh = programOf(gl, MESH, PICTURE);
        this.around = programOf(gl, BEHIND, AROUND);
        this.undrawn = programOf(gl, BEHIND, UNDRAWN);
        this.gone = programOf(gl, BEHIND, GONE);
        gl.enable(gl.DEPTH_TEST);
        gl.enable(gl.CULL_FACE);
        gl.depthFunc(gl.LEQUAL);
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        gl.enableVertexAttribArray(0);
        this.texture = this.newTexture();
        // two textures with 1/REDUCED of the width and height: one for the warped picture, one for the greys of places that the
        // picture does not show
        this.reduced = [gl.LINEAR_MIPMAP_NEAREST, gl.LINEAR].map((filter) => {
            const one = { texture: this.newTexture(), framebuffer: gl.createFramebuffer() };
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
            return one;
        });
    }

    newTexture() {
        const { gl } = this, texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        // NEAREST: the shader decides which pixels are mixed
        for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
            [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
            gl.texParameteri(gl.TEXTURE_2D, name, value);
        return texture;
    }

    // Sets the size of the canvas in pixels.
    resize(width, height) {
        const { gl, reduced } = this;
        Object.assign(gl.canvas, { width, height });
        reduced.size = [width, height].map((px) => Math.ceil(px / REDUCED));
        for (const { texture, framebuffer } of reduced) {
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, ...reduced.size, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
            gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, framebuffer);
            gl.framebufferTexture2D(gl.DRAW_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
        }
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    }

    // Uploads a picture and the meshes of its parts (halves of a split view, or the whole picture).
    load(pixels, parts) {
        const { gl } = this;
        gl.bindTexture(gl.TEXTURE_2D, this.texture);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        // uses the visible size, because a video frame's coded size may be a pixel wider and higher
        this.size = [pixels.displayWidth ?? pixels.width, pixels.displayHeight ?? pixels.height];
        if (parts === this.loaded)
            return; // keeps the meshes in the GPU: they were uploaded for an earlier picture with the same depth grids
        for (const { buffers, masks } of this.uploaded) {
            buffers.forEach((buffer) => gl.deleteBuffer(buffer));
            gl.deleteTexture(masks);
        }
        this.uploaded = parts.map((part) => this.loadPart(part));
        this.loaded = parts;
    }

    loadPart({ grid: { masks, maskSide, columns, rows }, mesh }) {
        const { gl } = this, texture = this.newTexture();
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, columns * maskSide, rows * maskSide, 0, gl.RED, gl.UNSIGNED_BYTE, masks);
        const buffers = [[gl.ARRAY_BUFFER, mesh.vertices], [gl.ELEMENT_ARRAY_BUFFER, mesh.indices]].map(([target, data]) => {
            const buffer = gl.createBuffer();
            gl.bindBuffer(target, buffer);
            gl.bufferData(target, data, gl.STATIC_DRAW);
            return buffer;
        });
        return { buffers, masks: texture };
    }

    // Draws the loaded picture from another camera. matrices, boxes: for each half of a split view (or for the whole picture),
    // the result of warpMatrix(), and { left, top, width, height } in drawn pixels. period: distance in drawn pixels between
    // the lines of the lattice that marks places that the picture does not show. gone: fraction of the pixels left out while
    // the picture fades; there the canvas below shows through.
    paint(matrices, boxes, period, gone) {
        const { gl, mesh } = this;
        gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.useProgram(mesh.program);
        gl.bindTexture(gl.TEXTURE_2D, this.texture);
        gl.activeTexture(gl.TEXTURE1);
        gl.uniform1i(mesh.at('masks'), 1);
        gl.uniform2fv(mesh.at('size'), this.size);
        this.loaded.forEach((part, i) => this.paintPart(part, this.uploaded[i], matrices[i], boxes[i]));
        gl.activeTexture(gl.TEXTURE0);
        this.paintUndrawn(period);
        if (gone > 0)
            this.leaveOut(gone);
    }

    paintPart({ grid, mesh: { indices } }, { buffers, masks }, matrix, { left, top, width, height }) {
        const { gl, mesh } = this;
        gl.viewport(left, gl.canvas.height - top - height, width, height);
        gl.uniformMatrix4fv(mesh.at('warp'), false, matrix);
        gl.uniform2f(mesh.at('origin'), grid.x, grid.y);
        gl.uniform2f(mesh.at('extent'), grid.width, grid.height);
        gl.uniform1f(mesh.at('bit'), grid.cellPx / grid.maskSide);
        gl.bindTexture(gl.TEXTURE_2D, masks);
        gl.bindBuffer(gl.ARRAY_BUFFER, buffers[0]);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers[1]);
        gl.vertexAttribPointer(0, FLOATS, gl.FLOAT, false, 0, 0);
        gl.drawElements(gl.TRIANGLES, indices.length, gl.UNSIGNED_INT, 0);
    }

    // Fills the places that the picture does not show with the greys around them.
    paintUndrawn(period) {
        const { gl, gl: { canvas: { width, height } }, reduced, undrawn, around } = this, [drawn, greys] = reduced;
        gl.bindTexture(gl.TEXTURE_2D, drawn.texture);
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, drawn.framebuffer);
        gl.blitFramebuffer(0, 0, width, height, 0, 0, ...reduced.size, gl.COLOR_BUFFER_BIT, gl.LINEAR);
        gl.generateMipmap(gl.TEXTURE_2D);
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, greys.framebuffer);
        gl.viewport(0, 0, ...reduced.size);
        gl.useProgram(around.program);
        gl.uniform2fv(around.at('size'), reduced.size);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
        gl.viewport(0, 0, width, height);
        gl.bindTexture(gl.TEXTURE_2D, greys.texture);
        gl.useProgram(undrawn.program);
        gl.uniform2f(undrawn.at('size'), width, height);
        gl.uniform1f(undrawn.at('period'), period);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
    }

    leaveOut(gone) {
        const { gl } = this;
        gl.disable(gl.DEPTH_TEST);
        gl.useProgram(this.gone.program);
        gl.uniform1f(this.gone.at('gone'), gone);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        gl.enable(gl.DEPTH_TEST);
    }
}
