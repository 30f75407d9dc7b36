/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertex and index buffers, and how shaders see them. */
#include "gpu/mesh.h"

#include "gpu/gl.h"

enum { BIND_POSITION, BIND_NORMAL, BIND_TEXCOORD, BIND_COLOR, BIND_LIGHT, BIND_SCALAR, BIND_SECOND_TEXCOORD };

GLuint mesh_buffer(struct log *log, const char *name, size_t bytes, const void *data, GLbitfield flags)
{
    GLuint buffer = 0;
    gl_forget_errors();
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, (GLsizeiptr)bytes, data, flags);
    if (glGetError() == GL_NO_ERROR)
        return buffer;
    log_err(log, "%s: the GPU has no room for %zu bytes", name, bytes);
    glDeleteBuffers(1, &buffer);
    return 0;
}

static void attribute(GLuint vao, enum mesh_attribute location, GLuint binding, GLint size, GLenum type, GLboolean normalized,
                      GLuint offset)
{
    glEnableVertexArrayAttrib(vao, location);
    glVertexArrayAttribFormat(vao, location, size, type, normalized, offset);
    glVertexArrayAttribBinding(vao, location, binding);
}

static void describe(const struct mesh *mesh)
{
    attribute(mesh->vao, MESH_POSITION, BIND_POSITION, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayVertexBuffer(mesh->vao, BIND_POSITION, mesh->positions, 0, 12);
    attribute(mesh->vao, MESH_NORMAL, BIND_NORMAL, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayVertexBuffer(mesh->vao, BIND_NORMAL, mesh->normals, 0, 12);
    if (mesh->texcoords) {
        attribute(mesh->vao, MESH_TEXCOORD, BIND_TEXCOORD, 2, GL_FLOAT, GL_FALSE, 0);
        glVertexArrayVertexBuffer(mesh->vao, BIND_TEXCOORD, mesh->texcoords, 0, 8);
    }
    if (mesh->second_texcoords) {
        attribute(mesh->vao, MESH_SECOND_TEXCOORD, BIND_SECOND_TEXCOORD, 2, GL_FLOAT, GL_FALSE, 0);
        glVertexArrayVertexBuffer(mesh->vao, BIND_SECOND_TEXCOORD, mesh->second_texcoords, 0, 8);
    }
    if (mesh->colors) {
        attribute(mesh->vao, MESH_COLOR, BIND_COLOR, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0);
        glVertexArrayVertexBuffer(mesh->vao, BIND_COLOR, mesh->colors, 0, 4);
    }
    glVertexArrayAttribFormat(mesh->vao, MESH_LIGHT, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0);
    glVertexArrayAttribBinding(mesh->vao, MESH_LIGHT, BIND_LIGHT);
    glVertexArrayAttribFormat(mesh->vao, MESH_SCALAR, 1, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(mesh->vao, MESH_SCALAR, BIND_SCALAR);
    glVertexArrayAttribFormat(mesh->vao, MESH_FLAGS, 3, GL_UNSIGNED_BYTE, GL_TRUE, 4);
    glVertexArrayAttribBinding(mesh->vao, MESH_FLAGS, BIND_SCALAR);
    glVertexArrayElementBuffer(mesh->vao, mesh->indices);
}

bool mesh_init(struct mesh *mesh, struct log *log, const char *name, const struct mesh_params *params)
{
    size_t vertices = params->vertex_count;
    *mesh = (struct mesh){ .vertex_count = vertices, .index_count = params->index_count };
    mesh->positions = mesh_buffer(log, name, vertices * 12, params->positions_m, 0);
    mesh->normals = mesh_buffer(log, name, vertices * 12, params->normals, 0);
    mesh->indices = mesh_buffer(log, name, params->index_count * 4, params->indices, 0);
    if (params->texcoords)
        mesh->texcoords = mesh_buffer(log, name, vertices * 8, params->texcoords, 0);
    if (params->second_texcoords)
        mesh->second_texcoords = mesh_buffer(log, name, vertices * 8, params->second_texcoords, 0);
    if (params->colors)
        mesh->colors = mesh_buffer(log, name, vertices * 4, params->colors, 0);
    if (!mesh->positions || !mesh->normals || !mesh->indices || (params->texcoords && !mesh->texcoords) ||
        (params->second_texcoords && !mesh->second_texcoords) || (params->colors && !mesh->colors)) {
        mesh_finish(mesh);
        return false;
    }
    glCreateVertexArrays(1, &mesh->vao);
    describe(mesh);
    return true;
}

void mesh_finish(struct mesh *mesh)
{
    GLuint buffers[] = { mesh->positions, mesh->normals, mesh->texcoords, mesh->second_texcoords, mesh->colors, mesh->indices };
    glDeleteVertexArrays(1, &mesh->vao);
    glDeleteBuffers(sizeof(buffers) / sizeof(buffers[0]), buffers);
    *mesh = (struct mesh){ 0 };
}

static void bind_optional(GLuint vao, enum mesh_attribute location, GLuint binding, GLuint buffer, GLsizei stride)
{
    if (buffer) {
        glVertexArrayVertexBuffer(vao, binding, buffer, 0, stride);
        glEnableVertexArrayAttrib(vao, location);
    } else {
        glDisableVertexArrayAttrib(vao, location);
    }
}

void mesh_bind(const struct mesh *mesh, GLuint light, GLuint scalars)
{
    bind_optional(mesh->vao, MESH_LIGHT, BIND_LIGHT, light, 4);
    bind_optional(mesh->vao, MESH_SCALAR, BIND_SCALAR, scalars, 8);
    bind_optional(mesh->vao, MESH_FLAGS, BIND_SCALAR, scalars, 8);
    glBindVertexArray(mesh->vao);
}
