/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements `plantcast import`: converts models in a work folder, and moves the successfully converted ones to the plant's folder. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/system/confine.h"
#include "base/text/json_text.h"
#include "base/mem.h"
#include "preprocess/import/commands.h"
#include "preprocess/import/file_name.h"
#include "preprocess/import/findings.h"
#include "preprocess/import/formats.h"
#include "preprocess/import/import_fail.h"
#include "preprocess/import/options.h"
#include "preprocess/import/plant_draft.h"
#include "preprocess/import/revision/anew.h"
#include "preprocess/import/serve.h"
#include "preprocess/child/work_folder.h"
#include "preprocess/match/file_set.h"

enum { RVM_ITEM_LEVEL = 3 }; /* tree level of an RVM file whose nodes are equipment: file (0), sites, zones, equipment (3) */

struct import_command {
    const char *folder, *name;
    const char *report; /* path of the JSON file for the readers' findings (findings.h); NULL: none */
    bool undo, force, dry_run;
    int lent; /* descriptor of a folder lock held by the parent process (plant_folder.h); 0: none */
    struct conversion_params conversion;
    struct work_folder work;
    char **paths;
    json_t *findings; /* array of findings_read() results (findings.h), one per model read */
    struct plant_draft_model *models;
    /* count: number of models to convert, later number of converted models (the length of `models`); unread: number of models
     * whose conversion failed */
    int count, unread;
    bool anew, interrupted;
};
enum { EXIT_PARTLY = 3 };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast import MODEL... -o FOLDER [--name NAME] [--dry-run] [--anew]\n"
          "       plantcast import --undo [--force] -o FOLDER\n"
          "       plantcast import --serve [--port N] [MODEL... TAGS] -o FOLDER\n"
          "\n"
          "Converts CAD exports to GLB models with names, hierarchy and attributes, and writes a plant.yaml for them.\n"
          "If FOLDER contains a plant already, the exports are imported as a new revision of that plant:\n"
          "the import finds the plant's assets and sensors in the new geometry.\n"
          "review.csv then lists what was added, removed, moved or renamed, and which tags lost their position.\n"
          "\n"
          "  MODEL             CAD export, in one of these formats:\n"
          "                    glTF (.glb .gltf), STEP (.step .stp .p21 .stpz), IGES (.iges .igs), IFC (.ifc .ifczip),\n"
          "                    meshes (.obj .stl .ply .fbx .dae .zae .3ds), RVM of AVEVA PDMS, E3D or Marine (.rvm;\n"
          "                    its attributes are in a file of the same name with the ending .att or .txt)\n"
          "                    Files of all formats but glTF may be compressed with gzip (.stp.gz)\n"
          "  --name NAME       name of the plant (default: file name of the first model)\n"
          "  --dry-run         print what a new revision would change, and change nothing\n"
          "  --undo            undo the last import: restore the previous models, plant file, tag list and matches\n"
          "  --force           with --undo: undo even if files were edited since the import; edited files are kept as\n"
          "                    NAME.undone\n"
          "  --anew            write a new plant.yaml and tags.csv; the old files are kept as NAME.1, NAME.2, ...\n"
          "  --report FILE     write a JSON report of lost, omitted, guessed and wrong parts to FILE (IMPORT.md)\n"
          "  --serve           serve a web page on this machine for uploading models and tag lists, matching tags\n"
          "                    and placing sensors\n"
          "  --port N          TCP port of the web page, with --serve (default: 8080)\n",
          out);
    options_print(out);
    fputs("Exit status: 0 success, 1 nothing imported, 2 wrong usage, 3 imported without the models that could not be read.\n",
          out);
}

/* Reads the outline (nodes, sizes) of a converted model, leaving out triangles of nodes without area, because plantcast-prep
 * rejects such nodes. said: output of the reader that converted the model. Returns false with the reason in why; there is then
 * no outline to free. Rejects a model without triangles, because it would give a plant without assets. */
static bool read_outline(struct model_outline *outline, const char *glb, const char *said, char why[CONVERSION_WHY_BYTES])
{
    if (!model_outline_read(outline, glb, why, CONVERSION_WHY_BYTES))
        return false;
    size_t count = json_array_size(json_object_get(outline->header.json, "nodes"));
    bool *flat = mem_array(count + 1, sizeof(*flat));
    findings_flat_nodes(said, flat, count);
    model_outline_leave_out(outline, flat);
    mem_free(flat);
    if (outline->triangles > 0)
        return true;
    model_outline_finish(outline);
    snprintf(why, CONVERSION_WHY_BYTES,
             "the model has no triangles with an area, so there is nothing to show: export surfaces, not only lines and points");
    return false;
}

