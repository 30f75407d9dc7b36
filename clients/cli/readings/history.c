/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast history import|export`: reads and writes recorded series as CSV. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "clients/cli/commands.h"
#include "history/history.h"
#include "history/import.h"
#include "history/month.h"
#include "history/series_text.h"
#include "base/text/timestamp.h"
#include "plant/parse/number.h"

enum { NAMES_BYTES = 64 << 20 }; /* largest file of --tags */

struct history_options {
    const char *plant, *folder, *csv, *tags, *from, *to, *start, *unit, *longest_gap, *encoding;
    int points;
};

static void print_usage(FILE *out)
{
    fputs("usage: plantcast history import PLANT.yaml FILE.csv [--folder DIR] [--start TIME [--unit ms|s|min|h]]\n"
          "                                [--longest-gap DURATION] [--encoding NAME]\n"
          "       plantcast history export PLANT.yaml --tags A,B|@FILE [--from TIME] [--to TIME] [--points N] [--folder DIR]\n"
          "\n"
          "`import` adds readings to the recorded history of a plant, for example older ones. The daemon can keep running.\n"
          "FILE.csv has the columns Tag, Time, Value and optionally Quality and Unit,\n"
          "or FILE.csv has a column Time and one column for each tag.\n"
          "The time column is the one named Time, Timestamp, UTC, DateTime or Date, else the first column.\n"
          "Times look like 2026-11-20T10:00:00Z; times without a zone are in the time zone of the plant.\n"
          "With --start, times are numbers that count from that time, in the unit given with --unit.\n"
          "Values are in the tag's Eng Units, unless the column Unit names another unit.\n"
          "Blank cells, NaN and words such as Bad, No Data or I/O Timeout become readings of quality Bad.\n"
          "If several rows of a tag have the same time, the last row is used.\n"
          "If any row has an error, nothing is imported, and all errors are printed with line and column.\n"
          "\n"
          "`export` prints recorded readings as CSV that `import` can read (default: those of the last hour).\n"
          "Exit status: 1 if the plant lacks one of the tags, or its readings cannot be read; the other tags are still printed.\n"
          "\n"
          "  --folder DIR     folder of recorded readings (default: the folder given in the plant file, or PLANT.history;\n"
          "                   for the service plantcastd@NAME: /var/lib/plantcast/NAME/history)\n"
          "  --start TIME     time that the number 0 in the time column stands for\n"
          "  --unit UNIT      unit of numbers in the time column: ms, s, min or h\n"
          "  --longest-gap DURATION  show a gap without data between two readings of a tag that are farther apart\n"
          "                   than DURATION, such as 90s, 15min, 8h or 2d.\n"
          "                   Default: the tag's column `Stale s`, unless shorter than the usual spacing of readings;\n"
          "                   else ten times the median spacing of the tag's readings (of all other tags' readings,\n"
          "                   if the tag has only two)\n"
          "  --encoding NAME  character encoding of FILE.csv, such as GB18030 or Windows-1251 (default: detected)\n"
          "  --tags A,B|@FILE  tags to export: names separated by commas, or a file with one name per line\n"
          "  --from, --to TIME  start and end of the period to export (default: the last hour)\n"
          "  --points N       maximum number of rows for each tag (default: 20000). If there are more\n"
          "                   readings, `export` prints the lowest, highest and mean value of short intervals\n"
          "  TIME             a time such as 2026-11-20T10:00:00Z (or offset +01:00), seconds since 1970, or -8h (8 hours ago)\n",
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
    } units[] = { { "ms", 1000 }, { "s", US_PER_S }, { "min", 60 * US_PER_S }, { "h", 3600 * US_PER_S }, { "d", 86400 * US_PER_S } };
    for (size_t i = 0; i < sizeof(units) / sizeof(units[0]); i++)
        if (!strcmp(text, units[i].name)) {
            *unit_us = units[i].us;
            return true;
        }
    return false;
}

/* Parses a duration such as "90s" or "1.5h"; a number without a unit is in seconds. Returns false for other text. */
static bool parse_span(const char *text, int64_t *span_us)
{
    char number[24];
    double count;
    size_t length = strspn(text, "0123456789.");
    int64_t unit_us = US_PER_S;
    if (length == 0 || length >= sizeof(number) || (text[length] && !parse_unit(text + length, &unit_us)))
        return false;
    snprintf(number, sizeof(number), "%.*s", (int)length, text);
    if (number_parse(number, &count) != NUMBER_GOOD || !(count * (double)unit_us >= 1 && count * (double)unit_us < 9e18))
        return false;
    *span_us = (int64_t)(count * (double)unit_us);
    return true;
}

/* Prints a duration in s, min, h or days, depending on its length; INT64_MAX as "any time". */
static void print_span(int64_t span_us, char out[32])
{
    double s = (double)span_us / US_PER_S;
    if (span_us == INT64_MAX)
        snprintf(out, 32, "any time");
    else if (s < 120)
        snprintf(out, 32, "%.4g s", s);
    else if (s < 7200)
        snprintf(out, 32, "%.4g min", s / 60);
    else if (s < 2 * 86400)
        snprintf(out, 32, "%.4g h", s / 3600);
    else
        snprintf(out, 32, "%.4g d", s / 86400);
}

static void print_counts(const char *path, const struct import_counts *counts)
{
    char from[TIMESTAMP_BYTES], to[TIMESTAMP_BYTES], least[32], most[32];
    timestamp_print(counts->from_us, from);
    timestamp_print(counts->to_us, to);
    print_span(counts->longest_us[0], least);
    print_span(counts->longest_us[1], most);
    printf("%s: %lld samples of %d tag%s from %s to %s imported, recorded as %lld points\n", path, counts->samples, counts->tags,
           counts->tags == 1 ? "" : "s", from, to, counts->points);
    if (!counts->encoding.ascii && strcmp(counts->encoding.name, "UTF-8") != 0) {
        char *read_as = charset_describe(&counts->encoding);
        printf("Encoding: %s\n", read_as);
        mem_free(read_as);
    }
    printf("Bad samples: %lld\nDuplicate times: %lld (of rows with the same tag and time, the last row is used)\n", counts->bad,
           counts->duplicates);
    if (counts->samples)
        printf("Gaps without data: %lld (longer than %s%s%s)\n", counts->gaps, least, strcmp(least, most) ? " to " : "",
               strcmp(least, most) ? most : "");
}

static int run_import(const struct history_options *options, const struct plant *plant, const char *folder, struct log *log)
{
    struct import_params params = {
        .log = log, .plant = plant, .folder = folder, .path = options->csv, .start_us = INT64_MIN, .unit_us = US_PER_S
    };
    char encoding[CHARSET_NAME_BYTES];
    struct import_counts counts;
    struct diag diag = { 0 };
    timestamp_use_zone(plant->time_zone);
    if (options->start && !timestamp_parse(options->start, clock_utc_ns() / 1000, &params.start_us) &&
        !timestamp_parse_local(options->start, INT64_MIN, &params.start_us))
        return wrong("--start: expected " TIMESTAMP_FORMS ", found", options->start);
    if (options->unit && (!options->start || !parse_unit(options->unit, &params.unit_us)))
        return wrong("--unit: expected ms, s, min or h together with --start, found", options->unit);
    if (options->longest_gap && !parse_span(options->longest_gap, &params.longest_gap_us))
        return wrong("--longest-gap: expected a duration such as 90s, 15min, 8h or 2d, found", options->longest_gap);
    if (options->encoding && !charset_resolve(options->encoding, encoding))
        return wrong("--encoding: expected the name of an encoding, as printed by iconv --list, found", options->encoding);
    params.encoding = options->encoding ? encoding : NULL;
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

/* Prints the readings of a tag. Returns false if the readings cannot be read (logged), or if standard output cannot be written:
   ferror(stdout) tells the two apart. */
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
    good = good && fwrite(text.at ? text.at : "", 1, text.length, stdout) == text.length;
    text_finish(&text);
    history_series_finish(&series);
    return good;
}

/* Returns the tag names that --tags gives, and their separators: commas, or line ends if `option` is '@' and the path of a file.
   Returns NULL with the reason printed if this file cannot be read. */
static char *read_names(const char *option, const char **separators)
{
    size_t bytes;
    bool is_file = *option == '@';
    char *names = is_file ? text_read_file(option + 1, NAMES_BYTES, &bytes) : mem_strdup(option);
    if (!names)
        fprintf(stderr, "plantcast: --tags %s: %s\n", option, strerror(errno));
    *separators = is_file ? "\r\n" : ",";
    if (names && is_file && !strncmp(names, "\xEF\xBB\xBF", 3)) /* the byte order mark of a file from Windows */
        memset(names, '\n', 3);
    return names;
}

static int run_export(const struct history_options *options, const struct plant *plant, const char *folder, struct log *log)
{
    int64_t now_us = clock_utc_ns() / 1000, to_us = now_us, from_us;
    if (!options->tags)
        return wrong("--tags: expected tag names separated by commas, or @FILE, found", "none");
    if (options->to && !timestamp_parse(options->to, now_us, &to_us))
        return wrong("--to: expected " TIMESTAMP_FORMS ", found", options->to);
    from_us = to_us - 3600 * US_PER_S;
    if (options->from && !timestamp_parse(options->from, now_us, &from_us))
        return wrong("--from: expected " TIMESTAMP_FORMS ", found", options->from);
    if (from_us >= to_us)
        return wrong("--from: expected a time before --to, found", options->from ? options->from : "");
    const char *separators;
    char *names = read_names(options->tags, &separators), *rest = names;
    if (!names)
        return 1;
    struct history_reader *reader = history_reader_create(log, folder);
    history_reader_show_by(reader, plant);
    int was_buckets = -1, count = 0;
    bool good = true;
    for (char *tag; !ferror(stdout) && (tag = strsep(&rest, separators));) {
        int index = plant_find_tag(plant, tag);
        if (!*tag)
            continue;
        count++;
        if (index < 0)
            fprintf(stderr, "plantcast: %s: the plant has no tag '%s'\n", options->plant, tag);
        good = index >= 0 && export_tag(reader, &plant->tags[index], from_us, to_us, options->points, &was_buckets) && good;
    }
    if (count == 0) {
        fprintf(stderr, "plantcast: --tags %s: this list has no tag names\n", options->tags);
        good = false;
    }
    mem_free(names);
    history_reader_destroy(&reader);
    return good ? 0 : 1;
}

/* --- the command line ------------------------------------------------------------------------------------------------------------- */

/* Parses the command line. Returns -1 to continue, or the exit code. */
static int parse(int argc, char **argv, struct history_options *out)
{
    static const struct option options[] = {
        { "folder", required_argument, NULL, 'd' }, { "tags", required_argument, NULL, 't' },  { "from", required_argument, NULL, 'f' },
        { "to", required_argument, NULL, 'u' },     { "start", required_argument, NULL, 's' }, { "unit", required_argument, NULL, 'n' },
        { "points", required_argument, NULL, 'p' }, { "longest-gap", required_argument, NULL, 'g' },
        { "encoding", required_argument, NULL, 'e' },
        { "help", no_argument, NULL, 'h' },         { NULL, 0, NULL, 0 },
    };
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        switch (option) {
        case 'd': out->folder = optarg; break;
        case 't': out->tags = optarg; break;
        case 'f': out->from = optarg; break;
        case 'u': out->to = optarg; break;
        case 's': out->start = optarg; break;
        case 'n': out->unit = optarg; break;
        case 'e': out->encoding = optarg; break;
        case 'g': out->longest_gap = optarg; break;
        case 'p':
            out->points = atoi(optarg);
            if (out->points < 2)
                return wrong("--points: expected a number of at least 2, found", optarg);
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
    char *folder = options.folder ? mem_strdup(options.folder) : plant_recorded_folder(plant);
    code = (import ? run_import : run_export)(&options, plant, folder, log);
    mem_free(folder);
    log_destroy(&log);
    plant_destroy(&plant);
    return code;
}
