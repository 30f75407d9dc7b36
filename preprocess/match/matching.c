/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads an exported tag list, matches its tags to equipment, composes the new files, and writes them if the resulting plant can
 * be loaded. */
#include "preprocess/match/matching.h"

#include <errno.h>
#include <limits.h>
#include <regex.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/mem.h"
#include "preprocess/child/child.h"
#include "preprocess/child/child_paths.h"
#include "preprocess/match/equipment.h"
#include "preprocess/match/file_set.h"
#include "preprocess/match/plant_edit.h"
#include "preprocess/match/plant_trial.h"
#include "preprocess/match/tag_rows.h"

static const size_t max_plant_bytes = (size_t)64 << 20, max_list_bytes = (size_t)256 << 20;

struct matching_run {
    const struct matching_params *params;
    struct plant *plant;
    struct model_index site;
    struct tag_export list;
    struct matcher matcher;
    struct match *matches;
    struct decisions before;
    struct quantities quantities;
    struct place_proposal *places;
    struct tag_rows rows;
    struct tag_source source;
    char *result;                                      /* text printed for the user after matching */
    char *plant_text, *new_text;                       /* plant file: current text, and text to write */
    /* texts of the plant file, the tag list and matches.csv when the run began; NULL: the file does not exist */
    char *plant_before, *tags_before, *matches_before;
    /* new texts of the tag list and matches.csv; left_names: for the report, names of the first tags that are missing from the
     * new tag list */
    struct text tags_text, matches_text, left_names;
    size_t left, by_hand, left_out, written, assumed, own_nodes;
};

static bool fail_at(const char *path, const char *why)
{
    fprintf(stderr, "plantcast match: %s: %s\n", path, why);
    return false;
}

static char *beside(const struct matching_run *run, const char *name)
{
    return mem_printf("%s/%s", run->plant->files.folder, name);
}

/* --- reading ---------------------------------------------------------------------------------------------------------------- */

static void print_list(const struct matching_run *run)
{
    const struct tag_export *list = &run->list;
    const char *path = run->params->tags, separator = list->separator;
    printf("%s: %s", path, list->format);
    if (*list->encoding.name)
        printf(", %s", list->encoding.name);
    if (separator)
        printf(", separated by %s", separator == ',' ? "commas" : separator == ';' ? "semicolons" : separator == '\t' ? "tabs" : "bars");
    printf("; %zu tags\n", list->count);
    if (*list->encoding.other)
        printf("%s: encoding read as %s, but may be %s: set --encoding NAME\n", path, list->encoding.name, list->encoding.other);
    else if (*list->encoding.name && strcmp(list->encoding.name, "UTF-8") != 0)
        printf("%s: read as %s\n", path, list->encoding.name);
    if (list->same > 0)
        printf("%s: ignored %zu duplicate rows\n", path, list->same);
    struct text differing = { 0 };
    tag_names_say(&list->differing, "row repeats a tag, with other contents: only the first row of each tag is used",
                  "rows repeat a tag, with other contents: only the first row of each tag is used", &differing);
    if (differing.length > 0)
        printf("%s: %s", path, differing.at);
    text_finish(&differing);
    if (list->renamed > 0)
        printf("%s: %zu tags share their name with a tag in another folder of the control system: they are named FOLDER/TAG\n", path,
               list->renamed);
    for (const char *line = list->remarks.at, *end; line && *line; line = *end ? end + 1 : end) {
        end = line + strcspn(line, "\n");
        printf("%s: %.*s\n", path, (int)(end - line), line);
    }
    if (list->nameless > 0)
        printf("%s: ignored %zu rows without a tag name\n", path, list->nameless);
    if (list->control > 0)
        printf("%s: replaced %zu control characters by blanks\n", path, list->control);
    if (list->damaged > 0)
        printf("%s: %zu characters are not valid %s: replaced by \xef\xbf\xbd\n", path, list->damaged,
               *list->encoding.name ? list->encoding.name : "text");
}

