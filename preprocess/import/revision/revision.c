/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans how new models change a plant's files, one model after the other: first its assets, then the tags on these assets. */
#include "preprocess/import/revision/revision.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "plant/models/transform.h"
#include "plant/tags/tag_edit.h"
#include "preprocess/import/revision/asset_pattern.h"
#include "preprocess/import/revision/model_states.h"

/* distance in metres below which positions in the old and the new model count as equal, because exports round to a millimetre */
static const double tolerance_m = 0.002;

struct planning {
    struct revision *revision;
    const struct revision_input *input;
    struct asset_edit *assets; /* planned edits of the plant file, by asset of the plant */
    struct tag_edit *tags;
    size_t tag_count, tag_room;
    struct text added;
    json_t *ids;
    struct revision_row *tag_rows;
    size_t tag_row_count, tag_row_room;
    /* state for the model being compared: */
    const char *file;
    struct model_states states;
    struct asset_patterns patterns;
    /* nodes that belong to the current asset; before: by node of the old model; after: by node of the new model */
    bool *before, *after;
    bool *lost;           /* by node of the old model: the current asset loses it, although the new model has its counterpart */
    bool loses;           /* the current asset loses nodes */
    bool *covered;        /* by node of the new model: it belongs to an asset */
    bool *set_free;       /* by node of the new model: an asset has lost it */
    bool *roots;          /* by node of the old model: a review row about an asset already mentions it */
    char *why;
};

/* --- the review ----------------------------------------------------------------------------------------------------------------- */

static void say(struct planning *p, enum revision_kind kind, const char *change, const char *name, const char *fmt, ...)
    __attribute__((format(printf, 5, 6)));
static void say(struct planning *p, enum revision_kind kind, const char *change, const char *name, const char *fmt, ...)
{
    struct text detail = { 0 }, printable = { 0 };
    va_list ap;
    va_start(ap, fmt);
    text_add_v(&detail, fmt, ap);
    va_end(ap);
    model_outline_add_printable(&printable, name);
    const struct revision_row row = { kind, change, printable.at ? printable.at : mem_strdup(""), detail.at ? detail.at : mem_strdup("") };
    if (kind == REVISION_TAG) {
        mem_grow(&p->tag_rows, &p->tag_row_room, p->tag_row_count + 1, sizeof(*p->tag_rows));
        p->tag_rows[p->tag_row_count++] = row;
    } else {
        mem_grow(&p->revision->rows, &p->revision->row_room, p->revision->row_count + 1, sizeof(*p->revision->rows));
        p->revision->rows[p->revision->row_count++] = row;
    }
}

static char *path_of(const struct model_outline *outline, size_t node)
{
    struct text path = { 0 };
    model_outline_path(outline, node, &path);
    return path.at;
}

static char *name_of(const struct model_outline *outline, size_t node)
{
    struct text name = { 0 };
    model_outline_name(outline, node, &name);
    return name.at;
}

/* Adds review rows about nodes that were added, removed or renamed. Of a whole subtree, only the topmost node gets a row. */
static void review_nodes(struct planning *p)
{
    const struct model_outline *old = &p->states.before.outline, *new = &p->states.after.outline;
    const struct node_pairs *pairs = &p->states.pairs;
    for (size_t i = 0; i < old->header.count; i++) {
        int parent = old->header.nodes[i].parent, other = pairs->to_new[i];
        bool first = parent < 0 || pairs->to_new[parent] >= 0;
        bool renamed = other >= 0 && strcmp(old->nodes[i].name, new->nodes[other].name) != 0;
        bool parent_renamed = parent >= 0 && pairs->to_new[parent] >= 0 &&
                              strcmp(old->nodes[parent].name, new->nodes[pairs->to_new[parent]].name) != 0;
        char *path = p->roots[i] || !((other < 0 && first) || (renamed && !parent_renamed)) ? NULL : path_of(old, i);
        if (path && other < 0)
            say(p, REVISION_NODE, "removed", path, "%zu nodes", old->header.nodes[i].end - i);
        char *name = path && other >= 0 ? name_of(new, (size_t)other) : NULL;
        if (name)
            say(p, REVISION_NODE, "renamed", path, "now %s", name);
        mem_free(name);
        mem_free(path);
    }
    for (size_t i = 0; i < new->header.count; i++) {
        int parent = new->header.nodes[i].parent;
        if (pairs->to_old[i] >= 0 || (parent >= 0 && pairs->to_old[parent] < 0))
            continue;
        char *path = path_of(new, i);
        say(p, REVISION_NODE, "added", path, "%zu nodes, %llu triangles", new->header.nodes[i].end - i,
            (unsigned long long)new->nodes[i].all_triangles);
        mem_free(path);
    }
}

