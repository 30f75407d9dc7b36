/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shadow lookups of the software renderer: the bounds of shadow map tiles decide most points without reading texels. The
   results must be bit-identical to lookups that read all texels. */
#include "render/soft/lookups.h"

#include "tests/support/test.h"

enum { SIDE_PX = 100, TILES = (SIDE_PX + SUN_TILE_STEP_PX - 1) / SUN_TILE_STEP_PX, ROUNDS = 20000, AREA_PX = 20 };

struct lookup_counts {
    /* numbers of points: told: decided by the bounds of a tile; open: for which texels had to be read; half: of those, partly
       lit */
    int told, open, half;
};

/* Returns the depth at (x, y) of a random shadow map, which has flat areas, slopes and noise. */
static uint16_t depth_at(const uint16_t areas[], int x, int y)
{
    uint16_t area = areas[y / AREA_PX * (SIDE_PX / AREA_PX) + x / AREA_PX];
    if (area % 3 == 0)
        return area;
    return (uint16_t)(area % 3 == 1 ? area / 2 + 50 * x + 70 * y : rand() % (UINT16_MAX + 1));
}

static struct soft_light light_create(void)
{
    struct soft_light light = { .sun_map_px = SIDE_PX, .sun_tiles = TILES };
    uint16_t areas[SIDE_PX / AREA_PX * SIDE_PX / AREA_PX], depths[SIDE_PX][SIDE_PX];
    light.sun_map = mem_array(soft_sun_map_bytes(&light), 1);
    light.sun_bounds = mem_array(soft_sun_bounds_bytes(&light), 1);
    for (size_t i = 0; i < sizeof(areas) / sizeof(areas[0]); i++)
        areas[i] = (uint16_t)(rand() % (UINT16_MAX + 1));
    for (int i = 0; i < SIDE_PX * SIDE_PX; i++)
        depths[i / SIDE_PX][i % SIDE_PX] = depth_at(areas, i % SIDE_PX, i / SIDE_PX);
    for (int tile = 0; tile < TILES * TILES; tile++) {
        uint16_t *texels = light.sun_map + (ptrdiff_t)tile * SUN_TILE_TEXELS;
        for (int i = 0; i < SUN_TILE_TEXELS; i++) {
            int x = tile % TILES * SUN_TILE_STEP_PX + i % SUN_TILE_PX, y = tile / TILES * SUN_TILE_STEP_PX + i / SUN_TILE_PX;
            texels[i] = depths[y < SIDE_PX ? y : SIDE_PX - 1][x < SIDE_PX ? x : SIDE_PX - 1];
        }
        light.sun_bounds[tile] = soft_sun_bounds(texels);
    }
    return light;
}

static float random_part(void)
{
    return (float)rand() / (float)RAND_MAX;
}

static int whole_within_map(float part)
{
    float px = part * SIDE_PX - 0.5f;
    return px < 0 ? 0 : px > SIDE_PX - 1 ? SIDE_PX - 1 : (int)px;
}

/* Makes random points to look up, some of them slightly outside the map. Their depths are random, or close to that of a texel
   nearby. */
static void places_at_random(const struct soft_light *light, lanes at[3])
{
    for (int i = 0; i < LANES; i++) {
        float s = random_part() * 1.1f - 0.05f, t = random_part() * 1.1f - 0.05f;
        int tile = whole_within_map(t) / SUN_TILE_STEP_PX * TILES + whole_within_map(s) / SUN_TILE_STEP_PX;
        float texel = light->sun_map[tile * SUN_TILE_TEXELS + rand() % SUN_TILE_TEXELS];
        at[0][i] = s;
        at[1][i] = t;
        at[2][i] = rand() % 2 ? random_part() * 1.1f - 0.05f : (texel + 0.5f * (float)(rand() % 5 - 2)) / 65535.0f;
    }
}

static void compare(const struct soft_light *light, const lanes at[3], lanes_int wanted, struct lookup_counts *counts)
{
    struct sun_aim aim;
    sun_aim(light, at, wanted, &aim);
    sun_prefetch_bounds(light, &aim);
    sun_bound(light, &aim);
    sun_prefetch(light, &aim);
    lanes seen = sun_look(light, &aim), all = sun_tap(light, at[0], at[1], at[2]);
    for (int i = 0; i < LANES; i++) {
        if (!wanted[i])
            continue;
        float got = seen[i], want = all[i];
        assert_memory_equal(&got, &want, sizeof(got));
        counts->told += !aim.open[i];
        counts->open += aim.open[i] != 0;
        counts->half += want > 0 && want < 1;
    }
}

TEST(test_bounds_tell_what_texels_tell)
{
    struct lookup_counts counts = { 0 };
    srand((unsigned)sweep_seed());
    struct soft_light light = light_create();
    for (int round = 0; round < ROUNDS; round++) {
        lanes at[3];
        lanes_int wanted;
        places_at_random(&light, at);
        for (int i = 0; i < LANES; i++)
            wanted[i] = rand() % 4 ? -1 : 0;
        compare(&light, at, wanted, &counts);
    }
    assert_true(counts.told > ROUNDS && counts.open > ROUNDS && counts.half > ROUNDS / 10);
    mem_free(light.sun_map);
    mem_free(light.sun_bounds);
}
