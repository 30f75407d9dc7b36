/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast snapshot` of one asset of the demo plant, run as a user would: exit codes, messages and the picture's content. */
#include "tests/support/test.h"
#include <sys/wait.h>
#include <unistd.h>

#include <png.h>

#include "base/text/text.h"
#include "tests/support/rig.h"

static const char demo[] = "build/demo";
static char *folder, *plant;

static const char *from_environment(const char *name, const char *otherwise)
{
    const char *value = getenv(name);
    return value ? value : otherwise;
}

/* Returns the exit code of `plantcast snapshot ARGS`; its output goes to FOLDER/said. */
static int snapshot(const char *args)
{
    char *command = test_printf("'%s/plantcast' snapshot %s >'%s/said' 2>&1", from_environment("PLANTCAST_BIN", "build"), args, folder);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static bool said(const char *text)
{
    size_t bytes;
    char *path = test_printf("%s/said", folder), *all = test_memory(text_read_file(path, 1 << 20, &bytes));
    bool found = all && strstr(all, text);
    return found;
}

static int draw(const char *options)
{
    char *args = test_printf("%s -o %s/out.png --size 320x180 --no-overlay --gl %s %s", plant, folder,
                            from_environment("PLANTCAST_GL", "egl-surfaceless"), options);
    int code = snapshot(args);
    return code;
}

static char *read_demo(const char *name)
{
    size_t bytes;
    char *path = test_printf("%s/%s", demo, name), *all = text_read_file(path, 1 << 20, &bytes);
    return all;
}

static void link_demo(const char *name)
{
    char *path = test_printf("%s/%s", demo, name), *whole = realpath(path, NULL), *link = test_printf("%s/%s", folder, name);
    assert_non_null(whole);
    assert_int_equal(symlink(whole, link), 0);
    free(whole);
}

/* Writes a plant with only the demo plant's first asset and that asset's tags, because each run computes the ambient light of
   the whole plant. */
static void write_plant(void)
{
    char *text = test_memory(read_demo("plant.yaml")), *list = test_memory(read_demo("tags.csv")), *rest = NULL;
    struct text *tags = test_text();
    assert_true(text && list);
    char *second = strstr(text, "\n  - { id: E-102,");
    assert_non_null(second);
    second[1] = '\0';
    for (char *line = strtok_r(list, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
        if (tags->length == 0 || strstr(line, ",E-101,"))
            text_add(tags, "%s\n", line);
    plant = temp_write_text(folder, "plant.yaml", text);
    temp_write_text(folder, "tags.csv", tags->at);
    link_demo("plant.glb");
    link_demo("plant.prepared");
}

static void write_values(const char *text)
{
    temp_write_text(folder, "values.csv", text);
}

/* Counts the pixels of the picture that are clearly coloured, that is, not grey. */
static int count_colored(void)
{
    png_image image = { .version = PNG_IMAGE_VERSION };
    char *path = test_printf("%s/out.png", folder);
    int count = 0;
    assert_true(png_image_begin_read_from_file(&image, path));
    assert_true(image.width == 320 && image.height == 180);
    image.format = PNG_FORMAT_RGB;
    uint8_t *rgb = mem_array(320 * 180, 3);
    assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
    for (int i = 0; i < 320 * 180; i++)
        count += abs(rgb[3 * i] - rgb[3 * i + 1]) > 40 || abs(rgb[3 * i + 1] - rgb[3 * i + 2]) > 40;
    mem_free(rgb);
    return count;
}

TEST(test_without_values_nothing_has_a_color)
{
    assert_int_equal(draw(""), 0);
    assert_in_range(count_colored(), 0, 20);
}

TEST(test_values_give_color)
{
    write_values("tag,value,quality\nTE-101,90,good\nTE-102,120,\nTE-103,,bad\nTE-104,30,uncertain\n");
    char *options = test_printf("--values %s/values.csv --tier moving", folder);
    assert_int_equal(draw(options), 0);
    assert_true(count_colored() > 50);
}

TEST(test_wrong_values_are_named)
{
    write_values("tag,value,quality\nTE-101,warm,good\nNO-SUCH,1,good\nTE-102,1,perhaps\n");
    char *options = test_printf("--values %s/values.csv", folder);
    assert_int_equal(draw(options), 1);
    assert_true(said("values.csv:2:8: error: value: expected a number, found 'warm'") && said("values.csv:3:1: error: tag 'NO-SUCH'"));
    assert_true(said("values.csv:4:10: error: quality: expected good, uncertain or bad, found 'perhaps'"));
}

TEST(test_images_are_colour_maps)
{
    static const char ppm[] = "P6\n2 1\n255\n\xff\x00\x00\x00\x00\xff";
    char *image = temp_write(folder, "map.ppm", ppm, sizeof(ppm) - 1);
    write_values("tag,value,quality\nTE-101,90,good\nTE-102,120,\n");
    char *options = test_printf("--values %s/values.csv --tier moving --colormap %s", folder, image);
    assert_int_equal(draw(options), 0);
    assert_true(count_colored() > 50);
    assert_int_equal(draw("--colormap no-such.png"), 2);
    assert_true(said("no-such.png: No such file or directory"));
    assert_int_equal(draw("--colormap plaid"), 2);
}

TEST(test_split_and_bands)
{
    write_values("tag,value,quality\nTE-101,90,good\nTE-102,120,\nPT-101,9,good\n");
    char *options = test_printf("--values %s/values.csv --breaks limits --isolines every:20 --split 'group=pressure;scale=linear'", folder);
    assert_int_equal(draw(options), 0);
    assert_true(count_colored() > 50);
    assert_int_equal(draw("--split group=flow"), 2);
    assert_int_equal(draw("--group pressure --scale log"), 2);
    assert_true(said("scale: a logarithmic scale needs a range that begins at 1e-18 or above"));
}

TEST(test_usage)
{
    assert_int_equal(snapshot("--help"), 0);
    assert_true(said("usage: plantcast snapshot"));
    assert_int_equal(snapshot(""), 2);
    assert_int_equal(snapshot("a.yaml b.yaml -o x.png"), 2);
    assert_int_equal(snapshot("a.yaml"), 2);
    assert_int_equal(snapshot("a.yaml -o x.png --size 12"), 2);
    assert_int_equal(snapshot("a.yaml -o x.png --at noon"), 2);
    assert_int_equal(snapshot("a.yaml -o x.png --frobnicate"), 2);
    assert_int_equal(snapshot("http://127.0.0.1:1/ -o x.png --values v.csv"), 2);
    assert_int_equal(draw("--look shiny"), 2);
    assert_int_equal(draw("--group flow"), 2);
}

TEST(test_failures)
{
    assert_int_equal(snapshot("no-such-plant.yaml -o x.png"), 1);
    assert_int_equal(draw("--prepared /no/such/folder"), 1);
    assert_int_equal(snapshot("http://127.0.0.1:1/ -o x.png"), 1);
}

int main(void)
{
    struct rig rig;
    if (!rig_init(&rig, "snapshot_test"))
        return 0;
    rig_finish(&rig);
    if (access(demo, R_OK) != 0) {
        printf("1..1\nok 1 - snapshot_test # SKIP no demo plant: make demo\n");
        return 0;
    }
    folder = temp_folder();
    write_plant();
    return tests_run(NULL);
}