/* Replaces the plant's assets by the equipment selected with --equipment. Returns false with an error if the tag list refers to
 * assets, because those tags would lose their equipment. */
static bool choose_equipment(struct matching_run *run)
{
    char why[MODEL_INDEX_WHY_BYTES];
    struct text lines = { 0 };
    for (size_t i = 0; i < run->plant->tag_count; i++)
        if (run->plant->tags[i].asset >= 0)
            return fail_at(run->params->plant, "--equipment would replace assets that have tags: edit `assets` in the plant file by hand");
    int count = equipment_choose(&run->site, run->params->equipment, run->params->equipment_count, &lines, why);
    char *text = count < 0 ? NULL : plant_edit_replace(run->plant_text, "assets", lines.at);
    if (count >= 0 && !text)
        snprintf(why, sizeof(why), "--equipment can edit the list `assets` in the plant file only if each item is on a line of its own");
    struct plant *plant = text ? plant_trial_load(run->plant, text, NULL, "plantcast match") : NULL;
    text_finish(&lines);
    if (!text)
        return fail_at(run->params->plant, why);
    model_index_finish(&run->site);
    mem_free(run->plant_text);
    run->plant_text = text;
    if (!plant)
        return false;
    plant_destroy(&run->plant);
    run->plant = plant;
    printf("%s: %d nodes selected as assets\n", run->params->plant, count);
    return model_index_read(&run->site, run->plant, why) || fail_at(run->params->plant, why);
}

/* Reads the file `name` of the plant's folder if it exists. Returns false if it cannot be read. */
static bool read_optional(struct matching_run *run, const char *name,
                          bool (*read)(struct matcher *matcher, const char *path, char why[MATCH_WHY_BYTES]))
{
    char why[MATCH_WHY_BYTES], *path = beside(run, name);
    bool good = access(path, F_OK) != 0 || read(&run->matcher, path, why) || fail_at(path, why);
    mem_free(path);
    return good;
}

/* Reads the plant in this process. The confined child is only for the exported tag list; the plant's own files are read by the
   daemon, too. */
static bool read_plant(struct matching_run *run)
{
    const struct matching_params *params = run->params;
    char why[MODEL_INDEX_WHY_BYTES];
    size_t bytes;
    run->plant = plant_load_or_print(params->plant);
    if (!run->plant)
        return false;
    run->plant_text = text_read_file(params->plant, max_plant_bytes, &bytes);
    if (!run->plant_text)
        return fail_at(params->plant, strerror(errno));
    char *path = beside(run, "matches.csv");
    run->plant_before = mem_strdup(run->plant_text);
    run->tags_before = text_read_file(run->plant->files.tags_path, max_list_bytes, &bytes);
    run->matches_before = text_read_file(path, max_list_bytes, &bytes);
    mem_free(path);
    if (!model_index_read(&run->site, run->plant, why))
        return fail_at(params->plant, why);
    if (params->equipment_count > 0 && !choose_equipment(run))
        return false;
    return true;
}

/* Reads the exported tag list and the lists that go with it (rules, aliases, decisions); called in the confined child. */
static bool read_lists(struct matching_run *run)
{
    const struct matching_params *params = run->params;
    char why[MODEL_INDEX_WHY_BYTES];
    if (!tag_export_read(&run->list, params->tags, params->encoding, why, sizeof(why)))
        return fail_at(params->tags, why);
    print_list(run);
    run->matcher.site = &run->site;
    char *path = beside(run, "matches.csv");
    bool good = !params->decisions || decisions_read(&run->before, params->decisions, why) || fail_at(params->decisions, why);
    good = good && (decisions_read(&run->before, path, why) || fail_at(path, why));
    mem_free(path);
    return good && read_optional(run, "match_rules.csv", matcher_read_rules) && read_optional(run, "aliases.csv", matcher_read_aliases) &&
           (tag_rows_read(&run->rows, run->plant->files.tags_path, why) || fail_at(run->plant->files.tags_path, why));
}

