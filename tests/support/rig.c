/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For GL tests: creates GL contexts, sets up plants with a renderer, and reads pixels of frames. */
#include "tests/support/rig.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#define XXH_STATIC_LINKING_ONLY /* declares XXH3's hash state completely, so that it can be on the stack */
#include <xxhash.h>

#include "base/mem.h"
#include "render/split_view.h"
#include "tests/support/cielab.h"
#include "tests/support/test.h"

bool rig_init(struct rig *rig, const char *test)
{
    const char *name = getenv("PLANTCAST_GL");
    enum gl_kind kind = GL_EGL_SURFACELESS;
    *rig = (struct rig){ .log = log_create(LOG_INFO) };
    if (name && !gl_kind_parse(name, &kind)) {
        fprintf(stderr, "PLANTCAST_GL=%s is unknown\n", name);
        exit(1);
    }
    rig->gl = gl_create(rig->log, kind, NULL);
    rig->workers = workers_create(0);
    if (rig->gl)
        return true;
    printf("TAP version 13\n1..1\nok 1 - %s # SKIP no %s context on this machine\n", test, gl_kind_name(kind));
    rig_finish(rig);
    return false;
}

void rig_finish(struct rig *rig)
{
    gl_destroy(&rig->gl);
    workers_destroy(&rig->workers);
    log_destroy(&rig->log);
}

int rig_run(struct rig *rig)
{
    if (!rig_init(rig, program_invocation_short_name))
        return 0;
    int failed = tests_run(NULL);
    rig_finish(rig);
    return failed;
}

/* Returns a folder, named after a hash of the scene, in which test programs share results that take long to compute; tests/run
   sets PLANTCAST_SHARED. NULL: results are not shared. The caller frees it. */
static char *shared_folder(const struct scene *scene)
{
    const char *shared = getenv("PLANTCAST_SHARED");
    XXH3_state_t state;
    if (!shared)
        return NULL;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    for (size_t i = 0; i < scene->asset_count; i++) {
        XXH3_64bits_update(&state, &scene->assets[i].file->view.header->checksum, sizeof(uint64_t));
        XXH3_64bits_update(&state, scene->assets[i].placement, sizeof(scene->assets[i].placement));
    }
    char *folder = mem_printf("%s/toy-%016" PRIx64, shared, XXH3_64bits_digest(&state));
    mkdir(folder, 0777);
    return folder;
}

void stand_init(struct stand *stand, struct rig *rig, struct toy *toy)
{
    if (!toy->scene.folder)
        toy->scene.folder = shared_folder(&toy->scene);
    *stand = (struct stand){ .rig = rig, .toy = toy };
    stand->field = field_create(rig->workers, &toy->scene);
    stand->renderer = renderer_create(rig->log, rig->gl, &toy->scene, stand->field);
    stand->snapshot = toy_snapshot(toy);
    if (!stand->renderer)
        abort();
}

void stand_finish(struct stand *stand)
{
    renderer_destroy(&stand->renderer);
    field_destroy(&stand->field);
    snapshot_destroy(&stand->snapshot);
    toy_destroy(&stand->toy);
}

void stand_look(const struct stand *stand, int i, struct view *view)
{
    const struct scene *scene = &stand->toy->scene;
    double away = i % 4 == 3 ? 0.15 : 0.5 + i % 3;
    for (int c = 0; c < 3; c++) {
        double size = scene->bounds_max_m[c] - scene->bounds_min_m[c];
        view->camera.target_m[c] = scene->bounds_min_m[c] + 0.5 * size;
        view->camera.eye_m[c] = view->camera.target_m[c] + away * size * (c == 0 ? cos(i) : c == 1 ? sin(i) : 0.7 - 0.2 * i);
    }
}

struct frame *stand_draw(struct stand *stand, const struct view *view)
{
    struct frame *frame = split_view_draw_now(stand->renderer, view, stand->snapshot);
    if (!frame)
        abort();
    return frame;
}