/* Converts one model file to GLB. On success appends it to import->models. */
static void convert(struct import_command *import, const char *path)
{
    int number = import->count;
    struct plant_draft_model *model = &import->models[number];
    const struct import_format *format = import_format_of(path);
    char why[CONVERSION_WHY_BYTES] = "", *glb = mem_printf("%s/%d.glb", import->work.path, number), *stem = file_name_stem(path);
    struct text said = { 0 };
    bool good = conversion_run(path, glb, import->work.path, &import->conversion, &said, why) &&
                read_outline(&model->outline, glb, said.at ? said.at : "", why);
    struct text plain = { 0 };
    const char *slash = strrchr(path, '/');
    json_t *findings = findings_read(slash ? slash + 1 : path, said.at ? said.at : "", good ? NULL : why, &plain);
    json_array_append_new(import->findings, findings);
    if (good) {
        model->file = mem_printf("%s.glb", stem);
        if (format->reader == FORMAT_GLTF) {
            model->units = import->conversion.units;
            model->up = import->conversion.up;
        }
        model->item_level = format->reader == FORMAT_RVM ? RVM_ITEM_LEVEL : 0;
        struct text summary = { 0 };
        model_outline_summary(&model->outline, findings_guessed_m(findings), &summary);
        findings_print(path, summary.at, stdout);
        findings_print(path, plain.at, stdout);
        text_finish(&summary);
        import->count++;
    } else {
        model_outline_finish(&model->outline);
        *model = (struct plant_draft_model){ 0 };
        import_fail(path, why);
        import->unread++;
        import->interrupted = work_folder_interrupted() || !strcmp(why, "interrupted");
    }
    text_finish(&plain);
    text_finish(&said);
    mem_free(stem);
    mem_free(glb);
}

enum found_plant { NO_PLANT, BEGUN_PLANT /* an empty plant, as `plantcast import --serve` writes it */, WHOLE_PLANT };

static enum found_plant find_plant(const struct import_command *import)
{
    char *plant = mem_printf("%s/plant.yaml", import->folder);
    enum found_plant found = plant_draft_is_begun(plant) ? BEGUN_PLANT : access(plant, F_OK) == 0 ? WHOLE_PLANT : NO_PLANT;
    mem_free(plant);
    return found;
}

/* Converts all models. If a model fails, the plant keeps its current copy of that model. With `--anew`, any failure fails the
 * import, because the plant would lose the model's assets. */
static int convert_all(struct import_command *import)
{
    int count = import->count;
    import->count = 0;
    for (int i = 0; i < count && !import->interrupted; i++)
        convert(import, import->paths[i]);
    if (import->interrupted || work_folder_interrupted())
        return import_fail(import->folder, "interrupted");
    if (import->unread > 0 && (import->count == 0 || (import->anew && find_plant(import) == WHOLE_PLANT))) {
        if (import->count > 0)
            import_fail(import->folder, "nothing was imported: --anew needs all models of the plant, and some could not be read");
        return 1;
    }
    if (import->unread > 0)
        fprintf(stderr, "plantcast import: %d of %d models could not be read; all other models are imported\n", import->unread, count);
    return 0;
}

/* Writes the JSON file of the readers' findings (lost shapes, errors). A write error does not fail the import, because the
 * plant does not need this file. */
static void write_report(const struct import_command *import)
{
    char *text = json_text(json_pack("{s:O}", "models", import->findings), 0);
    int status = import->report ? atomic_file_put(import->report, text, strlen(text)) : 0;
    if (status != 0)
        fprintf(stderr, "plantcast import: warning: %s: %s\n", import->report, strerror(-status));
    mem_free(text);
}

/* Keeps a file that an import without a plant would replace, as PATH.1, or PATH.2 if PATH.1 exists, and so on. Returns an exit status. */
static int keep_old(const char *path)
{
    struct stat old, unused;
    char *kept = NULL;
    if (lstat(path, &old) != 0)
        return 0;
    for (int i = 1; !kept || lstat(kept, &unused) == 0; i++) {
        mem_free(kept);
        kept = mem_printf("%s.%d", path, i);
    }
    int status = rename(path, kept) == 0 ? 0 : import_fail(path, strerror(errno));
    if (status == 0)
        printf("%s: the previous file is kept as %s\n", path, kept);
    mem_free(kept);
    return status;
}

static int move_all(const struct import_command *import)
{
    int status = 0;
    for (int i = 0; i < import->count && status == 0; i++) {
        char *from = mem_printf("%s/%d.glb", import->work.path, i), *to = mem_printf("%s/%s", import->folder, import->models[i].file);
        status = keep_old(to);
        if (status == 0 && rename(from, to) != 0)
            status = import_fail(to, strerror(errno));
        mem_free(from);
        mem_free(to);
    }
    return status;
}

