/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder with a plant in it, and runs of plantcast-prep on it. */
#ifndef TESTS_PREP_CASE_H
#define TESTS_PREP_CASE_H
#include <jansson.h>
#include <stdint.h>

#include "base/text/text.h"

struct prep_case {
    char *folder, *plant;  /* plant: FOLDER/plant.yaml */
    struct text out, err;  /* output of the last run */
};

/* Set-up and tear-down for cmocka; *state is the case. The folder is empty at first. */
int prep_case_set_up(void **state);
int prep_case_tear_down(void **state);

/* prep_case_plant() writes plant.yaml. prep_case_tags() writes tags.csv: a header with the columns tag, address, type, source,
   group, asset, node, x, y, z, then these rows. */
void prep_case_plant(struct prep_case *c, const char *yaml);
void prep_case_tags(struct prep_case *c, const char *rows);

/* prep_case_run() runs plantcast-prep with these arguments in a shell, where $PLANT is the plant file and $FOLDER its folder,
   and returns the exit status. It skips the test if the program is not built. prep_case_expect() fails if the status differs. */
int prep_case_run(struct prep_case *c, const char *arguments);
void prep_case_expect(struct prep_case *c, const char *arguments, int status);
char *prep_case_program(void); /* returns the program's path; skips the test if it is not built */

void prep_case_read(struct prep_case *c, const char *name, struct text *to);
/* Finds the prepared file whose name ends in `ending`; fails if there is none or several. Returns its path; *key receives the
   cache key that its name contains. */
char *prep_case_file(const struct prep_case *c, const char *ending, uint64_t *key);
void prep_case_says(const struct text *text, const char *words);
json_t *prep_case_json(const struct text *text); /* parses JSON; the result belongs to the running test */
/* Returns the number at a path such as "assets.0.surface.bridges"; fails if there is no number there. */
double prep_case_number(const json_t *root, const char *path);

#endif
