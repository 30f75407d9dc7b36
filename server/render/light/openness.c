/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the openness file. To detect an outdated file, it stores a hash of everything that openness depends on:
   assets, their placement and files, GL driver and program version. */
#include "render/light/openness.h"

#include <string.h>
#define XXH_STATIC_LINKING_ONLY /* this macro exposes the definition of XXH3's hash state, so that the state can be on the stack */
#include <xxhash.h>

#include "base/mem.h"
#include "base/text/embedded.h"
#include "base/thread.h"
#include "gpu/mesh.h"
#include "version.h"

static const char magic[] = "PLCOPEN1";
enum { GROUND_TEXELS = OPENNESS_GROUND_PX * OPENNESS_GROUND_PX };

static void add_text(XXH3_state_t *state, const char *text)
{
    XXH3_64bits_update(state, text, strlen(text) + 1);
}

static uint64_t key_of(const struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    const struct gl *gl = gpu_scene->gl;
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    add_text(&state, PLANTCAST_VERSION);
    add_text(&state, embedded_find("bake.comp"));
    add_text(&state, gl->renderer);
    add_text(&state, gl->version);
    XXH3_64bits_update(&state, gpu_scene->up, sizeof(gpu_scene->up));
    for (size_t i = 0; i < scene->asset_count; i++) {
        const struct scene_asset *asset = &scene->assets[i];
        const struct asset_header *header = asset->file->view.header;
        int start = asset->plant->start;
        XXH3_64bits_update(&state, &header->key, sizeof(header->key));
        XXH3_64bits_update(&state, &header->checksum, sizeof(header->checksum));
        XXH3_64bits_update(&state, asset->placement, sizeof(asset->placement));
        XXH3_64bits_update(&state, &start, sizeof(start));
    }
    return XXH3_64bits_digest(&state);
}

static size_t vertices_of(const struct gpu_scene *gpu_scene)
{
    size_t count = 0;
    for (size_t i = 0; i < gpu_scene->scene->asset_count; i++)
        count += gpu_scene->of_asset[i]->mesh.vertex_count;
    return count;
}

static char *path_of(const struct gpu_scene *gpu_scene)
{
    const char *folder = gpu_scene->scene->folder;
    return folder ? mem_printf("%s/openness", folder) : NULL;
}

/* --- reading --------------------------------------------------------------------------------------------------------------------- */

bool openness_open(struct openness *openness, const struct gpu_scene *gpu_scene)
{
    char *path = path_of(gpu_scene);
    *openness = (struct openness){ 0 };
    bool good = path && cache_file_open_if_good(&openness->file, gpu_scene->gl->log, path, magic, key_of(gpu_scene));
    if (good && openness->file.count != GROUND_TEXELS + vertices_of(gpu_scene)) {
        log_warn(gpu_scene->gl->log,
                 "cache file %s has the ambient light of %zu points, but the plant needs %zu; the light is computed again", path,
                 openness->file.count, GROUND_TEXELS + vertices_of(gpu_scene));
        good = false;
    }
    mem_free(path);
    if (!good)
        openness_close(openness);
    return good;
}

void openness_close(struct openness *openness)
{
    cache_file_close(&openness->file);
}

bool openness_upload(struct openness *openness, const struct gpu_scene *gpu_scene, const struct pool_slice *slice)
{
    const uint8_t *from = (const uint8_t *)openness->file.bytes + GROUND_TEXELS + openness->vertex;
    uint8_t(*texels)[4] = mem_array(slice->count, sizeof(*texels));
    for (size_t i = 0; i < slice->count; i++)
        texels[i][2] = from[i];
    GLuint buffer = mesh_buffer(gpu_scene->gl->log, "openness", slice->count * sizeof(*texels), texels, 0);
    if (buffer)
        glCopyNamedBufferSubData(buffer, slice->page->buffer, 0, (GLintptr)pool_offset(slice),
                                 (GLsizeiptr)(slice->count * sizeof(*texels)));
    glDeleteBuffers(1, &buffer);
    mem_free(texels);
    openness->vertex += slice->count;
    return buffer != 0;
}

void openness_upload_ground(const struct openness *openness, GLuint ground)
{
    uint8_t(*texels)[2] = mem_array(GROUND_TEXELS, sizeof(*texels));
    for (size_t i = 0; i < GROUND_TEXELS; i++)
        texels[i][1] = (uint8_t)openness->file.bytes[i];
    glTextureSubImage2D(ground, 0, 0, 0, OPENNESS_GROUND_PX, OPENNESS_GROUND_PX, GL_RG, GL_UNSIGNED_BYTE, texels);
    mem_free(texels);
}

/* --- writing --------------------------------------------------------------------------------------------------------------------- */

struct openness_writer {
    struct thread thread;
    struct log *log;
    char *path;
    uint64_t key;
    size_t count;
    uint8_t *bytes;
};

static void *openness_main(void *arg)
{
    const struct openness_writer *writer = arg;
    const struct atomic_file_part part = { writer->bytes, writer->count };
    int status = cache_file_write_parts(writer->path, magic, writer->key, &part, 1);
    if (status != 0)
        log_info(writer->log, "cache file %s cannot be written (%s); the ambient light will be computed again at each start", writer->path,
                 strerror(-status));
    return NULL;
}

static void read_ground(uint8_t *out, GLuint ground)
{
    uint8_t(*texels)[2] = mem_array(GROUND_TEXELS, sizeof(*texels));
    glGetTextureImage(ground, 0, GL_RG, GL_UNSIGNED_BYTE, (GLsizei)(GROUND_TEXELS * sizeof(*texels)), texels);
    for (size_t i = 0; i < GROUND_TEXELS; i++)
        out[i] = texels[i][1];
    mem_free(texels);
}

static void read_slice(uint8_t *out, const struct pool_slice *slice)
{
    uint8_t(*texels)[4] = mem_array(slice->count, sizeof(*texels));
    glGetNamedBufferSubData(slice->page->buffer, (GLintptr)pool_offset(slice), (GLsizeiptr)(slice->count * sizeof(*texels)), texels);
    for (size_t i = 0; i < slice->count; i++)
        out[i] = texels[i][2];
    mem_free(texels);
}

struct openness_writer *openness_write(const struct gpu_scene *gpu_scene, struct pool_slice *const *slices, GLuint ground)
{
    char *path = path_of(gpu_scene);
    if (!path)
        return NULL;
    struct openness_writer *writer = mem_new(sizeof(*writer));
    *writer = (struct openness_writer){ .log = gpu_scene->gl->log, .path = path, .key = key_of(gpu_scene) };
    writer->count = GROUND_TEXELS + vertices_of(gpu_scene);
    writer->bytes = mem_array(writer->count, 1);
    read_ground(writer->bytes, ground);
    size_t at = GROUND_TEXELS;
    for (size_t i = 0; i < gpu_scene->scene->asset_count; at += slices[i]->count, i++)
        read_slice(writer->bytes + at, slices[i]);
    thread_init(&writer->thread);
    if (!thread_start(&writer->thread, writer->log, "openness", openness_main, writer))
        openness_writer_finish(&writer);
    return writer;
}

void openness_writer_finish(struct openness_writer **pointer)
{
    struct openness_writer *writer = *pointer;
    if (!writer)
        return;
    thread_stop(&writer->thread);
    thread_finish(&writer->thread);
    mem_free(writer->bytes);
    mem_free(writer->path);
    mem_free(writer);
    *pointer = NULL;
}
