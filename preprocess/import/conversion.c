/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs every reader in a confined child process: the built-in RVM and glTF readers in a fork of this program, other readers as
 * external programs. A second child checks the GLB file that the reader wrote. */
#include "preprocess/import/conversion.h"

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "plant/plant_folder.h"
#include "preprocess/child/child.h"
#include "preprocess/child/child_paths.h"
#include "preprocess/child/work_folder.h"
#include "preprocess/geometry/geometry.h"
#include "preprocess/import/cad_attributes.h"
#include "preprocess/import/cad_glb.h"
#include "preprocess/import/encoding.h"
#include "preprocess/import/file_name.h"
#include "preprocess/import/formats.h"
#include "preprocess/import/gltf_pack.h"
#include "preprocess/import/rvm.h"
#include "preprocess/import/unpack.h"
#include "preprocess/model/gltf_shim.h"

enum { MAX_NAMED = 20 };
static const size_t max_bytes = (size_t)4 << 30;

/* Formats an error message into `why`. Always returns false, so that callers can write `return fail(...)`. */
static bool fail(char why[CONVERSION_WHY_BYTES], const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static bool fail(char why[CONVERSION_WHY_BYTES], const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(why, CONVERSION_WHY_BYTES, fmt, ap);
    va_end(ap);
    return false;
}

/* --- RVM ---------------------------------------------------------------------------------------------------------------------------- */

/* Looks for an RVM model's attribute file in the model's folder. Returns its path, which the caller frees, or NULL if there is none. */
static char *attributes_beside(const char *path)
{
    static const char *const endings[] = { ".att", ".ATT", ".txt", ".TXT" };
    for (size_t i = 0; i < sizeof(endings) / sizeof(endings[0]); i++) {
        char *beside = file_name_with_ending(path, endings[i]);
        struct stat st;
        if (stat(beside, &st) == 0 && S_ISREG(st.st_mode))
            return beside;
        mem_free(beside);
    }
    return NULL;
}

static bool add_attributes(struct cad_model *model, const char *path, const struct attribute_params *params, struct text *said,
                           char why[CONVERSION_WHY_BYTES])
{
    struct attribute_counts counts;
    size_t length;
    char reason[256];
    char *text = text_read_file(path, max_bytes, &length);
    if (!text)
        return fail(why, "%s: %s", path, strerror(errno));
    bool good = cad_attributes_read(model, text, length, params, &counts, reason, sizeof(reason));
    mem_free(text);
    if (!good)
        return fail(why, "%s: %s", path, reason);
    if (counts.elements == 0)
        return fail(why, "%s: this attribute file has no elements (NEW ... END): if it is not an attribute file, rename it", path);
    text_add(said, "attributes of %s: %zu elements, of which %zu are in the model; %zu values\n", text_base_name(path), counts.elements,
             counts.matched, counts.attributes);
    encoding_say(said, "attributes", &counts.encoding);
    return true;
}

static void say_counts(struct text *said, const struct rvm_counts *counts)
{
    text_add(said, "%zu primitives\n", counts->primitives);
    if (counts->covered_faces > 0)
        text_add(said, "left out: %zu faces, %.1f m2, that are hidden behind a neighbouring face (--keep-covered keeps hidden faces)\n",
                 counts->covered_faces, counts->covered_m2);
    if (counts->no_end)
        text_add(said, "error\t1\tRVM: the file has no end mark (END:), so parts may be missing: export the model again\n");
    if (counts->unknown_chunks > 0)
        text_add(said, "error\t%zu\tRVM: parts of the file (chunks) of unknown kinds were skipped; the first one is %s\n",
                 counts->unknown_chunks, counts->unknown_chunk);
}

static bool convert_rvm(const char *path, const char *attributes, const char *glb, const struct conversion_params *params,
                        struct text *said, char why[CONVERSION_WHY_BYTES])
{
    struct rvm_counts counts;
    struct text findings = { 0 };
    size_t length;
    char *bytes = text_read_file(path, max_bytes, &length);
    if (!bytes)
        return fail(why, "%s", strerror(errno));
    const struct rvm_params how = { .chord_m = params->chord_m, .keep_covered = params->keep_covered, .encoding = params->encoding,
                                     .findings = &findings };
    struct cad_model *model = cad_model_create();
    char *stem = file_name_stem(path);
    bool good = rvm_read(model, bytes, length, &how, &counts, why, CONVERSION_WHY_BYTES);
    mem_free(bytes);
    if (good) {
        say_counts(said, &counts);
        text_add(said, "%s", findings.at ? findings.at : "");
        encoding_say(said, "names", &counts.encoding);
    }
    if (good && counts.primitives > 0 && counts.empty == counts.primitives)
        good = fail(why, "none of the model's %zu primitives can be shown: each has no extent, or numbers that are infinite or invalid",
                    counts.primitives);
    if (good && attributes) {
        const struct attribute_params read = { .encoding = params->encoding,
                                               .model_encoding = counts.encoding.ascii ? "" : counts.encoding.name };
        good = add_attributes(model, attributes, &read, said, why);
    }
    text_finish(&findings);
    int status = good ? cad_glb_write(model, stem, glb) : 0;
    if (status != 0)
        good =
            fail(why,
                 status == -EFBIG ? "the model does not fit into a GLB file, which holds at most 4 GiB: export the plant in parts" : "%s",
                 strerror(-status));
    mem_free(stem);
    cad_model_destroy(&model);
    return good;
}

/* --- children ------------------------------------------------------------------------------------------------------------------------- */

struct model_reading {
    const struct import_format *format;
    const char *path, *attributes; /* path of the model; path of its RVM attribute file, NULL: none */
    const char *output;            /* path of the GLB file that the reader writes */
    const char *folder;
    const struct conversion_params *params;
    /* result of find_encoding(), in memory shared with the child process: name of the encoding; "": names need no conversion */
    char *encoding;
};

/* Runs the built-in reader for RVM or glTF. Called in the child process; returns its exit status: 0, or 1 with the reason on stderr. */
static int read_ourselves(void *arg)
{
    const struct model_reading *reading = arg;
    struct text said = { 0 };
    char why[CONVERSION_WHY_BYTES] = "";
    bool good = reading->format->reader == FORMAT_GLTF
                    ? gltf_pack(reading->path, reading->output, why)
                    : convert_rvm(reading->path, reading->attributes, reading->output, reading->params, &said, why);
    fputs(said.at ? said.at : "", stdout);
    if (!good)
        fprintf(stderr, "%s\n", why);
    return good ? 0 : 1;
}

/* Prints a record for the import's report (format: findings.h) with the number of glTF nodes whose mesh has no triangles. */
static void say_empty_nodes(const struct gltf_model *model)
{
    struct text names = { 0 };
    size_t count = 0;
    for (uint32_t i = 0; i < model->node_count; i++) {
        const struct gltf_node *node = &model->nodes[i];
        const struct gltf_mesh *mesh = node->mesh >= 0 ? &model->meshes[node->mesh] : NULL;
        if (!mesh || mesh->primitive_count > 0)
            continue;
        if (mesh->skipped_lines + mesh->skipped_points == 0)
            printf("lost\t#%u\t%s\tnode\t\tthe node's mesh has no triangles\n", node->number, node->name);
        else if (count++ < MAX_NAMED)
            text_add(&names, "%s%s", count > 1 ? ", " : "", *node->name ? node->name : "a node without a name");
    }
    if (count > 0)
        printf("not shown: %zu nodes that consist only of lines or points: %s%s\n", count, names.at, count > MAX_NAMED ? ", ..." : "");
    text_finish(&names);
}

/* Prints a record for the import's report (format: findings.h) for each node whose triangles have no area. Instances that share
   a node number count as one node. */
static void say_flat_nodes(const struct gltf_model *model)
{
    for (uint32_t i = 0, next; i < model->node_count; i = next) {
        bool shown = false, area = false;
        for (next = i; next < model->node_count && model->nodes[next].number == model->nodes[i].number; next++) {
            const struct gltf_node *node = &model->nodes[next];
            shown |= node->mesh >= 0 && model->meshes[node->mesh].index_count > 0;
            area = area || geometry_node_has_area(model, next);
        }
        if (shown && !area)
            printf("flat\t#%u\t%s\tnode\t\tnone of the node's triangles has an area\n", model->nodes[i].number, model->nodes[i].name);
    }
}

/* Checks the GLB file that a reader wrote; runs in a second child process, because a compromised reader may have written the
 * file. Rejects what plantcast-prep would reject. Returns the child's exit status. */
static int check(void *arg)
{
    const struct model_reading *reading = arg;
    struct model_source source;
    struct gltf_model model;
    char why[MODEL_WHY_BYTES] = "";
    bool good = model_source_open(&source, reading->output, why) && gltf_load(&model, &source, why);
    for (uint32_t i = 0; good && i < model.left_out_textures; i++)
        printf("left out: %s\n", model.left_out[i]);
    if (good && reading->format->reader == FORMAT_GLTF)
        say_empty_nodes(&model);
    if (good)
        say_flat_nodes(&model);
    if (good && model.node_count == 0)
        good = wrong(why, "the model file is empty");
    if (!good)
        fprintf(stderr, "%s\n", why);
    return good ? 0 : 1;
}

static bool run_reading(const struct model_reading *reading, struct child_params *child, struct child_paths *paths, struct text *said,
                        char why[CONVERSION_WHY_BYTES])
{
    char reason[CHILD_WHY_BYTES], *name = mem_printf("the %s reader", reading->format->name);
    child->name = name;
    child->folder = reading->folder;
    child->timeout_s = reading->params->timeout_s;
    child->memory_bytes = reading->params->memory_bytes;
    child->timeout_option = "limit set by --timeout, or by plantcastd --limit import-seconds";
    child->memory_option = "limit set by --memory, or by plantcastd --limit import-megabytes";
    child->role = CONFINE_READER;
    child->paths = paths->at;
    child->path_count = paths->count;
    bool good = child_run(child, said, reason) || fail(why, "%s", reason);
    child_paths_finish(paths);
    mem_free(name);
    return good;
}

/* Unpacks a compressed model to the path from which its reader will read it; runs in a child process. Returns the child's exit status. */
static int unpack_model(void *arg)
{
    const struct model_reading *reading = arg;
    char why[CONVERSION_WHY_BYTES] = "";
    struct text said = { 0 };
    bool good = unpack(reading->path, reading->output, &said, why, sizeof(why));
    fputs(said.at ? said.at : "", stdout);
    if (!good)
        fprintf(stderr, "%s\n", why);
    return good ? 0 : 1;
}

/* Unpacks a compressed model into the folder `beside` of the reading, to a file whose name ends in `ending`. Returns the path, which the
 * caller frees with mem_free, or NULL with the reason in why. */
static char *unpacked(const struct model_reading *packed, const char *ending, struct text *said, char why[CONVERSION_WHY_BYTES])
{
    struct child_paths paths = { 0 };
    char *stem = file_name_stem(packed->path), *path = mem_printf("%s/beside/%s%s", packed->folder, stem, ending);
    struct model_reading unpacking = *packed;
    unpacking.output = path;
    child_paths_add(&paths, packed->path, CONFINE_READ);
    child_paths_add(&paths, packed->folder, CONFINE_WRITE);
    if (!run_reading(packed, &(struct child_params){ .call = unpack_model, .arg = &unpacking }, &paths, said, why)) {
        mem_free(path);
        path = NULL;
    }
    mem_free(stem);
    return path;
}

/* Detects the encoding of the model's names, for readers that cannot do so themselves; runs in a child process. Returns the
 * child's exit status. */
static int find_encoding(void *arg)
{
    const struct model_reading *reading = arg;
    struct text said = { 0 };
    size_t length;
    char *text = text_read_file(reading->path, max_bytes, &length);
    if (!text) {
        fprintf(stderr, "%s\n", strerror(errno));
        return 1;
    }
    struct charset_choice choice = encoding_choose(text, length, reading->params->encoding, "");
    encoding_say(&said, "names", &choice);
    fputs(said.at ? said.at : "", stdout);
    if (!choice.ascii)
        snprintf(reading->encoding, CHARSET_NAME_BYTES, "%s", choice.name);
    return 0;
}

/* Detects the encoding of the model's names in a child process. The child may be compromised, so the result is accepted only if
 * it consists of letters, digits and the punctuation found in names of encodings. */
static bool ask_encoding(const struct model_reading *reading, char encoding[CHARSET_NAME_BYTES], struct text *said,
                         char why[CONVERSION_WHY_BYTES])
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_:.,+";
    struct child_paths paths = { 0 };
    char *shared = mmap(NULL, CHARSET_NAME_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED)
        return fail(why, "%s", strerror(errno));
    struct model_reading asking = *reading;
    asking.encoding = shared;
    child_paths_add(&paths, reading->path, CONFINE_READ);
    bool good = run_reading(reading, &(struct child_params){ .call = find_encoding, .arg = &asking }, &paths, said, why);
    size_t length = strnlen(shared, CHARSET_NAME_BYTES);
    if (good && length > 0 && length < CHARSET_NAME_BYTES) {
        memcpy(encoding, shared, length + 1);
        if (encoding[strspn(encoding, letters)])
            good = fail(why,
                        "the %s reader could not determine the character encoding of names: set --encoding NAME",
                        reading->format->name);
    }
    munmap(shared, CHARSET_NAME_BYTES);
    return good;
}