/* --- deciding --------------------------------------------------------------------------------------------------------------- */

/* Applies people's decisions about tags, which override the matcher. */
static bool obey(struct matching_run *run)
{
    char *path = beside(run, "matches.csv"), why[200];
    bool good = true;
    for (size_t i = 0; i < run->list.count && good; i++) {
        const struct decision *decision = decisions_of(&run->before, run->list.tags[i].fields[EXPORT_NAME]);
        struct match *match = &run->matches[i];
        if (!decision || !decision->by_hand)
            continue;
        int asset = *decision->asset ? matcher_find_asset(&run->matcher, decision->asset) : -1;
        if (*decision->asset && asset < 0) {
            snprintf(why, sizeof(why), "tag %.60s: no asset of the plant is called '%.80s'", decision->tag, decision->asset);
            good = fail_at(path, why);
        }
        mem_free(match->reason);
        *match = (struct match){ .status = asset < 0 ? MATCH_NONE : decision->status,
                                 .asset = asset,
                                 .node = match->asset == asset ? match->node : -1,
                                 .confidence = match->asset == asset ? match->confidence : 1,
                                 .reason = mem_strdup("by hand") };
        if (match->node < 0 && match->confidence > 0.98)
            /* lowers the confidence below 1: the person has chosen only the asset; the sensor's position on it is assumed */
            match->confidence = 0.95;
        run->by_hand++;
    }
    mem_free(path);
    return good;
}

/* Determines the source of the tags: the one named by --source, the one added by --modbus, or the plant's only source. */
static bool find_source(struct matching_run *run)
{
    const struct matching_params *params = run->params;
    const struct plant_source *found = NULL;
    bool only = run->plant->source_count == 1 && (!params->modbus || !strcmp(run->plant->sources[0].kind, "modbus"));
    const char *id = params->source ? params->source : params->modbus && !only ? "plc" : NULL;
    for (size_t i = 0; i < run->plant->source_count; i++)
        if (id ? !strcmp(run->plant->sources[i].id, id) : only)
            found = &run->plant->sources[i];
    if (found)
        run->source = (struct tag_source){ found->id, !strcmp(found->kind, "modbus"),
                                           params->modbus ? params->address_base : found->address_base };
    else if (params->modbus)
        run->source = (struct tag_source){ id ? id : "plc", true, params->address_base };
    else if (params->source || run->plant->source_count > 1)
        return fail_at(params->plant, params->source ? "--source: the plant has no source with this id"
                                                     : "the plant has several sources: select one source with --source ID");
    return true;
}

static void put_rows(struct matching_run *run)
{
    decisions_add_header(&run->matches_text);
    for (size_t i = 0; i < run->list.count; i++) {
        static const char *const places[] = { "", "own node", "at ", "spread" };
        const struct export_tag *tag = &run->list.tags[i];
        const struct match *match = &run->matches[i];
        const struct decision *before = decisions_of(&run->before, tag->fields[EXPORT_NAME]);
        const struct place_proposal *place = &run->places[i];
        int quantity = run->quantities.of_tag[i];
        const char *asset = tag_rows_put(&run->rows, &(struct tag_row_input){ .site = &run->site,
                                                                              .tag = tag,
                                                                              .match = match,
                                                                              .before = before,
                                                                              .place = place,
                                                                              .group = quantity < 0 ? "" : run->quantities.at[quantity].id,
                                                                              .source = &run->source });
        const char *found = match->asset < 0 ? "" : run->plant->assets[match->asset].id;
        bool kept = asset && (!before || !before->edited) && match->status == MATCH_SURE && strcmp(asset, found) != 0;
        struct match shown = *match;
        if (kept) { /* a person edited this tag's asset in the tag list: keeps the edited asset in place of the match */
            shown.status = *asset ? MATCH_SURE : MATCH_NONE;
            found = asset;
        }
        const char *node = place->kind == PLACE_AT_NODE && place->node >= 0
                               ? run->site.models[run->site.assets[match->asset].model].nodes[place->node].name
                               : "";
        char *where = kept || (before && before->by_hand) ? mem_strdup("") : mem_printf("%s%s", places[place->kind], node);
        decisions_add_row(&run->matches_text, run->plant, tag->fields[EXPORT_NAME], &shown, found, where,
                          kept || (before && before->by_hand));
        mem_free(where);
        run->left_out += !asset;
        run->written += asset != NULL;
        run->own_nodes += asset && place->kind == PLACE_OWN_NODE;
        run->assumed += asset && (place->kind == PLACE_AT_NODE || place->kind == PLACE_SPREAD);
    }
}

