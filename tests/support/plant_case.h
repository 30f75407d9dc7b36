/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant file and a tag list in their own folder, loaded, and assertions on the findings about them. For cmocka tests. */
#ifndef TESTS_PLANT_CASE_H
#define TESTS_PLANT_CASE_H
#include "plant/plant.h"

struct plant_case {
    char *folder, *path; /* path: FOLDER/plant.yaml; FOLDER/m.glb exists, to be used as a model */
    struct plant *plant; /* the loaded plant; NULL: loading found errors */
    struct diag diag;
};

int plant_case_set_up(void **state);
int plant_case_tear_down(void **state);
/* Writes both files (the list as tags.csv) and loads them, replacing those loaded before. */
void plant_case_load(struct plant_case *c, const char *yaml, const char *csv);
void plant_case_forget(struct plant_case *c);
void plant_case_assert_loaded(struct plant_case *c, int warnings);

struct expected_finding {
    const char *file; /* path of the file in which the finding is reported; the end of the path suffices */
    int line, column;
    const char *words; /* words that the text of the finding contains */
};
/* Asserts that exactly these findings were reported. */
void plant_case_assert_found(const struct plant_case *c, const struct expected_finding *expected, size_t count);
#define FOUND(c, ...) \
    plant_case_assert_found(c, (const struct expected_finding[]){ __VA_ARGS__ }, \
                            sizeof((const struct expected_finding[]){ __VA_ARGS__ }) / sizeof(struct expected_finding))

#endif
