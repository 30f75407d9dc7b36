/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the orders with which users at desks send views to the panes of wall displays: the newest one for each pane. A new
   order for a pane replaces the older one. */
#include "views/wall_remote.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "views/kept_list.h"

enum { SEEN = 256 }; /* maximum number of wall displays that the plant file can have */

struct pointer {
    struct wall_place place;
    bool points;
    double position_m[3];
    char by[2 * WALL_DESK_BYTES + 64];
    uint64_t number;
};

struct display_seen {
    char wall[NAMED_VIEW_ID_BYTES];
    int display;
    bool there;
};

struct wall_remote {
    const struct plant *plant;
    struct kept_list kept; /* form of an order: { id, wall, display, area, view, title, held, desk, by, time_us } */
    struct pointer pointers[WALL_POINTERS];
    uint64_t pointed;
    struct display_seen seen[SEEN];
    size_t seen_count;
};

/* --- the file --------------------------------------------------------------------------------------------------------------- */

static bool good_order(const json_t *order)
{
    const char *view = json_string_value(json_object_get(order, "view"));
    return !*view || !named_view_address_wrong(view);
}

static const struct kept_list_kind KIND = {
    WALL_REMOTE_FILE, "walls", "the keys id, wall, display, area, view, title, held, desk, by and time_us",
    WALLS * WALL_DISPLAYS * WALL_PANES, { "id", "wall", "area", "view", "title", "desk", "by" }, { "display", "time_us" }, good_order
};

struct wall_remote *wall_remote_open(struct log *log, const struct plant *plant, const char *folder, struct file_writer *writer)
{
    struct wall_remote *remote = mem_new(sizeof(*remote));
    remote->plant = plant;
    kept_list_open(&remote->kept, log, folder, &KIND, writer);
    return remote;
}

void wall_remote_close(struct wall_remote **pointer)
{
    struct wall_remote *remote = *pointer;
    if (!remote)
        return;
    kept_list_close(&remote->kept);
    mem_free(remote);
    *pointer = NULL;
}

const char *wall_remote_unread_file(const struct wall_remote *remote)
{
    return kept_list_unread_file(&remote->kept);
}

/* --- orders ----------------------------------------------------------------------------------------------------------------- */

const char *wall_place_wrong(const struct plant *plant, const struct wall_place *place)
{
    const struct wall *wall = wall_find(plant, place->wall);
    if (!wall)
        return "wall: unknown wall";
    if (place->display < 1 || place->display > (int)wall->display_count)
        return "display: the wall has no such display";
    const struct wall_display *display = &wall->displays[place->display - 1];
    for (size_t i = 0; i < display->pane_count; i++)
        if (!strcmp(display->panes[i].area, place->area))
            return display->panes[i].kind == PANE_VIEWS ? NULL : "area: only a pane with the key `views` accepts views, holds and pointers";
    return place->area[0] ? "area: the display has no such pane" : NULL;
}

static void print_id(const struct wall_place *place, char id[NAMED_VIEW_ID_BYTES + WALL_AREA_BYTES + 8])
{
    snprintf(id, NAMED_VIEW_ID_BYTES + WALL_AREA_BYTES + 8, "%s/%d/%s", place->wall, place->display, place->area);
}

enum refusal_code wall_remote_order(struct wall_remote *remote, const struct wall_order *order, const char *who, int64_t now_us)
{
    char id[NAMED_VIEW_ID_BYTES + WALL_AREA_BYTES + 8];
    const struct wall_place *place = &order->place;
    if (remote->kept.unreadable)
        return kept_list_refusal(&remote->kept);
    print_id(place, id);
    json_t *entry = json_pack("{s:s,s:s,s:i,s:s,s:s,s:s,s:b,s:s,s:s,s:I}", "id", id, "wall", place->wall, "display", place->display, "area",
                              place->area, "view", order->view, "title", order->title, "held", order->held, "desk", order->desk, "by", who,
                              "time_us", (json_int_t)now_us);
    if (!entry)
        return REFUSAL_NOT_UTF8;
    json_t *list = json_copy(kept_list_newest(&remote->kept));
    size_t at = kept_list_find(list, id);
    if (at < json_array_size(list))
        json_array_remove(list, at);
    if (order->view[0] || order->held)
        json_array_append(list, entry);
    json_decref(entry);
    return kept_list_put(&remote->kept, list);
}

/* --- pointers --------------------------------------------------------------------------------------------------------------- */

static bool same_place(const struct wall_place *a, const struct wall_place *b)
{
    return a->display == b->display && !strcmp(a->wall, b->wall) && !strcmp(a->area, b->area);
}

static void set_pointer(struct wall_remote *remote, const struct wall_place *place, const double *position_m, const char *by)
{
    /* takes the pointer that already points into this pane or, if there is none, the pointer that was moved least recently */
    struct pointer *pointer = &remote->pointers[0];
    for (int i = 0; i < WALL_POINTERS; i++) {
        if (same_place(&remote->pointers[i].place, place)) {
            pointer = &remote->pointers[i];
            break;
        }
        if (remote->pointers[i].number < pointer->number)
            pointer = &remote->pointers[i];
    }
    pointer->place = *place;
    pointer->points = position_m != NULL;
    if (position_m)
        memcpy(pointer->position_m, position_m, sizeof(pointer->position_m));
    snprintf(pointer->by, sizeof(pointer->by), "%s", by);
    pointer->number = ++remote->pointed;
}

