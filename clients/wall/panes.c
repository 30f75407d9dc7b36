/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What panes show besides the plant: alarms, tiles, the clock, a text. Each says what it shows as text first; only what differs is drawn.
   */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "brush.h"
#include "player.h"
#include "render/overlay/overlay_pen.h"
#include "value/quality.h"
#include "words.h"

static const double LETTERS = 13, PAD = 8; /* units */

const char *player_time(const struct player *player, int64_t us)
{
    static char texts[8][16];
    static int next;
    time_t seconds = (time_t)(us / 1000000);
    struct tm local;
    char *out = texts[next = (next + 1) % 8];
    (void)player; /* the time zone of the process is the plant's */
    if (!localtime_r(&seconds, &local) || strftime(out, sizeof(texts[0]), "%H:%M:%S", &local) == 0)
        snprintf(out, sizeof(texts[0]), "?");
    return out;
}

static int decimals_of(const struct model *model, int tag)
{
    int group = tag >= 0 ? model->plant.tags[tag].group : -1;
    double range = group >= 0 ? model->plant.groups[group].max - model->plant.groups[group].min : 0;
    return range > 0 && isfinite(range) ? (int)fmax(0, fmin(6, 2 - floor(log10(range / 4)))) : 2;
}

static const char *item_of(const struct pane *pane, size_t index)
{
    const char *text = json_string_value(json_array_get(pane->items, index));
    return text ? text : "";
}

static const char *about_age(int64_t age_ns)
{
    return say("walls.age", "age", say_age(age_ns), NULL);
}

/* The nth line of what it says, in a buffer that is used again after four others. */
static const char *line_of(const struct text *said, int number)
{
    static char lines[4][256];
    static int next;
    const char *at = said->at;
    char *out = lines[next = (next + 1) % 4];
    for (; number > 0 && at; number--) {
        at = strchr(at, '\n');
        at += at != NULL;
    }
    snprintf(out, sizeof(lines[0]), "%.*s", at ? (int)strcspn(at, "\n") : 0, at ? at : "");
    return out;
}

/* --- title ------------------------------------------------------------------------------------------------------------------------ */

void pane_draw_title(struct player *player, const struct pane *pane, cairo_t *cairo, const char *text, const char *about, int priority,
                     bool hollow)
{
    double unit = player->unit, size = LETTERS * unit, pad = PAD * unit;
    struct box title = { pane->box.x, pane->box.y, pane->box.width, pane->title_px };
    brush_fill(cairo, &title, pane->called ? RAISED : SURFACE);
    struct box line = { title.x, title.y + title.height - fmax(1, unit / 2), title.width, fmax(1, unit / 2) };
    brush_fill(cairo, &line, LINE);
    double y = title.y + 0.5 * (title.height - 1.36 * size);
    double width = *about ? brush_measure(cairo, 0.8 * size, false, about).width : 0;
    struct box right = { title.x + pad, y + 0.2 * size, title.width - 2 * pad, size };
    if (width < 0.6 * title.width)
        brush_text(cairo, &right, 0.8 * size, false, INK_2, ALIGN_RIGHT, false, about);
    else
        width = 0;
    struct box left = { title.x + pad, y, title.width - 3 * pad - width, 1.4 * size };
    if (priority) {
        brush_badge(cairo, left.x, title.y + 0.5 * (title.height - 1.3 * size), 1.3 * size, priority, hollow);
        left.x += 1.7 * size;
        left.width -= 1.7 * size;
    }
    brush_text(cairo, &left, size, true, INK, ALIGN_LEFT, false, text);
}

static struct box body_of(const struct pane *pane)
{
    return (struct box){ pane->box.x, pane->box.y + pane->title_px, pane->box.width, pane->box.height - pane->title_px };
}

/* --- alarms ----------------------------------------------------------------------------------------------------------------------- */

struct alarm_row {
    const struct model_alarm *alarm;
    int count; /* of a flood: so many of its equipment; 0: it is one */
    const char *name;
};

static bool is_worse(const struct model_alarm *a, const struct model_alarm *b)
{
    return a->priority != b->priority ? a->priority < b->priority : a->raised_us < b->raised_us;
}

