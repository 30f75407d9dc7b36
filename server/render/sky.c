/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One triangle at the far plane. */
#include "render/sky.h"

#include "gpu/program.h"

bool sky_init(struct sky_pass *sky, struct log *log)
{
    sky->programs[TIER_MOVING] = program_create(log, program_params(.vertex = "screen.vert", .fragment = "sky.frag"));
    sky->programs[TIER_STILL] = program_create(log, program_params(.vertex = "screen.vert", .fragment = "sky.frag", .defines = "#define STILL\n"));
    glCreateVertexArrays(1, &sky->vao);
    return sky->programs[TIER_MOVING] && sky->programs[TIER_STILL];
}

void sky_finish(struct sky_pass *sky)
{
    program_destroy(&sky->programs[TIER_MOVING]);
    program_destroy(&sky->programs[TIER_STILL]);
    glDeleteVertexArrays(1, &sky->vao);
}

void sky_draw(const struct sky_pass *sky, const struct picture *picture)
{
    gl_pass_enter("sky");
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glUseProgram(sky->programs[picture->view->tier]);
    glBindTextureUnit(1, picture->light->ground);
    glBindTextureUnit(2, picture->light->sun_map);
    glBindVertexArray(sky->vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthMask(GL_TRUE);
    gl_pass_leave(picture->stage->gl, "sky");
}
