// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the newest picture from the present camera until the server's picture of that camera arrives: draws the picture by WebGL 2 on a
// mesh over its depth grid, once per animation frame in which the camera has moved. Places that the picture does not show become grey, as
// light as their surroundings, never coloured; a lattice is drawn over wide grey places. Loaded together with the camera controller.
import { same } from '../../core/camera.js';
import { depthAt, FLOATS, isNear, moveBy, warpMatrix } from '../../core/warp_mesh.js';
import { isWhole } from '../../core/wire.js';
import { make } from '../common/dom.js';

const KEPT = 8; // maximum number of newest depth grids that are kept: grids may be decoded before their pictures
// distance from the eye to the near clipping plane, as a fraction of the nearest depth that the picture's depth grid can express
const NEAREST = 0.05;
// If updates come later than SLOW_MS after each other, as without a GPU, the warped picture is drawn with fewer pixels.
const SLOW_MS = 26, SLOW_COUNT = 8, PAUSE_MS = 150, LEAST_PX = 250000;

const FADE_MS = 80; // time in which the server's picture replaces the warped one
const LATE_MS = 1000; // time without an answer of the worker after which pictures do not wait for it

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
// Pixels behind a step in depth that contain a part of the colour before the step become grey.
export const PICTURE = `#version 300 es
precision highp float;
in vec2 at;
flat in float kind;
uniform sampler2D picture, masks;
uniform vec2 origin, size;
uniform float bit;
out vec4 colour;
bool isNear(float x, float y) {
    return texelFetch(masks, ivec2(vec2(x, y) / bit), 0).r > 0.5;
}
void main() {
    if (kind > 0.5 && isNear(at.x, at.y) != (kind < 1.5))
        discard;
    colour = vec4(texture(picture, (origin + at) / size).rgb, 1.0);
    if (kind > 1.5 && (isNear(at.x - bit, at.y) || isNear(at.x + bit, at.y) || isNear(at.x, at.y - bit) || isNear(at.x, at.y + bit)))
        colour.rgb = vec3(dot(colour.rgb, vec3(0.299, 0.587, 0.114)));
}`;
const BEHIND = `#version 300 es
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 1.0, 1.0);
}`;
// Computes from a reduced picture the greys around places that are not drawn, and how wide these places are. A reduced picture keeps this
// cheap on machines without a GPU.
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
// Fades out the warped picture by discarding its pixels one after the other, in a dither pattern, so that the server's picture below shows.
// A mixture of both colours would be read as the value between them.
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
// REDUCED: REDUCED x REDUCED pixels become one pixel of the reduced picture, from which the greys are computed
const LATTICE_PX = 14, REDUCED = 4;

// Returns true if picture and viewport have the same shape. The width and height of a reduced picture are rounded to even numbers.
export const hasViewportShape = ({ shownWidth, fullWidth, fullHeight }) =>
    Math.abs(shownWidth - fullWidth) <= 2 + 2 * fullWidth / fullHeight;

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

export class Warp {
    constructor({ session, viewport, modules }) {
        Object.assign(this, { session, viewport, modules, updates: 0, mostPx: Infinity, intervals: [], last: 0, count: 0 });
        this.waitsFrom = null; // time at which pictures began to wait for the worker; null: it has answered
        this.grids = [];    // newest depth grids: { id, depth, parts: [{ grid, mesh }] or null until decoded, fails }, newest last
        this.held = null;   // newest frame, decoded but not drawn on the viewport's canvas: { frame, picture }
        this.source = null; // picture that WebGL draws: { picture, camera, parts, isLoaded }
        this.canvas = make('canvas', { id: 'warp', 'aria-hidden': 'true' });
        this.canvas.style.display = 'none';
        if (!this.open())
            return;
        this.canvas.addEventListener('webglcontextlost', (event) => this.lose(event));
        this.canvas.addEventListener('webglcontextrestored', () => this.regain());
        viewport.canvas.after(this.canvas);
        this.worker = new Worker(new URL('./warp_worker.js', import.meta.url), { type: 'module' });
        this.worker.onmessage = ({ data }) => this.take(data);
        this.worker.onerror = () => this.giveUp();
        viewport.warp = this;
        session.on('frame', (frame) => this.prepare(frame));
        session.on('hello', () => this.forget());
        if (session.picture)
            this.prepare(session.picture);
    }

