/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast history import|export`: recorded series in and out, as CSV. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "commands.h"
#include "history/history.h"
#include "history/import.h"
#include "history/month.h"
#include "history/series_text.h"
#include "base/timestamp.h"

struct history_options {
    const char *plant, *folder, *csv, *tags, *from, *to, *start, *unit;
    int points;
};

static void print_usage(FILE *out)
{
    fputs("usage: plantcast history import PLANT.yaml FILE.csv [--folder DIR] [--start INSTANT [--unit ms|s|min|h]]\n"
          "       plantcast history export PLANT.yaml --tags A,B [--from INSTANT] [--to INSTANT] [--points N] [--folder DIR]\n"
          "\n"
          "import takes series into the plant's history, also while its daemon records: what happened before it was there.\n"
          "The CSV has the columns Tag, Time, Value and perhaps Quality and Unit, or Time and one column for each tag. Values are in\n"
          "the tag's Eng Units, as its device gives them, unless Unit says another. Times are instants\n"
          "such as 2026-11-20T10:00:00Z (without a zone: the plant's), or, with --start, numbers that count from there. They are in a\n"
          "column called Time, Timestamp, UTC, DateTime or Date, or in the first one.\n"
          "Nothing is imported where anything is wrong; every error is printed with its line.\n"
          "\n"
          "export prints what import takes: the points that were kept (of the last hour, unless --from and --to say otherwise).\n"
          "\n"
          "  --folder DIR     where history is (as the plant file says; else beside it)\n"
          "  --points N       at most so many of each tag (20000); where there are more: lowest, highest and mean of stretches of time\n"
          "  INSTANT          2026-11-20T10:00:00Z, with an offset such as +01:00, seconds since 1970, or back from now: -8h\n",
          out);
}

static int wrong(const char *what, const char *value)
{
    fprintf(stderr, "plantcast history: %s '%s'\n", what, value);
    print_usage(stderr);
    return 2;
}

/* --- import --------------------------------------------------------------------------------------------------------------------- */

static bool parse_unit(const char *text, int64_t *unit_us)
{
    static const struct {
        const char *name;
        int64_t us;
    } units[] = { { "ms", 1000 }, { "s", US_PER_S }, { "min", 60 * US_PER_S }, { "h", 3600 * US_PER_S } };
    for (size_t i = 0; i < sizeof(units) / sizeof(units[0]); i++)
        if (!strcmp(text, units[i].name)) {
            *unit_us = units[i].us;
            return true;
        }
    return false;
}

static void print_counts(const char *path, const struct import_counts *counts)
{
    char from[TIMESTAMP_BYTES], to[TIMESTAMP_BYTES];
    timestamp_print(counts->from_us, from);
    timestamp_print(counts->to_us, to);
    printf("%s: %lld samples of %d tags from %s to %s: %lld points kept\n", path, counts->samples, counts->tags, from, to, counts->points);
}

static int run_import(const struct history_options *options, const struct plant *plant, const char *folder, struct log *log)
{
    struct import_params params = {
        .log = log, .plant = plant, .folder = folder, .path = options->csv, .start_us = INT64_MIN, .unit_us = US_PER_S
    };
    struct import_counts counts;
    struct diag diag = { 0 };
    timestamp_use_zone(plant->time_zone);
    if (options->start && !timestamp_parse(options->start, clock_utc_ns() / 1000, &params.start_us) &&
        !timestamp_parse_local(options->start, INT64_MIN, &params.start_us))
        return wrong("--start: expected " TIMESTAMP_FORMS ", found", options->start);
    if (options->unit && (!options->start || !parse_unit(options->unit, &params.unit_us)))
        return wrong("--unit: expected ms, s, min or h, and --start, found", options->unit);
    bool good = history_import(&params, &diag, &counts);
    diag_print(&diag, stderr);
    if (good)
        print_counts(options->csv, &counts);
    else
        fprintf(stderr, "plantcast: %s: not imported\n", options->csv);
    diag_finish(&diag);
    return good ? 0 : 1;
}

/* --- export --------------------------------------------------------------------------------------------------------------------- */

static bool export_tag(struct history_reader *reader, const struct plant_tag *tag, int64_t from_us, int64_t to_us, int points,
                       int *was_buckets)
{
    struct history_series series;
    struct text text = { 0 };
    bool good = history_series(reader, tag->name, from_us, to_us, points, &series) == 0;
    if (good && *was_buckets != (series.bucket_us > 0)) {
        *was_buckets = series.bucket_us > 0;
        series_text_csv_head(&text, series.bucket_us > 0);
    }
    if (good)
        series_text_csv(&text, tag->name, tag->unit, &series);
    if (text.at)
        fwrite(text.at, 1, text.length, stdout);
    text_finish(&text);
    history_series_finish(&series);
    return good;
}

static int run_export(const struct history_options *options, const struct plant *plant, const char *folder, struct log *log)
{
    int64_t now_us = clock_utc_ns() / 1000, to_us = now_us, from_us;
    if (!options->tags)
        return wrong("--tags: expected names, with commas between them, found", "none");
    if (options->to && !timestamp_parse(options->to, now_us, &to_us))
        return wrong("--to: expected " TIMESTAMP_FORMS ", found", options->to);
    from_us = to_us - 3600 * US_PER_S;
    if (options->from && !timestamp_parse(options->from, now_us, &from_us))
        return wrong("--from: expected " TIMESTAMP_FORMS ", found", options->from);
    if (from_us >= to_us)
        return wrong("--from: expected an earlier instant than --to, found", options->from ? options->from : "");
    struct history_reader *reader = history_reader_create(log, folder);
    history_reader_show_by(reader, plant);
    char *names = mem_strdup(options->tags), *rest = names;
    int was_buckets = -1;
    bool good = true;
    for (char *tag; good && (tag = strsep(&rest, ","));) {
        int index = plant_find_tag(plant, tag);
        good = index >= 0;
        if (!good)
            fprintf(stderr, "plantcast: %s: there is no tag '%s'\n", options->plant, tag);
        good = good && export_tag(reader, &plant->tags[index], from_us, to_us, options->points, &was_buckets);
    }
    mem_free(names);
    history_reader_destroy(&reader);
    return good ? 0 : 1;
}

/* --- the command line ------------------------------------------------------------------------------------------------------------- */

/* -1: go on; else the exit code. */
static int parse(int argc, char **argv, struct history_options *out)
{
    static const struct option options[] = {
        { "folder", required_argument, NULL, 'd' }, { "tags", required_argument, NULL, 't' },  { "from", required_argument, NULL, 'f' },
        { "to", required_argument, NULL, 'u' },     { "start", required_argument, NULL, 's' }, { "unit", required_argument, NULL, 'n' },
        { "points", required_argument, NULL, 'p' }, { "help", no_argument, NULL, 'h' },        { NULL, 0, NULL, 0 },
    };
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        switch (option) {
        case 'd': out->folder = optarg; break;
        case 't': out->tags = optarg; break;
        case 'f': out->from = optarg; break;
        case 'u': out->to = optarg; break;
        case 's': out->start = optarg; break;
        case 'n': out->unit = optarg; break;
        case 'p':
            out->points = atoi(optarg);
            if (out->points < 2)
                return wrong("--points: expected a number from 2, found", optarg);
            break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    }
    return -1;
}

int cmd_history(int argc, char **argv)
{
    struct history_options options = { .points = 20000 };
    int code = parse(argc, argv, &options);
    if (code >= 0)
        return code;
    bool import = argc - optind == 3 && !strcmp(argv[optind], "import"), export = argc - optind == 2 && !strcmp(argv[optind], "export");
    if (!import && !export) {
        print_usage(stderr);
        return 2;
    }
    options.plant = argv[optind + 1];
    options.csv = import ? argv[optind + 2] : NULL;
    struct plant *plant = (import ? plant_load_or_print : plant_load_without_models)(options.plant);
    if (!plant)
        return 1;
    struct log *log = log_create(LOG_WARN);
    char *folder = options.folder ? mem_strdup(options.folder) : plant_history_folder(plant);
    code = (import ? run_import : run_export)(&options, plant, folder, log);
    mem_free(folder);
    log_destroy(&log);
    plant_destroy(&plant);
    return code;
}
