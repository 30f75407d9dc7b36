/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds a tag's equipment by number: an instrument loop has the number of its equipment, possibly followed by one or two more
 * digits (ISA-5.1, 4.2; ISA-5.1-2009 annex A). */
#include <stdio.h>
#include <string.h>

#include "preprocess/match/matcher_impl.h"

static bool has_token(const struct name_tokens *tokens, const struct name_token *token)
{
    for (int i = 0; i < tokens->count; i++)
        if (tokens->at[i].digits == token->digits && !strcmp(tokens->at[i].text, token->text))
            return true;
    return false;
}

/* Rates how well the tag's prefix fits an asset: 2 if the prefix occurs in the asset's name or area; 1 if the tag has no
 * prefix, or one that most tags have; 0 if the prefix names another area. */
static int rate_prefix(const struct matcher *matcher, const struct match_subject *subject, int asset)
{
    const struct isa_name *name = &subject->name;
    const struct plant_asset *of = &matcher->site->plant->assets[asset];
    struct name_tokens area;
    char key[NAME_KEY_BYTES];
    bool all = name->letters > 0;
    name_tokens_read(&area, of->area);
    for (int i = 0; i < name->letters; i++)
        all &= has_token(&matcher->site->assets[asset].tokens, &name->tokens.at[i]) || has_token(&area, &name->tokens.at[i]);
    if (all)
        return 2;
    name_tokens_key(&name->tokens, 0, name->letters, key);
    const char *number = name->tokens.at[name->number].text;
    bool leads = name->letters == 1 && name->tokens.at[0].digits && strncmp(number, key, strlen(key)) == 0 && strlen(key) < strlen(number);
    return name->letters <= 0 || leads || (*matcher->common_prefix && !strcmp(key, matcher->common_prefix));
}

/* Returns the suffix of an asset's name: a letter after the number that distinguishes, for example, pump A from pump B; "": none. */
static const char *suffix_of(const struct indexed_asset *asset)
{
    int at = asset->number + 1;
    const char *text = at == asset->tokens.count - 1 ? asset->tokens.at[at].text : "";
    return *text >= 'A' && *text <= 'F' && !text[1] ? text : "";
}

/* kinds of equipment: a word for the kind in descriptions, and the letters that names of such equipment begin with */
static const struct {
    const char *word, *letters;
} classes[] = {
    { "PUMP", "P PU PO PMP PP MP" },
    { "POMPE", "PO P" },
    { "펌프", "P PU" },
    { "TANK", "T TK BA V D TA" },
    { "VESSEL", "V D BA" },
    { "DRUM", "D V BA" },
    { "SEPARATOR", "V S D SP" },
    { "EXCHANGER", "E HE HX EX EC" },
    { "HEATER", "E H HX HE F" },
    { "COOLER", "E HX HE EC A" },
    { "CONDENSER", "E C CD HX" },
    { "REBOILER", "E HX" },
    { "PREHEATER", "E HX" },
    { "열교환기", "E HE HX" },
    { "COMPRESSOR", "K C CO CP" },
    { "COLUMN", "C T CO" },
    { "TOWER", "T C CT" },
    { "REACTOR", "R RE RX" },
    { "FURNACE", "F H" },
    { "BOILER", "B BL F" },
    { "FAN", "FN K B VE" },
    { "BLOWER", "B K BL" },
    { "FILTER", "F S FL FI" },
    { "TURBINE", "TU ST GT KT" },
    { "PIPE", "TY L" },
    { "MIXER", "M A MX" },
    { "AGITATOR", "A M AG" },
};

static bool has_word(const char *list, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = strstr(list, word); at; at = strstr(at + 1, word))
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || !at[length]))
            return true;
    return false;
}

/* Returns whether the tag's description contains a word for the kind of equipment indicated by the letters of the asset's name. */
static bool fits_class(const struct matcher *matcher, const struct match_subject *subject, int asset)
{
    const struct indexed_asset *of = &matcher->site->assets[asset];
    for (int d = 0; d < subject->description.count; d++)
        for (size_t c = 0; c < sizeof(classes) / sizeof(*classes); c++)
            if (!strcmp(classes[c].word, subject->description.at[d].text))
                for (int i = of->number - 1; i <= of->number + 1; i += 2)
                    if (i >= 0 && i < of->tokens.count && has_word(classes[c].letters, of->tokens.at[i].text))
                        return true;
    return false;
}

enum number_filter { PREFIX_FITS, SAME_SUFFIX, NO_SUFFIX, FITS_CLASS };

/* Removes the assets that do not pass the filter from the list of assets that a tag may belong to, unless none passes. */
static void keep(const struct matcher *matcher, const struct match_subject *subject, struct match_candidates *list,
                 enum number_filter filter)
{
    struct match_candidates kept = { .more = list->more };
    for (int i = 0; i < list->count; i++) {
        const char *suffix = suffix_of(&matcher->site->assets[list->assets[i]]);
        bool good = filter == PREFIX_FITS   ? rate_prefix(matcher, subject, list->assets[i]) == 2
                    : filter == SAME_SUFFIX ? !strcmp(suffix, subject->name.suffix)
                    : filter == NO_SUFFIX   ? !*suffix
                                            : fits_class(matcher, subject, list->assets[i]);
        if (good)
            candidates_add(&kept, list->assets[i], -1);
    }
    if (kept.count > 0)
        *list = kept;
}

