/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates the vertex and index buffers of a triangle mesh, and describes their memory layout to shaders. */
#include "gpu/mesh.h"

#include <math.h>

#include "base/mem.h"

enum { BIND_POSITION, BIND_NORMAL, BIND_TEXCOORD, BIND_COLOR, BIND_SECOND_TEXCOORD, BIND_INSTANCE };

GLuint mesh_buffer(struct log *log, const char *name, size_t bytes, const void *data, GLbitfield flags)
{
    GLuint buffer = 0;
    gl_clear_errors();
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, (GLsizeiptr)bytes, data, flags);
    if (gl_no_errors())
        return buffer;
    log_err(log, "out of GPU memory: the buffer `%s` of %zu bytes cannot be allocated", name, bytes);
    glDeleteBuffers(1, &buffer);
    return 0;
}

/* Creates a GPU buffer that belongs to the mesh, and fills it with data. */
static GLuint own_buffer(struct gpu_mesh *mesh, struct log *log, const char *name, size_t bytes, const void *data)
{
    GLuint buffer = mesh_buffer(log, name, bytes, data, 0);
    mesh->bytes += buffer ? bytes : 0;
    return buffer;
}

/* Creates a buffer for data that the caller keeps: without a copy if GL can read the data in place, else with a copy. */
static GLuint kept_buffer(struct gpu_mesh *mesh, const struct gl *gl, const char *name, size_t bytes, const void *data)
{
    enum { EXTERNAL_VIRTUAL_MEMORY_BUFFER = 0x9160 }; /* constant of GL_AMD_pinned_memory; the function loader glad does not define it */
    GLuint buffer = 0;
    if (!gl->reads_in_place)
        return own_buffer(mesh, gl->log, name, bytes, data);
    gl_clear_errors();
    glCreateBuffers(1, &buffer);
    glBindBuffer(EXTERNAL_VIRTUAL_MEMORY_BUFFER, buffer);
    glBufferData(EXTERNAL_VIRTUAL_MEMORY_BUFFER, (GLsizeiptr)bytes, data, GL_STATIC_DRAW);
    glBindBuffer(EXTERNAL_VIRTUAL_MEMORY_BUFFER, 0);
    if (gl_no_errors())
        return buffer;
    glDeleteBuffers(1, &buffer);
    return own_buffer(mesh, gl->log, name, bytes, data);
}

static void attribute(GLuint vao, enum mesh_attribute location, GLuint binding, GLint size, GLenum type, GLboolean normalized,
                      GLuint offset)
{
    glEnableVertexArrayAttrib(vao, location);
    glVertexArrayAttribFormat(vao, location, size, type, normalized, offset);
    glVertexArrayAttribBinding(vao, location, binding);
}

static void describe_texcoords(GLuint vao, enum mesh_attribute location, GLuint binding, GLuint buffer, bool is_short)
{
    attribute(vao, location, binding, 2, is_short ? GL_UNSIGNED_SHORT : GL_FLOAT, is_short, 0);
    glVertexArrayVertexBuffer(vao, binding, buffer, 0, is_short ? 4 : 8);
}

static GLuint describe(const struct gpu_mesh *mesh)
{
    GLuint vao = 0;
    glCreateVertexArrays(1, &vao);
    attribute(vao, MESH_POSITION, BIND_POSITION, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayVertexBuffer(vao, BIND_POSITION, mesh->positions, 0, 12);
    attribute(vao, MESH_NORMAL, BIND_NORMAL, 2, GL_SHORT, GL_TRUE, 0);
    glVertexArrayVertexBuffer(vao, BIND_NORMAL, mesh->normals, 0, 4);
    if (mesh->texcoords)
        describe_texcoords(vao, MESH_TEXCOORD, BIND_TEXCOORD, mesh->texcoords, mesh->short_texcoords);
    if (mesh->second_texcoords)
        describe_texcoords(vao, MESH_SECOND_TEXCOORD, BIND_SECOND_TEXCOORD, mesh->second_texcoords, mesh->short_second_texcoords);
    if (mesh->colors) {
        attribute(vao, MESH_COLOR, BIND_COLOR, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0);
        glVertexArrayVertexBuffer(vao, BIND_COLOR, mesh->colors, 0, 4);
    }
    glVertexArrayElementBuffer(vao, mesh->indices);
    return vao;
}

static void describe_instances(GLuint vao)
{
    for (GLuint i = 0; i < MESH_INSTANCE_VECTORS; i++)
        attribute(vao, i < 3 ? MESH_INSTANCE_NORMALS + i : MESH_INSTANCE_PLACES + i - 3, BIND_INSTANCE, 4, GL_FLOAT, GL_FALSE, 16 * i);
    glVertexArrayBindingDivisor(vao, BIND_INSTANCE, 1);
}

/* --- packing -------------------------------------------------------------------------------------------------------------- */

static int16_t to_short(float part)
{
    return (int16_t)lrintf(32767 * part);
}

/* Packs a normal into two 16-bit numbers (octahedral mapping). A zero normal, which has no direction, is packed as "up". */
static void fold(const float n[3], int16_t out[2])
{
    float sum = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]);
    float x = sum > 0 ? n[0] / sum : 0, y = sum > 0 ? n[1] / sum : 0;
    bool below = n[2] < 0;
    out[0] = to_short(below ? copysignf(1 - fabsf(y), x) : x);
    out[1] = to_short(below ? copysignf(1 - fabsf(x), y) : y);
}