/* Runs Open CASCADE on the solids of an IFC file that web-ifc cannot build. Open CASCADE writes them to a folder, from which
 * ifc.mjs then reads them. Returns false only if the user interrupted it; if Open CASCADE fails, the model is read without
 * these solids. */
static bool build_curved_solids(const struct model_reading *reading, const char *list, struct text *said, char why[CONVERSION_WHY_BYTES])
{
    char *program = import_format_program(import_format_of("x.step"));
    if (!program) {
        text_add(
            said,
            "this Plantcast was built without Open CASCADE: pipes and curved solids are imported with the coarser shapes of web-ifc\n");
        return true;
    }
    struct child_paths paths = { 0 };
    char *output = mem_printf("%s/solids.glb", reading->folder), *chord = mem_printf("%g", reading->params->chord_m * 1000);
    const char *const argv[] = { program, reading->path, output, chord, list, "-", "-", NULL };
    child_paths_add(&paths, reading->path, CONFINE_READ);
    child_paths_add(&paths, reading->folder, CONFINE_WRITE);
    child_paths_add(&paths, program, CONFINE_EXECUTE);
    bool built = run_reading(reading, &(struct child_params){ .argv = argv }, &paths, said, why);
    bool interrupted = !built && !strcmp(why, "interrupted");
    if (!built && !interrupted)
        text_add(said, "error\t1\tOpen CASCADE: %s; pipes and curved solids are imported with the coarser shapes of web-ifc\n", why);
    mem_free(output);
    mem_free(chord);
    mem_free(program);
    return !interrupted;
}

