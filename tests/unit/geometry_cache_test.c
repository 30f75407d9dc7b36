/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The build cache of plantcast-prep: with a changed sensor, a cached build has the same bits as a full build, without reading
   the model; with very many sensors, an equally good field. Damaged entries are not used, and a killed run can be resumed. */
#include "tests/support/test.h"
#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "preprocess/cache/folder.h"
#include "preprocess/pipeline/geometry_cache.h"
#include "protocol/asset_distance.h"
#include "surface/mesh/bvh.h"
#include "surface/surface_store.h"
#include "tests/support/cad.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"

#define AROUND 104 /* enough triangles to be kept */
#define TUBE 50

static const char plant_text[] = "plant: { name: Stock test }\n"
                                 "assets: [{ id: A, model: model.glb, nodes: torus, up: z }]\n"
                                 "groups: [{ id: t, unit: K, min: 0, max: 1 }, { id: p, unit: bar, min: 0, max: 1, power: 3 }]\n"
                                 "tags: tags.csv\n";
static const char first_tags[] = "a,,,,t,A,,1.3,0,0\nb,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\nd,,,,t,A,TT-1,,,\n";

/* Results of plantcast-prep that several tests use, each made once: a folder prepared with first_tags, and, for each other tag
   list, what a run without a cache gives. */
static struct {
    struct prep_case *c; /* the plant of all tests */
    json_t *first;       /* report on the asset, from the run that made FOLDER/first */
    struct {
        char *tags, *bytes;
        size_t size;
        json_t *levels;
    } fresh[16];
    size_t fresh_count;
} made;

static int make_plant(void **state)
{
    struct cad *torus = test_cad();
    struct cad_random chance = { 3 };
    struct model_maker maker;
    prep_case_set_up(state);
    struct prep_case *c = made.c = *state;
    cad_torus(torus, &chance, AROUND, TUBE, 0.3, 0.4);
    assert_true(torus->triangle_count >= GEOMETRY_CACHE_TRIANGLES);
    maker_init(&maker);
    maker_cad(&maker, "torus", torus);
    maker_node(&maker, "TT-1", -1, json_pack("{s:[f,f,f]}", "translation", 0.0, -1.3, 0.0));
    maker_node(&maker, "TT-2", -1, json_pack("{s:[f,f,f]}", "translation", 0.9, -0.9, 0.1));
    maker_write(&maker, c->folder, "model.glb");
    return 0;
}

static int remove_plant(void **state)
{
    for (size_t i = 0; i < made.fresh_count; i++) {
        mem_free(made.fresh[i].tags);
        mem_free(made.fresh[i].bytes);
        json_decref(made.fresh[i].levels);
    }
    json_decref(made.first);
    return prep_case_tear_down(state);
}

static void in_folder(const struct prep_case *c, const char *command)
{
    char *whole = test_printf("cd '%s' && %s", c->folder, command);
    assert_int_equal(system(whole), 0);
}

/* Makes the plant of a test, without preparing anything. */
static int set_up(void **state)
{
    *state = made.c;
    in_folder(made.c, "rm -rf kept fresh");
    prep_case_plant(made.c, plant_text);
    return 0;
}

#define CASE(name) TEST_ON(struct prep_case *c, name, set_up, NULL)

/* Runs plantcast-prep with these tags; its output goes to FOLDER/`into`. Returns the report on the asset; *model_read: whether
   the run had to read the model. */
static json_t *prepare(struct prep_case *c, const char *tags, const char *into, bool *model_read)
{
    char *arguments = test_printf("$PLANT --report json --output $FOLDER/%s", into);
    prep_case_tags(c, tags);
    prep_case_expect(c, arguments, 0);
    json_t *report = prep_case_json(&c->out), *asset = json_array_get(json_object_get(report, "assets"), 0);
    *model_read = json_is_true(json_object_get(json_array_get(json_object_get(report, "models"), 0), "read"));
    assert_string_equal(json_string_value(json_object_get(asset, "state")), "built");
    return asset;
}

static char *path_of(const struct prep_case *c, const char *folder, const json_t *asset)
{
    return mem_printf("%s/%s/%s", c->folder, folder, json_string_value(json_object_get(asset, "file")));
}

