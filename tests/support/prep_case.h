/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder with a plant in it, and plantcast-prep run on that. */
#ifndef TESTS_PREP_CASE_H
#define TESTS_PREP_CASE_H
#include <jansson.h>
#include <stdint.h>

#include "base/text/text.h"

struct prep_case {
    char *folder, *plant;  /* plant: FOLDER/plant.yaml */
    struct text out, err;  /* of the last run */
};

/* For cmocka's set-up and tear-down: *state is the case. Nothing is in the folder yet. */
int prep_case_set_up(void **state);
int prep_case_tear_down(void **state);

/* plant.yaml, tags.csv (rows after the usual header: tag, address, type, source, group, asset, node, x, y, z). */
void prep_case_plant(struct prep_case *c, const char *yaml);
void prep_case_tags(struct prep_case *c, const char *rows);

/* Runs plantcast-prep with these arguments in a shell, where $PLANT is the plant file and $FOLDER its folder. Skips the test if there is
   no program. The exit status; expect fails on another one. */
int prep_case_run(struct prep_case *c, const char *arguments);
void prep_case_expect(struct prep_case *c, const char *arguments, int status);
char *prep_case_program(void); /* its path; skips if there is none. mem_free */

void prep_case_read(struct prep_case *c, const char *name, struct text *to);
/* The one file of the kind (its ending) that was prepared, and the key that it is named by; mem_free. */
char *prep_case_file(const struct prep_case *c, const char *ending, uint64_t *key);
void prep_case_says(const struct text *text, const char *words);
json_t *prep_case_json(const struct text *text);
/* The number at a path such as "assets.0.surface.bridges"; fails where there is none. */
double prep_case_number(const json_t *root, const char *path);

#endif