/* an external reader program, from the table of formats (formats.h) */
struct reader_program {
    char *program, *runtime;           /* paths of the reader and of its interpreter; runtime NULL: the reader is an executable */
    char encoding[CHARSET_NAME_BYTES]; /* encoding of names that is passed to the reader; "-": the reader decides */
};

static bool run_reader(const struct model_reading *reading, const struct reader_program *reader, struct child_paths *paths,
                       struct text *said, char why[CONVERSION_WHY_BYTES])
{
    const struct conversion_params *params = reading->params;
    const char *units = params->units ? params->units : reading->format->unitless ? params->mesh_units : NULL;
    char *chord = mem_printf("%g", params->chord_m * 1000), *memory = mem_printf("--max-old-space-size=%zu", params->memory_bytes >> 20);
    const char *argv[11];
    int count = 0;
    if (reader->runtime) {
        argv[count++] = reader->runtime;
        argv[count++] = memory;
        child_paths_add_folder_of(paths, reader->program, CONFINE_READ);
    }
    child_paths_add(paths, reader->runtime ? reader->runtime : reader->program, CONFINE_EXECUTE);
    const char *const rest[] = { reader->program,           reading->path,                   reading->output, chord,
                                 units ? units : "-", params->up ? params->up : "-", reader->encoding, NULL };
    memcpy(argv + count, rest, sizeof(rest));
    bool good = run_reading(reading, &(struct child_params){ .argv = argv }, paths, said, why);
    mem_free(chord);
    mem_free(memory);
    return good;
}