/* Makes FOLDER/kept a copy of what a first run with first_tags gives. Returns the report on the asset. */
static json_t *prepare_first(struct prep_case *c)
{
    bool model_read;
    if (!made.first) {
        made.first = json_deep_copy(prepare(c, first_tags, "first", &model_read));
        assert_true(model_read);
    }
    prep_case_tags(c, first_tags);
    in_folder(c, "rm -rf kept && cp -a first kept");
    return made.first;
}

/* Makes sure that `tags` has been prepared once into an empty folder. Returns the index of the result in made.fresh[]. */
static size_t prepare_fresh(struct prep_case *c, const char *tags)
{
    bool model_read;
    size_t i = 0;
    while (i < made.fresh_count && strcmp(made.fresh[i].tags, tags) != 0)
        i++;
    if (i < made.fresh_count)
        return i;
    assert_in_range(i, 0, sizeof(made.fresh) / sizeof(*made.fresh) - 1);
    json_t *fresh = prepare(c, tags, "fresh", &model_read);
    assert_true(model_read);
    char *path = test_memory(path_of(c, "fresh", fresh));
    made.fresh[i].tags = mem_strdup(tags);
    made.fresh[i].bytes = text_read_file(path, (size_t)1 << 30, &made.fresh[i].size);
    made.fresh[i].levels = json_deep_copy(json_object_get(fresh, "levels"));
    assert_non_null(made.fresh[i].bytes);
    made.fresh_count++;
    in_folder(c, "rm -r fresh");
    return i;
}

/* Asserts that preparing `tags` in an empty folder gives the same file, byte by byte, and the same levels and surface in the report. */
static void assert_as_fresh(struct prep_case *c, const char *tags, const json_t *found)
{
    size_t i = prepare_fresh(c, tags), size;
    char *path = test_memory(path_of(c, "kept", found)), *bytes = test_memory(text_read_file(path, (size_t)1 << 30, &size));
    assert_non_null(bytes);
    assert_int_equal(size, made.fresh[i].size);
    assert_memory_equal(bytes, made.fresh[i].bytes, size);
    assert_true(json_equal(made.fresh[i].levels, json_object_get(found, "levels")));
}

/* While a group has a single sensor, distances do not matter and are not checked against the heat method. Once a second sensor
   is added, they must be checked. */
CASE(what_was_not_checked_is_checked_once_it_shows)
{
    static const char *const tags[] = { "a,,,,t,A,,1.3,0,0\nc,,,,p,A,,0,1,0.3\n",
                                        "a,,,,t,A,,1.3,0,0\nb,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\n" };
    for (int i = 0; i < 2; i++) {
        bool model_read;
        json_t *asset = prepare(c, tags[i], "kept", &model_read), *surface = json_object_get(asset, "surface");
        assert_true(model_read == (i == 0));
        assert_int_equal(json_is_number(json_object_get(surface, "heat_disagreement")), i);
        assert_int_equal(json_is_number(json_object_get(surface, "time_m2")), i);
    }
}

static int number(const json_t *asset, const char *name)
{
    return (int)json_integer_value(json_object_get(asset, name));
}