/* --- tags of earlier runs that are missing from the current list -------------------------------------------------------------- */

enum { LEFT_NAMED = 20 };

static int by_folded_name(const void *a, const void *b)
{
    return strcasecmp(*(const char *const *)a, *(const char *const *)b);
}

/* Returns whether a tag of an earlier run comes from the control system of the current export, judging by its source in the plant file. */
static bool is_of_source(const struct matching_run *run, const char *tag)
{
    for (size_t i = 0; i < run->plant->tag_count; i++)
        if (!strcasecmp(run->plant->tags[i].name, tag) && run->plant->tags[i].source >= 0)
            return !run->source.id || !strcmp(run->plant->sources[run->plant->tags[i].source].id, run->source.id);
    return run->plant->source_count <= 1;
}

/* Keeps decisions about tags that are missing from the current export, because they may belong to another control system, or
 * reappear in a later export. */
static void keep_left(struct matching_run *run)
{
    const char **names = mem_array(run->list.count + 1, sizeof(*names));
    for (size_t i = 0; i < run->list.count; i++)
        names[i] = run->list.tags[i].fields[EXPORT_NAME];
    qsort(names, run->list.count, sizeof(*names), by_folded_name);
    for (size_t i = 0; i < run->before.count; i++) {
        const char *tag = run->before.at[i].tag;
        if (bsearch(&tag, names, run->list.count, sizeof(*names), by_folded_name))
            continue;
        text_add(&run->matches_text, "%s", run->before.at[i].row);
        if (!is_of_source(run, tag))
            continue;
        if (run->left < LEFT_NAMED)
            text_add(&run->left_names, "%s%s", run->left > 0 ? ", " : "", tag);
        run->left++;
    }
    mem_free(names);
}

/* --- the plant file --------------------------------------------------------------------------------------------------------- */

/* Appends a group of sensors to the plant file's lines. The range of the group's colour scale is derived from the scaled limits
   (lowest and highest measurable values) of its tags. */
static void add_group(const struct quantity *quantity, struct text *lines)
{
    bool known = quantity->low < quantity->high;
    text_add(lines, "  - { id: ");
    plant_edit_add_quoted(lines, quantity->id);
    text_add(lines, ", quantity: ");
    plant_edit_add_quoted(lines, quantity->name);
    text_add(lines, ", unit: ");
    plant_edit_add_quoted(lines, quantity->unit);
    text_add(lines, ", min: %.6g, max: %.6g } # %zu tags; ", known ? quantity->low : 0, known ? quantity->high : 100, quantity->tags);
    text_add(lines, known ? "range: the scaled limits of these tags"
                          : "the range is a guess: no tag of the group has lowest and highest measurable values (scaled limits)");
    if (quantity->blank > 0)
        text_add(lines, "; %zu tags have no unit", quantity->blank);
    text_add(lines, "\n");
}

static bool take_text(struct matching_run *run, char *text)
{
    if (!text)
        return fail_at(run->params->plant, "plantcast match can edit the lists `groups` and `sources` in the plant file only if each item "
                                           "is on a line of its own");
    mem_free(run->new_text);
    run->new_text = text;
    return true;
}