/* Reads an IFC file with web-ifc. If web-ifc lists elements that it cannot build, Open CASCADE builds them, and web-ifc reads
 * the file again together with the results. */
static bool read_ifc(const struct model_reading *reading, struct reader_program *reader, struct text *said, char why[CONVERSION_WHY_BYTES])
{
    char *list = mem_printf("%s/asked.txt", reading->folder);
    bool good = ask_encoding(reading, reader->encoding, said, why), again = good;
    if (*reading->params->encoding)
        snprintf(reader->encoding, sizeof(reader->encoding), "%s", reading->params->encoding);
    for (int pass = 0; again && pass < 2; pass++) {
        struct text heard = { 0 };
        struct child_paths paths = { 0 };
        child_paths_add(&paths, reading->path, CONFINE_READ);
        child_paths_add(&paths, reading->folder, CONFINE_WRITE);
        why[0] = 0;
        good = build_curved_solids(reading, list, &heard, why) && run_reader(reading, reader, &paths, &heard, why);
        child_paths_finish(&paths);
        again = pass == 0 && strcmp(why, "interrupted") != 0 && access(list, F_OK) == 0;
        if (!again)
            text_add(said, "%s", heard.at ? heard.at : "");
        text_finish(&heard);
    }
    mem_free(list);
    return good;
}

static bool run_program(const struct model_reading *reading, struct child_paths *paths, struct text *said, char why[CONVERSION_WHY_BYTES])
{
    const struct import_format *format = reading->format;
    struct reader_program reader = { import_format_program(format), import_format_runtime(format), "-" };
    bool good;
    if (!reader.program) {
        good = fail(why, "%s is not read: %s", format->name, import_format_missing(format));
    } else if (!strcmp(format->name, "IFC")) {
        good = read_ifc(reading, &reader, said, why);
    } else {
        snprintf(reader.encoding, sizeof(reader.encoding), "%s", *reading->params->encoding ? reading->params->encoding : "-");
        good = run_reader(reading, &reader, paths, said, why);
    }
    child_paths_finish(paths);
    mem_free(reader.program);
    mem_free(reader.runtime);
    return good;
}

