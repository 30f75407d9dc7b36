/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores named views as JSON, in the same form in memory and in the file. */
#include "views/named_views.h"

#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "views/kept_list.h"

struct named_views {
    const struct plant *plant;
    struct kept_list kept; /* form of a saved view: { id, title, view, by, time_us, before: [{ title, view, by, time_us }, ...] } */
};

/* --- the file --------------------------------------------------------------------------------------------------------------- */

static bool good_version(const json_t *view)
{
    const char *title = json_string_value(json_object_get(view, "title")), *address = json_string_value(json_object_get(view, "view"));
    return title && address && !named_view_title_wrong(title) && !named_view_address_wrong(address) &&
           json_is_string(json_object_get(view, "by")) && json_is_integer(json_object_get(view, "time_us"));
}

static bool good_view(const json_t *view)
{
    const json_t *before = json_object_get(view, "before");
    if (!named_view_id_valid(json_string_value(json_object_get(view, "id"))) || !good_version(view) || !json_is_array(before))
        return false;
    for (size_t k = 0; k < json_array_size(before); k++)
        if (!good_version(json_array_get(before, k)))
            return false;
    return true;
}

static const struct kept_list_kind VIEWS = {
    NAMED_VIEWS_FILE, "views", "the keys id, title, view, by, time_us and before",
    NAMED_VIEWS, { "id" }, { NULL }, good_view
};

struct named_views *named_views_open(struct log *log, const struct plant *plant, const char *folder, struct file_writer *writer)
{
    struct named_views *views = mem_new(sizeof(*views));
    views->plant = plant;
    kept_list_open(&views->kept, log, folder, &VIEWS, writer);
    views->kept.number = plant->screens.view_count + json_array_size(views->kept.list) > 0;
    return views;
}

void named_views_close(struct named_views **pointer)
{
    struct named_views *views = *pointer;
    if (!views)
        return;
    kept_list_close(&views->kept);
    mem_free(views);
    *pointer = NULL;
}

const char *named_views_unread_file(const struct named_views *views)
{
    return kept_list_unread_file(&views->kept);
}

/* --- changes ---------------------------------------------------------------------------------------------------------------- */

static enum refusal_code refusal(const struct named_views *views, const char *id)
{
    enum refusal_code why = kept_list_refusal(&views->kept);
    return why ? why : named_view_find(views->plant, id) ? REFUSAL_FIXED : REFUSAL_NONE;
}

/* Returns the earlier versions that a view has after a change: its current version, then the earlier ones that it has already. */
static json_t *versions(const json_t *view)
{
    json_t *all = json_copy(json_object_get(view, "before"));
    json_t *last = json_pack("{s:O,s:O,s:O,s:O}", "title", json_object_get(view, "title"), "view", json_object_get(view, "view"), "by",
                             json_object_get(view, "by"), "time_us", json_object_get(view, "time_us"));
    json_array_insert_new(all, 0, last);
    while (json_array_size(all) > NAMED_VIEW_VERSIONS)
        json_array_remove(all, NAMED_VIEW_VERSIONS);
    return all;
}

static bool same(const json_t *view, const struct named_view_edit *edit)
{
    return !strcmp(json_string_value(json_object_get(view, "title")), edit->title) &&
           !strcmp(json_string_value(json_object_get(view, "view")), edit->address);
}

enum refusal_code named_views_save(struct named_views *views, const struct named_view_edit *edit, const char *who, int64_t time_us)
{
    enum refusal_code why = refusal(views, edit->id);
    json_t *newest = kept_list_newest(&views->kept);
    size_t count = json_array_size(newest), at = kept_list_find(newest, edit->id);
    json_t *old = json_array_get(newest, at), *list, *view;
    if (why || (!old && count >= NAMED_VIEWS))
        return why ? why : REFUSAL_VIEWS;
    if (old && same(old, edit)) /* stores no earlier version if only the position of the view in the list changes */
        view = json_incref(old);
    else
        view = json_pack("{s:s,s:s,s:s,s:s,s:I,s:o}", "id", edit->id, "title", edit->title, "view", edit->address, "by", who, "time_us",
                         (json_int_t)time_us, "before", old ? versions(old) : json_array());
    if (!view)
        return REFUSAL_NOT_UTF8;
    list = json_copy(newest);
    if (old)
        json_array_remove(list, at);
    count = json_array_size(list);
    if (edit->at >= 0)
        at = (size_t)edit->at;
    json_array_insert_new(list, at < count ? at : count, view);
    return kept_list_put(&views->kept, list);
}

enum refusal_code named_views_remove(struct named_views *views, const char *id)
{
    enum refusal_code why = refusal(views, id);
    json_t *newest = kept_list_newest(&views->kept);
    size_t at = kept_list_find(newest, id);
    if (why || at == json_array_size(newest))
        return why ? why : REFUSAL_VIEWLESS;
    json_t *list = json_copy(newest);
    json_array_remove(list, at);
    return kept_list_put(&views->kept, list);
}

/* --- reading ---------------------------------------------------------------------------------------------------------------- */

static const char *address_of(const json_t *view)
{
    return json_string_value(json_object_get(view, "view"));
}

const char *named_views_address(const struct named_views *views, const char *id)
{
    return address_of(json_array_get(views->kept.list, kept_list_find(views->kept.list, id)));
}

bool named_views_have(const struct named_views *views, const char *address)
{
    size_t i, k;
    const json_t *view, *old;
    json_array_foreach(views->kept.list, i, view)
    {
        if (!strcmp(address_of(view), address))
            return true;
        json_array_foreach(json_object_get(view, "before"), k, old) if (!strcmp(address_of(old), address)) return true;
    }
    return false;
}

/* --- messages --------------------------------------------------------------------------------------------------------------- */

uint64_t named_views_number(const struct named_views *views)
{
    return views->kept.number;
}

json_t *named_views_message(const struct named_views *views, const char *id)
{
    json_t *list = json_array();
    for (size_t i = 0; i < views->plant->screens.view_count; i++) {
        const struct named_view *view = &views->plant->screens.views[i];
        json_array_append_new(list, json_pack("{s:s,s:s,s:s,s:b}", "id", view->id, "title", view->title ? view->title : view->id, "view",
                                              view->address, "fixed", true));
    }
    for (size_t i = 0; i < json_array_size(views->kept.list); i++) {
        json_t *view = json_copy(json_array_get(views->kept.list, i));
        const char *name = json_string_value(json_object_get(view, "id"));
        if (!id || strcmp(name, id) != 0)
            json_object_del(view, "before");
        if (named_view_find(views->plant, name))
            json_decref(view);
        else
            json_array_append_new(list, view);
    }
    return json_pack("{s:s,s:o}", "type", "views", "list", list);
}

json_t *named_views_list(const struct named_views *views)
{
    return views->kept.list;
}

bool named_views_mirror(struct named_views *views, json_t *list)
{
    return kept_list_mirror(&views->kept, list);
}
