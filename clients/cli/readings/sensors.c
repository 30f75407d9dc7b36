/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast sensors suggest`: proposes where more sensors would help most. `drift` is in sensors_drift.c, `accept` in sensors_accept.c. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "clients/cli/commands.h"
#include "placing/sensor_suggest.h"
#include "plant/influence.h"
#include "plant/plant.h"
#include "scene/scene_create.h"

enum { MAX_ADDED = 100 };

struct suggest_options {
    const char *plant, *group, *asset, *prepared;
    size_t count;
    bool csv;
};

static void print_usage(FILE *out)
{
    fputs("usage: plantcast sensors suggest PLANT.yaml --add N [--group ID] [--asset ID] [--prepared FOLDER] [--csv]\n"
          "       plantcast sensors drift PLANT.yaml [--to TIME] [--group ID] [--prepared FOLDER] [--folder DIR]\n"
          "       plantcast sensors accept PLANT.yaml ...      (details: plantcast sensors accept --help)\n"
          "\n"
          "suggest proposes positions for N more sensors that detect as many missed hot spots as possible.\n"
          "A hot spot is missed if it raises no sensor's reading by at least 5 % of the group's range.\n"
          "The size of a hot spot is hot_spot_m of the sensor group (INTERPOLATIONS.md, show: blind).\n"
          "\n"
          "  --add N            number of additional sensors for which to propose positions\n"
          "  --group ID         sensor group of the new sensors (default: first group of the plant file)\n"
          "  --asset ID         propose positions only on this asset (default: all assets with sensors of the group)\n"
          "  --prepared FOLDER  output folder of plantcast-prep (default: PLANT.prepared next to PLANT.yaml;\n"
          "                     for the service plantcastd@NAME: /var/lib/plantcast/NAME/prepared)\n"
          "  --csv              print the proposed positions as CSV instead of text\n",
          out);
}

static void print_suggestions(const struct suggest_options *options, const struct scene *scene, const struct plant_group *group,
                              const struct suggestion *list, size_t count)
{
    puts(options->csv ? "asset,x_m,y_m,z_m,blindness_before,blindness_after,unseen_before,unseen_after" : "");
    for (size_t i = 0; i < count; i++) {
        const struct suggestion *s = &list[i];
        const char *asset = scene->assets[s->asset].plant->id;
        if (options->csv)
            printf("%s,%.4f,%.4f,%.4f,%.5f,%.5f,%.5f,%.5f\n", asset, s->at_m[0], s->at_m[1], s->at_m[2], s->before, s->after,
                   s->unseen_before, s->unseen_after);
        else
            printf("%2zu. %s at %.3f, %.3f, %.3f m: blindness (smallest detectable hot spot) falls from %.1f to %.1f %% (by %.1f), surface "
                   "without any detection from %.1f to %.1f %%\n",
                   i + 1, asset, s->at_m[0], s->at_m[1], s->at_m[2], 100 * s->before, 100 * s->after, 100 * (s->before - s->after),
                   100 * s->unseen_before, 100 * s->unseen_after);
    }
    if (!options->csv && count < options->count)
        printf("%zu of %zu sensors proposed: more sensors would not detect more hot spots of group '%s'\n", count, options->count,
               group->id);
    if (!options->csv)
        printf("Blindness: how much hotter than its surroundings a hot spot of %g m must be before any sensor detects it, in %% of the "
               "group's range (%g %s).\n",
               group->hot_spot_m, group->max - group->min, group->unit);
}

static int suggest_in(const struct suggest_options *options, const struct plant *plant, struct log *log)
{
    int group = options->group ? plant_find_group(plant, options->group) : 0;
    int asset = options->asset ? plant_find_asset(plant, options->asset) : -1;
    if (group < 0 || (options->asset && asset < 0)) {
        fprintf(stderr, "plantcast: %s: no %s '%s'\n", options->plant, group < 0 ? "group" : "asset",
                group < 0 ? options->group : options->asset);
        return 1;
    }
    char *folder = options->prepared ? mem_strdup(options->prepared) : plant_prepared_folder(plant);
    struct scene *scene = scene_create(log, plant, folder);
    struct workers *workers = scene ? workers_create(0) : NULL;
    struct suggestion list[MAX_ADDED];
    const struct suggest_query query = { log, workers, scene, folder, group, asset, options->count };
    size_t count = scene ? sensor_suggest(&query, list) : 0;
    if (count > 0)
        print_suggestions(options, scene, &plant->groups[group], list, count);
    else if (scene)
        fprintf(stderr,
                "plantcast: %s: nothing to suggest: group '%s' has no sensor with a known position on the asset, or its sensors already "
                "cover the asset\n",
                options->plant, plant->groups[group].id);
    workers_destroy(&workers);
    scene_destroy(&scene);
    mem_free(folder);
    return count > 0 ? 0 : 1;
}

static int suggest(const struct suggest_options *options)
{
    struct plant *plant = plant_load_or_print(options->plant);
    if (!plant)
        return 1;
    struct log *log = log_create(LOG_WARN);
    int code = suggest_in(options, plant, log);
    log_destroy(&log);
    plant_destroy(&plant);
    return code;
}

int cmd_sensors(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "drift"))
        return cmd_sensors_drift(argc - 1, argv + 1);
    if (argc > 1 && !strcmp(argv[1], "accept"))
        return cmd_sensors_accept(argc - 1, argv + 1);
    static const struct option options[] = { { "add", required_argument, NULL, 'a' },
                                             { "group", required_argument, NULL, 'g' },
                                             { "asset", required_argument, NULL, 's' },
                                             { "prepared", required_argument, NULL, 'd' },
                                             { "csv", no_argument, NULL, 'c' },
                                             { "help", no_argument, NULL, 'h' },
                                             { 0 } };
    struct suggest_options taken = { 0 };
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        char *end = "";
        switch (option) {
        case 'a': taken.count = strtoul(optarg, &end, 10); break;
        case 'g': taken.group = optarg; break;
        case 's': taken.asset = optarg; break;
        case 'd': taken.prepared = optarg; break;
        case 'c': taken.csv = true; break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
        if (*end) {
            taken.count = 0;
            break;
        }
    }
    if (argc - optind != 2 || strcmp(argv[optind], "suggest") != 0 || taken.count < 1 || taken.count > MAX_ADDED) {
        if (argc - optind == 2 && !strcmp(argv[optind], "suggest"))
            fprintf(stderr, "plantcast: --add: expected 1 to %d\n", MAX_ADDED);
        print_usage(stderr);
        return 2;
    }
    taken.plant = argv[optind + 1];
    return suggest(&taken);
}
