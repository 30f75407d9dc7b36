/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Import of a plant through the daemon: which file names are accepted, complete and interrupted uploads, and the commands that
   are run one after another. */
#include "importing/plant_import.h"

#include "tests/support/test.h"
#include <sys/stat.h>
#include <unistd.h>

#include <jansson.h>

#include "base/files/atomic_file.h"
#include "importing/export_folder.h"

struct plant_import_fixture {
    char *root, *plant, *exports;
    struct plant_import *import;
};

static void begin(struct plant_import_fixture *f)
{
    f->root = temp_folder();
    f->plant = test_printf("%s/plant.yaml", f->root);
    f->exports = export_folder_of(f->root);
    assert_int_equal(mkdir(f->exports, 0700), 0);
    char *left = test_printf("%s/.upload.abc", f->exports);
    assert_int_equal(atomic_file_put(left, "x", 1), 0);
    f->import = plant_import_create(f->plant);
    assert_non_null(f->import);
    assert_int_not_equal(access(left, F_OK), 0); /* the file of an upload that was interrupted must be removed */
}

static void end(struct plant_import_fixture *f)
{
    plant_import_destroy(&f->import);
    plant_import_destroy(&f->import);
    mem_free(f->exports);
}

TEST_FIXTURE(struct plant_import_fixture, begin, end)

TEST(test_names)
{
    static const char *const good[] = { "plant.rvm", "열교환기 도면.ifc", "-x.glb", "a b (1).STEP", "Behälter #3.csv" };
    static const char *const bad[] = { "",         ".",         "..",       ".hidden.glb", "a/b.glb",    "../x.csv",     "a\\b.glb",
                                       "a\nb.glb", "a\x7f.glb", "\xff.glb", "/x",          "a\x01.json", "caf\xc3.step", "x\xed\xa0\x80" };
    char long_name[300];
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++)
        assert_true(export_name_good(good[i]));
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        assert_false(export_name_good(bad[i]));
    memset(long_name, 'a', sizeof(long_name));
    long_name[200] = 0;
    assert_true(export_name_good(long_name));
    long_name[200] = 'a';
    long_name[201] = 0;
    assert_false(export_name_good(long_name));
    assert_int_equal(export_kind_of("x.RVM"), EXPORT_MODEL);
    assert_int_equal(export_kind_of("x.dwg"), EXPORT_MODEL);
    assert_int_equal(export_kind_of("no ending"), EXPORT_MODEL);
    assert_int_equal(export_kind_of("x.att"), EXPORT_BESIDE);
    assert_int_equal(export_kind_of("tags.XLSX"), EXPORT_TAGS);
}

static int put(const struct plant_import_fixture *f, const char *name, const char *text, bool whole)
{
    int error;
    struct export_upload *upload = export_upload_begin(f->exports, name, &error);
    if (!upload)
        return error;
    assert_int_equal(export_upload_write(upload, text, strlen(text)), 0);
    if (whole)
        return export_upload_end(&upload);
    export_upload_abandon(&upload);
    assert_null(upload);
    return 0;
}

TEST_ON(const struct plant_import_fixture *f, test_uploads, set_up, tear_down)
{
    struct export_list list = { 0 };
    assert_int_equal(put(f, "b.csv", "1", true), 0);
    assert_int_equal(put(f, "a.rvm", "12", true), 0);
    assert_int_equal(put(f, "a.rvm", "123", true), 0); /* a second upload with the same name replaces the first file */
    assert_int_equal(put(f, "gone.glb", "1", false), 0);
    int error;
    struct export_upload *upload = export_upload_begin(f->exports, "under way.glb", &error);
    export_folder_list(f->exports, &list);
    assert_int_equal(list.count, 2);
    assert_string_equal(list.at[0].name, "a.rvm");
    assert_int_equal(list.at[0].bytes, 3);
    assert_int_equal(list.at[0].kind, EXPORT_MODEL);
    assert_int_equal(list.at[1].kind, EXPORT_TAGS);
    export_list_finish(&list);
    export_upload_abandon(&upload);
    assert_int_equal(put(f, "c.xlsx", "1", true), 0);
    export_folder_remove_tag_lists(f->exports, "c.xlsx");
    export_folder_list(f->exports, &list);
    assert_int_equal(list.count, 2);
    assert_string_equal(list.at[1].name, "c.xlsx");
    export_list_finish(&list);
    assert_int_equal(export_folder_remove(f->exports, "c.xlsx"), 0);
    assert_int_not_equal(export_folder_remove(f->exports, "c.xlsx"), 0);
    assert_null(export_upload_begin("/nowhere at all", "x", &error));
    assert_true(error < 0);
}

static json_t *told(const struct plant_import_fixture *f)
{
    char *text = test_memory(plant_import_text(f->import, &(struct import_source){ .host = "" }));
    json_t *object = test_json(json_loads(text, 0, NULL));
    assert_non_null(object);
    return object;
}