static GLuint upload_normals(struct gpu_mesh *mesh, struct log *log, const char *name, size_t count, const float (*normals)[3])
{
    int16_t(*folded)[2] = mem_try_array(count, sizeof(*folded));
    if (!folded) {
        log_err(log, "cannot draw %s: out of memory for %zu surface normals", name, count);
        return 0;
    }
    for (size_t i = 0; i < count; i++)
        fold(normals[i], folded[i]);
    GLuint buffer = own_buffer(mesh, log, name, count * sizeof(*folded), folded);
    mem_free(folded);
    return buffer;
}

/* Uploads texture coordinates. *is_short receives true if they were packed into 16 bits, and false if some are outside 0..1 or
   memory was short. */
static GLuint upload_texcoords(struct gpu_mesh *mesh, struct log *log, const char *name, size_t count, const float (*texcoords)[2],
                               bool *is_short)
{
    const float *at = texcoords[0];
    size_t numbers = 2 * count, i = 0;
    while (i < numbers && at[i] >= 0 && at[i] <= 1)
        i++;
    uint16_t *packed = i == numbers ? mem_try_array(numbers, sizeof(*packed)) : NULL;
    *is_short = packed != NULL;
    if (!packed)
        return own_buffer(mesh, log, name, numbers * sizeof(*at), at);
    for (i = 0; i < numbers; i++)
        packed[i] = (uint16_t)lrintf(65535 * at[i]);
    GLuint buffer = own_buffer(mesh, log, name, numbers * sizeof(*packed), packed);
    mem_free(packed);
    return buffer;
}

/* --- creating and destroying ---------------------------------------------------------------------------------------------- */

bool mesh_init(struct gpu_mesh *mesh, const struct gl *gl, const char *name, const struct mesh_params *params)
{
    size_t vertices = params->vertex_count;
    struct log *log = gl->log;
    *mesh = (struct gpu_mesh){ .vertex_count = vertices, .index_count = params->index_count };
    mesh->positions = kept_buffer(mesh, gl, name, vertices * 12, params->positions_m);
    mesh->normals = upload_normals(mesh, log, name, vertices, params->normals);
    mesh->indices = kept_buffer(mesh, gl, name, params->index_count * 4, params->indices);
    if (params->texcoords)
        mesh->texcoords = upload_texcoords(mesh, log, name, vertices, params->texcoords, &mesh->short_texcoords);
    if (params->second_texcoords)
        mesh->second_texcoords = upload_texcoords(mesh, log, name, vertices, params->second_texcoords, &mesh->short_second_texcoords);
    if (params->colors)
        mesh->colors = kept_buffer(mesh, gl, name, vertices * 4, params->colors);
    if (!mesh->positions || !mesh->normals || !mesh->indices || (params->texcoords && !mesh->texcoords) ||
        (params->second_texcoords && !mesh->second_texcoords) || (params->colors && !mesh->colors)) {
        mesh_finish(mesh);
        return false;
    }
    mesh->vao = describe(mesh);
    mesh->instanced_vao = describe(mesh);
    describe_instances(mesh->instanced_vao);
    return true;
}

void mesh_finish(struct gpu_mesh *mesh)
{
    GLuint buffers[] = { mesh->positions, mesh->normals, mesh->texcoords, mesh->second_texcoords, mesh->colors, mesh->indices };
    glDeleteVertexArrays(2, (GLuint[2]){ mesh->vao, mesh->instanced_vao });
    glDeleteBuffers(sizeof(buffers) / sizeof(buffers[0]), buffers);
    *mesh = (struct gpu_mesh){ 0 };
}

void mesh_bind(const struct gpu_mesh *mesh)
{
    glBindVertexArray(mesh->vao);
}

void mesh_bind_instances(const struct gpu_mesh *mesh, GLuint instances)
{
    glVertexArrayVertexBuffer(mesh->instanced_vao, BIND_INSTANCE, instances, 0, 16 * MESH_INSTANCE_VECTORS);
    glBindVertexArray(mesh->instanced_vao);
}