CASE(a_changed_sensor_costs_its_own_distances)
{
    static const struct {
        const char *tags;
        int kept;
        bool model_read;
    } changes[] = {
        { first_tags, 0, true },
        { "a,,,,t,A,,1.3,0,0.02\nb,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\nd,,,,t,A,TT-1,,,\n", 3, false }, /* moved */
        { "b,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\nd,,,,t,A,TT-1,,,\n", 3, false },                       /* removed */
        { "e,,,,t,A,,0.8,0.8,0\nb,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\nd,,,,t,A,TT-1,,,\n", 3, false },  /* added */
        { "e,,,,t,A,,0.8,0.8,0\nb,,,,t,A,,-1.3,0,0\nc,,,,t,A,,0,1,0.3\nd,,,,t,A,TT-1,,,\n", 4, false },  /* of another group */
        /* the tag refers to the node TT-2 by name; no earlier tag did, so the model must be read for the node's position */
        { "e,,,,t,A,,0.8,0.8,0\nb,,,,t,A,,-1.3,0,0\nc,,,,t,A,TT-2,,,\nd,,,,t,A,TT-1,,,\n", 3, true },
        { "d,,,,t,A,TT-1,,,\nc,,,,t,A,TT-2,,,\ne,,,,t,A,,0.8,0.8,0\nb,,,,t,A,,-1.3,0,0.01\n", 3, false }, /* in another order */
    };
    for (size_t i = 0; i < sizeof(changes) / sizeof(*changes); i++) {
        bool model_read;
        json_t *asset = prepare(c, changes[i].tags, "kept", &model_read);
        print_message("# change %zu: %d of the distances were there\n", i, number(asset, "kept_sensors"));
        assert_int_equal(number(asset, "kept_sensors"), changes[i].kept);
        assert_int_equal(number(asset, "stocked"), i > 0);
        assert_true(model_read == changes[i].model_read);
        if (i % 2 || i == 6)
            assert_as_fresh(c, changes[i].tags, asset);
    }
}

/* Returns the path of the only file in the folder with this suffix. */
static char *kept_file(const struct prep_case *c, const char *ending)
{
    char path[400] = "", *command = test_printf("ls '%s'/kept/*%s", c->folder, ending);
    FILE *names = popen(command, "r");
    assert_non_null(names);
    assert_non_null(fgets(path, sizeof(path), names));
    assert_true(feof(names) || fgetc(names) == EOF);
    pclose(names);
    path[strcspn(path, "\n")] = 0;
    return mem_strdup(path);
}

static void damage(const char *path, bool cut)
{
    size_t size;
    char *bytes = test_memory(text_read_file(path, (size_t)1 << 30, &size));
    assert_non_null(bytes);
    /* changes a byte in each eighth of the file, which damages each part of a cached mesh, and the distances of each cached
       sensor (its record has 32 bytes before them) */
    for (size_t i = size / 8 + 40; i < size; i += size / 8)
        bytes[i] ^= 4;
    assert_int_equal(atomic_file_put(path, bytes, cut ? size / 3 : size), 0);
}

CASE(what_is_damaged_is_made_anew)
{
    for (int cut = 0; cut < 2; cut++) {
        char *tags = test_printf("a,,,,t,A,,1.3,0,0.0%d\nb,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\nd,,,,t,A,TT-1,,,\n", cut ? 5 : 2);
        bool model_read;
        prepare_first(c);
        char *stock = test_memory(kept_file(c, cut ? ".surface" : ".stock")), *columns = test_memory(kept_file(c, ".columns"));
        damage(stock, cut);
        damage(columns, cut);
        json_t *asset = prepare(c, tags, "kept", &model_read);
        assert_true(model_read);
        prep_case_says(&c->err, stock);
        prep_case_says(&c->err, cut ? "truncated: " : "damaged: its checksum ");
        prep_case_says(&c->err, columns);
        assert_int_equal(number(asset, "stocked"), 0);
        assert_in_range(number(asset, "kept_sensors"), 0, cut ? 1 : 0);
        assert_as_fresh(c, tags, asset);
    }
}

/* Makes a cache file look like one of an older version: the last of the 8 bytes at its beginning is the version. */
static void make_older(const char *path)
{
    int fd = open(path, O_RDWR);
    assert_true(fd >= 0);
    assert_int_equal(pwrite(fd, "0", 1, 7), 1);
    close(fd);
}

static bool is_older(const char *path)
{
    char version = 0;
    int fd = open(path, O_RDONLY);
    assert_true(fd >= 0);
    assert_int_equal(pread(fd, &version, 1, 7), 1);
    close(fd);
    return version == '0';
}