/* Equipment with its alarms, the gravest first. */
static size_t by_equipment(const struct model *model, struct alarm_row *rows)
{
    size_t count = 0;
    for (size_t i = 0; i < model->list_count; i++) {
        const struct model_alarm *alarm = &model->list[i];
        int asset = alarm->tag >= 0 ? model->plant.tags[alarm->tag].asset : -1;
        const char *name = asset >= 0 ? model->plant.assets[asset].id : model_alarm_name(model, alarm);
        size_t at = 0;
        if (alarm_status_is_cleared(alarm->status))
            continue;
        while (at < count && strcmp(rows[at].name, name) != 0)
            at++;
        if (at == count)
            rows[count++] = (struct alarm_row){ alarm, 0, name };
        rows[at].count++;
        if (is_worse(alarm, rows[at].alarm))
            rows[at].alarm = alarm;
    }
    for (size_t i = 1; i < count; i++) /* few, and nearly sorted */
        for (size_t k = i; k > 0 && is_worse(rows[k].alarm, rows[k - 1].alarm); k--) {
            struct alarm_row row = rows[k];
            rows[k] = rows[k - 1];
            rows[k - 1] = row;
        }
    return count;
}

static bool is_flood(const struct player *player)
{
    struct rules_alarm *alarms = player_rules_alarms(player);
    bool flood = rules_is_flood(alarms, player->model.list_count, model_now_us(&player->model));
    mem_free(alarms);
    return flood;
}

static size_t alarm_rows(const struct player *player, bool flood, struct alarm_row **rows)
{
    const struct model *model = &player->model;
    *rows = mem_array(model->list_count + 1, sizeof(**rows));
    if (flood)
        return by_equipment(model, *rows);
    for (size_t i = 0; i < model->list_count; i++)
        (*rows)[i] = (struct alarm_row){ &model->list[i], 0, model_alarm_name(model, &model->list[i]) };
    return model->list_count;
}

static const char *kind_text(const struct model_alarm *alarm)
{
    char key[32];
    snprintf(key, sizeof(key), "kind.%s", alarm_kind_name(alarm->kind));
    return say(key, NULL);
}

static void alarm_texts(const struct player *player, const struct alarm_row *row, char head[200], char what[300])
{
    const struct model *model = &player->model;
    const struct model_alarm *alarm = row->alarm;
    char count[16];
    what[0] = 0;
    snprintf(head, 200, "%s %s", kind_text(alarm), model_alarm_name(model, alarm));
    if (row->count) {
        snprintf(count, sizeof(count), "%d", row->count);
        snprintf(what, 300, "%s", say("walls.many", "count", count, "worst", head, NULL));
        snprintf(head, 200, "%s", row->name);
        return;
    }
    if (alarm->tag < 0)
        return;
    const struct plant_tag *tag = &model->plant.tags[alarm->tag];
    int decimals = decimals_of(model, alarm->tag);
    if (!isnan(alarm->value) && !isnan(alarm->limit)) {
        char value[80];
        snprintf(value, sizeof(value), "%s %s", say_number(alarm->value, decimals), tag->unit);
        snprintf(what, 300, "%s", say("alarms.value", "value", value, "limit", say_number(alarm->limit, decimals), NULL));
    }
    if (tag->description[0])
        snprintf(what + strlen(what), 300 - strlen(what), "%s%s", what[0] ? " \u00b7 " : "", tag->description);
}

void pane_count_alarms(const struct player *player, char out[200])
{
    bool flood = is_flood(player);
    char active[16], waiting[16];
    int counts[2] = { 0, 0 };
    for (size_t i = 0; i < player->model.list_count; i++) {
        counts[0] += !alarm_status_is_cleared(player->model.list[i].status);
        counts[1] += player->model.list[i].waiting;
    }
    snprintf(active, sizeof(active), "%d", counts[0]);
    snprintf(waiting, sizeof(waiting), "%d", counts[1]);
    out[0] = 0;
    if (flood || counts[0] || counts[1])
        snprintf(out, 200, "%s", say(flood ? "walls.flood" : "walls.counts", "active", active, "waiting", waiting, NULL));
}

static void say_alarms(struct player *player, const struct pane *pane, int64_t now_ns, struct text *said)
{
    bool flood = is_flood(player);
    struct alarm_row *rows;
    char head[200], what[300], counts[200];
    size_t count = alarm_rows(player, flood, &rows);
    pane_count_alarms(player, counts);
    text_add(said, "%s\n%s\n%s\n", pane->title ? pane->title : say("alarms.title", NULL), about_age(now_ns - player->said_ns),
             counts[0] ? counts : say("alarms.none", NULL));
    for (size_t i = 0; i < count; i++) {
        alarm_texts(player, &rows[i], head, what);
        text_add(said, "%d %d %d %s %s %s\n", rows[i].alarm->priority, (int)rows[i].alarm->status, (int)rows[i].alarm->waiting, head, what,
                 player_time(player, rows[i].alarm->raised_us));
    }
    mem_free(rows);
}