static int bring_in(const struct import_command *import)
{
    const struct plant_draft draft = {
        .name = import->name, .folder = import->folder, .models = import->models, .count = (size_t)import->count, .anew = import->anew
    };
    const struct revise_params params = { .folder = import->folder,
                                          .work = import->work.path,
                                          .models = import->models,
                                          .count = (size_t)import->count,
                                          .dry_run = import->dry_run };
    enum found_plant found = find_plant(import);
    if (found == WHOLE_PLANT && !import->anew)
        return revise(&params);
    if (import->dry_run)
        return import_fail(import->folder, "this folder contains no plant to compare with: leave out --dry-run");
    if (import->anew || found == BEGUN_PLANT)
        return import_anew(&params, &draft);
    int status = move_all(import);
    return status == 0 && plant_draft_write(&draft) == 0 ? 0 : 1;
}

static int run_import(struct import_command *import)
{
    int status = work_folder_begin(&import->work, import->folder);
    if (status != 0)
        return import_fail(import->folder, strerror(-status));
    char *why = NULL;
    int lock = file_set_lock(
        &(struct plant_folder_params){ .folder = import->folder, .own = import->work.path, .lent = import->lent }, &why);
    if (lock < 0)
        status = import_fail(import->folder, why);
    /* Creates the work folder again if it is missing: the previous lock holder may have deleted it as a leftover of a dead
       process. EEXIST, the usual case, is no error. */
    else if (mkdir(import->work.path, 0700) != 0 && errno != EEXIST)
        status = import_fail(import->work.path, strerror(errno));
    mem_free(why);
    import->findings = json_array();
    import->models = mem_array((size_t)import->count, sizeof(*import->models));
    if (status == 0)
        status = convert_all(import);
    write_report(import);
    json_decref(import->findings);
    if (status == 0)
        status = bring_in(import);
    for (int i = 0; i < import->count; i++) {
        mem_free(import->models[i].file);
        model_outline_finish(&import->models[i].outline);
    }
    mem_free(import->models);
    work_folder_end(&import->work, status == 0);
    if (lock >= 0)
        close(lock);
    return status == 0 && import->unread > 0 ? EXIT_PARTLY : status;
}

/* Returns whether two models have the same file name without extension, so that their GLB files would have the same name. */
static bool two_alike(char **paths, int count)
{
    bool alike = false;
    for (int i = 0; i < count && !alike; i++)
        for (int k = 0; k < i && !alike; k++) {
            char *first = file_name_stem(paths[k]), *second = file_name_stem(paths[i]);
            alike = !strcmp(first, second);
            if (alike)
                fprintf(stderr, "plantcast import: %s and %s would both be written as %s.glb: rename one of these files\n", paths[k],
                        paths[i], first);
            mem_free(first);
            mem_free(second);
        }
    return alike;
}

int command_import(int argc, char **argv)
{
    static const struct option options[] = { { "output", required_argument, NULL, 'o' },
                                             { "name", required_argument, NULL, 'n' },
                                             { "dry-run", no_argument, NULL, 'd' },
                                             { "undo", no_argument, NULL, 'x' },
                                             { "force", no_argument, NULL, 'f' },
                                             { "anew", no_argument, NULL, 'a' },
                                             { "serve", no_argument, NULL, 's' },
                                             { "port", required_argument, NULL, 'p' },
                                             { "report", required_argument, NULL, 'r' },
                                             { "folder-lent", required_argument, NULL, 'l' },
                                             OPTIONS_OF_CONVERSION,
                                             { 0 } };
    struct import_command import = { .conversion = options_default };
    struct serve_params serve = { .port = "8080" };
    bool serves = false;
    for (int option; (option = getopt_long(argc, argv, "o:", options, NULL)) != -1;)
        switch (option) {
        case 'o': import.folder = optarg; break;
        case 'n': import.name = optarg; break;
        case 'd': import.dry_run = true; break;
        case 'x': import.undo = true; break;
        case 'f': import.force = true; break;
        case 'a': import.anew = true; break;
        case 's': serves = true; break;
        case 'l': import.lent = atoi(optarg); break;
        case 'r': import.report = optarg; break;
        case 'p': serve.port = optarg; break;
        case 'F': import_formats_print(stdout); return 0;
        case 'h': print_usage(stdout); return 0;
        default:
            if (!options_take(&import.conversion, "import", option, optarg))
                return 2;
        }
    import.count = argc - optind;
    import.paths = argv + optind;
    if (serves && import.folder) {
        serve.folder = import.folder;
        serve.files = import.paths;
        serve.count = import.count;
        return import_serve(&serve);
    }
    if ((import.count < 1) != import.undo || !import.folder || (import.force && !import.undo) || (import.dry_run && import.undo)) {
        print_usage(stderr);
        return 2;
    }
    if (import.undo)
        return revise_undo(import.folder, import.force, import.lent);
    if (two_alike(import.paths, import.count))
        return 1;
    char *stem = file_name_stem(import.paths[0]), lacks[CONFINE_LACKS_BYTES];
    if (confine_lacks(lacks))
        fprintf(stderr, "plantcast import: warning: this kernel has %s\n", lacks);
    import.name = import.name ? import.name : stem;
    int status = run_import(&import);
    mem_free(stem);
    return status;
}