static char *source_line(const struct matching_run *run)
{
    const struct matching_params *params = run->params;
    const char *colon = strchr(params->modbus, ':');
    struct text line = { 0 };
    text_add(&line, "  - { id: %s, type: modbus, host: %.*s", run->source.id,
             (int)(colon ? colon - params->modbus : (long)strlen(params->modbus)), params->modbus);
    if (colon)
        text_add(&line, ", port: %s", colon + 1);
    if (params->unit >= 0)
        text_add(&line, ", unit: %d", params->unit);
    text_add(&line, ", address_base: %d", params->address_base);
    if (params->byte_order)
        text_add(&line, ", byte_order: %s", params->byte_order);
    text_add(&line, " }\n");
    return line.at;
}

/* Updates the line of the tags' source in the plant file, unless a person has edited the line since source_line() wrote it. */
static bool change_source(struct matching_run *run)
{
    regex_t regex;
    regmatch_t found;
    char *line = source_line(run),
         *pattern = mem_printf("^  - \\{ id: %s, type: modbus, host: [^ ,]+(, port: [0-9]+)?(, unit: [0-9]+)?, address_base: [01]"
                               "(, byte_order: [A-D]{4})? \\}$",
                               run->source.id);
    bool ours = regcomp(&regex, pattern, REG_EXTENDED | REG_NEWLINE) == 0 && regexec(&regex, run->new_text, 1, &found, 0) == 0,
         same = strstr(run->new_text, line) != NULL, good = same || ours;
    if (ours && !same)
        take_text(run, mem_printf("%.*s%.*s%s", (int)found.rm_so, run->new_text, (int)strlen(line) - 1, line, run->new_text + found.rm_eo));
    regfree(&regex);
    mem_free(pattern);
    mem_free(line);
    return good ||
           fail_at(run->params->plant, "--modbus cannot change a source that was edited by hand: edit the source in the plant file");
}

static bool add_source(struct matching_run *run)
{
    for (size_t i = 0; i < run->plant->source_count; i++)
        if (!strcmp(run->plant->sources[i].id, run->source.id))
            return change_source(run);
    char *line = source_line(run), *text = plant_edit_append(run->new_text, "sources", "# Where values come from.\n", line);
    mem_free(line);
    return take_text(run, text);
}

static bool compose_plant(struct matching_run *run, bool placeholder)
{
    struct text lines = { 0 };
    size_t used = 0;
    run->new_text = mem_strdup(run->plant_text);
    for (size_t i = 0; i < run->quantities.count; i++)
        if (run->quantities.at[i].is_new) {
            add_group(&run->quantities.at[i], &lines);
            used++;
        }
    bool good = used == 0 || take_text(run, plant_edit_append(run->new_text, "groups", "# What is measured.\n", lines.at));
    text_finish(&lines);
    if (good && used > 0 && placeholder)
        good = take_text(run, plant_edit_remove_line(run->new_text, plant_edit_placeholder));
    return good && (!run->params->modbus || add_source(run));
}

/* --- writing ---------------------------------------------------------------------------------------------------------------- */

/* Returns whether a file still has the text that was read. Called immediately before writing, because matching may take
 * minutes, during which others may save the file. */
static bool is_as_read(const char *path, const char *before)
{
    size_t length = 0;
    char *now = text_read_file(path, max_list_bytes, &length);
    bool is = before && now ? !strcmp(before, now) : before == now;
    mem_free(now);
    return is || fail_at(path, "this file was changed by another program during matching, so nothing was written: run the command again");
}

static bool add_one(struct file_set *set, const char *path, const char *before, const char *text)
{
    int status = before && !strcmp(before, text) ? 0 : file_set_add(set, path, text);
    return status == 0 || fail_at(path, strerror(-status));
}

static void say_written(const char *path, const char *before, const char *text)
{
    printf("%s: %s\n", path, before && !strcmp(before, text) ? "unchanged" : "written");
}

