/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast sensors drift`: finds sensors that, in a week of recorded history, drifted away from their neighbours' prediction. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/timestamp.h"
#include "clients/cli/commands.h"
#include "plant/plant.h"
#include "scene/scene_create.h"
#include "service/drift_report.h"

struct drift_options {
    const char *plant, *group, *to, *prepared, *folder;
};

static void print_usage(FILE *out)
{
    fputs("usage: plantcast sensors drift PLANT.yaml [--to TIME] [--group ID] [--prepared FOLDER] [--folder DIR]\n"
          "\n"
          "Prints how far the readings of each sensor have drifted within one week.\n"
          "Compares hourly means of the readings with the values predicted from the other sensors of the group\n"
          "on the same asset (DRIFT.md).\n"
          "An asset needs at least three sensors of the group, and half a week of recorded readings.\n"
          "\n"
          "  --to TIME          end of the week, such as 2026-11-20T10:00:00Z or -1d for a day ago (default: now)\n"
          "  --group ID         sensor group to check (default: all groups)\n"
          "  --prepared FOLDER  output folder of plantcast-prep (default: PLANT.prepared next to PLANT.yaml;\n"
          "                     for the service plantcastd@NAME: /var/lib/plantcast/NAME/prepared)\n"
          "  --folder DIR       folder of recorded readings (default: the folder given in the plant file, or PLANT.history;\n"
          "                     for the service plantcastd@NAME: /var/lib/plantcast/NAME/history)\n"
          "Output: CSV with columns tag, verdict (found, none or unknown), change (drift within the week), error\n"
          "(standard error of the change), scatter (standard deviation of the differences from the predicted\n"
          "values), unit, hours (number of hours with readings), cause.\n"
          "The column `cause` says why a verdict is unknown. A number that cannot be computed is left empty.\n"
          "Exit status: 0 no sensor drifts, 1 a sensor drifts.\n",
          out);
}

/* Prints a number and a comma; if NaN, only the comma. */
static void print_number(double number)
{
    if (!isnan(number))
        printf("%.4g", number);
    putchar(',');
}

static int print_report(const struct plant *plant, const struct drift_report *report, int group)
{
    int found = 0;
    for (size_t i = 0; i < report->count; i++) {
        const struct drift *drift = &report->drifts[i];
        printf("%s,%s,", plant->tags[neighbours_tag(report->neighbours, i)].name, drift_verdict_name(drift->verdict));
        print_number(drift->change);
        print_number(drift->error);
        print_number(drift->scatter);
        printf("%s,%d,%s\n", plant->groups[group].unit, drift->hours, drift_unknown_cause(drift, report->count));
        found += drift->verdict == DRIFT_FOUND;
    }
    return found;
}

/* Searches for drift in all sensors of the plant, or only in the sensor group with index `only`, and prints the result. Returns
   the number of drifting sensors, or -1 if the history cannot be read. */
static int look_at(const struct scene *scene, struct history_reader *reader, int only, int64_t to_us)
{
    int found = 0;
    puts("tag,verdict,change,error,scatter,unit,hours,cause");
    for (int g = 0; g < (int)scene->plant->group_count; g++)
        for (size_t a = 0; a < scene->asset_count && (only < 0 || g == only); a++) {
            struct drift_report report;
            if (!drift_report_read(&report, reader, scene, (int)a, g, to_us))
                return -1;
            found += print_report(scene->plant, &report, g);
            drift_report_finish(&report);
        }
    return found;
}

static int drift_in(const struct drift_options *options, const struct plant *plant, struct log *log)
{
    int64_t to_us = clock_utc_ns() / 1000;
    int group = options->group ? plant_find_group(plant, options->group) : -1, found = -1;
    timestamp_use_zone(plant->time_zone);
    if (options->to && !timestamp_parse(options->to, to_us, &to_us)) {
        fprintf(stderr, "plantcast: --to: expected " TIMESTAMP_FORMS ", found '%s'\n", options->to);
        return 2;
    }
    if (options->group && group < 0) {
        fprintf(stderr, "plantcast: %s: no group '%s'\n", options->plant, options->group);
        return 2;
    }
    char *prepared = options->prepared ? mem_strdup(options->prepared) : plant_prepared_folder(plant);
    char *folder = options->folder ? mem_strdup(options->folder) : plant_recorded_folder(plant);
    struct scene *scene = scene_create(log, plant, prepared);
    struct history_reader *reader = history_reader_create(log, folder);
    history_reader_show_by(reader, plant);
    if (scene)
        found = look_at(scene, reader, group, to_us);
    history_reader_destroy(&reader);
    scene_destroy(&scene);
    mem_free(prepared);
    mem_free(folder);
    return found < 0 ? 2 : found > 0;
}

int cmd_sensors_drift(int argc, char **argv)
{
    static const struct option options[] = {
        { "to", required_argument, NULL, 'u' },     { "group", required_argument, NULL, 'g' }, { "prepared", required_argument, NULL, 'p' },
        { "folder", required_argument, NULL, 'd' }, { "help", no_argument, NULL, 'h' },        { NULL, 0, NULL, 0 },
    };
    struct drift_options taken = { 0 };
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        switch (option) {
        case 'u': taken.to = optarg; break;
        case 'g': taken.group = optarg; break;
        case 'p': taken.prepared = optarg; break;
        case 'd': taken.folder = optarg; break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    }
    if (argc - optind != 1) {
        print_usage(stderr);
        return 2;
    }
    taken.plant = argv[optind];
    struct plant *plant = plant_load_or_print(taken.plant);
    if (!plant)
        return 2;
    struct log *log = log_create(LOG_WARN);
    int code = drift_in(&taken, plant, log);
    log_destroy(&log);
    plant_destroy(&plant);
    return code;
}
