/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Our own reader for RVM, a copy of what is glTF, another program for the rest. */
#include "preprocess/import/conversion.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "preprocess/child/child.h"
#include "preprocess/import/cad_attributes.h"
#include "preprocess/import/cad_glb.h"
#include "preprocess/import/encoding.h"
#include "preprocess/import/file_name.h"
#include "preprocess/import/formats.h"
#include "preprocess/import/gltf_pack.h"
#include "preprocess/import/rvm.h"

static const size_t max_bytes = (size_t)4 << 30;

/* Returns false, so that callers can return it. */
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

/* Looks beside the model for its attributes. Returns their path, or NULL; the caller frees it. */
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
        return fail(why, "%s: no elements (NEW ... END): this is no attribute file; give one of the two another name", path);
    text_add(said, "attributes of %s: %zu elements, %zu of them in the model; %zu values\n", path, counts.elements, counts.matched,
             counts.attributes);
    encoding_say(said, "attributes", &counts.encoding);
    return true;
}

static void say_counts(struct text *said, const struct rvm_counts *counts)
{
    const struct {
        size_t count;
        const char *what;
    } left_out[] = { { counts->empty, "primitives without extent, or with numbers that are not finite" },
                     { counts->obstructions, "obstruction volumes" },
                     { counts->insulations, "insulation volumes" },
                     { counts->unknown_kinds, "primitives of an unknown kind" },
                     { counts->unknown_chunks, "unknown chunks" } };
    text_add(said, "%zu primitives\n", counts->primitives);
    if (counts->covered_faces > 0)
        text_add(said, "left out: %zu faces, %.1f m2, that lie on a neighbour's face and cannot be seen (--keep-covered keeps them)\n",
                 counts->covered_faces, counts->covered_m2);
    for (size_t i = 0; i < sizeof(left_out) / sizeof(left_out[0]); i++)
        if (left_out[i].count > 0)
            text_add(said, "left out: %zu %s\n", left_out[i].count, left_out[i].what);
}

static bool convert_rvm(const char *path, const char *glb, const struct conversion_params *params, struct text *said,
                        char why[CONVERSION_WHY_BYTES])
{
    struct rvm_counts counts;
    size_t length;
    char *bytes = text_read_file(path, max_bytes, &length);
    if (!bytes)
        return fail(why, "%s", strerror(errno));
    const struct rvm_params how = { .chord_m = params->chord_m, .keep_covered = params->keep_covered, .encoding = params->encoding };
    struct cad_model *model = cad_model_create();
    char *attributes = attributes_beside(path), *stem = file_name_stem(path);
    bool good = rvm_read(model, bytes, length, &how, &counts, why, CONVERSION_WHY_BYTES);
    mem_free(bytes);
    if (good && counts.primitives > 0 && counts.empty == counts.primitives)
        good = fail(why, "none of its %zu primitives can be shown: they have no extent, or numbers that are not finite", counts.primitives);
    if (good) {
        say_counts(said, &counts);
        encoding_say(said, "names", &counts.encoding);
    }
    if (good && attributes) {
        const struct attribute_params read = { .encoding = params->encoding,
                                               .model_encoding = counts.encoding.ascii ? "" : counts.encoding.name };
        good = add_attributes(model, attributes, &read, said, why);
    }
    int status = good ? cad_glb_write(model, stem, glb) : 0;
    if (status != 0)
        good = fail(why, status == -EFBIG ? "a GLB file holds at most 4 GiB: export the plant in parts" : "%s", strerror(-status));
    mem_free(attributes);
    mem_free(stem);
    cad_model_destroy(&model);
    return good;
}

/* --- other programs ------------------------------------------------------------------------------------------------------------------- */

/* For readers that cannot find it themselves. Returns false with errno if the file cannot be read. */
static bool find_encoding(const char *path, const char *asked, char encoding[CHARSET_NAME_BYTES], struct text *said)
{
    size_t length;
    char *text = text_read_file(path, max_bytes, &length);
    if (!text)
        return false;
    struct charset_choice choice = encoding_choose(text, length, asked, "");
    mem_free(text);
    encoding_say(said, "names", &choice);
    if (!choice.ascii)
        snprintf(encoding, CHARSET_NAME_BYTES, "%s", choice.name);
    return true;
}

static bool convert_by_program(const struct import_format *format, const char *path, const char *glb, const char *folder,
                               const struct conversion_params *params, struct text *said, char why[CONVERSION_WHY_BYTES])
{
    char *program = import_format_program(format), encoding[CHARSET_NAME_BYTES] = "-";
    if (!strcmp(format->name, "IFC") && !find_encoding(path, params->encoding, encoding, said))
        return fail(why, "%s", strerror(errno));
    if (params->encoding)
        snprintf(encoding, sizeof(encoding), "%s", params->encoding);
    if (!program)
        return fail(why, "%s is not read: %s", format->name, format->missing);
    char *chord = mem_printf("%g", params->chord_m * 1000), *memory = mem_printf("--max-old-space-size=%zu", params->memory_bytes >> 20);
    char *input = realpath(path, NULL), *output = mem_printf("%s/output.glb", folder);
    const char *argv[11];
    int count = 0;
    if (format->runtime) {
        argv[count++] = format->runtime;
        argv[count++] = memory;
    }
    const char *const rest[] = { program, input, output, chord, params->units ? params->units : "-", params->up ? params->up : "-",
                                 encoding, NULL };
    memcpy(argv + count, rest, sizeof(rest));
    const struct child_params child = {
        .argv = argv, .folder = folder, .timeout_s = params->timeout_s, .memory_bytes = params->memory_bytes
    };
    char reason[CHILD_WHY_BYTES];
    bool good = input ? child_run(&child, said, reason) || fail(why, "%s", reason) : fail(why, "%s", strerror(errno));
    if (good && rename(output, glb) != 0)
        good = fail(why, "its reader wrote nothing");
    free(input);
    mem_free(output);
    mem_free(chord);
    mem_free(memory);
    mem_free(program);
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
        return fail(why, "it is no file");
    if (!format)
        return fail(why, "its ending is none that import reads (plantcast import --formats); `convert` in the plant file (PLANT.md) runs a "
                         "program of yours");
    if (params->units && !format->unitless)
        return fail(why, "%s says itself what its units are: leave out --units", format->name);
    if (params->up && !format->upless)
        return fail(why, "%s says itself which axis is up: leave out --up", format->name);
    switch (format->reader) {
    case FORMAT_RVM: return convert_rvm(path, glb, params, said, why);
    case FORMAT_GLTF: return gltf_pack(path, glb, why);
    default: return convert_by_program(format, path, glb, folder, params, said, why);
    }
}