/* As many as there is room for; the rest is counted. */
static void draw_alarms(struct player *player, const struct pane *pane, cairo_t *cairo)
{
    struct alarm_row *rows;
    size_t count = alarm_rows(player, is_flood(player), &rows);
    double unit = player->unit, size = LETTERS * unit, pad = PAD * unit, high = 3.1 * size, counts_px = 1.9 * size;
    struct box body = body_of(pane);
    double free_px = body.height - counts_px;
    size_t room = (size_t)fmax(1, floor(free_px / high)),
           shown = count <= room ? count : (size_t)fmax(1, floor((free_px - 1.5 * size) / high));
    brush_text_fitting(cairo, &(struct box){ body.x + pad, body.y + 0.2 * size, body.width - 2 * pad, 1.6 * size }, size, true, INK,
                       ALIGN_LEFT, line_of(&pane->said, 2));
    double y = body.y + counts_px;
    for (size_t i = 0; i < shown; i++, y += high) {
        char head[200], what[300];
        const struct model_alarm *alarm = rows[i].alarm;
        struct box row = { body.x, y, body.width, high - fmax(1, unit / 2) };
        alarm_texts(player, &rows[i], head, what);
        brush_fill(cairo, &row, alarm->waiting ? RAISED : SURFACE);
        const char *time = player_time(player, alarm->raised_us);
        struct box line = { row.x + pad + 1.8 * size, y + 0.2 * size, row.width - 2 * pad - 1.8 * size, size };
        double wide = brush_measure(cairo, size, false, time).width;
        brush_badge(cairo, row.x + pad, y + 0.3 * size, 1.3 * size, alarm->priority, alarm_status_is_cleared(alarm->status));
        brush_text(cairo, &line, size, false, INK_2, ALIGN_RIGHT, false, time);
        line.width -= wide + pad;
        brush_text(cairo, &line, size, alarm->waiting, INK, ALIGN_LEFT, false, head);
        line.y += 1.4 * size;
        line.width += wide + pad;
        brush_text(cairo, &line, 0.85 * size, false, INK_2, ALIGN_LEFT, false, what);
    }
    if (shown < count) {
        char more[24];
        snprintf(more, sizeof(more), "%zu", count - shown);
        struct box line = { body.x + pad, y, body.width - 2 * pad, size };
        brush_text(cairo, &line, size, false, INK_2, ALIGN_LEFT, false, say("walls.more", "count", more, NULL));
    }
    mem_free(rows);
}

/* --- tiles ------------------------------------------------------------------------------------------------------------------------- */

static const char *tile_value(const struct model *model, int tag, bool *known)
{
    const struct reading *reading = tag >= 0 ? &model->snapshot->readings[tag] : NULL;
    *known = reading && !quality_is_bad(reading->quality);
    return *known ? say_number(reading->value, decimals_of(model, tag)) : say("quality.bad", NULL);
}

static size_t tile_tags(const struct model *model, const struct pane *pane, int tags[PANE_ITEMS])
{
    size_t count = json_array_size(pane->items);
    for (size_t i = 0; i < count && i < PANE_ITEMS; i++)
        tags[i] = plant_find_tag(&model->plant, item_of(pane, i));
    return count < PANE_ITEMS ? count : PANE_ITEMS;
}

static void say_tiles(struct player *player, const struct pane *pane, int64_t now_ns, struct text *said)
{
    const struct model *model = &player->model;
    int tags[PANE_ITEMS];
    size_t count = tile_tags(model, pane, tags);
    text_add(said, "%s\n%s\n", pane->title ? pane->title : "", about_age(model_oldest_ns(model, tags, count, -1, now_ns)));
    for (size_t i = 0; i < count; i++) {
        bool known;
        const struct model_alarm *alarm = model_gravest(model, tags[i]);
        const char *value = tile_value(model, tags[i], &known);
        text_add(said, "%s %s %u %d %d\n", item_of(pane, i), value, tags[i] >= 0 ? model->snapshot->readings[tags[i]].quality : 0,
                 alarm ? alarm->priority : 0, alarm ? (int)alarm->status : 0);
    }
}

static double share_of(const struct plant_group *group, double value)
{
    return fmax(0, fmin(1, (value - group->min) / (group->max - group->min)));
}