/* After an update of the program, the files of the previous version are replaced without a warning. */
CASE(files_of_another_version_are_made_again)
{
    static const char tags[] = "a,,,,t,A,,1.3,0,0.04\nb,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\nd,,,,t,A,TT-1,,,\n";
    static const char *const endings[] = { ".stock", ".surface", ".spots" };
    bool model_read;
    prepare_first(c);
    for (size_t i = 0; i < sizeof(endings) / sizeof(*endings); i++) {
        char *path = kept_file(c, endings[i]);
        make_older(path);
        mem_free(path);
    }
    json_t *asset = prepare(c, tags, "kept", &model_read);
    assert_true(model_read);
    assert_int_equal(number(asset, "stocked"), 0);
    assert_int_equal(number(asset, "kept_sensors"), 3);
    assert_null(c->err.at ? strstr(c->err.at, "cache file") : NULL);
    for (size_t i = 0; i < sizeof(endings) / sizeof(*endings); i++) {
        char *path = kept_file(c, endings[i]);
        assert_false(is_older(path));
        mem_free(path);
    }
    assert_as_fresh(c, tags, asset);
}

static ino_t file_number(const char *path)
{
    struct stat st;
    assert_int_equal(stat(path, &st), 0);
    return st.st_ino;
}

/* A sensor's nearest sample points are taken from a cache file. It is rewritten only if many were missing in it or it was
   damaged. */
CASE(points_are_found_once)
{
    static const char *const places[] = { "1.3,0,0.02", "1.3,0,0.05", "0.8,0.8,0" };
    bool model_read;
    prepare_first(c);
    char *spots = test_memory(kept_file(c, ".spots"));
    for (int i = 0; i < 3; i++) {
        char *tags = test_printf("a,,,,t,A,,%s\nb,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\nd,,,,t,A,TT-1,,,\n", places[i]);
        if (i)
            damage(spots, i == 2);
        ino_t before = file_number(spots); /* inode of the cache file: it stays the same unless the file is replaced by a new one */
        json_t *asset = prepare(c, tags, "kept", &model_read);
        assert_false(model_read);
        if (i)
            prep_case_says(&c->err, spots);
        assert_true((file_number(spots) == before) == (i == 0));
        assert_as_fresh(c, tags, asset);
    }
}

/* --- killed midway ------------------------------------------------------------------------------------------------------------ */

/* Runs plantcast-prep into FOLDER/kept with a limit on the size of files it writes. A longer write kills it by SIGXFSZ; with
   `told`, the write fails with an error instead. Returns the exit status. */
static int prepare_limited(struct prep_case *c, const char *tags, size_t bytes, bool told)
{
    char *program = prep_case_program(), *folder = temp_path(c->folder, "kept"), *said = temp_path(c->folder, "said");
    int status;
    prep_case_tags(c, tags);
    pid_t pid = fork();
    if (pid == 0) {
        const struct rlimit most = { bytes, bytes }, none = { 0, 0 };
        int nothing = open("/dev/null", O_WRONLY);
        dup2(nothing, STDOUT_FILENO);
        dup2(told ? open(said, O_WRONLY | O_CREAT | O_TRUNC, 0600) : nothing, STDERR_FILENO);
        setrlimit(RLIMIT_CORE, &none);
        setrlimit(RLIMIT_FSIZE, &most);
        signal(SIGXFSZ, told ? SIG_IGN : SIG_DFL);
        execl(program, program, c->plant, "--output", folder, (char *)NULL);
        _exit(127);
    }
    assert_true(pid > 0);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return status;
}

static void prepare_killed_at(struct prep_case *c, const char *tags, size_t bytes)
{
    int status = prepare_limited(c, tags, bytes, false);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ);
}

static size_t bytes_of(const char *path)
{
    struct stat st;
    assert_int_equal(stat(path, &st), 0);
    return (size_t)st.st_size;
}

/* The program is killed while it writes a cached sensor or the asset file. The old asset file must stay, also for processes
   that have mapped it, and the next run must give the same as a full build. */