/* Moves the reader's output file to `glb`. Rejects anything but a regular file, because a compromised reader may leave a symlink to a file
 * that only the daemon may read. */
static bool take_output(const struct model_reading *reading, const char *glb, struct text *said, char why[CONVERSION_WHY_BYTES])
{
    struct stat st;
    if (lstat(reading->output, &st) != 0)
        return fail(why, "the model could not be read: the %s reader wrote no output file, and gave no reason", reading->format->name);
    if (!S_ISREG(st.st_mode) || st.st_nlink != 1)
        return fail(why, "the model could not be read: the output of the %s reader is not a regular file", reading->format->name);
    struct child_paths paths = { 0 };
    child_paths_add(&paths, reading->output, CONFINE_READ);
    bool good = run_reading(reading, &(struct child_params){ .call = check, .arg = (void *)(uintptr_t)reading }, &paths, said, why);
    if (good && rename(reading->output, glb) != 0)
        good = fail(why, "%s", strerror(errno));
    return good;
}

static bool read_model(const struct import_format *format, const char *path, const char *glb, const char *folder,
                       const struct conversion_params *params, struct text *said, char why[CONVERSION_WHY_BYTES])
{
    /* each reader runs in a separate folder, so that a compromised reader cannot replace models that were read earlier */
    char *own = mem_printf("%s/reading", folder), *output = mem_printf("%s/output.glb", own), *input = realpath(path, NULL);
    char *beside = mem_printf("%s/beside", own); /* unpacked model, and links to the files next to the original */
    bool made = mkdir(own, 0700) == 0 && mkdir(beside, 0700) == 0;
    char *attributes = input && format->reader == FORMAT_RVM ? attributes_beside(input) : NULL;
    struct model_reading reading = {
        .format = format, .path = input, .attributes = attributes, .output = output, .folder = own, .params = params
    };
    struct child_params ourselves = { .call = read_ourselves, .arg = &reading };
    struct child_paths paths = { 0 };
    bool good = made && input;
    if (!good)
        fail(why, "%s", strerror(errno));
    char *ending = good ? unpack_ending(input) : NULL, *inner = ending ? unpacked(&reading, ending, said, why) : NULL;
    good = good && (inner || !ending);
    if (inner)
        reading.path = inner;
    child_paths_add(&paths, inner ? inner : input, CONFINE_READ);
    child_paths_add(&paths, attributes, CONFINE_READ);
    child_paths_add(&paths, own, CONFINE_WRITE);
    if (good && format->beside) {
        child_paths_add_beside(&paths, input, format->beside);
        if (format->linked || inner)
            child_paths_link_beside(beside, input, format->beside); /* after unpacking, which would write through a link of the same name */
    }
    if (good)
        good = format->reader == FORMAT_PROGRAM ? run_program(&reading, &paths, said, why)
                                                : run_reading(&reading, &ourselves, &paths, said, why);
    good = good && take_output(&reading, glb, said, why);
    child_paths_finish(&paths);
    plant_folder_remove(own);
    free(input);
    mem_free(own);
    mem_free(beside);
    mem_free(inner);
    mem_free(ending);
    mem_free(output);
    mem_free(attributes);
    return good;
}

bool conversion_run(const char *path, const char *glb, const char *folder, const struct conversion_params *params, struct text *said,
                    char why[CONVERSION_WHY_BYTES])
{
    const struct import_format *format = import_format_of(path);
    struct stat st;
    if (stat(path, &st) != 0)
        return fail(why, "%s", strerror(errno));
    if (!S_ISREG(st.st_mode))
        return fail(why, "the model is not a regular file");
    const char *dot = strrchr(path, '.');
    if (!format && dot && !strcasecmp(dot, ".ifcxml"))
        return fail(why, FORMAT_IFC_XML);
    if (!format)
        return fail(why, "unknown file ending: `plantcast import --formats` prints the known ones; `convert` in the plant file runs your "
                         "own converter (PLANT.md)");
    if (params->units && !format->unitless)
        return fail(why, "%s files state their own units: leave out --units", format->name);
    if (params->up && !format->upless)
        return fail(why, "%s files state their own up axis: leave out --up", format->name);
    return read_model(format, path, glb, folder, params, said, why);
}
