/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-import`: CAD exports as one GLB file each, with names, hierarchy and attributes. `plantcast import` runs it. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "base/text.h"
#include "preprocess/import/cad_attributes.h"
#include "preprocess/import/cad_glb.h"
#include "preprocess/import/plant_draft.h"
#include "preprocess/import/rvm.h"

static const size_t max_bytes = (size_t)4 << 30;
static const double default_chord_mm = 1;

struct params {
    const char *folder, *name;
    double chord_m;
};

static void print_usage(FILE *out)
{
    fprintf(
        out,
        "usage: plantcast import MODEL... -o FOLDER [--name NAME] [--chord MM]\n"
        "\n"
        "Reads CAD exports and writes into FOLDER a GLB file for each, with names, hierarchy and attributes, and plant.yaml, which names\n"
        "them. What is there already of plant.yaml stays as it is.\n"
        "  MODEL        .rvm (AVEVA PDMS, E3D, Marine), with its attributes beside it as .att or .txt of the same name; .glb or .gltf as "
        "it is\n"
        "  --name NAME  of the plant; else the first model's file name\n"
        "  --chord MM   how far a triangle may be from a round surface (%g)\n"
        "Exit status: 0 good, 1 a model could not be read (nothing is written for any of them), 2 usage.\n",
        default_chord_mm);
}

static int fail_at(const char *path, const char *why)
{
    fprintf(stderr, "plantcast import: %s: %s\n", path, why);
    return 1;
}

static char *with_ending(const char *path, const char *ending)
{
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    size_t stem = dot && (!slash || dot > slash) ? (size_t)(dot - path) : strlen(path);
    return mem_printf("%.*s%s", (int)stem, path, ending);
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Looks beside the model for its attributes. Returns their path, or NULL; the caller frees it. */
static char *attributes_beside(const char *path)
{
    static const char *const endings[] = { ".att", ".ATT", ".txt", ".TXT" };
    for (size_t i = 0; i < sizeof(endings) / sizeof(endings[0]); i++) {
        char *beside = with_ending(path, endings[i]);
        struct stat st;
        if (stat(beside, &st) == 0 && S_ISREG(st.st_mode))
            return beside;
        mem_free(beside);
    }
    return NULL;
}

/* Returns NULL on failure, already printed; free with mem_free. */
static char *read_whole(const char *path, size_t *length)
{
    char *bytes = text_read_file(path, max_bytes, length);
    if (!bytes)
        fail_at(path, strerror(errno));
    return bytes;
}

static bool add_attributes(struct cad_model *model, const char *path)
{
    struct attribute_counts counts;
    size_t length;
    char why[256];
    char *text = read_whole(path, &length);
    if (!text)
        return false;
    bool good = cad_attributes_read(model, text, length, &counts, why, sizeof(why));
    mem_free(text);
    if (!good)
        fail_at(path, why);
    else
        printf("%s: %zu elements, %zu of them in the model; %zu attributes%s\n", path, counts.elements, counts.matched, counts.attributes,
               counts.not_utf8 > 0 ? "; read as Latin-1 where it is not UTF-8" : "");
    return good;
}

static void print_model(const char *path, const struct cad_model *model, const struct rvm_counts *counts)
{
    size_t triangles = 0, unnamed = 0;
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t i = 0; i < model->node_count; i++) {
        const struct cad_node *node = &model->nodes[i];
        triangles += node->triangle_count;
        unnamed += node->name[0] == 0;
        for (size_t v = 0; v < node->vertex_count; v++)
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = fmin(low[axis], node->vertices[v].position_m[axis]);
                high[axis] = fmax(high[axis], node->vertices[v].position_m[axis]);
            }
    }
    printf("%s: %zu nodes, %zu unnamed; %zu primitives, %zu triangles", path, model->node_count, unnamed, counts->primitives, triangles);
    if (triangles > 0) {
        double middle = hypot(hypot((low[0] + high[0]) / 2, (low[1] + high[1]) / 2), (low[2] + high[2]) / 2);
        printf("; %.1f x %.1f x %.1f m, %.0f m from the origin", high[0] - low[0], high[1] - low[1], high[2] - low[2], middle);
    }
    printf("\n");
    const struct {
        size_t count;
        const char *what;
    } left_out[] = { { counts->empty, "primitives without extent" },
                     { counts->obstructions, "obstruction volumes" },
                     { counts->insulations, "insulation volumes" },
                     { counts->unknown_kinds, "primitives of an unknown kind" },
                     { counts->unknown_chunks, "unknown chunks" } };
    for (size_t i = 0; i < sizeof(left_out) / sizeof(left_out[0]); i++)
        if (left_out[i].count > 0)
            printf("%s: left out: %zu %s\n", path, left_out[i].count, left_out[i].what);
}

static struct cad_model *read_rvm(const char *path, const struct params *params)
{
    struct rvm_counts counts;
    size_t length;
    char why[256];
    char *bytes = read_whole(path, &length);
    if (!bytes)
        return NULL;
    struct cad_model *model = cad_model_create();
    bool good = rvm_read(model, bytes, length, params->chord_m, &counts, why, sizeof(why));
    mem_free(bytes);
    if (!good)
        fail_at(path, why);
    else
        print_model(path, model, &counts);
    char *attributes = good ? attributes_beside(path) : NULL;
    if (!good || (attributes && !add_attributes(model, attributes)))
        cad_model_destroy(&model);
    mem_free(attributes);
    return model;
}

static int write_all(const struct params *params, char **paths, struct cad_model **models, int count)
{
    int status = 0;
    struct plant_draft draft = { .name = params->name, .folder = params->folder, .count = (size_t)count };
    if (mkdir(params->folder, 0777) != 0 && errno != EEXIST)
        return fail_at(params->folder, strerror(errno));
    draft.models = mem_array((size_t)count, sizeof(*draft.models));
    for (int i = 0; i < count && status == 0; i++) {
        char *file = with_ending(base_name(paths[i]), ".glb"), *stem = with_ending(base_name(paths[i]), "");
        char *path = mem_printf("%s/%s", params->folder, file);
        int error = cad_glb_write(models[i], stem, path);
        draft.models[i] = (struct plant_draft_model){ file, models[i] };
        if (error != 0)
            status = fail_at(path, strerror(-error));
        mem_free(path);
        mem_free(stem);
    }
    if (status == 0)
        status = plant_draft_write(&draft) == 0 ? 0 : fail_at(params->folder, strerror(errno));
    for (int i = 0; i < count; i++)
        mem_free(draft.models[i].file);
    mem_free(draft.models);
    return status;
}

/* Their GLB files would have one name. */
static bool two_alike(char **paths, int count)
{
    bool alike = false;
    for (int i = 0; i < count && !alike; i++)
        for (int k = 0; k < i && !alike; k++) {
            char *first = with_ending(base_name(paths[k]), ".glb"), *second = with_ending(base_name(paths[i]), ".glb");
            alike = !strcmp(first, second);
            if (alike)
                fprintf(stderr, "plantcast import: %s and %s would both be %s; rename one of them\n", paths[k], paths[i], first);
            mem_free(first);
            mem_free(second);
        }
    return alike;
}

int main(int argc, char **argv)
{
    static const struct option options[] = { { "output", required_argument, NULL, 'o' },
                                             { "name", required_argument, NULL, 'n' },
                                             { "chord", required_argument, NULL, 'c' },
                                             { "help", no_argument, NULL, 'h' },
                                             { 0 } };
    struct params params = { .chord_m = default_chord_mm / 1000 };
    for (int option; (option = getopt_long(argc, argv, "o:", options, NULL)) != -1;) {
        char *end;
        switch (option) {
        case 'o': params.folder = optarg; break;
        case 'n': params.name = optarg; break;
        case 'c':
            params.chord_m = strtod(optarg, &end) / 1000;
            if (*end || !(params.chord_m >= 1e-5 && params.chord_m <= 1)) {
                fprintf(stderr, "plantcast import: --chord %s: 0.01 to 1000 (mm)\n", optarg);
                return 2;
            }
            break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    }
    int count = argc - optind, status = 0;
    if (count < 1 || !params.folder) {
        print_usage(stderr);
        return 2;
    }
    if (two_alike(argv + optind, count))
        return 1;
    char *stem = with_ending(base_name(argv[optind]), "");
    params.name = params.name ? params.name : stem;
    struct cad_model **models = mem_array((size_t)count, sizeof(struct cad_model *));
    for (int i = 0; i < count; i++) {
        models[i] = read_rvm(argv[optind + i], &params);
        status = models[i] ? status : 1;
    }
    if (status == 0)
        status = write_all(&params, argv + optind, models, count);
    for (int i = 0; i < count; i++)
        cad_model_destroy(&models[i]);
    mem_free(models);
    mem_free(stem);
    return status;
}