/* Writes the plant's files. The plant file comes first, because it only gains groups and a source, and is valid with the old
 * tag list. matches.csv comes last: if the run is killed before that, the next run completes the work and does not mistake the
 * tag list's new rows for people's edits. */
static bool write_files(struct matching_run *run, const char *matches_path)
{
    const char *plant = run->params->plant, *tags = run->plant->files.tags_path;
    struct file_set set = { 0 };
    bool good = add_one(&set, plant, run->plant_before, run->new_text) && add_one(&set, tags, run->tags_before, run->tags_text.at) &&
                add_one(&set, matches_path, run->matches_before, run->matches_text.at) && is_as_read(plant, run->plant_before) &&
                is_as_read(tags, run->tags_before) && is_as_read(matches_path, run->matches_before);
    if (good) {
        int status = file_set_commit(&set);
        good = status == 0 || fail_at(run->plant->files.folder, strerror(-status));
    }
    file_set_abandon(&set);
    if (good) {
        say_written(tags, run->tags_before, run->tags_text.at);
        say_written(matches_path, run->matches_before, run->matches_text.at);
        say_written(plant, run->plant_before, run->new_text);
    }
    return good;
}

static void say_rows(const struct tag_rows *rows, FILE *out)
{
    const struct {
        const struct tag_names *names;
        const char *one, *many;
    } lines[] = {
        { &rows->types, "tag is not in the tag list, because Plantcast does not know the data type or it does not fit the address",
          "tags are not in the tag list, because Plantcast does not know the data type or it does not fit the address" },
        { &rows->scalings, "tag has no scaling in the tag list and would show raw values, because the scaling cannot be used",
          "tags have no scaling in the tag list and would show raw values, because the scaling cannot be used" },
        { &rows->ranges, "tag has no range in the tag list, because only one end of the range is a number",
          "tags have no range in the tag list, because only one end of the range is a number" },
        { &rows->limits, "tag has no alarm limits in the tag list, because its limits do not rise from LL to HH",
          "tags have no alarm limits in the tag list, because their limits do not rise from LL to HH" },
        { &rows->differing, "tag has another address, type, scaling, unit or limit in this export; the tag list keeps its own",
          "tags have another address, type, scaling, unit or limit in this export; the tag list keeps its own" },
    };
    struct text text = { 0 };
    for (size_t i = 0; i < sizeof(lines) / sizeof(*lines); i++)
        tag_names_say(lines[i].names, lines[i].one, lines[i].many, &text);
    fputs(text.at ? text.at : "", out);
    text_finish(&text);
}

static void print_result(const struct matching_run *run, FILE *out)
{
    size_t counts[3] = { 0 };
    for (size_t i = 0; i < run->list.count; i++)
        counts[run->matches[i].status]++;
    fprintf(out, "%zu tags; matches to equipment: %zu sure, %zu likely, %zu none", run->list.count, counts[MATCH_SURE],
            counts[MATCH_LIKELY], counts[MATCH_NONE]);
    fprintf(out, run->by_hand > 0 ? "; %zu of them by hand\n" : "\n", run->by_hand);
    fprintf(out, "positions: %zu tags are at a node of their own, %zu tags at an assumed position of their equipment\n", run->own_nodes,
            run->assumed);
    size_t left_out = run->left_out - run->rows.types.count;
    if (left_out > 0)
        fprintf(out,
                left_out == 1 ? "%zu tag is not in the tag list, because the tag is text or has no address for %s\n"
                              : "%zu tags are not in the tag list, because these tags are text or have no address for %s\n",
                left_out, run->source.id ? run->source.id : "a source");
    say_rows(&run->rows, out);
    if (run->left > 0)
        fprintf(out, "%zu tags are no longer in the exported list; decisions about these tags are kept: %s%s\n", run->left,
                run->left_names.at, run->left > LEFT_NAMED ? ", ..." : "");
    if (!run->source.id)
        fprintf(out, "the tag list has no addresses, because the plant has no source: add one with --modbus HOST\n");
    for (size_t i = 0; i < run->quantities.count; i++)
        if (run->quantities.at[i].is_new)
            fprintf(out, "group %s: %zu tag%s\n", run->quantities.at[i].id, run->quantities.at[i].tags,
                   run->quantities.at[i].tags == 1 ? "" : "s");
}