/* --- frames --------------------------------------------------------------------------------------------------------------------- */

/* Computes the transform from the model's units and axes to the tag list's coordinates X, Y, Z. */
static void model_to_list(const struct plant_asset *asset, double out[16])
{
    const double u = asset->unit_m;
    const double upright[16] = { u, 0, 0, 0, 0, asset->up == AXIS_Y ? 0 : u, asset->up == AXIS_Y ? u : 0, 0,
                                 0, asset->up == AXIS_Y ? -u : 0, asset->up == AXIS_Y ? 0 : u, 0, 0, 0, 0, 1 };
    if (asset->sensors_in_asset_frame)
        memcpy(out, upright, sizeof(upright));
    else
        transform_multiply(asset->placement, upright, out);
}

static void in_model(const struct plant_asset *asset, const double listed[3], double out[3])
{
    double to_list[16], from_list[16];
    model_to_list(asset, to_list);
    if (transform_invert(to_list, from_list))
        transform_point(from_list, listed, out);
}

static void moved_in_list(const struct plant_asset *asset, const double motion[16], const double listed[3], double out[3])
{
    double to_list[16], before[3], after[3];
    in_model(asset, listed, before);
    transform_point(motion, before, after);
    model_to_list(asset, to_list);
    transform_point(to_list, after, out);
}

/* --- tags ----------------------------------------------------------------------------------------------------------------------- */

static struct tag_edit *edit_tag(struct planning *p, const struct plant_tag *tag)
{
    mem_grow(&p->tags, &p->tag_room, p->tag_count + 1, sizeof(*p->tags));
    struct tag_edit *edit = &p->tags[p->tag_count++];
    *edit = (struct tag_edit){ .tag = tag->name, .position_m = { NAN, NAN, NAN } };
    return edit;
}

/* Records that a tag loses its exact position on the model: the tag list will only give its equipment. */
static void lose_place(struct planning *p, const struct plant_tag *tag, const char *detail)
{
    edit_tag(p, tag)->place = "equipment";
    say(p, REVISION_TAG, "place lost", tag->name, "on %s: %s", p->input->plant->assets[tag->asset].id, detail);
}

static void lose_equipment(struct planning *p, const struct plant_tag *tag)
{
    edit_tag(p, tag)->asset = "";
    mem_grow(&p->revision->lost, &p->revision->lost_room, p->revision->lost_count + 1, sizeof(*p->revision->lost));
    p->revision->lost[p->revision->lost_count++] = tag->name;
    say(p, REVISION_TAG, "equipment lost", tag->name, "asset %s is no longer in the model", p->input->plant->assets[tag->asset].id);
}

/* Returns whether the asset loses this node of the old model; if so, the tag on it loses its place. */
static bool lose_node(struct planning *p, const struct plant_tag *tag, int node)
{
    if (node < 0 || !p->lost[node])
        return false;
    char *path = path_of(&p->states.before.outline, (size_t)node), *detail = mem_printf("its node %s no longer belongs to the asset", path);
    lose_place(p, tag, detail);
    mem_free(detail);
    mem_free(path);
    return true;
}