const uint8_t *frame_pixel(const struct frame *frame, int x, int y)
{
    return frame->bgrx + (size_t)y * (size_t)frame->stride_bytes + (size_t)x * 4;
}

static uint32_t color_hash(uint32_t r, uint32_t g, uint32_t b)
{
    return (r << 16 | g << 8 | b) * 2654435761u >> 16;
}

int map_index_exact(const struct colormap *map, const uint8_t *bgrx)
{
    /* number of entries of a hash table from colour to index in the colour map; linear probing finds the first of several equal
       colours */
    enum { SLOTS = 1024 };
    static const struct colormap *known;
    static int16_t places[SLOTS];
    if (known != map) {
        memset(places, -1, sizeof(places));
        for (int i = 0; i < 256; i++) {
            uint32_t slot = color_hash(map->rgb[i][0], map->rgb[i][1], map->rgb[i][2]) % SLOTS;
            while (places[slot] >= 0 && memcmp(map->rgb[places[slot]], map->rgb[i], 3) != 0)
                slot = (slot + 1) % SLOTS;
            if (places[slot] < 0)
                places[slot] = (int16_t)i;
        }
        known = map;
    }
    uint32_t slot = color_hash(bgrx[2], bgrx[1], bgrx[0]) % SLOTS;
    for (; places[slot] >= 0; slot = (slot + 1) % SLOTS) {
        const uint8_t *rgb = map->rgb[places[slot]];
        if (rgb[0] == bgrx[2] && rgb[1] == bgrx[1] && rgb[2] == bgrx[0])
            break;
    }
    return places[slot];
}

bool is_grey(const uint8_t *bgrx)
{
    return bgrx[0] == bgrx[1] && bgrx[1] == bgrx[2];
}

bool is_color(const uint8_t *bgrx, const uint8_t rgb[3])
{
    return bgrx[2] == rgb[0] && bgrx[1] == rgb[1] && bgrx[0] == rgb[2];
}

int map_colors_off(const struct colormap *map, const uint8_t *bgrx, double place)
{
    int wanted = (int)fmin(fmax(256 * place, 0), 255);
    if ((place > 0.999 && is_color(bgrx, map->above)) || (place < 0.001 && is_color(bgrx, map->below)))
        return 0;
    for (int off = 0; off < 256; off++)
        if ((wanted >= off && is_color(bgrx, map->rgb[wanted - off])) || (wanted + off < 256 && is_color(bgrx, map->rgb[wanted + off])))
            return off;
    return -1;
}

int map_index_nearest(const struct colormap *map, const uint8_t *bgrx, bool deuteranope)
{
    static const struct colormap *known;
    static bool known_deuteranope;
    static double labs[256][3];
    static struct {
        uint32_t color; /* cached colour of a pixel; a further bit marks the cache entry as used */
        int nearest;
    } found[1 << 16];
    double lab[3], least = INFINITY;
    int nearest = -1;
    if (known != map || known_deuteranope != deuteranope)
        memset(found, 0, sizeof(found));
    for (int i = 0; i < 256 && (known != map || known_deuteranope != deuteranope); i++)
        lab_of(map->rgb[i], deuteranope, labs[i]);
    known = map;
    known_deuteranope = deuteranope;
    uint32_t color = 1u << 24 | (uint32_t)bgrx[2] << 16 | (uint32_t)bgrx[1] << 8 | bgrx[0], slot = color * 2654435761u >> 16;
    if (found[slot].color == color)
        return found[slot].nearest;
    lab_of((const uint8_t[3]){ bgrx[2], bgrx[1], bgrx[0] }, deuteranope, lab);
    for (int i = 0; i < 256; i++) {
        double distance = lab_distance(lab, labs[i]);
        if (distance < least) {
            least = distance;
            nearest = i;
        }
    }
    found[slot].color = color;
    found[slot].nearest = nearest;
    return nearest;
}
