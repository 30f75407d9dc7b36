/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/surface_case.h"

#include "tests/support/test.h"

struct log *the_log;
struct workers *workers;
struct cad_random chance;

double between(double low, double high)
{
    return low + (high - low) * cad_random(&chance);
}

static void release_surface(void *resource)
{
    struct surface *surface = resource;
    surface_destroy(&surface);
}

void skip_if_watched(void)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    print_message("# too slow under a sanitizer\n");
    skip();
#endif
}

struct surface *surface_of(const struct cad *cad)
{
    struct surface *surface = surface_create(the_log, workers, (const float(*)[3])cad->positions, cad->vertex_count, cad->triangles,
                                             cad->triangle_count, &(struct surface_params){ 0 });
    assert_non_null(surface);
    owned_add(release_surface, surface);
    return surface;
}

double influence_value(const struct influence *influence, const double *readings, size_t vertex)
{
    double sum = 0;
    for (size_t i = 0; i < influence->count; i++)
        sum += readings[i] * (double)influence->shares[i * influence->vertex_count + vertex];
    return sum;
}

void add_triangle_apart(struct cad *cad)
{
    float positions[3][3] = { { 5, 0, 0 }, { 6, 0, 0 }, { 5, 1, 0 } };
    const struct cad triangle = { positions, (uint32_t[]){ 0, 1, 2 }, .vertex_count = 3, .triangle_count = 1 };
    cad_append(cad, &triangle, (double[3]){ 0 });
}

int surface_case_set_up(void **state)
{
    (void)state;
    cad_random_start(&chance);
    the_log = log_create(LOG_ERROR);
    workers = workers_create(0);
    return 0;
}

int surface_case_tear_down(void **state)
{
    (void)state;
    workers_destroy(&workers);
    log_destroy(&the_log);
    return 0;
}