/* Grey, with a band for the usual range, a mark where the value is, and its limits. */
static void draw_bar(cairo_t *cairo, const struct box *bar, const struct plant_tag *tag, const struct plant_group *group, double value,
                     bool known, double em)
{
    double low = share_of(group, isnan(tag->limits[LIMIT_L]) ? group->min : tag->limits[LIMIT_L]);
    double high = fmax(low, share_of(group, isnan(tag->limits[LIMIT_H]) ? group->max : tag->limits[LIMIT_H]));
    struct box usual = { bar->x + low * bar->width, bar->y, (high - low) * bar->width, bar->height };
    brush_fill(cairo, bar, GROUND);
    if (known)
        brush_fill(cairo, &usual, LINE);
    for (int i = 0; i < LIMIT_COUNT; i++) {
        if (isnan(tag->limits[i]))
            continue;
        bool outer = i == LIMIT_LL || i == LIMIT_HH;
        struct box line = { bar->x + share_of(group, tag->limits[i]) * bar->width, bar->y - 0.12 * em, 0.12 * em, bar->height + 0.24 * em };
        brush_fill(cairo, &line, outer ? INK : 0x7d858c);
    }
    if (known) {
        struct box at = { bar->x + share_of(group, value) * bar->width - 0.3 * em, bar->y - 0.25 * em, 0.6 * em, bar->height + 0.5 * em };
        brush_fill(cairo, &at, RAISED);
        brush_fill(cairo, &(struct box){ at.x + 0.08 * em, at.y + 0.08 * em, at.width - 0.16 * em, at.height - 0.16 * em }, INK);
    }
}

static void draw_tile(struct player *player, cairo_t *cairo, const struct box *box, const char *name, int tag, double em)
{
    const struct model *model = &player->model;
    const struct model_alarm *alarm = model_gravest(model, tag);
    bool known, gone = alarm && alarm_status_is_cleared(alarm->status);
    const char *value = tile_value(model, tag, &known);
    double line = 0.15 * em, x = box->x + 0.5 * em, width = box->width - em;
    brush_fill(cairo, box, RAISED);
    if (alarm && !gone) {
        cairo_rectangle(cairo, box->x + line / 2, box->y + line / 2, box->width - line, box->height - line);
        brush_colour(cairo, brush_priority(alarm->priority));
        cairo_set_line_width(cairo, line);
        cairo_stroke(cairo);
    }
    brush_text(cairo, &(struct box){ x, box->y + 0.25 * em, width - (alarm ? 1.4 * em : 0), em }, em, false, INK_2, ALIGN_LEFT, false,
               name);
    if (alarm)
        brush_badge(cairo, x + width - 1.1 * em, box->y + 0.35 * em, 1.1 * em, alarm->priority, gone);
    double y = box->y + 1.6 * em;
    struct box size = brush_text(cairo, &(struct box){ x, y, width, 2 * em }, known ? 1.6 * em : 1.1 * em, true, known ? INK : INK_2,
                                 ALIGN_LEFT, false, value);
    if (known && model->plant.tags[tag].unit[0])
        brush_text(cairo, &(struct box){ x + size.width + 0.3 * em, y + 0.8 * em, width - size.width - 0.3 * em, em }, em, false, INK_2,
                   ALIGN_LEFT, false, model->plant.tags[tag].unit);
    int group = tag >= 0 ? model->plant.tags[tag].group : -1;
    struct box bar = { x, box->y + 4.1 * em, width, 0.6 * em };
    if (group >= 0)
        draw_bar(cairo, &bar, &model->plant.tags[tag], &model->plant.groups[group], model->snapshot->readings[tag].value, known, em);
}

/* As many beside each other as are wide enough; smaller letters where there is no room for as large ones as there should be. */
static void draw_tiles(struct player *player, const struct pane *pane, cairo_t *cairo)
{
    int tags[PANE_ITEMS], columns = 1;
    size_t count = tile_tags(&player->model, pane, tags);
    struct box body = body_of(pane);
    double em = LETTERS * player->unit, least = 0.4 * em, gap = 0.25 * em;
    for (;; em *= 0.94) {
        gap = 0.25 * em;
        columns = (int)fmin(fmax(1, floor((body.width - gap) / (9 * em + gap))), (double)(count ? count : 1));
        double rows = ceil((double)count / columns);
        if (em < least || rows * (5.2 * em + gap) + gap <= body.height)
            break;
    }
    double width = (body.width - gap) / columns - gap;
    for (size_t i = 0; i < count; i++) {
        double column = (double)(i % (size_t)columns), row = (double)(i / (size_t)columns);
        struct box box = { body.x + gap + column * (width + gap), body.y + gap + row * (5.2 * em + gap), width, 5.2 * em };
        draw_tile(player, cairo, &box, item_of(pane, i), tags[i], em);
    }
}

/* --- clock, text ------------------------------------------------------------------------------------------------------------------ */

