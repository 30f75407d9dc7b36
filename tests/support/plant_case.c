/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plant files for tests. */
#include "tests/support/plant_case.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "base/mem.h"
#include "tests/support/temp.h"

int plant_case_set_up(void **state)
{
    struct plant_case *c = mem_new(sizeof(*c));
    c->folder = temp_folder();
    c->path = temp_path(c->folder, "plant.yaml");
    temp_write_text(c->folder, "m.glb", "glTF");
    *state = c;
    return 0;
}

void plant_case_forget(struct plant_case *c)
{
    plant_destroy(&c->plant);
    diag_finish(&c->diag);
}

int plant_case_tear_down(void **state)
{
    struct plant_case *c = *state;
    plant_case_forget(c);
    mem_free(c);
    return 0;
}

void plant_case_load(struct plant_case *c, const char *yaml, const char *csv)
{
    plant_case_forget(c);
    temp_write_text(c->folder, "plant.yaml", yaml);
    temp_write_text(c->folder, "tags.csv", csv);
    c->plant = plant_load(c->path, &c->diag);
}

void plant_case_assert_loaded(struct plant_case *c, int warnings)
{
    if (!c->plant || c->diag.warnings != warnings)
        diag_print(&c->diag, stderr);
    assert_non_null(c->plant);
    assert_int_equal(c->diag.warnings, warnings);
}

static bool is(const struct diag_item *item, const struct expected_finding *expected)
{
    size_t length = strlen(item->file), end = strlen(expected->file);
    return length >= end && !strcmp(item->file + length - end, expected->file) && item->line == expected->line &&
           item->column == expected->column && strstr(item->text, expected->words);
}

void plant_case_assert_found(const struct plant_case *c, const struct expected_finding *expected, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        size_t k = 0;
        while (k < c->diag.count && !is(&c->diag.items[k], &expected[i]))
            k++;
        if (k < c->diag.count)
            continue;
        diag_print(&c->diag, stderr);
        fail_msg("not found: %s:%d:%d: %s", expected[i].file, expected[i].line, expected[i].column, expected[i].words);
    }
    if (c->diag.count != count)
        diag_print(&c->diag, stderr);
    assert_int_equal(c->diag.count, count);
}
