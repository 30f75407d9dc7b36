/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the alarm settings of the plant file and the tag list. PLANT.md and TAGS.md describe the format. */
#include "plant/sections/plant_alarms.h"

#include <string.h>
#include <strings.h>

#include "base/mem.h"

#define MAX_DELAY_S 86400.0

struct alarm_reference {
    char *text;
    size_t tag; /* index of the tag whose row of the tag list contains the reference to another tag */
    enum tag_column column;
    int line, at_column;
};

/* --- the plant file --------------------------------------------------------------------------------------------------------- */

void plant_alarms_read_mode(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    static const char *const names[] = { [ALARMS_DISPLAY] = "display", [ALARMS_MIRROR] = "mirror", [ALARMS_LOCAL] = "local" };
    const char *text = yaml_text(node);
    for (int i = 0; text && i < 3; i++) {
        if (strcmp(text, names[i]) != 0)
            continue;
        plant->alarms = (enum alarm_mode)i;
        return;
    }
    yaml_expected(reader, node, "alarms", "display, mirror or local");
}

void plant_alarms_read_group(struct yaml_reader *reader, yaml_node_t *node, void *group)
{
    static const struct yaml_choice latch_choices[] = { { "no", 0 }, { "yes", 1 }, { 0 } };
    static const struct yaml_key keys[] = {
        { "deadband", KEY_NUMBER, false, offsetof(struct plant_alarm_settings, deadband), 0, PLANT_MAX_VALUE, NULL, NULL },
        { "on_delay_s", KEY_NUMBER, false, offsetof(struct plant_alarm_settings, on_delay_s), 0, MAX_DELAY_S, NULL, NULL },
        { "off_delay_s", KEY_NUMBER, false, offsetof(struct plant_alarm_settings, off_delay_s), 0, MAX_DELAY_S, NULL, NULL },
        { "priority", KEY_INT, false, offsetof(struct plant_alarm_settings, priority), 1, ALARM_PRIORITIES, NULL, NULL },
        { "latch", KEY_FLAG, false, offsetof(struct plant_alarm_settings, latch), 0, 0, latch_choices, NULL },
        { 0 }
    };
    struct yaml_map map;
    yaml_map_read(reader, node, "alarm", keys, &((struct plant_group *)group)->alarm_settings, &map);
}

void plant_alarms_check(struct yaml_reader *reader, struct text_position place, const struct plant *plant)
{
    if (plant->alarms == ALARMS_LOCAL && plant->history.off)
        yaml_error(reader, place, "`alarms: local` requires `record: yes` in `history`, because alarm events are stored there");
}

/* --- rows ------------------------------------------------------------------------------------------------------------------- */

static void keep_reference(struct tag_columns *columns, const struct plant *plant, enum tag_column column,
                           struct alarm_references *references)
{
    if (!cell_given(columns, column))
        return;
    mem_grow(&references->at, &references->capacity, references->count + 1, sizeof(*references->at));
    references->at[references->count++] = (struct alarm_reference){
        .text = mem_strdup(cell_text(columns, column)),
        .tag = plant->tag_count - 1,
        .column = column,
        .line = csv_cell_line(&columns->csv, columns->at[column]),
        .at_column = csv_cell_column(&columns->csv, columns->at[column]),
    };
}

static void read_priority(struct tag_columns *columns, struct plant_alarm_settings *alarm_settings)
{
    double priority;
    if (!cell_number(columns, COL_PRIORITY, 1, ALARM_PRIORITIES, &priority))
        return;
    alarm_settings->priority = (int)priority;
    if (alarm_settings->priority != priority)
        cell_error(columns, COL_PRIORITY, "Priority: expected a whole number from 1 to %d, found '%.60s'", ALARM_PRIORITIES,
                   cell_text(columns, COL_PRIORITY));
}

void plant_alarms_read_row(struct tag_columns *columns, struct plant *plant, struct plant_tag *tag, struct alarm_references *references)
{
    struct plant_alarm_settings *alarm_settings = &tag->alarms.settings;
    *alarm_settings = (struct plant_alarm_settings){ .priority = ALARM_PRIORITY_DEFAULT };
    if (tag->group >= 0)
        *alarm_settings = plant->groups[tag->group].alarm_settings;
    if (cell_number(columns, COL_ALARM_DEADBAND, 0, PLANT_MAX_VALUE, &alarm_settings->deadband))
        alarm_settings->deadband = unit_change_span(&tag->scale.change, alarm_settings->deadband);
    cell_number(columns, COL_ON_DELAY, 0, MAX_DELAY_S, &alarm_settings->on_delay_s);
    cell_number(columns, COL_OFF_DELAY, 0, MAX_DELAY_S, &alarm_settings->off_delay_s);
    read_priority(columns, alarm_settings);
    if (cell_given(columns, COL_LATCH))
        alarm_settings->latch = cell_flag(columns, COL_LATCH);
    tag->alarms.suppressed_by = tag->alarms.mirror.tag = -1;
    keep_reference(columns, plant, COL_SUPPRESSED_BY, references);
    keep_reference(columns, plant, COL_MIRRORS, references);
    if (cell_given(columns, COL_MIRRORS) && plant->alarms != ALARMS_MIRROR)
        cell_warning(columns, COL_MIRRORS, "Mirrors has no effect, because the plant file has no `alarms: mirror`");
}

