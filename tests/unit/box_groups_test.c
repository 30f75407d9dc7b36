/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grouping of boxes that overlap, directly or through others: compared with testing each pair of boxes. */
#include "preprocess/levels/box_groups.h"

#include "tests/support/test.h"
#include <time.h>

#include "surface/mesh/trimesh.h"
#include "tests/support/cad.h"

static double cpu_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Makes random boxes with sides up to `size`; every tenth side is up to five times longer. flat: axis along which all boxes
   have the thickness 0, in one plane; 3: none. */
static void fill(struct part_box *boxes, size_t count, int flat, double size, uint64_t seed)
{
    struct cad_random random = { .state = seed };
    for (uint32_t i = 0; i < count; i++) {
        boxes[i].part = i;
        for (int axis = 0; axis < 3; axis++) {
            double side = size * cad_random(&random) * (cad_random(&random) < 0.1 ? 5 : 1), low = axis == flat ? 0 : cad_random(&random);
            boxes[i].low_m[axis] = (float)low;
            boxes[i].high_m[axis] = (float)(low + (axis == flat ? 0 : side));
        }
    }
}

static uint32_t *fresh(size_t count)
{
    uint32_t *parent = mem_array(count, sizeof(*parent));
    for (uint32_t i = 0; i < count; i++)
        parent[i] = i;
    return parent;
}

static bool meet(const struct part_box *a, const struct part_box *b)
{
    bool apart = false;
    for (int axis = 0; axis < 3; axis++)
        apart |= a->high_m[axis] < b->low_m[axis] || b->high_m[axis] < a->low_m[axis];
    return !apart;
}

TEST(groups_are_those_of_all_pairs)
{
    for (uint64_t seed = 1; seed <= 40; seed++) {
        enum { COUNT = 400 };
        struct part_box boxes[COUNT];
        size_t groups = 0;
        fill(boxes, COUNT, (int)(seed % 4), 0.002 * (double)seed, seed);
        uint32_t *found = fresh(COUNT), *wanted = fresh(COUNT);
        for (uint32_t i = 0; i < COUNT; i++)
            for (uint32_t j = i + 1; j < COUNT; j++)
                if (meet(&boxes[i], &boxes[j]))
                    trimesh_join(wanted, i, j);
        box_groups_join(boxes, COUNT, found);
        for (uint32_t i = 0; i < COUNT; i++)
            for (uint32_t j = i + 1; j < COUNT; j++)
                assert_int_equal(trimesh_root(found, i) == trimesh_root(found, j), trimesh_root(wanted, i) == trimesh_root(wanted, j));
        for (uint32_t i = 0; i < COUNT; i++)
            groups += trimesh_root(found, i) == i;
        assert_true(groups >= 1);
        mem_free(found);
        mem_free(wanted);
    }
}

/* 83,750 boxes must be grouped quickly, whichever axis their plane is perpendicular to: comparing each pair would take 3,500
   million comparisons. */
TEST(a_plate_across_any_axis_takes_no_longer)
{
    enum { COUNT = 83750 };
    struct part_box *boxes = test_memory(mem_array(COUNT, sizeof(*boxes)));
    for (int flat = 0; flat < 4; flat++)
        for (int large = 0; large < 3; large++) {
            fill(boxes, COUNT, flat, (const double[]){ 0.002, 0.02, 0.1 }[large], 7);
            uint32_t *parent = fresh(COUNT);
            double start_s = cpu_s();
            box_groups_join(boxes, COUNT, parent);
            double took_s = cpu_s() - start_s;
            print_message("# flat %d, size %d: %.3f s\n", flat, large, took_s);
            assert_true(took_s < 1.5);
            mem_free(parent);
        }
}