void wall_remote_point(struct wall_remote *remote, const struct wall_place *place, const double *position_m, const char *who,
                       const char *desk)
{
    char by[sizeof(remote->pointers[0].by)];
    snprintf(by, sizeof(by), "%.120s%s%.120s", desk, desk[0] ? ", " : "", who);
    set_pointer(remote, place, position_m, by);
}

static bool mirror_pointer(struct wall_remote *remote, const json_t *one)
{
    const char *wall = json_string_value(json_object_get(one, "wall")), *area = json_string_value(json_object_get(one, "area"));
    const char *by = json_string_value(json_object_get(one, "by"));
    const json_t *position = json_object_get(one, "position");
    struct wall_place place = { .display = (int)json_integer_value(json_object_get(one, "display")) };
    double position_m[3];
    if (!wall || strlen(wall) >= sizeof(place.wall) || !area || strlen(area) >= sizeof(place.area) || !by)
        return false;
    strcpy(place.wall, wall);
    strcpy(place.area, area);
    for (size_t i = 0; i < 3; i++)
        position_m[i] = json_number_value(json_array_get(position, i));
    set_pointer(remote, &place, json_array_size(position) == 3 ? position_m : NULL, by);
    return true;
}

bool wall_remote_mirror_pointers(struct wall_remote *remote, const json_t *pointed)
{
    const json_t *list = json_object_get(pointed, "list");
    bool good = json_is_array(list);
    for (size_t i = 0; i < json_array_size(list) && good; i++)
        good = mirror_pointer(remote, json_array_get(list, i));
    return good;
}

/* --- connected displays ----------------------------------------------------------------------------------------------------- */

void wall_remote_see(struct wall_remote *remote, const char *wall, int display, bool there)
{
    size_t i = 0;
    while (i < remote->seen_count && (remote->seen[i].display != display || strcmp(remote->seen[i].wall, wall) != 0))
        i++;
    if (i == SEEN)
        return;
    struct display_seen *seen = &remote->seen[i];
    if (i < remote->seen_count && seen->there == there)
        return;
    remote->seen_count += i == remote->seen_count;
    snprintf(seen->wall, sizeof(seen->wall), "%s", wall);
    seen->display = display;
    seen->there = there;
    remote->kept.number++;
}

/* --- messages --------------------------------------------------------------------------------------------------------------- */

uint64_t wall_remote_number(const struct wall_remote *remote)
{
    return remote->kept.number;
}

uint64_t wall_remote_pointer_number(const struct wall_remote *remote)
{
    return remote->pointed;
}

/* Returns whether the pane of an order exists in the plant file. An order for a missing pane is stored but not sent, because a later plant
 * file may have the pane again. */
static bool is_there(const struct wall_remote *remote, const json_t *order)
{
    struct wall_place place = { .display = (int)json_integer_value(json_object_get(order, "display")) };
    snprintf(place.wall, sizeof(place.wall), "%s", json_string_value(json_object_get(order, "wall")));
    snprintf(place.area, sizeof(place.area), "%s", json_string_value(json_object_get(order, "area")));
    return place.area[0] && !wall_place_wrong(remote->plant, &place);
}

char *wall_remote_text(const struct wall_remote *remote)
{
    json_t *list = json_array(), *displays = json_array();
    for (size_t i = 0; i < json_array_size(remote->kept.list); i++)
        if (is_there(remote, json_array_get(remote->kept.list, i)))
            json_array_append(list, json_array_get(remote->kept.list, i));
    for (size_t i = 0; i < remote->seen_count; i++)
        if (remote->seen[i].there)
            json_array_append_new(displays, json_pack("{s:s,s:i}", "wall", remote->seen[i].wall, "display", remote->seen[i].display));
    return json_text(json_pack("{s:s,s:o,s:o}", "type", "walls", "list", list, "displays", displays), 0);
}

char *wall_remote_pointers_text(const struct wall_remote *remote, uint64_t after)
{
    json_t *list = json_array();
    for (int i = 0; i < WALL_POINTERS; i++) {
        const struct pointer *pointer = &remote->pointers[i];
        if (pointer->number <= after)
            continue;
        const double *at = pointer->position_m;
        json_array_append_new(list, json_pack("{s:s,s:i,s:s,s:s?,s:o}", "wall", pointer->place.wall, "display", pointer->place.display,
                                              "area", pointer->place.area, "by", pointer->by, "position",
                                              pointer->points ? json_pack("[f,f,f]", at[0], at[1], at[2]) : json_null()));
    }
    return json_text(json_pack("{s:s,s:o}", "type", "pointed", "list", list), 0);
}

json_t *wall_remote_list(const struct wall_remote *remote)
{
    return remote->kept.list;
}

bool wall_remote_mirror(struct wall_remote *remote, json_t *list)
{
    return kept_list_mirror(&remote->kept, list);
}
