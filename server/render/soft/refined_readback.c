/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the GPU holds and previews do not read: the ground's openness and the surroundings. */
#include "base/mem.h"
#include "render/soft/refined_impl.h"

static bool complain(const struct refiner *refiner, const char *what)
{
    log_err(refiner->gpu_scene->gl->log, "still pictures: %s cannot be read back: out of memory", what);
    return false;
}

bool refined_read_light(struct refiner *refiner, const struct light_set *set)
{
    struct refined_light *light = &refiner->light;
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
    return good || complain(refiner, "the ground");
}

bool refined_read_surroundings(struct refiner *refiner, int number)
{
    struct refined_surroundings *surroundings = &refiner->surroundings;
    const struct environment_slot *slot = &refiner->environments->slots[number];
    size_t texels = ENVIRONMENT_LAYERS * ENVIRONMENT_PX * ENVIRONMENT_PX;
    if (!slot->mirrored)
        slot = &refiner->environments->slots[0];
    if (surroundings->mirrored == slot->mirrored)
        return true;
    if (!surroundings->texels) {
        surroundings->texels = mem_try_array(texels, sizeof(*surroundings->texels));
        if (!surroundings->texels)
            return complain(refiner, "the surroundings");
        glGetTextureImage(refiner->environments->brdf, 0, GL_RG, GL_FLOAT, (GLsizei)sizeof(surroundings->brdf), surroundings->brdf);
    }
    glGetTextureImage(slot->mirrored, 0, GL_RGBA, GL_FLOAT, (GLsizei)(texels * sizeof(*surroundings->texels)), surroundings->texels);
    glGetNamedBufferSubData(slot->irradiance, 0, (GLsizeiptr)sizeof(surroundings->irradiance), surroundings->irradiance);
    surroundings->mirrored = slot->mirrored;
    return true;
}
