/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a pane of views shows: its views in turn, what a desk sent, or the place of an alarm. */
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "player.h"
#include "words.h"

struct rules_alarm *player_rules_alarms(const struct player *player)
{
    const struct model *model = &player->model;
    struct rules_alarm *list = mem_array(model->list_count + 1, sizeof(*list));
    for (size_t i = 0; i < model->list_count; i++) {
        const struct model_alarm *alarm = &model->list[i];
        const struct plant_tag *tag = alarm->tag >= 0 ? &model->plant.tags[alarm->tag] : NULL;
        list[i] = (struct rules_alarm){ .id = alarm->tag * ALARM_KINDS + (int)alarm->kind, .priority = alarm->priority };
        list[i].gone = alarm_status_is_cleared(alarm->status);
        list[i].waiting = alarm->waiting;
        list[i].has_place = tag && tag->asset >= 0 && tag->has_position;
        list[i].raised_us = alarm->raised_us;
    }
    return list;
}

/* What a desk sent to this pane, or NULL. */
static const json_t *find_order(const struct player *player, const struct pane *pane)
{
    char place[160];
    int display = pane->view.tile.display ? 1 : player->display; /* tiles are one picture, sent to the first */
    snprintf(place, sizeof(place), "%s/%d/%s", player->wall_id, display, pane->area);
    for (size_t i = 0; i < json_array_size(player->model.orders); i++) {
        const json_t *order = json_array_get(player->model.orders, i);
        const char *id = json_string_value(json_object_get(order, "id"));
        if (id && !strcmp(id, place))
            return order;
    }
    return NULL;
}

static const char *string_of(const json_t *o, const char *name)
{
    const char *text = json_string_value(json_object_get(o, name));
    return text ? text : "";
}

static void say_order(const struct player *player, const json_t *order, struct text *words)
{
    const char *desk = string_of(order, "desk"), *by = string_of(order, "by");
    char who[256];
    snprintf(who, sizeof(who), "%s%s%s", desk, *desk && *by ? ", " : "", by);
    const char *time = player_time(player, json_integer_value(json_object_get(order, "time_us")));
    bool held = json_is_true(json_object_get(order, "held"));
    text_add(words, " \u00b7 %s", say(held ? "walls.held" : "walls.sent", "who", who, "time", time, NULL));
}

/* Whether the pane stays as it is: nobody turns a page that somebody needs. */
static bool rests(const struct player *player, const struct pane *pane, const json_t *order, const struct rules_alarm *alarms)
{
    bool waits = order != NULL;
    for (size_t i = 0; i < player->model.list_count; i++)
        waits |= player->model.list[i].waiting;
    return waits || (pane->on_alarm && rules_is_flood(alarms, player->model.list_count, model_now_us(&player->model)));
}

static void say_alarm(const struct player *player, const struct model_alarm *alarm, struct text *words)
{
    char kind[32];
    snprintf(kind, sizeof(kind), "kind.%s", alarm_kind_name(alarm->kind));
    text_add(words, "%s %s \u00b7 %s", say(kind, NULL), model_alarm_name(&player->model, alarm),
             say("walls.since", "time", player_time(player, alarm->raised_us), NULL));
}

/* A text that is another one whenever another view, or another version of it, is to be seen. */
static void want(struct player *player, struct pane *pane, const json_t *order, const struct model_alarm *alarm, const char *address,
                 struct text *wanted)
{
    if (alarm)
        text_add(wanted, "alarm %d %d %d", alarm->tag, (int)alarm->kind, (int)alarm_status_is_cleared(alarm->status));
    else
        text_add(wanted, "view %zu %s %lld", pane->at, address, (long long)json_integer_value(json_object_get(order, "time_us")));
    text_add(wanted, " %dx%d %s", player->width_px, player->height_px, pane->view.configuration);
}

/* Whose address names what the plant does not have: another picture in its place would pass for it. */
static void say_wrong(const json_t *view, struct text *wrong)
{
    const char *why = string_of(view, "wrong");
    wrong->length = 0;
    if (*why)
        text_add(wrong, "%s", say("named.wrong", "why", why, NULL));
}

/* How long a view is shown. */
static int64_t dwell_ns(const struct pane *pane)
{
    double own_s = json_number_value(json_object_get(json_array_get(pane->stops, pane->at), "dwell_s"));
    return (int64_t)((own_s > 0 ? own_s : pane->every_s) * 1e9);
}

void pane_choose(struct player *player, struct pane *pane, int64_t now_ns)
{
    const struct model *model = &player->model;
    struct rules_alarm *alarms = player_rules_alarms(player);
    const json_t *order = find_order(player, pane);
    int called = pane->on_alarm ? rules_next(&player->call, alarms, model->list_count, now_ns, model_now_us(model)) : -1;
    const struct model_alarm *alarm = called >= 0 ? &model->list[called] : NULL;
    size_t count = json_array_size(pane->items);
    if (!rests(player, pane, order, alarms) && count > 1 && pane->changed_ns && now_ns - pane->changed_ns >= dwell_ns(pane))
        pane->at = (pane->at + 1) % count;
    const char *id = json_string_value(json_array_get(pane->items, pane->at));
    const json_t *view = model_view(model, id ? id : "");
    const char *sent = string_of(order, "view"), *address = *sent ? sent : string_of(view, "view");
    struct text wanted = { 0 };
    pane->called = alarm && (!pane->view.tile.display || pane->view.tile.leads);
    pane->words.length = 0;
    text_add(&pane->words, "%s", "");
    bool chooses = !pane->view.tile.display || pane->view.tile.leads;
    if (!chooses) /* what is shown is known to the one that leads */
        text_add(&pane->words, "%s", pane->title ? pane->title : player->wall_id);
    else if (alarm)
        say_alarm(player, alarm, &pane->words);
    else if (*sent)
        text_add(&pane->words, "%s", string_of(order, "title"));
    else if (!view)
        text_add(&pane->words, "%s", say("named.unknown", "id", id, NULL));
    else
        text_add(&pane->words, "%s", pane->title ? pane->title : *string_of(view, "title") ? string_of(view, "title") : id);
    const char *said = string_of(json_array_get(pane->stops, pane->at), "text");
    if (chooses && !order && !alarm && *said)
        text_add(&pane->words, " \u00b7 %s", said);
    if (chooses && order && !alarm)
        say_order(player, order, &pane->words);
    want(player, pane, order, alarm, address, &wanted);
    say_wrong(chooses && !alarm && !*sent ? view : NULL, &pane->wrong);
    if (!chooses)
        pane->wanted.length = 0;
    if (chooses && pane->view.greeted && view_pane_fits(&pane->view, model) &&
        (!pane->wanted.at || strcmp(wanted.at, pane->wanted.at) != 0)) {
        pane->wanted.length = 0;
        text_add(&pane->wanted, "%s", wanted.at);
        pane->changed_ns = now_ns;
        if (alarm)
            view_pane_show_tag(&pane->view, model, alarm->tag);
        else
            view_pane_show(&pane->view, model, address);
    }
    view_pane_tick(&pane->view, now_ns);
    text_finish(&wanted);
    mem_free(alarms);
}