    // Prepares WebGL. Returns false if the browser does not have it; pictures are then shown unwarped.
    open() {
        const gl = this.canvas.getContext('webgl2', { antialias: false, powerPreference: 'high-performance' });
        if (!gl)
            return false;
        try {
            this.mesh = programOf(gl, MESH, PICTURE);
            this.around = programOf(gl, BEHIND, AROUND);
            this.undrawn = programOf(gl, BEHIND, UNDRAWN);
            this.gone = programOf(gl, BEHIND, GONE);
        } catch (error) {
            console.warn(`pictures are not warped: ${error.message}`);
            return false;
        }
        // fit() creates the textures of `reduced` when the canvas changes its size, as it does from this size
        this.canvas.width = this.canvas.height = 1;
        gl.enable(gl.DEPTH_TEST);
        gl.enable(gl.CULL_FACE);
        gl.depthFunc(gl.LEQUAL);
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        gl.enableVertexAttribArray(0);
        this.gl = gl;
        this.texture = this.newTexture();
        // two reduced textures: the picture, and the greys for places that the picture does not show
        this.reduced = [gl.LINEAR_MIPMAP_NEAREST, gl.LINEAR].map((filter) => {
            const one = { texture: this.newTexture(), framebuffer: gl.createFramebuffer() };
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
            gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
            return one;
        });
        return true;
    }