CASE(killed_midway_it_goes_on)
{
    bool model_read;
    json_t *first = prepare_first(c);
    char *before = path_of(c, "kept", first), *columns = kept_file(c, ".columns"), *folder = temp_path(c->folder, "kept"), why[200];
    /* two limits on the size of files: one within the new record in the cache of distances, which begins up to 1 kB after the
       present end of that file; one in the middle of the asset file */
    const size_t limits[] = { bytes_of(columns) + 1024 + 100, bytes_of(before) / 2 };
    struct folder_file mapped;
    struct asset_view view;
    uint64_t key = strtoull(json_string_value(json_object_get(first, "file")), NULL, 16);
    assert_true(limits[1] > 2 * bytes_of(columns));
    assert_int_equal(folder_open(&mapped, folder, key, why), 1);
    for (int i = 0; i < 2; i++) {
        char *tags = test_printf("%se,,,,t,A,,0.%d,-1.2,0\n", first_tags, 1 + i);
        if (i)
            prepare(c, first_tags, "kept", &model_read);
        prepare_killed_at(c, tags, limits[i]);
        struct folder_file old;
        assert_int_equal(folder_open(&old, folder, key, why), 1);
        folder_close(&old);
        json_t *asset = prepare(c, tags, "kept", &model_read);
        print_message("# killed at %zu bytes, then %d of the distances were there\n", limits[i], number(asset, "kept_sensors"));
        assert_false(model_read);
        assert_int_equal(number(asset, "kept_sensors"), i ? 5 : 4);
        assert_as_fresh(c, tags, asset);
        assert_true(asset_view_init(&view, mapped.bytes, mapped.size, why));
    }
    folder_close(&mapped);
    mem_free(before);
    mem_free(columns);
}

/* A file that does not fit on the disk is not started: the old one stays and no temporary file remains. Once there is room, it
   is written. */
CASE(without_room_the_old_file_stays)
{
    static const char tags[] = "a,,,,t,A,,1.3,0,0\nb,,,,t,A,,-1.3,0,0\nc,,,,p,A,,0,1,0.3\nd,,,,t,A,,0.1,-1.2,0\n";
    bool model_read;
    json_t *first = prepare_first(c);
    char *before = test_memory(path_of(c, "kept", first)), *columns = test_memory(kept_file(c, ".columns"));
    char *drafts = test_printf("ls '%s'/kept | grep -q asset.*new", c->folder);
    char *names_folder = test_printf("grep -q 'cannot be written to %s/kept: File too large' '%s'/said", c->folder, c->folder);
    size_t size = bytes_of(before);
    assert_true(size / 2 > bytes_of(columns));
    int status = prepare_limited(c, tags, size / 2, true);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
    assert_int_equal(bytes_of(before), size);
    assert_int_not_equal(system(drafts), 0);
    assert_int_equal(system(names_folder), 0);
    json_t *asset = prepare(c, tags, "kept", &model_read);
    assert_as_fresh(c, tags, asset);
}

CASE(what_nothing_needs_any_more_is_removed)
{
    bool model_read;
    prepare_first(c);
    char *stock = kept_file(c, ".stock"), *surface = test_memory(kept_file(c, ".surface")), *columns = kept_file(c, ".columns");
    char *spots = test_memory(kept_file(c, ".spots"));
    char *other = test_memory(mem_strdup(plant_text));
    memcpy(strstr(other, "up: z"), "up: y", 5);
    prep_case_plant(c, other);
    prepare(c, "a,,,,t,A,,1.3,0,0\n", "kept", &model_read);
    assert_true(model_read);
    assert_int_not_equal(access(stock, F_OK), 0);
    assert_int_not_equal(access(surface, F_OK), 0);
    assert_int_not_equal(access(columns, F_OK), 0);
    assert_int_not_equal(access(spots, F_OK), 0);
    mem_free(stock);
    mem_free(columns);
}

/* --- among many sensors ------------------------------------------------------------------------------------------------------- */

#define MANY 65
#define STEP (1 / 255.0)

/* Returns the rows of MANY tags of one group, placed around the ring. `first` selects the position of tag s0; the other tags
   are always at the same ones. */
static char *many_tags(int first)
{
    struct text rows = { 0 };
    for (int i = 0; i < MANY; i++) {
        double a = 2.4 * (i ? i : MANY + first), b = 1.7 * (i ? i : first), r = 1 + 0.4 * cos(b);
        char *row = test_printf("s%d,,,,t,A,,%.4f,%.4f,%.4f\n", i, r * cos(a), r * sin(a), 0.4 * sin(b));
        text_add_bytes(&rows, row, strlen(row));
    }
    text_add_bytes(&rows, "", 1);
    return rows.at;
}