static bool write_all(struct matching_run *run)
{
    char *matches_path = beside(run, "matches.csv");
    struct plant *loaded = plant_trial_load(run->plant, run->new_text, run->tags_text.at, "plantcast match");
    bool good = loaded != NULL;
    plant_destroy(&loaded);
    if (good)
        fputs(run->result, stdout);
    if (good && !run->params->dry_run)
        good = write_files(run, matches_path);
    mem_free(matches_path);
    return good;
}

static void finish(struct matching_run *run)
{
    matches_free(run->matches, run->list.count);
    quantities_finish(&run->quantities);
    mem_free(run->places);
    tag_export_finish(&run->list);
    matcher_finish(&run->matcher);
    decisions_finish(&run->before);
    tag_rows_finish(&run->rows);
    model_index_finish(&run->site);
    plant_destroy(&run->plant);
    text_finish(&run->tags_text);
    text_finish(&run->matches_text);
    text_finish(&run->left_names);
    mem_free(run->result);
    mem_free(run->plant_text);
    mem_free(run->new_text);
    mem_free(run->plant_before);
    mem_free(run->tags_before);
    mem_free(run->matches_before);
}

/* Locks the plant's folder. Returns a file descriptor, or a negative number after printing the error. */
static int lock_folder(const struct matching_params *params)
{
    char *folder = plant_folder_of(params->plant), *why = NULL;
    int lock = file_set_lock(&(struct plant_folder_params){ .folder = folder, .lent = params->lent }, &why);
    if (lock < 0)
        fail_at(lock == -EWOULDBLOCK ? folder : params->plant, why);
    mem_free(why);
    mem_free(folder);
    return lock;
}

/* --- the confined child --- */

struct matching_answer {
    struct matching_run *run;
    int file; /* memory file to which the confined child writes the files' new texts, each as an 8-byte length and its bytes */
};

static bool put_text(int file, const char *text)
{
    uint64_t length = text ? strlen(text) : 0;
    bool good = write(file, &length, sizeof(length)) == (ssize_t)sizeof(length);
    for (ssize_t n; good && length > 0; text += n, length -= (uint64_t)n) {
        n = write(file, text, length);
        good = n > 0;
    }
    return good;
}

/* Reads a text from the confined child's answer. Returns NULL if the answer is malformed; the child may be compromised. */
static char *get_text(int file)
{
    uint64_t length;
    if (read(file, &length, sizeof(length)) != (ssize_t)sizeof(length) || length > max_list_bytes)
        return NULL;
    char *text = mem_new(length + 1);
    for (size_t at = 0; at < length;) {
        ssize_t n = read(file, text + at, length - at);
        if (n <= 0 || memchr(text + at, 0, (size_t)n)) {
            mem_free(text);
            return NULL;
        }
        at += (size_t)n;
    }
    return text;
}

/* Reads and matches the untrusted tag list and composes all files; runs in the confined child. Returns the child's exit status:
 * 0, or 1 after printing the error. */
static int match_in_child(void *arg)
{
    const struct matching_answer *answer = arg;
    struct matching_run *run = answer->run;
    if (!read_lists(run) || !find_source(run))
        return 1;
    run->matches = matcher_run(&run->matcher, &run->list);
    if (!obey(run))
        return 1;
    bool placeholder = strstr(run->plant_text, plant_edit_placeholder) != NULL;
    for (size_t i = 0; i < run->plant->tag_count; i++)
        placeholder &= run->plant->tags[i].group < 0;
    quantities_find(&run->quantities, run->plant, placeholder ? "temperature" : NULL, &run->list, run->matches);
    run->places = places_find(&run->site, &run->list, run->matches, &run->quantities);
    put_rows(run);
    keep_left(run);
    tag_rows_write(&run->rows, &run->tags_text);
    if (!compose_plant(run, placeholder))
        return 1;
    size_t length;
    FILE *out = open_memstream(&run->result, &length);
    if (!out)
        return 1;
    print_result(run, out);
    fclose(out);
    return put_text(answer->file, run->new_text) && put_text(answer->file, run->tags_text.at) &&
                   put_text(answer->file, run->matches_text.at) && put_text(answer->file, run->result)
               ? 0
               : 1;
}