static void follow_node(struct planning *p, const struct plant_tag *tag)
{
    char *pattern = NULL;
    int node;
    enum asset_pattern_change change = asset_patterns_follow(&p->patterns, tag->place.node, p->before, &node, &pattern);
    if (lose_node(p, tag, node)) {
        mem_free(pattern);
        return;
    }
    switch (change) {
    case ASSET_PATTERN_SAME: break;
    case ASSET_PATTERN_OTHER: {
        struct tag_edit *edit = edit_tag(p, tag);
        edit->node = pattern;
        if (tag->place.assumed)
            edit->place = "equipment";
        say(p, REVISION_TAG, "renamed", tag->name, "the tag's node %s is now %s", tag->place.node, pattern);
        return; /* the asset's edit now owns `pattern` and frees it */
    }
    case ASSET_PATTERN_GONE: {
        char *detail = mem_printf("the tag's node %s is no longer in the model", tag->place.node);
        lose_place(p, tag, detail);
        mem_free(detail);
    }
    }
    mem_free(pattern);
}

static void follow_part(struct planning *p, const struct plant_tag *tag, const struct states_motion *whole)
{
    const struct plant_asset *asset = &p->input->plant->assets[tag->asset];
    const struct model_outline *old = &p->states.before.outline;
    struct states_motion motion = *whole;
    double at[3] = { 0 }, now[3];
    int node = -1;
    if (whole->change == STATES_CHANGED || p->loses) {
        in_model(asset, tag->place.position_m, at);
        node = model_states_nearest(&p->states, p->before, at);
    }
    if (lose_node(p, tag, node))
        return;
    if (whole->change == STATES_CHANGED) {
        bool *one = mem_array(old->header.count, sizeof(*one));
        if (node >= 0)
            one[node] = true;
        motion = model_states_motion(&p->states, one, tolerance_m / asset->unit_m);
        mem_free(one);
    }
    if (!motion.known) {
        lose_place(p, tag, "the surface below the sensor has changed shape");
        return;
    }
    moved_in_list(asset, motion.motion, tag->place.position_m, now);
    double distance_m = vec_distance(now, tag->place.position_m);
    if (distance_m <= tolerance_m)
        return;
    struct tag_edit *edit = edit_tag(p, tag);
    memcpy(edit->position_m, now, sizeof(now));
    if (tag->place.assumed)
        edit->place = "equipment";
    say(p, REVISION_TAG, "moved", tag->name, "%.3f m, with %s", distance_m, asset->id);
}

static void follow_asset(struct planning *p, size_t index, const struct states_motion *whole)
{
    const struct plant *plant = p->input->plant;
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        if (tag->asset != (int)index)
            continue;
        if (!whole)
            lose_equipment(p, tag);
        else if (tag->place.has_position)
            follow_part(p, tag, whole);
        else if (tag->place.node)
            follow_node(p, tag);
    }
}

/* --- assets --------------------------------------------------------------------------------------------------------------------- */

/* Returns the first of the old model's nodes that belong to the current asset. The asset usually has the name of this node. */
static int root_of(const struct planning *p)
{
    size_t i = 0;
    while (i < p->states.before.outline.header.count && !p->before[i])
        i++;
    return i < p->states.before.outline.header.count ? (int)i : -1;
}

static const char *without_slash(const char *name)
{
    return name + (name[0] == '/' && name[1]);
}

static void review_asset(struct planning *p, const struct plant_asset *asset, struct asset_edit *edit, const struct states_motion *motion)
{
    const struct model_outline *old = &p->states.before.outline, *new = &p->states.after.outline;
    int root = asset->nodes ? root_of(p) : -1, other = root < 0 ? -1 : p->states.pairs.to_new[root];
    if (other >= 0 && strcmp(old->nodes[root].name, new->nodes[other].name) != 0) {
        const char *name = new->nodes[other].name;
        p->roots[root] = true;
        /* rename the asset's tag only if it still equals the node's name in the old model */
        if (!strcmp(asset->tag, without_slash(old->nodes[root].name)) && *name)
            edit->tag = mem_strdup(without_slash(name));
        char *printable = name_of(new, (size_t)other);
        say(p, REVISION_ASSET, "renamed", asset->id, "now %s; the asset keeps its id", printable);
        mem_free(printable);
    }
    double moved_m = motion->moved * asset->unit_m;
    if (motion->change == STATES_CHANGED)
        say(p, REVISION_ASSET, "changed", asset->id, "%zu of %zu parts have another shape%s", motion->different, motion->parts,
            motion->known && moved_m <= tolerance_m ? "; the bounding box is unchanged" : "");
    else if (motion->change == STATES_MOVED)
        say(p, REVISION_ASSET, "moved", asset->id, "%.3f m", moved_m);
}

