/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the GPU holds and drafts do not read: the ground's openness and the surroundings. */
#include "base/mem.h"
#include "render/plate/plate_impl.h"

static bool complain(const struct plates *plates, const char *what)
{
    log_err(plates->gpu_scene->gl->log, "still pictures: %s cannot be read back: out of memory", what);
    return false;
}

bool plate_read_light(struct plates *plates, const struct light_set *set)
{
    struct plate_light *light = &plates->light;
    GLint side = 0;
    if (light->id == set->id)
        return true;
    glGetTextureLevelParameteriv(set->ground, 0, GL_TEXTURE_WIDTH, &side);
    size_t texels = (size_t)side * (size_t)side;
    uint8_t(*both)[2] = mem_try_array(texels, sizeof(*both));
    mem_free(light->open);
    light->id = 0;
    light->open = mem_try_array(texels, 1);
    light->open_px = side;
    bool good = both && light->open;
    if (good) {
        glGetTextureImage(set->ground, 0, GL_RG, GL_UNSIGNED_BYTE, (GLsizei)(texels * 2), both);
        for (size_t i = 0; i < texels; i++)
            light->open[i] = both[i][1];
        light->id = set->id;
    }
    mem_free(both);
    return good || complain(plates, "the ground");
}

bool plate_read_surroundings(struct plates *plates, int number)
{
    struct plate_surroundings *surroundings = &plates->surroundings;
    const struct environment_slot *slot = &plates->environments->slots[number];
    size_t texels = ENVIRONMENT_LAYERS * ENVIRONMENT_PX * ENVIRONMENT_PX;
    if (!slot->mirrored)
        slot = &plates->environments->slots[0];
    if (surroundings->mirrored == slot->mirrored)
        return true;
    if (!surroundings->texels) {
        surroundings->texels = mem_try_array(texels, sizeof(*surroundings->texels));
        if (!surroundings->texels)
            return complain(plates, "the surroundings");
        glGetTextureImage(plates->environments->brdf, 0, GL_RG, GL_FLOAT, (GLsizei)sizeof(surroundings->brdf), surroundings->brdf);
    }
    glGetTextureImage(slot->mirrored, 0, GL_RGBA, GL_FLOAT, (GLsizei)(texels * sizeof(*surroundings->texels)), surroundings->texels);
    glGetNamedBufferSubData(slot->irradiance, 0, (GLsizeiptr)sizeof(surroundings->irradiance), surroundings->irradiance);
    surroundings->mirrored = slot->mirrored;
    return true;
}