struct prepared {
    struct folder_file file;
    struct trimesh mesh; /* mesh of the finest level */
    struct bvh *bvh;
    float *values; /* one field value for each vertex, computed from made-up readings of all sensors */
};

static float value_at(const struct asset_view *view, uint32_t vertex)
{
    double sum = 0, weights = 0;
    for (uint32_t s = 0; s < view->header->sensor_count; s++) {
        double d = fmax(1e-5, (double)asset_distance_m(view, (size_t)s, vertex)), weight = 1 / (d * d);
        sum += (s * 7 % 3 == 0) * weight;
        weights += weight;
    }
    return (float)(sum / weights);
}

static void open_prepared(struct prepared *at, const struct prep_case *c, const char *into, const json_t *asset)
{
    char why[200], *folder = temp_path(c->folder, into);
    *at = (struct prepared){ 0 };
    assert_int_equal(folder_open(&at->file, folder, strtoull(json_string_value(json_object_get(asset, "file")), NULL, 16), why), 1);
    assert_true(folder_unpack(&at->file));
    const struct asset_view *view = &at->file.view;
    at->values = mem_array(view->header->vertex_count, sizeof(*at->values));
    for (uint32_t v = 0; v < view->header->vertex_count; v++) {
        const float *p = view->positions_m[v];
        trimesh_add_point(&at->mesh, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] });
        at->values[v] = value_at(view, v);
    }
    const struct asset_level *finest = &view->levels[0];
    for (uint32_t p = finest->first_primitive; p < finest->first_primitive + finest->primitive_count; p++)
        for (uint32_t i = 0; i < view->primitives[p].index_count; i += 3) {
            const uint32_t *v = view->indices + view->primitives[p].first_index + i;
            trimesh_add_tri(&at->mesh, v[0], v[1], v[2], 0);
        }
    at->bvh = bvh_create(&at->mesh);
}

static void close_prepared(struct prepared *at)
{
    bvh_destroy(&at->bvh);
    trimesh_finish(&at->mesh);
    mem_free(at->values);
    folder_close(&at->file);
}

static int by_size(const void *a, const void *b)
{
    float p = *(const float *)a, q = *(const float *)b;
    return (p > q) - (p < q);
}

/* Compares two preparations: at corners of the triangles of `other`, the field of `at` must be nearly that of `other`. */
static void assert_shows(const struct prepared *at, const struct prepared *other, const char *name)
{
    size_t count = other->mesh.tri_count;
    float *errors = mem_array(count, sizeof(*errors));
    for (size_t t = 0; t < count; t++) {
        struct bvh_place place;
        uint32_t v = other->mesh.tris[t][t % 3];
        double value = 0;
        bvh_nearest(at->bvh, other->mesh.points[v], INFINITY, NULL, NULL, &place);
        for (int c = 0; c < 3; c++)
            value += place.weights[c] * (double)at->values[at->mesh.tris[place.tri][c]];
        errors[t] = fabsf((float)value - other->values[v]);
    }
    qsort(errors, count, sizeof(*errors), by_size);
    print_message("# %s, %zu triangles, at %zu places: %.2f steps (99.9 %%), %.2f at most\n", name, at->mesh.tri_count, count,
                  (double)errors[count * 999 / 1000] / STEP, (double)errors[count - 1] / STEP);
    assert_true((double)errors[count * 999 / 1000] <= STEP);
    assert_true((double)errors[count - 1] <= 12 * STEP);
    mem_free(errors);
}

static void assert_on_vertices(const struct prepared *at)
{
    const struct asset_view *view = &at->file.view;
    assert_int_equal(view->header->sensor_count, MANY);
    for (uint32_t s = 0; s < MANY; s++) {
        uint32_t v = view->sensors[s].nearest_vertex;
        assert_memory_equal(view->positions_m[v], view->sensors[s].surface_m, sizeof(float[3]));
        assert_true(asset_distance_m(view, (size_t)s, v) == 0);
    }
}

/* Runs plantcast-prep with `tags` without the cache (in an empty folder, or with a damaged cache). Asserts that the result's
   field equals that of `moved`. */