enum taken { TAKEN, TAKEN_NOW /* the old model had no nodes of the asset, the new model has some */, TAKEN_NOTHING };

/* Marks the asset's nodes in the old and the new model (before[], after[]), and records changes of the asset's node patterns. */
static enum taken take(struct planning *p, const struct plant_asset *asset, struct asset_edit *edit)
{
    const struct model_outline *old = &p->states.before.outline, *new = &p->states.after.outline;
    char ignored[MODEL_WHY_BYTES];
    if (!nodes_take(asset->nodes, old->header.nodes, old->header.count, p->before, ignored, sizeof(ignored))) {
        if (!nodes_take(asset->nodes, new->header.nodes, new->header.count, p->after, ignored, sizeof(ignored)))
            memset(p->after, 0, new->header.count * sizeof(*p->after));
        return TAKEN_NOW;
    }
    if (!asset->nodes) {
        memset(p->after, 1, new->header.count * sizeof(*p->after));
        return TAKEN;
    }
    char *patterns = asset_patterns_update(&p->patterns, asset->nodes, &edit->nodes, &edit->node_count);
    bool any = patterns && nodes_take(patterns, new->header.nodes, new->header.count, p->after, ignored, sizeof(ignored));
    mem_free(patterns);
    return any ? TAKEN : TAKEN_NOTHING;
}

/* Finds the nodes that the asset loses although the new model has them, because no pattern of the asset selects them there. */
static void review_lost_nodes(struct planning *p, const struct plant_asset *asset)
{
    const struct model_outline *old = &p->states.before.outline;
    p->loses = false;
    for (size_t i = 0; i < old->header.count; i++) {
        int parent = old->header.nodes[i].parent, other = p->states.pairs.to_new[i];
        p->lost[i] = p->before[i] && other >= 0 && !p->after[other];
        if (!p->lost[i])
            continue;
        p->loses = p->set_free[other] = true;
        if (parent >= 0 && p->lost[parent])
            continue;
        char *path = path_of(&p->states.after.outline, (size_t)other);
        say(p, REVISION_ASSET, "node lost", asset->id, "%s no longer belongs to the asset", path);
        mem_free(path);
    }
}

static void plan_asset(struct planning *p, size_t index)
{
    const struct plant_asset *asset = &p->input->plant->assets[index];
    struct asset_edit *edit = &p->assets[index];
    enum taken taken = take(p, asset, edit);
    if (taken == TAKEN_NOTHING) {
        int root = root_of(p);
        edit->removed = true;
        if (root >= 0)
            p->roots[root] = true;
        say(p, REVISION_ASSET, "removed", asset->id, "no longer in %s", p->file);
        memset(p->after, 0, p->states.after.outline.header.count * sizeof(*p->after));
        review_lost_nodes(p, asset);
        follow_asset(p, index, NULL);
        return;
    }
    for (size_t i = 0; i < p->states.after.outline.header.count; i++)
        p->covered[i] |= p->after[i];
    if (taken == TAKEN_NOW)
        return;
    review_lost_nodes(p, asset);
    const struct states_motion motion = model_states_motion(&p->states, p->before, tolerance_m / asset->unit_m);
    review_asset(p, asset, edit, &motion);
    follow_asset(p, index, &motion);
}

/* --- models --------------------------------------------------------------------------------------------------------------------- */

