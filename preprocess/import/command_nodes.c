/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast nodes`: lists the nodes of a model, before or after its import. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/import/commands.h"
#include "preprocess/import/findings.h"
#include "preprocess/import/formats.h"
#include "preprocess/import/node_list.h"
#include "preprocess/import/options.h"
#include "preprocess/child/work_folder.h"

static void print_usage(FILE *out)
{
    fputs("usage: plantcast nodes MODEL [--grep RE] [--tree N] [--json]\n"
          "\n"
          "Lists the nodes (parts) of a CAD model.\n"
          "Prints for each node its index, triangle count, size, centre (Z up), path and properties.\n"
          "Triangle count, size and centre include the node's children.\n"
          "The first lines of the output state the node count, the model's size and its distance from the origin.\n"
          "Guessed units and axes, lost parts and errors are printed to standard error.\n"
          "A node without a name is listed under the name of its mesh, or else under its index.\n"
          "A plant file can also select a node by its index (nodes: \"#12\").\n"
          "  --grep RE         list only nodes whose path or properties match RE (extended, ignoring case)\n"
          "  --tree N          list only the first N levels of the hierarchy, indented\n"
          "  --json            print the list as JSON\n",
          out);
    options_print(out);
    fputs("Exit status: 0 success, 1 the model could not be read, 2 wrong usage, 3 no node matched.\n", out);
}

/* Reads the outline (nodes, sizes) of a model. glTF is read directly; other formats are first converted to GLB, as by
 * `plantcast import`. *guessed_m receives the length in metres of a unit that the reader assumed, or 0. */
static bool read_model(const char *path, const struct conversion_params *params, struct model_outline *outline, double *guessed_m)
{
    const struct import_format *format = import_format_of(path);
    char why[CONVERSION_WHY_BYTES] = "";
    struct text said = { 0 };
    struct work_folder work = { 0 };
    bool good;
    if (format && format->reader == FORMAT_GLTF) {
        good = model_outline_read(outline, path, why, sizeof(why));
    } else {
        int status = work_folder_begin(&work, NULL);
        char *glb = mem_printf("%s/model.glb", work.path ? work.path : "");
        if (status != 0)
            snprintf(why, sizeof(why), "%s", strerror(-status));
        good =
            status == 0 && conversion_run(path, glb, work.path, params, &said, why) && model_outline_read(outline, glb, why, sizeof(why));
        mem_free(glb);
        if (status == 0)
            work_folder_end(&work, false);
    }
    if (!good)
        fprintf(stderr, "plantcast nodes: %s: %s\n", path, why);
    struct text plain = { 0 };
    json_t *findings = findings_read(path, said.at ? said.at : "", NULL, &plain);
    *guessed_m = findings_guessed_m(findings);
    if (good)
        findings_print(path, plain.at, stderr);
    json_decref(findings);
    text_finish(&plain);
    text_finish(&said);
    return good;
}

int command_nodes(int argc, char **argv)
{
    static const struct option options[] = { { "grep", required_argument, NULL, 'g' },
                                             { "tree", required_argument, NULL, 'T' },
                                             { "json", no_argument, NULL, 'j' },
                                             OPTIONS_OF_CONVERSION,
                                             { 0 } };
    struct conversion_params params = options_default;
    struct node_list_params list = { 0 };
    struct model_outline outline;
    regex_t grep;
    char *end;
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;)
        switch (option) {
        case 'g':
            if (list.grep || regcomp(&grep, optarg, REG_EXTENDED | REG_NOSUB | REG_ICASE) != 0) {
                fprintf(stderr, "plantcast nodes: --grep %s: expected one valid extended regular expression\n", optarg);
                return 2;
            }
            list.grep = &grep;
            break;
        case 'T':
            list.levels = (int)strtol(optarg, &end, 10);
            if (*end || list.levels < 1) {
                fprintf(stderr, "plantcast nodes: --tree %s: expected a number of levels, at least 1\n", optarg);
                return 2;
            }
            break;
        case 'j': list.json = true; break;
        case 'F': import_formats_print(stdout); return 0;
        case 'h': print_usage(stdout); return 0;
        default:
            if (!options_take(&params, "nodes", option, optarg))
                return 2;
        }
    if (argc - optind != 1) {
        print_usage(stderr);
        return 2;
    }
    if (!read_model(argv[optind], &params, &outline, &list.guessed_m))
        return 1;
    size_t found = node_list_print(&outline, &list, stdout);
    model_outline_finish(&outline);
    if (list.grep)
        regfree(&grep);
    return found > 0 ? 0 : 3;
}