/* --- references between rows ------------------------------------------------------------------------------------------------ */

#define reference_error(r, ...) diag_error(diag, plant->files.tags_path, (r)->line, (r)->at_column, __VA_ARGS__)

static void resolve_suppression(struct plant *plant, struct diag *diag, const struct alarm_reference *reference)
{
    int by = plant_find_tag(plant, reference->text);
    if (by < 0)
        reference_error(reference, "Suppressed By: there is no tag '%.60s'", reference->text);
    else if (plant->tags[by].signal.type != DATA_BIT)
        reference_error(reference, "Suppressed By: '%.60s' is not a Boolean", reference->text);
    plant->tags[reference->tag].alarms.suppressed_by = by;
}

/* If the last word of the text is one of `words`, cuts that word off and returns its index in the list; otherwise returns -1. */
static int take_word(char *text, const char *const *words, int count)
{
    char *blank = strrchr(text, ' ');
    for (int i = 0; blank && i < count; i++)
        if (!strcasecmp(blank + 1, words[i])) {
            while (blank > text && blank[-1] == ' ')
                blank--;
            *blank = 0;
            return i;
        }
    return -1;
}

/* Finds the tag and the limit that a mirrored alarm bit reports, from a cell `TAG LIMIT [acknowledged]`; LIMIT is LL, L, H, HH or ALM. */
static void resolve_mirror(struct plant *plant, struct diag *diag, const struct alarm_reference *reference)
{
    static const char *const acknowledged[] = { "acknowledged" };
    static const char *const kinds[] = { "LL", "L", "H", "HH", "ALM" };
    struct plant_mirror *mirror = &plant->tags[reference->tag].alarms.mirror;
    char *text = mem_strdup(reference->text);
    mirror->acknowledged = take_word(text, acknowledged, 1) == 0;
    int kind = take_word(text, kinds, 5);
    mirror->limit = kind < 0 ? LIMIT_COUNT : kind;
    mirror->tag = plant_find_tag(plant, text);
    if (kind < 0)
        reference_error(reference, "Mirrors: expected a tag and LL, L, H, HH or ALM, optionally followed by 'acknowledged', found '%.60s'",
                        reference->text);
    else if (mirror->tag < 0)
        reference_error(reference, "Mirrors: there is no tag '%.60s'", text);
    else if (plant->tags[reference->tag].signal.type != DATA_BIT)
        reference_error(reference, "Mirrors: '%.60s' is not a Boolean", plant->tags[reference->tag].name);
    mem_free(text);
}

static void check_mirrored_once(const struct plant *plant, struct diag *diag, const struct alarm_references *references)
{
    for (size_t i = 0; i < references->count; i++) {
        const struct plant_mirror *one = &plant->tags[references->at[i].tag].alarms.mirror;
        for (size_t k = 0; k < i && references->at[i].column == COL_MIRRORS && one->tag >= 0; k++) {
            const struct plant_mirror *other = &plant->tags[references->at[k].tag].alarms.mirror;
            if (references->at[k].column == COL_MIRRORS && other->tag == one->tag && other->limit == one->limit &&
                other->acknowledged == one->acknowledged)
                reference_error(&references->at[i], "Mirrors: '%.60s' is already mirrored at line %d", references->at[i].text,
                                references->at[k].line);
        }
    }
}

void plant_alarms_resolve(struct plant *plant, struct diag *diag, struct alarm_references *references)
{
    for (size_t i = 0; i < references->count; i++)
        (references->at[i].column == COL_MIRRORS ? resolve_mirror : resolve_suppression)(plant, diag, &references->at[i]);
    check_mirrored_once(plant, diag, references);
    for (size_t i = 0; i < references->count; i++)
        mem_free(references->at[i].text);
    mem_free(references->at);
    *references = (struct alarm_references){ 0 };
}