static bool is_of(const struct plant_asset *asset, const struct plant *plant, const struct revision_model *model)
{
    struct stat own, other;
    char *expected = mem_printf("%s/%s", plant->files.folder, model->draft->file);
    bool same = !strcmp(asset->model, expected) || (model->before && stat(asset->model, &own) == 0 && stat(model->before, &other) == 0 &&
                                                    own.st_dev == other.st_dev && own.st_ino == other.st_ino);
    mem_free(expected);
    return same;
}

static void add_assets(struct planning *p, const struct revision_model *model, const bool *wanted, const struct plant_asset *like)
{
    static const struct {
        const char *name;
        double m;
    } units[] = { { "mm", 0.001 }, { "cm", 0.01 }, { "in", 0.0254 }, { "ft", 0.3048 } };
    struct plant_draft_model draft = *model->draft;
    size_t before = p->added.length;
    for (size_t i = 0; like && i < sizeof(units) / sizeof(units[0]); i++)
        if (fabs(like->unit_m / units[i].m - 1) < 1e-9)
            draft.units = units[i].name;
    if (like && like->up == AXIS_Z)
        draft.up = "z";
    plant_draft_add_assets(&draft, wanted, p->ids, &p->added);
    for (const char *line = p->added.at ? p->added.at + before : ""; *line; line += strcspn(line, "\n") + 1) {
        const char *id = strchr(line, '"') + 1;
        char *name = mem_printf("%.*s", (int)(strstr(id, "\", ") - id), id);
        say(p, REVISION_ASSET, "added", name, "in %s", draft.file);
        mem_free(name);
    }
}

/* Adds an asset for new equipment: for a node that has no counterpart in the old model, or that an asset has lost, if the node
 * belongs to no asset and has no asset's node below it. */
static void add_new(struct planning *p, const struct revision_model *model, const struct plant_asset *like)
{
    const struct model_outline *new = &p->states.after.outline;
    bool *wanted = mem_array(new->header.count + 1, sizeof(*wanted)), placed = false;
    for (int i = 0; i < 16; i++)
        placed |= fabs(like->placement[i] - transform_identity[i]) > 0;
    /* Adds new equipment as assets only if no asset of the model has a placement: that of a new asset could not be guessed. */
    if (!placed)
        for (size_t i = 0; i < new->header.count; i++) {
            wanted[i] = p->states.pairs.to_old[i] < 0 || p->set_free[i];
            for (size_t k = i; k < new->header.nodes[i].end && wanted[i]; k++)
                wanted[i] = !p->covered[k];
        }
    add_assets(p, model, wanted, like);
    mem_free(wanted);
}

static bool plan_model(struct planning *p, const struct revision_model *model)
{
    const struct plant *plant = p->input->plant;
    const struct plant_asset *like = NULL;
    for (size_t i = 0; i < plant->asset_count && !like; i++)
        like = is_of(&plant->assets[i], plant, model) ? &plant->assets[i] : NULL;
    if (!model->before || !like) {
        add_assets(p, model, NULL, NULL);
        return true;
    }
    p->file = model->draft->file;
    bool good = model_states_read(&p->states, model->before, model->after, p->why);
    if (good) {
        size_t olds = p->states.before.outline.header.count, news = p->states.after.outline.header.count;
        p->before = mem_array(olds + 1, sizeof(bool));
        p->roots = mem_array(olds + 1, sizeof(bool));
        p->lost = mem_array(olds + 1, sizeof(bool));
        p->after = mem_array(news + 1, sizeof(bool));
        p->set_free = mem_array(news + 1, sizeof(bool));
        p->covered = mem_array(news + 1, sizeof(bool));
        asset_patterns_init(&p->patterns, &p->states.before.outline.header, &p->states.after.outline.header, &p->states.pairs);
        for (size_t i = 0; i < plant->asset_count; i++)
            if (is_of(&plant->assets[i], plant, model) && plant->assets[i].nodes)
                asset_patterns_add_gained(&p->patterns, plant->assets[i].nodes);
        for (size_t i = 0; i < plant->asset_count; i++)
            if (is_of(&plant->assets[i], plant, model))
                plan_asset(p, i);
        add_new(p, model, like);
        review_nodes(p);
        asset_patterns_finish(&p->patterns);
        mem_free(p->before);
        mem_free(p->roots);
        mem_free(p->lost);
        mem_free(p->after);
        mem_free(p->set_free);
        mem_free(p->covered);
    }
    model_states_finish(&p->states);
    return good;
}

