/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds a tag's equipment by the tag's name: a model node with that name; the site's rules; equipment whose name is part of the
 * tag's name; the same with a spelling mistake in one of the names. */
#include <stdio.h>
#include <string.h>

#include "base/text/text.h"
#include "preprocess/match/matcher_impl.h"

void candidates_add(struct match_candidates *list, int asset, int node)
{
    for (int i = 0; i < list->count; i++)
        if (list->assets[i] == asset) {
            if (list->nodes[i] != node)
                list->nodes[i] = -1;
            return;
        }
    if (list->count == CANDIDATES) {
        list->more = true;
        return;
    }
    list->assets[list->count] = asset;
    list->nodes[list->count++] = node;
}

bool candidates_find(struct match_candidates *list, const struct key_map *map, const char *key)
{
    int thing = key_map_find(map, key);
    for (int i = thing; i >= 0; i = key_map_next(map, i))
        candidates_add(list, map->things[i].asset, map->things[i].node);
    return thing >= 0;
}

bool candidates_have(const struct match_candidates *list, int asset)
{
    for (int i = 0; i < list->count; i++)
        if (list->assets[i] == asset)
            return true;
    return list->more;
}

void candidates_name(const struct match_candidates *list, const struct model_index *site, char *text, size_t bytes)
{
    size_t length = 0;
    text[0] = 0;
    for (int i = 0; i < list->count && length < bytes; i++)
        length += (size_t)snprintf(text + length, bytes - length, "%s%.40s",
                                   i == 0                                ? ""
                                   : i == list->count - 1 && !list->more ? " or "
                                                                         : ", ",
                                   site->plant->assets[list->assets[i]].id);
    if (list->more && length < bytes)
        snprintf(text + length, bytes - length, ", ...");
}

static const char *id_of(const struct matcher *matcher, const struct match_candidates *list)
{
    return matcher->site->plant->assets[list->assets[0]].id;
}

static const char *node_name(const struct matcher *matcher, const struct match_candidates *list)
{
    const struct indexed_asset *asset = &matcher->site->assets[list->assets[0]];
    return matcher->site->models[asset->model].nodes[list->nodes[0]].name;
}

bool method_own_node(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    const struct name_tokens *tokens = &subject->name.tokens;
    char key[NAME_KEY_BYTES];
    name_tokens_key(tokens, 0, tokens->count, key);
    if (tokens->count < 1 || strlen(key) < 3 || !candidates_find(&out->candidates, &matcher->site->names, key))
        return false;
    out->confidence = 0.99;
    if (out->candidates.nodes[0] >= 0)
        snprintf(out->reason, sizeof(out->reason), "node '%.60s' has the tag's name", node_name(matcher, &out->candidates));
    else
        snprintf(out->reason, sizeof(out->reason), "'%.60s' has the tag's name", id_of(matcher, &out->candidates));
    return true;
}

/* --- the site's rules ------------------------------------------------------------------------------------------------------- */

static void put_groups(struct text *out, const char *equipment, const char *name, const regmatch_t groups[10])
{
    for (; *equipment; equipment++)
        if (equipment[0] == '\\' && equipment[1] >= '0' && equipment[1] <= '9') {
            const regmatch_t *group = &groups[*++equipment - '0'];
            if (group->rm_so >= 0)
                text_add_bytes(out, name + group->rm_so, (size_t)(group->rm_eo - group->rm_so));
        } else {
            text_add_bytes(out, equipment, 1);
        }
}

bool method_rules(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    const char *name = subject->tag->fields[EXPORT_NAME];
    for (size_t i = 0; i < matcher->rule_count; i++) {
        regmatch_t groups[10];
        if (regexec(&matcher->rules[i].pattern, name, 10, groups, 0) != 0)
            continue;
        struct text equipment = { 0 };
        text_add_bytes(&equipment, "", 0);
        put_groups(&equipment, matcher->rules[i].equipment, name, groups);
        int asset = matcher_find_asset(matcher, equipment.at);
        if (asset >= 0) {
            candidates_add(&out->candidates, asset, -1);
            out->confidence = 0.97;
            snprintf(out->reason, sizeof(out->reason), "rule %zu maps the tag to '%.60s'", i + 1, equipment.at);
        }
        text_finish(&equipment);
        if (asset >= 0)
            return true;
    }
    return false;
}

/* --- finding equipment whose name is part of the tag's name --------------------------------------------------------------------- */

static bool is_apart(const struct name_tokens *tokens, int from, int to)
{
    bool before = tokens->at[from].apart, behind = to == tokens->count || tokens->at[to].apart;
    /* true: a single letter up to F follows a number, as in E-101-A, and distinguishes this equipment from E-101, so that E-101
       does not match */
    bool letter = to < tokens->count && !tokens->at[to].digits && strlen(tokens->at[to].text) == 1 && tokens->at[to].text[0] <= 'F' &&
                  tokens->at[to - 1].digits;
    return before && behind && !letter;
}

/* Finds the longest range of the tag name's tokens (runs of letters or digits) that is the name of equipment. The range must
 * begin and end at a separator or at an end of the tag name. */
static bool find_within(const struct matcher *matcher, const struct name_tokens *tokens, struct proposal *out)
{
    for (int length = tokens->count; length >= 1; length--)
        for (int from = 0; from + length <= tokens->count; from++) {
            char key[NAME_KEY_BYTES];
            bool digits = name_tokens_have(tokens, from, from + length, true),
                 letters = name_tokens_have(tokens, from, from + length, false);
            name_tokens_key(tokens, from, from + length, key);
            if (!letters || (!digits && strlen(key) < 6) || !candidates_find(&out->candidates, &matcher->site->names, key))
                continue;
            out->confidence = is_apart(tokens, from, from + length) ? 0.97 : 0.7;
            return true;
        }
    return false;
}

