/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds a tag's equipment by text: attributes of model nodes, equipment named in the tag's description, words of descriptions, aliases. */
#include <stdio.h>
#include <string.h>

#include "preprocess/match/matcher_impl.h"

bool method_attributes(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    const struct name_tokens *tokens = &subject->name.tokens;
    char key[NAME_KEY_BYTES];
    name_tokens_key(tokens, 0, tokens->count, key);
    if (tokens->count < 2 || !candidates_find(&out->candidates, &matcher->site->attributes, key))
        return false;
    out->confidence = 0.95;
    snprintf(out->reason, sizeof(out->reason), "an attribute of '%.60s' is the tag's name",
             matcher->site->plant->assets[out->candidates.assets[0]].id);
    return true;
}

/* Finds equipment by its number in a text, provided that a word of the equipment's name is next to the number. */
static void find_numbers(const struct matcher *matcher, const struct name_tokens *tokens, struct match_candidates *out)
{
    const struct key_map *map = &matcher->site->numbers;
    for (int i = 0; i < tokens->count; i++) {
        if (!tokens->at[i].digits || tokens->at[i].raw_length < 3)
            continue;
        for (int k = key_map_find(map, tokens->at[i].text); k >= 0; k = key_map_next(map, k)) {
            const struct indexed_asset *of = &matcher->site->assets[map->things[k].asset];
            bool named = false;
            for (int side = i - 1; side <= i + 1; side += 2)
                for (int t = 0; t < of->tokens.count && side >= 0 && side < tokens->count; t++)
                    named |= !tokens->at[side].digits && !strcmp(of->tokens.at[t].text, tokens->at[side].text);
            if (named && of->number >= 0 && of->tokens.at[of->number].raw_length == tokens->at[i].raw_length)
                candidates_add(out, map->things[k].asset, -1);
        }
    }
}

/* Proposes all equipment named in the tag's description; where several names overlap in the text, only the longest is used. */
bool method_description(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    const struct name_tokens *tokens = &subject->description;
    for (int from = 0; from < tokens->count; from++)
        for (int to = tokens->count; to > from; to--) {
            char key[NAME_KEY_BYTES];
            if (!name_tokens_have(tokens, from, to, true) || !name_tokens_have(tokens, from, to, false) || !tokens->at[from].apart ||
                (to < tokens->count && !tokens->at[to].apart))
                continue;
            name_tokens_key(tokens, from, to, key);
            if (!candidates_find(&out->candidates, &matcher->site->names, key))
                continue;
            from = to - 1;
            break;
        }
    if (out->candidates.count == 0)
        find_numbers(matcher, tokens, &out->candidates);
    if (out->candidates.count == 0)
        return false;
    char named[160];
    candidates_name(&out->candidates, matcher->site, named, sizeof(named));
    out->confidence = 0.9;
    snprintf(out->reason, sizeof(out->reason), "the description names %s", named);
    return true;
}

/* --- words ------------------------------------------------------------------------------------------------------------------ */

struct word_count {
    const struct matcher *matcher;
    struct {
        int asset, words;
        size_t letters;
    } at[256];
    int count;
    const char *seen[NAME_MAX_TOKENS * 2]; /* distinct words of the tag's texts counted so far */
    int seen_count;
};

static void count_word(struct word_count *count, const char *word)
{
    const struct key_map *map = &count->matcher->site->words;
    for (int i = 0; i < count->seen_count; i++)
        if (!strcmp(count->seen[i], word))
            return;
    count->seen[count->seen_count++] = word;
    for (int i = key_map_find(map, word); i >= 0; i = key_map_next(map, i)) {
        int k = 0;
        while (k < count->count && count->at[k].asset != map->things[i].asset)
            k++;
        if (k == (int)(sizeof(count->at) / sizeof(*count->at)))
            return;
        count->count += k == count->count;
        count->at[k].asset = map->things[i].asset;
        count->at[k].words++;
        count->at[k].letters += strlen(word);
    }
}

static void count_words(struct word_count *count, const struct name_tokens *tokens)
{
    for (int i = 0; i < tokens->count; i++)
        if (!tokens->at[i].digits && strlen(tokens->at[i].text) >= 3)
            count_word(count, tokens->at[i].text);
}

static void count_own(const char *word, void *data)
{
    (void)word;
    ++*(int *)data;
}

/* Returns how many words the tag's texts and the asset must have in common to match: the number of words in the asset's
 * description, or in its name if the name has fewer words and no number. */
static int own_words(const struct model_index *site, int asset)
{
    int description = 0, name = 0;
    model_index_each_word(site->plant->assets[asset].description, count_own, &description);
    if (!name_tokens_have(&site->assets[asset].tokens, 0, site->assets[asset].tokens.count, true))
        model_index_each_word(site->plant->assets[asset].id, count_own, &name);
    return name > 0 && (name < description || description == 0) ? name : description;
}

bool method_words(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    struct word_count count = { .matcher = matcher };
    int most = 0;
    count_words(&count, &subject->description);
    count_words(&count, &subject->name.tokens);
    for (int i = 0; i < count.count; i++)
        if (count.at[i].words >= own_words(matcher->site, count.at[i].asset) && count.at[i].words > most)
            most = count.at[i].words;
    if (most == 0)
        return false;
    for (int i = 0; i < count.count; i++)
        if (count.at[i].words == most && count.at[i].words >= own_words(matcher->site, count.at[i].asset))
            candidates_add(&out->candidates, count.at[i].asset, -1);
    out->confidence = most >= 2 ? 0.86 : 0.6;
    snprintf(out->reason, sizeof(out->reason), "%d word%s of '%.60s'", most, most == 1 ? "" : "s",
             matcher->site->plant->assets[out->candidates.assets[0]].id);
    return true;
}

/* --- aliases ---------------------------------------------------------------------------------------------------------------- */

static bool is_within(const struct name_tokens *part, const struct name_tokens *whole)
{
    for (int from = 0; from + part->count <= whole->count; from++) {
        int i = 0;
        while (i < part->count && !strcmp(part->at[i].text, whole->at[from + i].text))
            i++;
        if (i == part->count)
            return true;
    }
    return false;
}

bool method_alias(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    int longest = 0;
    for (size_t i = 0; i < matcher->alias_count; i++) {
        const struct match_alias *alias = &matcher->aliases[i];
        if (alias->tokens.count < longest || alias->tokens.count == 0 ||
            !(is_within(&alias->tokens, &subject->name.tokens) || is_within(&alias->tokens, &subject->description) ||
              is_within(&alias->tokens, &subject->area)))
            continue;
        if (alias->tokens.count > longest)
            out->candidates = (struct match_candidates){ 0 };
        longest = alias->tokens.count;
        candidates_add(&out->candidates, alias->asset, -1);
        out->confidence = 0.95;
        snprintf(out->reason, sizeof(out->reason), "alias '%.60s'", alias->text);
    }
    return out->candidates.count > 0;
}