static void assert_shows_as_anew(struct prep_case *c, const struct prepared *moved, const char *tags, const char *into)
{
    struct prepared anew;
    bool model_read;
    if (strcmp(into, "kept") == 0) {
        char *findings = kept_file(c, ".splitting"), *asset = kept_file(c, ".asset");
        damage(findings, false);
        assert_int_equal(unlink(asset), 0);
        mem_free(findings);
        mem_free(asset);
    }
    json_t *found = prepare(c, tags, into, &model_read);
    assert_true(number(found, "split_measured") > 0);
    assert_int_equal(number(found, "split_kept"), 0);
    open_prepared(&anew, c, into, found);
    assert_shows(&anew, moved, "prepared anew");
    assert_shows(moved, &anew, "moved");
    assert_true(moved->mesh.tri_count < anew.mesh.tri_count * 11 / 10);
    close_prepared(&anew);
}

CASE(one_of_many_sensors_is_split_for_alone)
{
    struct prepared moved;
    bool model_read;
    const int moves = sweep(3, 2);
    int first_found = 0;
    for (int move = 0; move < moves; move++) {
        char *tags = test_memory(many_tags(move));
        /* before the second move, a run is killed while it writes its cache of measured triangles; the next run must give the
           same result */
        if (move == 1) {
            char *findings = test_memory(kept_file(c, ".splitting"));
            prepare_killed_at(c, tags, bytes_of(findings) / 2);
        }
        json_t *found = prepare(c, tags, "kept", &model_read);
        int measured = number(found, "split_measured"), kept = number(found, "split_kept");
        print_message("# move %d: %d findings, %d of them kept\n", move, measured + kept, kept);
        first_found = move == 0 ? measured + kept : first_found;
        assert_true(measured > 0);
        if (move > 0) /* triangles measured by an earlier run are not measured again */
            assert_true(measured + kept < 0.97 * first_found);
        assert_true(move == 0 ? kept == 0 : kept > measured / 2);
        /* after the last move (the second one in long runs, otherwise the first), errors from cached measurements would have
           added up: the field must still equal one prepared without them */
        if (move == moves - 1) {
            open_prepared(&moved, c, "kept", found);
            assert_on_vertices(&moved);
            assert_shows_as_anew(c, &moved, tags, "kept");
            if (sweep_is_whole())
                assert_shows_as_anew(c, &moved, tags, "fresh");
            close_prepared(&moved);
        }
    }
}

/* --- the surface alone --------------------------------------------------------------------------------------------------------- */

TEST(a_surface_comes_back_whole)
{
    struct cad *torus = test_cad();
    struct cad_random chance = { 9 };
    struct text *packed = test_text();
    const double source[1][3] = { { 1.2, 0.3, 0.1 } };
    cad_torus(torus, &chance, 40, 20, 0.3, 0.5);
    torus->triangles[3] = torus->triangles[4]; /* a triangle without area */
    struct surface *surface = surface_create(NULL, NULL, (const float(*)[3])torus->positions, torus->vertex_count, torus->triangles,
                                             torus->triangle_count, &(struct surface_params){ 0 });
    float *before_m = mem_array(torus->vertex_count, sizeof(*before_m)), *after_m = mem_array(torus->vertex_count, sizeof(*after_m));
    assert_true(surface_distances(surface, source, 1, before_m));
    surface_pack(surface, packed);
    struct unpack from = { .at = packed->at, .left = packed->length };
    struct surface *back = surface_unpack(&from, NULL, NULL);
    assert_non_null(back);
    assert_int_equal(from.left, 0);
    assert_true(surface_distances(back, source, 1, after_m));
    assert_memory_equal(before_m, after_m, torus->vertex_count * sizeof(*before_m));
    assert_memory_equal(surface_report(surface), surface_report(back), sizeof(struct surface_report));
    surface_destroy(&back);
    for (size_t cut = 1; cut < packed->length; cut += packed->length / 37) {
        from = (struct unpack){ .at = packed->at, .left = packed->length - cut };
        assert_null(surface_unpack(&from, NULL, NULL));
    }
    surface_destroy(&surface);
    mem_free(before_m);
    mem_free(after_m);
}

TEST_GROUP(make_plant, remove_plant)