    newTexture() {
        const { gl } = this, texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        // NEAREST, because users would read a mixture of two colours as the value between them
        for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
            [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
            gl.texParameteri(gl.TEXTURE_2D, name, value);
        return texture;
    }

    // Shows pictures unwarped until the browser restores WebGL.
    lose(event) {
        event.preventDefault(); // without this, the browser does not restore WebGL
        this.hide();
        this.viewport.warp = null;
        this.viewport.invalidate();
    }

    // Warps again after the browser has restored WebGL. Programs, textures and buffers of the lost context do not exist any more.
    regain() {
        this.source = this.loaded = this.painted = null;
        for (const part of this.grids.flatMap(({ parts }) => parts ?? []))
            part.buffers = null;
        if (!this.canvas.isConnected || !this.open())
            return;
        this.viewport.warp = this;
        this.viewport.invalidate();
    }

    // Shows pictures unwarped from now on, because WebGL or the worker fails.
    giveUp() {
        this.hide();
        this.viewport.warp = null;
        this.canvas.remove();
        this.worker.terminate();
        this.viewport.invalidate();
    }

    forget() {
        this.grids = [];
    }

    // Has the depth grids of a frame decoded, while the browser decodes its picture.
    prepare({ depth, camera, fullWidth, fullHeight }) {
        if (!depth || this.grids.some((one) => one.depth === depth))
            return;
        const id = ++this.count;
        this.grids = [...this.grids.slice(1 - KEPT), { id, depth, parts: null, fails: false }];
        this.worker.postMessage({ id, messages: depth.messages, frame: { camera, fullWidth, fullHeight } });
    }

    take({ id, parts, why }) {
        const entry = this.grids.find((one) => one.id === id);
        this.waitsFrom = null;
        clearTimeout(this.lateTimer);
        if (!entry)
            return;
        if (parts) {
            entry.parts = parts;
        } else {
            entry.fails = true;
            if (this.why !== why)
                console.warn(this.why = why);
        }
        this.viewport.invalidate();
    }

    get isAhead() {
        const { cameraNews, cameraSeq, picture } = this.session;
        return cameraNews || picture?.cameraSeq !== cameraSeq;
    }

    // Returns true if decoded pictures must wait until the depth grid of the newest picture is decoded. Without this, if grids are decoded
    // more slowly than pictures arrive, no grid would ever be that of the newest picture, and a move could not be drawn from a picture
    // that has just arrived.
    waits(decoded) {
        const newest = decoded.findLast(({ frame }) => !frame.more)?.frame;
        const known = newest?.depth && this.grids.find(({ depth }) => depth === newest.depth);
        if (!known || known.parts || known.fails)
            return false;
        if (this.waitsFrom === null)
            this.lateTimer = setTimeout(() => this.viewport.invalidate(), LATE_MS);
        this.waitsFrom ??= performance.now();
        return performance.now() - this.waitsFrom < LATE_MS;
    }

    // Returns true if the picture is to be shown from the present camera, which is not its own.
    get isWanted() {
        const { session, source, modules } = this, { picture, camera } = session;
        return source !== null && this.isAhead && session.leader === null && !session.lent && !modules.there('cameraController')?.fly
            && hasViewportShape(picture) && isNear(source.camera, camera);
    }

    // Draws the newest picture from the present camera, or shows the picture itself. Called once per animation frame, after new pictures
    // were drawn. Returns true if what is seen has changed.
    draw() {
        const { session } = this, { picture, camera } = session;
        if (!picture)
            return false;
        picture.ownCamera ??= picture.camera;
        const known = this.grids.find(({ depth }) => depth === picture.depth);
        if (!picture.depth || known?.fails)
            this.source = null;
        else if (known?.parts && this.source?.picture !== picture)
            this.source = { picture, camera: picture.ownCamera, parts: known.parts, isLoaded: false };
        try {
            if (!this.isWanted || !this.load())
                return !this.fade() && (this.hide() || this.loadEarly());
            if (this.isShown && this.painted === this.source && same(camera, picture.camera))
                return false;
            this.paint(camera, this.source, 0);
            this.fadeStart = null;
        } catch (error) { // WebGL can fail here, for example in a browser that does not accept a VideoFrame as a texture
            console.warn(`pictures are not warped: ${error.message}`);
            this.giveUp();
            return true;
        }
        picture.camera = camera;
        picture.moved = (x, y) => this.moved(x, y);
        this.updates++;
        return true;
    }

    // Keeps a decoded frame that will be shown warped, which saves drawing it on the viewport's canvas. Returns false if it must be drawn.
    hold(decoded) {
        if (isWhole(decoded.frame))
            this.held?.picture.close();
        else
            this.putHeld();
        this.held = this.isShown && isWhole(decoded.frame) ? decoded : null;
        return this.held !== null;
    }

    // Lets the warped picture give way to the server's picture of the same camera. Returns false if that is done, or not possible.
    fade() {
        const { session: { picture }, painted, isShown, viewport } = this, now = performance.now();
        if (!isShown || painted.parts !== this.loaded || painted.picture === picture || this.isAhead)
            return false;
        this.putHeld();
        Object.assign(picture, { camera: picture.ownCamera, moved: null });
        this.fadeStart ??= now;
        const gone = (now - this.fadeStart) / FADE_MS;
        if (gone >= 1)
            return false;
        this.paint(painted.seenFrom, painted, gone);
        viewport.invalidate();
        return true;
    }

    putHeld() {
        if (this.held)
            this.viewport.put(this.held);
        this.held = null;
    }

    hide() {
        this.putHeld();
        const { picture } = this.session;
        if (picture?.ownCamera)
            Object.assign(picture, { camera: picture.ownCamera, moved: null });
        if (!this.isShown)
            return false;
        this.isShown = false;
        this.fadeStart = null;
        this.canvas.style.display = 'none';
        return true;
    }

    // Loads the picture while a pointer is pressed, so that its first move is drawn sooner. Returns false, because nothing seen changes.
    loadEarly() {
        if (this.source && this.modules.there('cameraController')?.gestures.active)
            this.load();
        return false;
    }

    // Hands the picture and its mesh to WebGL. Returns false if the picture is no longer on the canvas.
    load() {
        const { gl, source, session, viewport, held } = this;
        if (source.isLoaded)
            return true;
        if (source.picture !== session.picture)
            return false;
        gl.bindTexture(gl.TEXTURE_2D, this.texture);
        const pixels = held?.frame.seq === source.picture.seq ? held.picture : viewport.canvas;
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        // uses the visible size, because the coded picture may be a pixel wider and higher than the frame
        source.size = [pixels.displayWidth ?? pixels.width, pixels.displayHeight ?? pixels.height];
        for (const part of source.parts)
            this.loadPart(part);
        source.isLoaded = true;
        return true;
    }

    // Uploads the mesh and the mask of one depth grid to the GPU, unless an earlier picture that shares the grid has uploaded them.
    loadPart(part) {
        const { gl } = this, { grid, mesh } = part;
        if (part.buffers)
            return;
        this.release(this.loaded, this.source.parts);
        this.loaded = this.source.parts;
        part.masks = this.newTexture();
        const { masks, maskSide, columns, rows } = grid;
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, columns * maskSide, rows * maskSide, 0, gl.RED, gl.UNSIGNED_BYTE, masks);
        part.buffers = [[gl.ARRAY_BUFFER, mesh.vertices], [gl.ELEMENT_ARRAY_BUFFER, mesh.indices]].map(([target, data]) => {
            const buffer = gl.createBuffer();
            gl.bindBuffer(target, buffer);
            gl.bufferData(target, data, gl.STATIC_DRAW);
            return buffer;
        });
    }

