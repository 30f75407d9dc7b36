/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predicts which coarser levels of detail will need too many triangles, so that these need not be split completely. */
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/subdivision/subdivide_impl.h"

#define SAMPLE_OF 8 /* one block of triangles in every SAMPLE_OF is sampled; a power of 2 */
#define BLOCK 8     /* triangles per block */
#define GRAIN 4096  /* number of triangles that a thread processes per unit of work, which takes a few tenths of a millisecond */
/* a level is given up if its estimated triangle count exceeds its limit by this many standard deviations */
#define SURE 1.5

/* Returns the number of triangles that will replace a triangle once its interpolation errors are small enough. Splitting an
 * edge leaves a quarter of its error where the field bends evenly, and more at a peak, so an edge may need several splits. */
static size_t tris_needed(const struct subdiv *subdiv, const struct subdiv_tri *tri)
{
    size_t needed = 1;
    for (int i = 0; i < 3; i++)
        for (double left = (double)subdiv->mesh.cuts[tri->e[i]].error; left > SUBDIV_AIM; left /= 4)
            needed++;
    return needed;
}

/* Returns a lower bound of the whole level's final triangle count, estimated from the sampled blocks. The variance between
 * these blocks gives the uncertainty. */
static double least_needed_by_sample(const struct subdiv *subdiv)
{
    const struct subdiv_mesh *mesh = &subdiv->mesh;
    const double blocks = (double)subdiv->sample_blocks;
    double sum = 0, squares = 0, *needed = mem_array(subdiv->sample_blocks, sizeof(*needed));
    for (size_t t = 0; t < mesh->tri_count; t++)
        needed[mesh->tris[t].origin / BLOCK] += (double)tris_needed(subdiv, &mesh->tris[t]);
    for (size_t b = 0; b < subdiv->sample_blocks; b++) {
        sum += needed[b];
        squares += needed[b] * needed[b];
    }
    mem_free(needed);
    double mean = sum / blocks, deviation = sqrt(fmax(0, squares / blocks - mean * mean) / blocks);
    return subdiv->sample_of * blocks * (mean - SURE * deviation);
}

struct sum {
    const struct subdiv *subdiv;
    atomic_size_t needed;
};

static void add_needed(void *arg, size_t begin, size_t end)
{
    struct sum *sum = arg;
    size_t needed = 0;
    for (size_t t = begin; t < end; t++)
        needed += tris_needed(sum->subdiv, &sum->subdiv->mesh.tris[t]);
    sum->needed += needed;
}

bool subdiv_will_exceed_bound(const struct subdiv *subdiv)
{
    struct sum sum = { .subdiv = subdiv };
    if (subdiv->sample_blocks)
        return least_needed_by_sample(subdiv) > (double)subdiv->most_tris;
    if (subdiv->finest)
        return false;
    workers_for(subdiv->in->workers, subdiv->mesh.tri_count, GRAIN, add_needed, &sum);
    return sum.needed > subdiv->most_tris;
}

size_t subdiv_take_sample(struct level *sample, const struct level *level)
{
    *sample = (struct level){ 0 };
    sample->indices = mem_array(level->index_count, sizeof(*sample->indices));
    sample->primitives = mem_array(level->primitive_count, sizeof(*sample->primitives));
    for (uint32_t p = 0; p < level->primitive_count; p++) {
        struct asset_primitive *to = &sample->primitives[sample->primitive_count++];
        *to = level->primitives[p];
        to->first_index = sample->index_count;
        for (uint32_t i = 0; i + 3 * BLOCK <= level->primitives[p].index_count; i += 3 * BLOCK) {
            uint32_t at = level->primitives[p].first_index + i;
            /* choose the sampled blocks by a hash: every eighth block could be the same part of a repeated shape */
            if (at / (3 * BLOCK) * 0x9e3779b9u >> 16 & (SAMPLE_OF - 1))
                continue;
            memcpy(sample->indices + sample->index_count, level->indices + at, 3 * BLOCK * sizeof(*sample->indices));
            sample->index_count += 3 * BLOCK;
        }
        to->index_count = sample->index_count - to->first_index;
    }
    return sample->index_count / (3 * BLOCK);
}