bool method_name_within(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    bool in_name = find_within(matcher, &subject->name.tokens, out);
    if (!in_name && !find_within(matcher, &subject->area, out))
        return false;
    const char *what = out->candidates.nodes[0] >= 0 ? node_name(matcher, &out->candidates) : id_of(matcher, &out->candidates);
    snprintf(out->reason, sizeof(out->reason), "the tag's %s contains '%.60s'%s", in_name ? "name" : "path", what,
             out->confidence < 0.9 ? ", but without separators around it" : "");
    return true;
}

/* --- spelling mistakes -------------------------------------------------------------------------------------------------------- */

/* Finds equipment whose name equals tokens (runs of letters or digits) of the tag's name, except for O in place of 0, and I or L in place
 * of 1. */
static bool find_folded(const struct matcher *matcher, const struct name_tokens *tokens, struct proposal *out)
{
    for (int length = tokens->count; length >= 1; length--)
        for (int from = 0; from + length <= tokens->count; from++) {
            char key[NAME_KEY_BYTES];
            name_tokens_folded(tokens, from, from + length, key);
            if (strlen(key) < 4 || !is_apart(tokens, from, from + length) ||
                !candidates_find(&out->candidates, &matcher->site->folded, key))
                continue;
            out->confidence = 0.9;
            snprintf(out->reason, sizeof(out->reason), "the tag's name contains '%.60s', with O for 0 or I for 1",
                     id_of(matcher, &out->candidates));
            return true;
        }
    return false;
}

/* Finds equipment with the same digits as the tag's name, and letters that differ by one mistake: a letter doubled, missing or
 * swapped. Proposes nothing if several assets match. */
static bool find_slip(const struct matcher *matcher, const struct name_tokens *tokens, struct proposal *out)
{
    const struct key_map *map = &matcher->site->digits;
    for (int length = tokens->count; length >= 2; length--)
        for (int from = 0; from + length <= tokens->count; from++) {
            char digits[NAME_KEY_BYTES], letters[NAME_KEY_BYTES], own_digits[NAME_KEY_BYTES], own[NAME_KEY_BYTES];
            bool other = false;
            name_tokens_split(tokens, from, from + length, digits, letters);
            if (strlen(digits) < 3 || strlen(letters) < 3 || !is_apart(tokens, from, from + length))
                continue;
            for (int i = key_map_find(map, digits); i >= 0; i = key_map_next(map, i)) {
                const struct name_tokens *of = &matcher->site->assets[map->things[i].asset].tokens;
                name_tokens_split(of, 0, of->count, own_digits, own);
                enum name_slip slip = strcmp(own_digits, digits) != 0 || strlen(own) < 3 ? NAME_DIFFERENT : name_slip(letters, own);
                other |= slip == NAME_OTHER_LETTER;
                if (slip == NAME_SLIP || slip == NAME_OTHER_LETTER)
                    candidates_add(&out->candidates, map->things[i].asset, -1);
            }
            if (out->candidates.count == 0)
                continue;
            out->confidence = other ? 0.6 : 0.88;
            snprintf(out->reason, sizeof(out->reason), "the tag's name contains '%.60s', with one letter wrong",
                     id_of(matcher, &out->candidates));
            return true;
        }
    return false;
}

/* Finds equipment whose name ends with tokens (runs of letters or digits) of the tag's name: ART1105BA for 1105-BA. */
static bool find_ending(const struct matcher *matcher, const struct name_tokens *tokens, struct proposal *out)
{
    for (int length = tokens->count; length >= 2; length--)
        for (int from = 0; from + length <= tokens->count; from++) {
            char key[NAME_KEY_BYTES];
            name_tokens_key(tokens, from, from + length, key);
            if (!is_apart(tokens, from, from + length) || !candidates_find(&out->candidates, &matcher->site->endings, key))
                continue;
            const struct name_tokens *of = &matcher->site->assets[out->candidates.assets[0]].tokens;
            /* index of the asset's last token (run of letters or digits) before the ending that the two names share */
            int dropped = of->count - length - 1;
            const struct name_token *before = from > 0 ? &tokens->at[from - 1] : NULL;
            bool contradicts = before && dropped >= 0 && before->digits == of->at[dropped].digits &&
                               strcmp(before->text, of->at[dropped].text) != 0 && !isa_are_letters(before->text);
            out->confidence = contradicts ? 0.5 : 0.87;
            snprintf(out->reason, sizeof(out->reason), "the tag's name contains the end of '%.60s'", id_of(matcher, &out->candidates));
            return true;
        }
    return false;
}

bool method_spelling(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    const struct name_tokens *tokens = &subject->name.tokens;
    return find_folded(matcher, tokens, out) || find_slip(matcher, tokens, out) || find_ending(matcher, tokens, out);
}

int matcher_find_asset(const struct matcher *matcher, const char *name)
{
    struct name_tokens tokens;
    struct match_candidates list = { 0 };
    char key[NAME_KEY_BYTES];
    int asset = plant_find_asset(matcher->site->plant, name);
    if (asset >= 0)
        return asset;
    name_tokens_read(&tokens, name);
    name_tokens_key(&tokens, 0, tokens.count, key);
    candidates_find(&list, &matcher->site->names, key);
    return list.count == 1 && !list.more ? list.assets[0] : -1;
}