static void check_told(const struct plant_import_fixture *f, const char *phase, const char *said, const char *failed)
{
    json_t *object = told(f);
    assert_string_equal(json_string_value(json_object_get(object, "phase")), phase);
    assert_string_equal(json_string_value(json_object_get(object, "said")), said);
    if (failed)
        assert_string_equal(json_string_value(json_object_get(object, "failed")), failed);
    else
        assert_true(json_is_null(json_object_get(object, "failed")));
}

TEST_ON(struct plant_import_fixture *f, test_orders, set_up, tear_down)
{
    struct import_order order = { .models = true, .units = "mm", .up = "z" }, taken;
    assert_true(import_order_good(&order));
    assert_false(import_order_good(&(struct import_order){ .units = "km" }));
    assert_false(import_order_good(&(struct import_order){ .up = "x" }));
    assert_true(import_order_good(&(struct import_order){ .encoding = "Shift-JIS" }));
    assert_false(import_order_good(&(struct import_order){ .encoding = "-x" }));
    assert_false(import_order_good(&(struct import_order){ .encoding = "a b" }));
    check_told(f, "idle", "", NULL);
    assert_false(plant_import_next(f->import, &taken));
    plant_import_cancel(f->import);
    assert_true(plant_import_order(f->import, &order));
    assert_false(plant_import_cancelled(f->import)); /* a cancellation applies only to the run during which it was requested */
    assert_false(plant_import_order(f->import, &order));
    assert_true(plant_import_busy(f->import));
    assert_true(plant_import_next(f->import, &taken));
    assert_string_equal(taken.units, "mm");
    assert_false(plant_import_next(f->import, &taken));
    plant_import_say(f->import, "one\ntwo \x01\xff\n");
    check_told(f, "reading", "one\ntwo ??\n", NULL);
    plant_import_set_phase(f->import, IMPORT_MATCHING);
    plant_import_cancel(f->import);
    assert_true(plant_import_cancelled(f->import));
    plant_import_end(f->import, false, "tag \xff is wrong");
    check_told(f, "idle", "one\ntwo ??\n", "tag ? is wrong");
    assert_true(plant_import_order(f->import, &(struct import_order){ .decides = true }));
    check_told(f, "matching", "", NULL);
    plant_import_end(f->import, true, NULL);
    check_told(f, "idle", "", NULL);
}

static const char *units_told(const struct plant_import_fixture *f, char out[8])
{
    json_t *object = told(f);
    snprintf(out, 8, "%s/%s", json_string_value(json_object_get(object, "units")), json_string_value(json_object_get(object, "up")));
    return out;
}

TEST_ON(struct plant_import_fixture *f, test_units_in_force_are_told_also_after_a_restart, set_up, tear_down)
{
    char is[8];
    assert_string_equal(units_told(f, is), "/");
    assert_true(plant_import_order(f->import, &(struct import_order){ .models = true, .units = "mm", .up = "z" }));
    assert_string_equal(units_told(f, is), "/");
    plant_import_end(f->import, true, NULL);
    assert_string_equal(units_told(f, is), "mm/z");
    assert_true(plant_import_order(f->import, &(struct import_order){ .models = true, .units = "ft" }));
    plant_import_end(f->import, false, "it was cancelled");
    assert_true(plant_import_order(f->import, &(struct import_order){ .decides = true }));
    plant_import_end(f->import, true, NULL);
    assert_string_equal(units_told(f, is), "mm/z");
    plant_import_destroy(&f->import);
    f->import = plant_import_create(f->plant);
    assert_string_equal(units_told(f, is), "mm/z");
    assert_true(plant_import_order(f->import, &(struct import_order){ .models = true, .up = "y" }));
    plant_import_end(f->import, true, NULL);
    plant_import_destroy(&f->import);
    f->import = plant_import_create(f->plant);
    assert_string_equal(units_told(f, is), "/y");
}

TEST(test_sources)
{
    static const struct import_source good[] = { { .host = "plc-1.site.example", .port = "502", .unit = "0", .order = "CDAB", .base = "0" },
                                                 { .host = "10.0.0.7" } };
    static const struct import_source bad[] = { { .host = "" },
                                                { .host = "--x" },
                                                { .host = "a }, {" },
                                                { .host = "a\nb" },
                                                { .host = "a", .port = "0" },
                                                { .host = "a", .port = "65536" },
                                                { .host = "a", .unit = "256" },
                                                { .host = "a", .unit = "+1" },
                                                { .host = "a", .order = "ABCE" },
                                                { .host = "a", .base = "2" } };
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++)
        assert_true(import_source_good(&good[i]));
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        assert_false(import_source_good(&bad[i]));
}