/* Removes the assets whose suffix letter (A, B, ...) differs from the tag's from the list. */
static void drop_other_suffix(const struct matcher *matcher, const struct match_subject *subject, struct match_candidates *list)
{
    struct match_candidates kept = { .more = list->more };
    for (int i = 0; i < list->count; i++) {
        const char *suffix = suffix_of(&matcher->site->assets[list->assets[i]]);
        if (!*suffix || !*subject->name.suffix || !strcmp(suffix, subject->name.suffix))
            candidates_add(&kept, list->assets[i], -1);
    }
    *list = kept;
}

bool method_number(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    const struct isa_name *name = &subject->name;
    if (name->letters < 0)
        return false;
    const struct name_token *number = &name->tokens.at[name->number];
    /* does the tag name's prefix have a run of digits, or of letters? If it has both, the prefix itself names the equipment,
     * and the loop number is not used. */
    bool digits = false, letters = false;
    for (int i = 0; i < name->letters; i++) {
        digits |= name->tokens.at[i].digits && name->tokens.at[i].raw_length >= 3;
        letters |= !name->tokens.at[i].digits;
    }
    if (digits && letters)
        return false;
    struct match_candidates *list = &out->candidates;
    char text[sizeof(number->text)];
    int length = (int)strlen(number->text), cut = 0;
    memcpy(text, number->text, sizeof(text));
    candidates_find(list, &matcher->site->numbers, text);
    while (list->count == 0 && cut < 2 && number->raw_length == length && length - cut - 1 >= 3) {
        text[length - ++cut] = 0;
        candidates_find(list, &matcher->site->numbers, text);
    }
    drop_other_suffix(matcher, subject, list);
    if (list->count == 0)
        return false;
    keep(matcher, subject, list, PREFIX_FITS);
    keep(matcher, subject, list, SAME_SUFFIX);
    keep(matcher, subject, list, NO_SUFFIX);
    if (list->count > 1 && !list->more)
        keep(matcher, subject, list, FITS_CLASS);
    const struct indexed_asset *asset = &matcher->site->assets[list->assets[0]];
    bool same_width = asset->number >= 0 && asset->tokens.at[asset->number].raw_length == number->raw_length - cut;
    bool other_area = rate_prefix(matcher, subject, list->assets[0]) == 0;
    out->confidence = other_area || !same_width ? 0.6 : cut ? 0.9 : 0.93;
    snprintf(out->reason, sizeof(out->reason), "loop %.30s: equipment number %.30s%s", number->text, text,
             other_area   ? ", but the tag's area prefix differs from the equipment's"
             : same_width ? ""
                          : ", with a different number of leading zeros");
    return true;
}

/* --- parts of names ----------------------------------------------------------------------------------------------------------- */

/* Looks in the asset's name for the tag name's tokens (runs of letters or digits) other than instrument letters and loop
 * number. Returns whether they occur there in the same order and include letters. */
static bool is_part(const struct isa_name *name, const struct name_tokens *of)
{
    int at = 0;
    bool letters = false; /* true: at least one of the matching tokens consists of letters */
    for (int i = 0; i < name->tokens.count; i++) {
        const struct name_token *token = &name->tokens.at[i];
        int next = at;
        if (i == name->letters || i == name->number)
            continue;
        while (next < of->count && (of->at[next].digits != token->digits || strcmp(of->at[next].text, token->text) != 0))
            next++;
        bool instrument = !token->digits && (isa_are_letters(token->text) || (strlen(token->text) == 1 && i == name->tokens.count - 1));
        if (next == of->count && !instrument)
            return false;
        letters |= next < of->count && !token->digits;
        at = next < of->count ? next + 1 : at;
    }
    return letters;
}

/* Matches tags that contain the equipment's number and another part of its name: RADIATOR-583216, 0001-F2. */
bool method_parts(const struct matcher *matcher, const struct match_subject *subject, struct proposal *out)
{
    const struct isa_name *name = &subject->name;
    const struct key_map *map = &matcher->site->numbers;
    for (int i = 0; i < name->tokens.count; i++) {
        const struct name_token *number = &name->tokens.at[i];
        if (i == name->number || !number->digits || number->raw_length < 3)
            continue;
        for (int k = key_map_find(map, number->text); k >= 0; k = key_map_next(map, k)) {
            const struct indexed_asset *of = &matcher->site->assets[map->things[k].asset];
            if (of->number >= 0 && of->tokens.at[of->number].raw_length == number->raw_length && is_part(name, &of->tokens))
                candidates_add(&out->candidates, map->things[k].asset, -1);
        }
    }
    if (out->candidates.count == 0)
        return false;
    out->confidence = 0.9;
    snprintf(out->reason, sizeof(out->reason), "the tag's name has the number and other parts of '%.60s'",
             matcher->site->plant->assets[out->candidates.assets[0]].id);
    return true;
}