static bool take_answer(struct matching_run *run, int file)
{
    char *texts[4];
    bool good = lseek(file, 0, SEEK_SET) == 0;
    for (int i = 0; i < 4; i++)
        texts[i] = get_text(file);
    for (int i = 0; i < 4; i++)
        good = good && texts[i];
    if (good) {
        run->new_text = texts[0];
        text_add(&run->tags_text, "%s", texts[1]);
        text_add(&run->matches_text, "%s", texts[2]);
        run->result = texts[3];
    }
    for (int i = good ? 1 : 0; i < (good ? 3 : 4); i++)
        mem_free(texts[i]);
    return good ||
           fail_at(run->params->tags, "the tag list could not be matched: the process that read it ended without a result or reason");
}

static void add_paths(const struct matching_run *run, struct child_paths *paths)
{
    const struct matching_params *params = run->params;
    const char *const stated[] = { params->tags, params->decisions, run->plant->files.tags_path };
    static const char *const names[] = { "matches.csv", "match_rules.csv", "aliases.csv" };
    for (size_t i = 0; i < sizeof(stated) / sizeof(stated[0]); i++)
        child_paths_add(paths, stated[i], CONFINE_READ);
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        char *path = beside(run, names[i]);
        child_paths_add(paths, path, CONFINE_READ);
        mem_free(path);
    }
}

/* Runs the matching in a confined child process, which can write nothing but its answer. Returns false if the child failed. */
static bool match(struct matching_run *run)
{
    char why[CHILD_WHY_BYTES], folder[PATH_MAX];
    struct text said = { 0 }, errors = { 0 };
    struct child_paths paths = { 0 };
    struct matching_answer answer = { run, memfd_create("matches", MFD_CLOEXEC) };
    if (answer.file < 0 || !getcwd(folder, sizeof(folder))) {
        fail_at(run->params->tags, strerror(errno));
        if (answer.file >= 0)
            close(answer.file);
        return false;
    }
    add_paths(run, &paths);
    bool good = child_run(&(struct child_params){ .call = match_in_child,
                                                  .arg = &answer,
                                                  .name = "the tag list reader",
                                                  /* the child starts in the current folder of this program, so that relative
                                                     paths in the options stay valid */
                                                  .folder = folder,
                                                  .timeout_s = run->params->timeout_s,
                                                  .memory_bytes = run->params->memory_bytes,
                                                  .timeout_option = "limit set by --timeout, or by plantcastd --limit import-seconds",
                                                  .memory_option = "limit set by --memory, or by plantcastd --limit import-megabytes",
                                                  .role = CONFINE_READER,
                                                  .paths = paths.at,
                                                  .path_count = paths.count,
                                                  .result = answer.file,
                                                  .errors = &errors },
                          &said, why);
    fputs(said.at ? said.at : "", stdout);
    if (why[0])
        fail_at(run->params->tags, why);
    else
        fputs(errors.at ? errors.at : "", stderr);
    good = good && take_answer(run, answer.file);
    close(answer.file);
    child_paths_finish(&paths);
    text_finish(&said);
    text_finish(&errors);
    return good;
}

int matching_run(const struct matching_params *params)
{
    struct matching_run run = { .params = params };
    int lock = lock_folder(params);
    bool good = lock >= 0 && read_plant(&run) && match(&run) && write_all(&run);
    finish(&run);
    if (lock >= 0)
        close(lock);
    return good ? 0 : 1;
}
