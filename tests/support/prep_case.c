/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs plantcast-prep. */
#include "tests/support/prep_case.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/mem.h"
#include "tests/support/owned.h"
#include "tests/support/temp.h"

int prep_case_set_up(void **state)
{
    struct prep_case *c = mem_new(sizeof(*c));
    c->folder = temp_folder();
    c->plant = temp_path(c->folder, "plant.yaml");
    *state = c;
    return 0;
}

int prep_case_tear_down(void **state)
{
    struct prep_case *c = *state;
    text_finish(&c->out);
    text_finish(&c->err);
    mem_free(c);
    return 0;
}

void prep_case_plant(struct prep_case *c, const char *yaml)
{
    temp_write_text(c->folder, "plant.yaml", yaml);
}

void prep_case_tags(struct prep_case *c, const char *rows)
{
    char *text = test_printf("Tag Name,Address,Data Type,Source,Group,Asset,Node,X,Y,Z\n%s", rows);
    temp_write_text(c->folder, "tags.csv", text);
}

void prep_case_read(struct prep_case *c, const char *name, struct text *to)
{
    char *path = temp_path(c->folder, name);
    size_t size;
    char *bytes = text_read_file(path, (size_t)1 << 30, &size);
    if (!bytes)
        fail_msg("%s cannot be read", path);
    text_finish(to);
    text_add_bytes(to, bytes, size);
    mem_free(bytes);
}

char *prep_case_program(void)
{
    const char *folder = getenv("PLANTCAST_BIN");
    char *program = test_printf("%s/plantcast-prep", folder ? folder : "build");
    if (access(program, X_OK) != 0) {
        print_message("# %s is not there\n", program);
        skip();
    }
    return program;
}

int prep_case_run(struct prep_case *c, const char *arguments)
{
    char *program = prep_case_program();
    char *command =
        mem_printf("PLANT='%s' FOLDER='%s'; '%s' %s >'%s/out' 2>'%s/err'", c->plant, c->folder, program, arguments, c->folder, c->folder);
    int status = system(command);
    mem_free(command);
    prep_case_read(c, "out", &c->out);
    prep_case_read(c, "err", &c->err);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

void prep_case_expect(struct prep_case *c, const char *arguments, int status)
{
    int got = prep_case_run(c, arguments);
    if (got != status)
        fail_msg("%s: exit status %d, expected %d\n%s%s", arguments, got, status, c->out.at ? c->out.at : "", c->err.at ? c->err.at : "");
}

char *prep_case_file(const struct prep_case *c, const char *ending, uint64_t *key)
{
    char *folder = temp_path(c->folder, "plant.prepared"), *path = NULL;
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;)
        if (strstr(entry->d_name, ending)) {
            assert_null(path);
            path = test_printf("%s/%s", folder, entry->d_name);
            *key = strtoull(entry->d_name, NULL, 16);
        }
    closedir(dir);
    assert_non_null(path);
    return path;
}

void prep_case_says(const struct text *text, const char *words)
{
    if (!text->at || !strstr(text->at, words))
        fail_msg("'%s' is not in: %s", words, text->at ? text->at : "(nothing)");
}

json_t *prep_case_json(const struct text *text)
{
    json_error_t error;
    json_t *root = json_loads(text->at ? text->at : "", 0, &error);
    if (!root)
        fail_msg("%s: %s", error.text, text->at ? text->at : "(nothing)");
    return test_json(root);
}

double prep_case_number(const json_t *root, const char *path)
{
    const json_t *at = root;
    char *copy = mem_strdup(path), *rest = copy;
    for (char *step = strtok_r(copy, ".", &rest); step; step = strtok_r(NULL, ".", &rest))
        at = json_is_array(at) ? json_array_get(at, (size_t)atoi(step)) : json_object_get(at, step);
    mem_free(copy);
    if (!json_is_number(at))
        fail_msg("there is no number %s", path);
    return json_number_value(at);
}