/* --- texts ---------------------------------------------------------------------------------------------------------------------- */

static bool something_stays(const struct planning *p)
{
    size_t removed = 0;
    for (size_t i = 0; i < p->input->plant->asset_count; i++)
        removed += p->assets[i].removed;
    if (removed < p->input->plant->asset_count)
        return true;
    snprintf(p->why, MODEL_WHY_BYTES, "%s: the imported models contain none of the plant's assets", p->input->models[0].draft->file);
    return false;
}

static bool compose(struct planning *p)
{
    const struct revision_input *input = p->input;
    char why[ASSET_EDIT_WHY_BYTES] = "";
    p->revision->plant_text = asset_edit_apply(input->plant_text, p->assets, input->plant->asset_count, p->added.at, why);
    if (!p->revision->plant_text) {
        snprintf(p->why, MODEL_WHY_BYTES, "%s: %s", input->plant->files.path, why);
        return false;
    }
    if (p->tag_count > 0 && input->tags_text) {
        struct refusal wrong;
        char text[REFUSAL_TEXT_BYTES];
        p->revision->tags_text = tag_edit(input->tags_text, p->tags, p->tag_count, &wrong);
        if (!p->revision->tags_text) {
            refusal_text(&wrong, text);
            snprintf(p->why, MODEL_WHY_BYTES, "%s: %.300s", input->plant->files.tags_path, text);
        }
        return p->revision->tags_text != NULL;
    }
    return true;
}

static void finish(struct planning *p)
{
    for (size_t i = 0; i < p->input->plant->asset_count; i++) {
        for (size_t k = 0; k < p->assets[i].node_count; k++)
            mem_free(p->assets[i].nodes[k]);
        mem_free(p->assets[i].nodes);
        mem_free(p->assets[i].tag);
    }
    for (size_t i = 0; i < p->tag_count; i++)
        mem_free((char *)(uintptr_t)p->tags[i].node);
    mem_free(p->assets);
    mem_free(p->tags);
    mem_free(p->tag_rows);
    text_finish(&p->added);
    json_decref(p->ids);
}

bool revision_plan(struct revision *revision, const struct revision_input *input, char why[MODEL_WHY_BYTES])
{
    struct planning p = { .revision = revision,
                          .input = input,
                          .assets = mem_array(input->plant->asset_count, sizeof(*p.assets)),
                          .ids = json_object(),
                          .why = why };
    bool good = true;
    for (size_t i = 0; i < input->plant->asset_count; i++)
        json_object_set_new_nocheck(p.ids, input->plant->assets[i].id, json_true());
    for (size_t i = 0; i < input->model_count && good; i++)
        good = plan_model(&p, &input->models[i]);
    good = good && something_stays(&p) && compose(&p);
    for (size_t i = 0; i < p.tag_row_count; i++) {
        mem_grow(&revision->rows, &revision->row_room, revision->row_count + 1, sizeof(*revision->rows));
        revision->rows[revision->row_count++] = p.tag_rows[i];
    }
    finish(&p);
    return good;
}

void revision_finish(struct revision *revision)
{
    for (size_t i = 0; i < revision->row_count; i++) {
        mem_free(revision->rows[i].name);
        mem_free(revision->rows[i].detail);
    }
    mem_free(revision->rows);
    mem_free(revision->lost);
    mem_free(revision->plant_text);
    mem_free(revision->tags_text);
    *revision = (struct revision){ 0 };
}
