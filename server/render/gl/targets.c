/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cache of free render targets (framebuffers): a fixed array, most recently used first. */
#include "render/gl/targets.h"

#include <string.h>

bool targets_take(struct targets *targets, struct log *log, int width_px, int height_px, int samples, struct target *out)
{
    int last = TARGETS - 1, found = last;
    for (int i = 0; i < TARGETS; i++) {
        const struct target *target = &targets->at[i];
        if (target->width_px == width_px && target->height_px == height_px && target->samples == samples)
            found = i;
    }
    struct target target = targets->at[found];
    bool known = target.width_px == width_px && target.height_px == height_px && target.samples == samples;
    if (!known && target.width_px)
        target_finish(&target);
    memmove(&targets->at[found], &targets->at[found + 1], (size_t)(last - found) * sizeof(target));
    targets->at[last] = (struct target){ 0 };
    if (!known && !target_init(&target, log, width_px, height_px, samples))
        return false;
    *out = target;
    return true;
}

size_t targets_bytes(const struct targets *targets)
{
    size_t bytes = 0;
    for (int i = 0; i < TARGETS; i++)
        bytes += target_bytes(&targets->at[i]);
    return bytes;
}

/* Frees the least recently used render targets until the rest fits the memory limit; the most recently used one always stays. */
static void keep_bound(struct targets *targets)
{
    for (int i = TARGETS - 1; i > 0 && targets->bound_bytes && targets_bytes(targets) > targets->bound_bytes; i--)
        if (targets->at[i].width_px)
            target_finish(&targets->at[i]);
}

void targets_bound(struct targets *targets, size_t bytes)
{
    targets->bound_bytes = bytes;
    keep_bound(targets);
}

void targets_give(struct targets *targets, const struct target *target)
{
    int last = TARGETS - 1;
    if (targets->at[last].width_px)
        target_finish(&targets->at[last]);
    memmove(&targets->at[1], &targets->at[0], (size_t)last * sizeof(*target));
    targets->at[0] = *target;
    keep_bound(targets);
}

void targets_finish(struct targets *targets)
{
    for (int i = 0; i < TARGETS; i++)
        if (targets->at[i].width_px)
            target_finish(&targets->at[i]);
}
