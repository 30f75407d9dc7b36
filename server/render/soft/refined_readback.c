/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the GPU holds and previews do not read: the ground's openness. */
#include "base/mem.h"
#include "render/soft/refined_impl.h"

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
    if (!good)
        log_err(refiner->gpu_scene->gl->log, "refined frames: the ground cannot be read back: out of memory");
    return good;
}
