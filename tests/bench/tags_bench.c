/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of listing 20,000 tags to other programs, printed as one JSON line per row. The event loop also serves frames, so each
   page must be quick. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "session/reply/reply.h"
#include "tests/support/plant_by_hand.h"
#include "value/quality.h"

enum { TAGS = 20000, PAGE = 1000, LONGEST_PAGE = 5000, ROUNDS = 5 };

static struct plant *make_plant(void)
{
    struct plant *plant = plant_by_hand_create(TAGS);
    plant_by_hand_source(plant, "plc", 502);
    for (int i = 0; i < TAGS; i++) {
        char name[16];
        snprintf(name, sizeof(name), "T-%05d", i);
        plant_by_hand_tag(plant, name, TABLE_HOLDING, 0, DATA_FLOAT32);
    }
    return plant;
}

/* Requests all pages. Returns the milliseconds of the slowest page and of all pages together. */
static void ask_all(const struct session_context *context, size_t count, double *longest_ms, double *all_ms, size_t *bytes)
{
    *longest_ms = *all_ms = 0;
    *bytes = 0;
    for (size_t first = 0; first < TAGS; first += count) {
        int64_t begun_ns = clock_work_ns();
        char *text = reply_api_tags_text(context, first, count);
        double ms = (double)(clock_work_ns() - begun_ns) / 1e6;
        *longest_ms = ms > *longest_ms ? ms : *longest_ms;
        *all_ms += ms;
        *bytes += strlen(text);
        mem_free(text);
    }
}

static void measure(const struct session_context *context, size_t count)
{
    double longest_ms = INFINITY, all_ms = INFINITY;
    size_t bytes = 0;
    for (int i = 0; i < ROUNDS; i++) {
        double longest, all;
        ask_all(context, count, &longest, &all, &bytes);
        longest_ms = longest < longest_ms ? longest : longest_ms;
        all_ms = all < all_ms ? all : all_ms;
    }
    printf("{\"name\": \"api_tags_page_of_%zu_ms\", \"value\": %.2f, \"unit\": \"ms\", \"goal\": [\"<=\", %zu]}\n", count, longest_ms,
           count / 50);
    printf("{\"name\": \"api_tags_20000_by_%zu_ms\", \"value\": %.1f, \"unit\": \"ms\", \"goal\": [\"<=\", 400], \"bytes\": %zu}\n", count,
           all_ms, bytes);
}

int main(void)
{
    struct plant *plant = make_plant();
    struct snapshot *snapshot = snapshot_create(TAGS);
    for (int i = 0; i < TAGS; i++)
        snapshot->readings[i] = (struct reading){ .value = 20 + i * 0.001, .quality = QUALITY_GOOD, .age_ns = i * NS_PER_MS };
    const struct session_context context = { .plant = plant, .readings.snapshot = snapshot };
    measure(&context, PAGE);
    measure(&context, LONGEST_PAGE);
    snapshot_destroy(&snapshot);
    return 0;
}
