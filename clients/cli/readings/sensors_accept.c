/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast sensors accept`: marks the assumed positions of many sensors (chosen on their equipment by `plantcast match`) as
   confirmed in the plant's tag list, all in one step. It can undo that. */
#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "clients/cli/commands.h"
#include "placing/assumed_places.h"
#include "placing/tag_file.h"
#include "plant/plant.h"
#include "plant/plant_folder.h"
#include "plant/tags/tag_edit.h"
#include "scene/scene_create.h"

enum { WAIT_MS = 3000 }; /* maximum milliseconds to wait while another program changes the plant's folder */

struct accept_options {
    const char *plant, *asset, *group, *tags, *within, *confidence, *prepared, *undo;
    bool dry_run;
};

static void print_usage(FILE *out)
{
    fputs("usage: plantcast sensors accept PLANT.yaml [--asset ID] [--group ID] [--tags PATTERN] [--within M] [--confidence C]\n"
          "                                [--prepared FOLDER] [--dry-run]\n"
          "       plantcast sensors accept PLANT.yaml --undo LIST.N\n"
          "\n"
          "Confirms positions of sensors that `plantcast match` only assumed (TAGS.md, Assumed places):\n"
          "clears the column `Place` of the tag list for all sensors that match every option.\n"
          "The previous tag list LIST is kept in the same folder as LIST.1, LIST.2, ...\n"
          "Run `plantcast reload` to make the daemon use the new tag list.\n"
          "\n"
          "  --asset ID         only sensors on this asset\n"
          "  --group ID         only sensors of this group\n"
          "  --tags PATTERN     only tags whose name matches PATTERN with the wildcards * and ?; if PATTERN has no\n"
          "                     wildcard, only tags whose name or description contains PATTERN\n"
          "  --within M         only sensors at most M metres from the surface of their asset\n"
          "  --confidence C     only sensors whose match to their asset has at least this confidence, 0 to 1\n"
          "                     (confidences of matches are in matches.csv next to the tag list)\n"
          "  --prepared FOLDER  output folder of plantcast-prep (default: PLANT.prepared next to PLANT.yaml;\n"
          "                     for the service plantcastd@NAME: /var/lib/plantcast/NAME/prepared)\n"
          "  --dry-run          print the names of the sensors that would be accepted, and change nothing\n"
          "  --undo LIST.N      restore the kept tag list LIST.N, if nothing but the column `Place` has changed since\n"
          "                     LIST.N was saved\n"
          "Exit status: 0 success, 1 no sensor was accepted or the tag list cannot be written.\n",
          out);
}

/* Replaces the tag list `before` with `after`; takes ownership of both texts. If either is NULL, saves nothing and prints the
   reason `failed`. Returns the exit code. */
static int save(const char *path, char *before, char *after, const struct refusal *failed)
{
    struct tag_save saved = { .path = (char *)path, .before = before, .after = after };
    char *kept = NULL;
    struct refusal why = *failed;
    bool good = before && after && tag_file_put(&saved, &kept, &why);
    char text[REFUSAL_TEXT_BYTES];
    refusal_text(&why, text);
    if (good)
        printf("%s: new tag list written; the previous tag list is kept as %s\n", path, text_base_name(kept));
    else
        fprintf(stderr, "plantcast: %s: %s\n", path, text);
    mem_free(kept);
    mem_free(before);
    mem_free(after);
    return good ? 0 : 1;
}

/* Returns a copy of the tag list with an empty column `Place`, so that two lists can be compared in all other columns. NULL:
   the list lacks a tag of the plant. */
static char *without_places(const struct plant *plant, const char *list)
{
    uint8_t *all = mem_array(plant->tag_count + 1, sizeof(*all));
    struct refusal why;
    for (size_t i = 0; i < plant->tag_count; i++)
        all[i] = ASSUMED_ACCEPTED;
    char *cleared = assumed_places_accept(plant, list, all, &why);
    mem_free(all);
    return cleared;
}

/* Checks whether --undo may restore an earlier version of the tag list: it may differ from the current one only in the column
   `Place`. Returns NULL if so, else the reason (mem_free). */
static char *wrong_version(const struct plant *plant, const char *before, const char *after)
{
    char *now = without_places(plant, before), *then = without_places(plant, after), *why = NULL;
    struct tag_lines lines = { 0 };
    if (!strcmp(before, after)) {
        why = mem_strdup("--undo: this earlier tag list equals the present tag list, so there is nothing to undo");
    } else if (!now || !then) {
        why = mem_strdup("--undo: this earlier tag list has other tags than the present tag list: to restore it anyway, use the web page");
    } else if (strcmp(now, then) != 0) {
        tag_lines(now, then, &lines);
        why = mem_printf("--undo: line %d of this earlier tag list differs in more than the column `Place`: to restore the list anyway, "
                         "use the web page",
                         lines.count ? lines.at[0].line : 1);
        tag_lines_finish(&lines);
    }
    mem_free(now);
    mem_free(then);
    return why;
}

/* Returns the path of the earlier tag list that --undo names (mem_free). NULL: `name` is not a version of the list at `path`. */
static char *version_path(const char *path, const char *name)
{
    const char *base = text_base_name(name), *list = text_base_name(path), *number = base + strlen(list);
    char real[PATH_MAX];
    if (strncmp(base, list, strlen(list)) != 0 || *number++ != '.' || !*number || number[strspn(number, "0123456789")])
        return NULL;
    char *version = mem_printf("%.*s%s", (int)(list - path), path, base);
    if (base == name || (realpath(name, real) && !strcmp(real, version)))
        return version;
    mem_free(version);
    return NULL;
}

static int undo(const struct accept_options *options, const struct plant *plant, const char *path)
{
    struct refusal failed = { .code = REFUSAL_NONE };
    char *version = version_path(path, options->undo), *before = NULL, *after = NULL, *why = NULL;
    if (!version)
        why = mem_printf(
            "--undo: this is not an earlier version of the tag list %s: earlier versions are in the same folder as %s.1, %s.2, ...", path,
            text_base_name(path), text_base_name(path));
    else if ((before = tag_file_read(path, &failed)) && (after = tag_file_read(version, &failed)))
        why = wrong_version(plant, before, after);
    mem_free(version);
    if (!why)
        return save(path, before, after, &failed);
    fprintf(stderr, "plantcast: --undo %s: %s\n", options->undo, why);
    mem_free(before);
    mem_free(after);
    mem_free(why);
    return 1;
}

static void print_outcome(const struct plant *plant, const uint8_t *outcome, bool names)
{
    static const char *const words[ASSUMED_OUTCOMES] = { [ASSUMED_ACCEPTED] = "accepted",
                                                         [ASSUMED_NOWHERE] =
                                                             "sensors without a position: the tag list has neither Node nor X, Y, Z",
                                                         [ASSUMED_MISSING] = "sensors on an asset without a model",
                                                         [ASSUMED_FAR] = "sensors farther from the surface than --within",
                                                         [ASSUMED_UNSURE] = "sensors with a confidence below --confidence, or unknown" };
    size_t counts[ASSUMED_OUTCOMES] = { 0 };
    for (size_t i = 0; i < plant->tag_count; i++) {
        counts[outcome[i]]++;
        if (names && outcome[i] == ASSUMED_ACCEPTED)
            puts(plant->tags[i].name);
    }
    for (int o = ASSUMED_ACCEPTED; o < ASSUMED_OUTCOMES; o++)
        if (counts[o] || o == ASSUMED_ACCEPTED)
            printf("%zu %s\n", counts[o], words[o]);
}

static bool number_of(const char *name, const char *text, double most, double *out)
{
    char *end;
    if (!text)
        return true;
    *out = strtod(text, &end);
    if (end != text && !*end && *out >= 0 && *out <= most)
        return true;
    fprintf(stderr, "plantcast: %s: expected 0 to %g, found '%s'\n", name, most, text);
    return false;
}

/* Reads from the options which sensors' assumed positions are accepted: those of an asset or group, near enough to the surface,
   and of sufficient confidence. Returns false with the reason printed. */
static bool read_filter(const struct accept_options *options, const struct plant *plant, struct assumed_filter *filter)
{
    *filter = (struct assumed_filter){ .asset = options->asset ? plant_find_asset(plant, options->asset) : -1,
                                       .group = options->group ? plant_find_group(plant, options->group) : -1,
                                       .within_m = -1,
                                       .confidence = -1 };
    bool no_asset = options->asset && filter->asset < 0, no_group = options->group && filter->group < 0;
    if (no_asset || no_group)
        fprintf(stderr, "plantcast: %s: no %s '%s'\n", plant->files.path, no_asset ? "asset" : "group",
                no_asset ? options->asset : options->group);
    snprintf(filter->pattern, sizeof(filter->pattern), "%s", options->tags ? options->tags : "");
    return !no_asset && !no_group && number_of("--within", options->within, 1e6, &filter->within_m) &&
           number_of("--confidence", options->confidence, 1, &filter->confidence);
}

static int accept_in(const struct accept_options *options, const struct plant *plant, struct log *log, const char *path)
{
    struct assumed_filter filter;
    if (!read_filter(options, plant, &filter))
        return 2;
    char *folder = options->prepared ? mem_strdup(options->prepared) : plant_prepared_folder(plant);
    struct scene *scene = scene_create(log, plant, folder);
    uint8_t *outcome = mem_array(plant->tag_count + 1, sizeof(*outcome));
    size_t count = scene ? assumed_places_choose(scene, &filter, outcome) : 0;
    int code = count > 0 ? 0 : 1;
    if (scene)
        print_outcome(plant, outcome, options->dry_run);
    if (count > 0 && !options->dry_run) {
        struct refusal why = { .code = REFUSAL_NONE };
        char *before = tag_file_read(path, &why), *after = before ? assumed_places_accept(plant, before, outcome, &why) : NULL;
        code = save(path, before, after, &why);
    }
    mem_free(outcome);
    scene_destroy(&scene);
    mem_free(folder);
    return code;
}

static int run_locked(const struct accept_options *options)
{
    struct plant *plant = plant_load_or_print(options->plant);
    if (!plant)
        return 1;
    struct log *log = log_create(LOG_WARN);
    char real[PATH_MAX]; /* if the tag list is a symlink, its earlier versions are next to the symlink's target */
    const char *path = realpath(plant->files.tags_path, real) ? real : plant->files.tags_path;
    int code = options->undo ? undo(options, plant, path) : accept_in(options, plant, log, path);
    log_destroy(&log);
    plant_destroy(&plant);
    return code;
}

/* Accepts the positions. Holds a lock on the plant's folder, since a daemon or an import may be replacing the tag list. */
static int accept_positions(const struct accept_options *options)
{
    if (options->dry_run)
        return run_locked(options);
    char *folder = plant_folder_of(options->plant), *why = NULL;
    int lock = plant_folder_lock(&(struct plant_folder_params){ .folder = folder, .wait_ms = WAIT_MS }, &why), code = 1;
    if (lock < 0)
        fprintf(stderr, "plantcast: the plant's folder %s is locked: %s: try again later\n", folder, why);
    else
        code = run_locked(options);
    if (lock >= 0)
        close(lock);
    mem_free(folder);
    mem_free(why);
    return code;
}

int cmd_sensors_accept(int argc, char **argv)
{
    static const struct option all[] = { { "asset", required_argument, NULL, 'a' },
                                         { "group", required_argument, NULL, 'g' },
                                         { "tags", required_argument, NULL, 't' },
                                         { "within", required_argument, NULL, 'w' },
                                         { "confidence", required_argument, NULL, 'c' },
                                         { "prepared", required_argument, NULL, 'd' },
                                         { "undo", required_argument, NULL, 'u' },
                                         { "dry-run", no_argument, NULL, 'n' },
                                         { "help", no_argument, NULL, 'h' },
                                         { 0 } };
    struct accept_options options = { 0 };
    for (int option; (option = getopt_long(argc, argv, "", all, NULL)) != -1;)
        switch (option) {
        case 'a': options.asset = optarg; break;
        case 'g': options.group = optarg; break;
        case 't': options.tags = optarg; break;
        case 'w': options.within = optarg; break;
        case 'c': options.confidence = optarg; break;
        case 'd': options.prepared = optarg; break;
        case 'u': options.undo = optarg; break;
        case 'n': options.dry_run = true; break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    if (argc - optind != 1 || (options.tags && strlen(options.tags) > 100)) {
        print_usage(stderr);
        return 2;
    }
    options.plant = argv[optind];
    return accept_positions(&options);
}