    release(parts, except) {
        if (parts === except)
            return;
        for (const part of parts ?? []) {
            part.buffers?.forEach((buffer) => this.gl.deleteBuffer(buffer));
            this.gl.deleteTexture(part.masks);
            part.buffers = null;
        }
    }

    // Chooses the size of the drawing: that of the picture, or less if updates are slow.
    fit({ fullWidth, fullHeight }) {
        const now = performance.now(), interval = now - this.last, { canvas } = this;
        this.last = now;
        if (interval < PAUSE_MS)
            this.intervals.push(interval);
        if (this.intervals.length >= SLOW_COUNT) {
            const middle = this.intervals.sort((a, b) => a - b)[SLOW_COUNT >> 1];
            this.intervals = [];
            if (middle > SLOW_MS)
                this.mostPx = Math.max(LEAST_PX, canvas.width * canvas.height / 2);
        }
        canvas.style.aspectRatio = `${fullWidth} / ${fullHeight}`; // exact, because a reduced width and height are rounded
        const scale = Math.min(1, Math.sqrt(this.mostPx / (fullWidth * fullHeight)));
        const [width, height] = [fullWidth, fullHeight].map((px) => Math.round(px * scale));
        if (canvas.width === width && canvas.height === height)
            return;
        Object.assign(canvas, { width, height });
        const { gl, reduced } = this;
        reduced.size = [width, height].map((px) => Math.ceil(px / REDUCED));
        for (const { texture, framebuffer } of reduced) {
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, ...reduced.size, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
            gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, framebuffer);
            gl.framebufferTexture2D(gl.DRAW_FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
        }
        gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    }

    // Draws the picture as the camera sees it. gone: part (0 to 1) of the pixels that are left out, at which the canvas below shows.
    paint(camera, source, gone) {
        const { gl, canvas, mesh } = this, { picture, parts } = source;
        this.fit(picture);
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.useProgram(mesh.program);
        gl.bindTexture(gl.TEXTURE_2D, this.texture);
        gl.activeTexture(gl.TEXTURE1);
        gl.uniform1i(mesh.at('masks'), 1);
        gl.uniform2fv(mesh.at('size'), source.size);
        for (const part of parts)
            this.paintPart(part, source, camera);
        gl.activeTexture(gl.TEXTURE0);
        this.paintUndrawn();
        if (gone > 0)
            this.leaveOut(gone);
        this.isShown = true;
        this.painted = Object.assign(source, { seenFrom: camera });
        canvas.style.display = '';
    }

    // Fills the places that the picture does not show with the greys around them.
    paintUndrawn() {
        const { gl, canvas: { width, height }, reduced, undrawn, around } = this, [drawn, greys] = reduced;
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
        gl.uniform1f(undrawn.at('period'), LATTICE_PX * window.devicePixelRatio * height / this.session.size.height);
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

    paintPart(part, source, camera) {
        const { gl, canvas, mesh } = this, { grid, buffers } = part, { fullWidth, fullHeight } = source.picture;
        const across = canvas.width / fullWidth, up = canvas.height / fullHeight;
        const closest = Math.max(1e-6, grid.base + grid.levels * grid.unit); // largest 1/depth that this depth grid can express, in 1/m
        part.matrix = warpMatrix(grid, source.camera, camera, NEAREST / closest);
        gl.viewport(grid.x * across, (fullHeight - grid.y - grid.height) * up, grid.width * across, grid.height * up);
        gl.uniformMatrix4fv(mesh.at('warp'), false, part.matrix);
        gl.uniform2f(mesh.at('origin'), grid.x, grid.y);
        gl.uniform1f(mesh.at('bit'), grid.cellPx / grid.maskSide);
        gl.bindTexture(gl.TEXTURE_2D, part.masks);
        gl.bindBuffer(gl.ARRAY_BUFFER, buffers[0]);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers[1]);
        gl.vertexAttribPointer(0, FLOATS, gl.FLOAT, false, 0, 0);
        gl.drawElements(gl.TRIANGLES, part.mesh.indices.length, gl.UNSIGNED_INT, 0);
    }

    // Returns where a pixel of the picture appears now, [x, y]; null: nowhere.
    moved(x, y) {
        const part = this.source?.parts.find(({ grid }) => x >= grid.x && x < grid.x + grid.width);
        const depth = part && depthAt(part.grid, x - part.grid.x, y - part.grid.y);
        const at = part?.matrix && depth !== null ? moveBy(part.matrix, part.grid, [x - part.grid.x, y - part.grid.y, depth]) : null;
        return at && [at[0] + part.grid.x, at[1] + part.grid.y];
    }
}