static void say_clock(const struct player *player, const struct pane *pane, struct text *said)
{
    time_t seconds = (time_t)(model_now_us(&player->model) / 1000000);
    struct tm local;
    char day[64] = "?";
    if (localtime_r(&seconds, &local))
        strftime(day, sizeof(day), "%Y-%m-%d %Z", &local);
    text_add(said, "%s\n%s\n%s%s%s", pane->title ? pane->title : player->model.plant.name, player_time(player, (int64_t)seconds * 1000000),
             day, player->model.clock_set ? "" : " \u00b7 ",
             player->model.clock_set ? "" : say("status.unset", "clock", say("status.clock", NULL), NULL));
}

/* The day goes into as many lines as it needs, as in the page; with the time it shrinks where they have no room. */
static void draw_clock(const struct player *player, const struct pane *pane, cairo_t *cairo)
{
    double em = LETTERS * player->unit, large = 0, high = 0;
    struct box body = body_of(pane), below = { body.x + 0.03 * body.width, 0, 0.94 * body.width, body.height };
    const char *day = line_of(&pane->said, 2);
    for (double least = 0.5 * em;; em *= 0.94) {
        struct box size = brush_measure(cairo, 2.6 * em, true, "00:00:00");
        large = 2.6 * em * fmin(1, 0.95 * body.width / size.width);
        high = brush_measure_wrapped(cairo, below.width, em, false, day).height;
        if (em < least || 1.4 * large + high <= body.height)
            break;
    }
    double y = body.y + fmax(0, 0.5 * (body.height - 1.4 * large - high));
    brush_text(cairo, &(struct box){ body.x, y, body.width, large }, large, true, INK, ALIGN_CENTRE, false, line_of(&pane->said, 1));
    below.y = y + 1.4 * large;
    below.height = fmax(high, body.y + body.height - below.y);
    brush_text(cairo, &below, em, false, INK_2, ALIGN_CENTRE, true, day);
}

static void draw_words(const struct player *player, const struct pane *pane, cairo_t *cairo)
{
    double em = LETTERS * player->unit, pad = PAD * player->unit;
    struct box body = body_of(pane), box = { body.x + pad, body.y + 0.5 * pad, body.width - 2 * pad, body.height - pad };
    for (size_t i = 0; i < json_array_size(pane->items) && box.height > em; i++) {
        double high = brush_text(cairo, &box, em, false, INK, ALIGN_LEFT, true, item_of(pane, i)).height;
        box.y += high;
        box.height -= high;
    }
}

/* --- all ----------------------------------------------------------------------------------------------------------------------------- */

void pane_say(struct player *player, struct pane *pane, int64_t now_ns, struct text *said)
{
    if (!pane->known) {
        text_add(said, "%s\n\nThis player cannot show a pane of %s", pane->title ? pane->title : pane->area, pane->kind_name);
        return;
    }
    switch (pane->kind) {
    case PANE_ALARMS: say_alarms(player, pane, now_ns, said); break;
    case PANE_TILES: say_tiles(player, pane, now_ns, said); break;
    case PANE_TREND: trend_say(player, pane, now_ns, said); break;
    case PANE_SNAPSHOT: snapshot_say(player, pane, now_ns, said); break;
    case PANE_CLOCK: say_clock(player, pane, said); break;
    default: text_add(said, "%s\n", pane->title ? pane->title : ""); break;
    }
}

void pane_draw(struct player *player, struct pane *pane, cairo_t *cairo, int64_t now_ns)
{
    brush_fill(cairo, &pane->box, SURFACE);
    pane_draw_title(player, pane, cairo, line_of(&pane->said, 0), pane->known && pane->kind == PANE_CLOCK ? "" : line_of(&pane->said, 1), 0,
                    false);
    if (!pane->known) {
        struct box body = body_of(pane);
        double em = LETTERS * player->unit;
        brush_text(cairo, &(struct box){ body.x + em, body.y + em, body.width - 2 * em, body.height - em }, em, false, INK_2, ALIGN_LEFT,
                   true, line_of(&pane->said, 2));
        return;
    }
    switch (pane->kind) {
    case PANE_ALARMS: draw_alarms(player, pane, cairo); break;
    case PANE_TILES: draw_tiles(player, pane, cairo); break;
    case PANE_TREND: {
        struct box body = body_of(pane);
        trend_draw(player, pane, cairo, &body);
        break;
    }
    case PANE_SNAPSHOT: {
        struct box body = body_of(pane);
        snapshot_draw(player, pane, cairo, &body, now_ns);
        break;
    }
    case PANE_CLOCK: draw_clock(player, pane, cairo); break;
    default: draw_words(player, pane, cairo); break;
    }
}
