// SPDX-License-Identifier: GPL-3.0-or-later
// Draws an eye's view for a headset with WebGL 2: the server's picture on the mesh over its depth grid, and boards (rectangles with a
// canvas).
import { clipOf, eyeMatrix } from '../../core/headset_views.js';
import { subtract, add, scale } from '../../core/vector.js';
import { FLOATS } from '../../core/warp_mesh.js';
import { MESH, PICTURE, programOf } from '../picture/painters/gl_painter.js';

const NEAREST_M = 0.05; // metres from the eye; nothing nearer is drawn
// grey of directions outside all pictures; a lattice on it distinguishes it from equipment without a sensor, which is also grey
const UNDRAWN = { light: 0.55, dark: 0.3 };
const BOARD = `#version 300 es
uniform vec4 corners[4];
out vec2 at;
void main() {
    at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = corners[gl_VertexID];
}`;
const CANVAS = `#version 300 es
precision highp float;
in vec2 at;
uniform sampler2D picture;
out vec4 colour;
void main() {
    colour = texture(picture, at);
}`;

// Draws a lattice on the faces of an infinitely large cube around the plant, which both eyes see in the same directions.
const RAYS = `#version 300 es
uniform vec3 rays[4];
out vec3 ray;
void main() {
    ray = rays[gl_VertexID];
    gl_Position = vec4(float(gl_VertexID & 1) * 2.0 - 1.0, 1.0 - float(gl_VertexID >> 1) * 2.0, 0.0, 1.0);
}`;
const LATTICE = `#version 300 es
precision highp float;
in vec3 ray;
uniform float grey;
out vec4 colour;
void main() {
    vec3 size = abs(ray);
    vec2 at = size.x > size.y && size.x > size.z ? ray.yz / size.x : size.y > size.z ? ray.zx / size.y : ray.xy / size.z;
    vec2 line = fract(12.0 * vec2(at.x + at.y, at.x - at.y));
    colour = vec4(vec3(min(line.x, line.y) < 0.12 ? grey - 0.08 : grey), 1.0);
}`;

export class Painter {
    // backdrop: `light` or `dark`, like the background of the pictures.
    constructor(gl, backdrop) {
        Object.assign(this, { gl, buffers: null, source: null });
        this.mesh = programOf(gl, MESH, PICTURE);
        this.board = programOf(gl, BOARD, CANVAS);
        this.undrawn = programOf(gl, RAYS, LATTICE);
        this.grey = UNDRAWN[backdrop] ?? UNDRAWN.light;
        // NEAREST filter: the shader decides which pixels are mixed
        this.picture = this.newTexture(gl.NEAREST);
        this.masks = this.newTexture(gl.NEAREST);
        gl.depthFunc(gl.LEQUAL);
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    }

    newTexture(filter) {
        const { gl } = this, texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, filter], [gl.TEXTURE_MAG_FILTER, filter],
            [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
            gl.texParameteri(gl.TEXTURE_2D, name, value);
        return texture;
    }

    // Sets the picture that is drawn from now on. canvas: its pixels; part: its { grid, mesh } of depth; camera: the picture's camera.
    take(canvas, part, camera) {
        const { gl } = this, { grid, mesh } = part;
        gl.bindTexture(gl.TEXTURE_2D, this.picture);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, canvas);
        if (this.source?.part !== part) {
            gl.bindTexture(gl.TEXTURE_2D, this.masks);
            const { masks, maskSide, columns, rows } = grid;
            gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, columns * maskSide, rows * maskSide, 0, gl.RED, gl.UNSIGNED_BYTE, masks);
            this.buffers ??= [gl.ARRAY_BUFFER, gl.ELEMENT_ARRAY_BUFFER].map((target) => [target, gl.createBuffer()]);
            [mesh.vertices, mesh.indices].forEach((data, i) => {
                const [target, buffer] = this.buffers[i];
                gl.bindBuffer(target, buffer);
                gl.bufferData(target, data, gl.DYNAMIC_DRAW);
            });
        }
        this.source = { part, camera, size: [canvas.width, canvas.height] };
    }

    clear(framebuffer) {
        const { gl } = this;
        gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    }

    // Fills an eye's view with the lattice that marks directions outside all pictures. The picture is drawn over it.
    drawUndrawn({ axes: [right, up, back], projection: p }) {
        const { gl, undrawn } = this;
        gl.disable(gl.DEPTH_TEST);
        gl.disable(gl.CULL_FACE);
        gl.disable(gl.BLEND);
        gl.useProgram(undrawn.program);
        gl.uniform1f(undrawn.at('grey'), this.grey);
        gl.uniform3fv(undrawn.at('rays'), [[-1, 1], [1, 1], [-1, -1], [1, -1]].flatMap(([x, y]) =>
            subtract(add(scale(right, (x + p[8]) / p[0]), scale(up, (y + p[9]) / p[5])), back)));
        gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }

    // Draws the picture as an eye at another position would see it.
    drawPicture(eye) {
        const { gl, mesh, source: { part: { grid, mesh: { indices } }, camera, size } } = this;
        gl.enable(gl.DEPTH_TEST);
        gl.enable(gl.CULL_FACE);
        gl.disable(gl.BLEND);
        gl.useProgram(mesh.program);
        gl.uniformMatrix4fv(mesh.at('warp'), false, eyeMatrix(grid, camera, eye, NEAREST_M));
        gl.uniform2f(mesh.at('origin'), grid.x, grid.y);
        gl.uniform2f(mesh.at('extent'), grid.width, grid.height);
        gl.uniform2fv(mesh.at('size'), size);
        gl.uniform1f(mesh.at('bit'), grid.cellPx / grid.maskSide);
        gl.uniform1i(mesh.at('masks'), 1);
        gl.activeTexture(gl.TEXTURE1);
        gl.bindTexture(gl.TEXTURE_2D, this.masks);
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D, this.picture);
        for (const [target, buffer] of this.buffers)
            gl.bindBuffer(target, buffer);
        gl.enableVertexAttribArray(0);
        gl.vertexAttribPointer(0, FLOATS, gl.FLOAT, false, 0, 0);
        gl.drawElements(gl.TRIANGLES, indices.length, gl.UNSIGNED_INT, 0);
        gl.disableVertexAttribArray(0);
    }

    // Draws rectangles (texts, markers and rays in the headset's view) in front of everything, in their order: { texture, at, axes, width,
    // height } in plant metres; without `at`, over the whole view.
    drawBoards(eye, boards) {
        const { gl, board } = this;
        gl.disable(gl.DEPTH_TEST);
        gl.disable(gl.CULL_FACE);
        gl.enable(gl.BLEND);
        gl.useProgram(board.program);
        for (const { texture, at, axes, width, height } of boards) {
            const corner = (x, y) => (at ? clipOf(eye, [add(subtract(at, eye.at), add(scale(axes[0], x * width / 2),
                scale(axes[1], y * height / 2))), 1], NEAREST_M) : [x, y, 0, 1]);
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.uniform4fv(board.at('corners'), [corner(-1, 1), corner(1, 1), corner(-1, -1), corner(1, -1)].flat());
            gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
        }
    }

    // Copies a canvas into a texture, creating the texture at the first call.
    upload(texture, canvas) {
        const { gl } = this, own = texture ?? this.newTexture(gl.LINEAR);
        gl.bindTexture(gl.TEXTURE_2D, own);
        gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, true);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, canvas);
        gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
        return own;
    }
}
