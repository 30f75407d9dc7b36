/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the numbers of an exported list: ranges, raw values, limits and Negate Value, with a decimal point or comma. The whole list decides
 * what a comma or dot means, because "1,500" alone may be 1.5 or 1500. */
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "plant/parse/number.h"
#include "preprocess/match/fold.h"
#include "preprocess/match/tag_export.h"
#include "preprocess/match/tag_names.h"

static const char *const field_names[EXPORT_FIELDS] = {
    [EXPORT_RAW_LOW] = "Raw Low",
    [EXPORT_RAW_HIGH] = "Raw High",
    [EXPORT_SCALED_LOW] = "Scaled Low",
    [EXPORT_SCALED_HIGH] = "Scaled High",
    [EXPORT_LL] = "LL",
    [EXPORT_L] = "L",
    [EXPORT_H] = "H",
    [EXPORT_HH] = "HH",
    [EXPORT_SPAN] = "Span",
};

enum separators {
    NO_SEPARATOR,
    DECIMAL_POINT, /* the dot is certainly the decimal separator, or the comma certainly separates thousands */
    DECIMAL_COMMA,
    ONE_POINT, /* 1.500: one and a half, or one thousand five hundred */
    ONE_COMMA,
};

static size_t count_of(const char *text, char sign)
{
    size_t count = 0;
    for (; *text; text++)
        count += *text == sign;
    return count;
}

/* Returns whether a number whose only separator is at `at` has the form of thousands: 1 to 3 digits, not beginning with 0, before
 * the separator, and 3 digits after it. */
static bool may_be_thousands(const char *text, const char *at)
{
    const char *first = text + (*text == '-' || *text == '+');
    return at > first && at - first <= 3 && *first != '0' && strlen(at + 1) == 3 && strspn(at + 1, "0123456789") == 3;
}

static enum separators separators_of(const char *text)
{
    const char *comma = strrchr(text, ','), *dot = strrchr(text, '.');
    if (!comma && !dot)
        return NO_SEPARATOR;
    if (comma && dot)
        return comma > dot ? DECIMAL_COMMA : DECIMAL_POINT;
    if (comma)
        return count_of(text, ',') > 1 ? DECIMAL_POINT : may_be_thousands(text, comma) ? ONE_COMMA : DECIMAL_COMMA;
    return count_of(text, '.') > 1 ? DECIMAL_COMMA : may_be_thousands(text, dot) ? ONE_POINT : DECIMAL_POINT;
}

/* Returns a number's text with dashes and digits in their plain forms, and without blanks and apostrophes, which may separate
 * thousands. The caller frees it. */
static char *plain_text(const char *text)
{
    char *plain = fold_text(text), *to = plain;
    for (const char *from = plain; *from; from++)
        if (*from != ' ' && *from != '\'')
            *to++ = *from;
    *to = 0;
    return plain;
}

/* Converts a number to a decimal point without separators of thousands. Returns false if the text is not a number. */
static bool convert(const char *text, char decimal, char out[64])
{
    size_t length = 0;
    double number;
    char thousands = decimal == ',' ? '.' : ',';
    for (; *text && length < 63; text++) {
        if (*text == thousands) {
            size_t digits = strspn(text + 1, "0123456789");
            if (digits != 3 || length == 0)
                return false;
        } else {
            out[length++] = *text == decimal ? '.' : *text;
        }
    }
    out[length] = 0;
    return !*text && number_parse(out, &number) == NUMBER_GOOD;
}

struct number_reading {
    struct tag_export *list;
    size_t points, commas; /* numbers of texts whose decimal separator is certain */
    struct tag_names unclear, wrong;
};

static void each_number(struct number_reading *reading, void (*each)(struct number_reading *reading, struct export_tag *tag, int field))
{
    for (size_t i = 0; i < reading->list->count; i++)
        for (int f = 0; f < EXPORT_FIELDS; f++)
            if (field_names[f] && reading->list->tags[i].fields[f])
                each(reading, &reading->list->tags[i], f);
}

static void count_separators(struct number_reading *reading, struct export_tag *tag, int field)
{
    char *text = plain_text(tag->fields[field]), number[64];
    enum separators kind = separators_of(text);
    reading->points += kind == DECIMAL_POINT && convert(text, '.', number);
    reading->commas += kind == DECIMAL_COMMA && convert(text, ',', number);
    mem_free(text);
}

/* Returns the decimal separator of a text such as 1,500. *unclear: whether neither the list's other numbers nor its format decide. */
static char decide(const struct number_reading *reading, enum separators kind, bool *unclear)
{
    char separator = reading->list->separator;
    bool comma = reading->commas > 0 && reading->points == 0, point = reading->points > 0 && reading->commas == 0;
    *unclear = false;
    if (kind == ONE_POINT && separator == 0) /* cells of spreadsheets and JSON write numbers with a decimal point */
        return '.';
    if (comma || point)
        return comma ? ',' : '.';
    *unclear = separator != ',' || reading->commas > 0;
    return separator == ',' || kind == ONE_POINT ? '.' : ',';
}

static void read_number(struct number_reading *reading, struct export_tag *tag, int field)
{
    char *text = plain_text(tag->fields[field]), number[64];
    enum separators kind = separators_of(text);
    bool unclear = false;
    char decimal = kind == DECIMAL_COMMA ? ',' : kind >= ONE_POINT ? decide(reading, kind, &unclear) : '.';
    bool good = convert(text, decimal, number);
    if (good && unclear)
        tag_names_add(&reading->unclear, tag->fields[EXPORT_NAME], "%s %.20s read as %s", field_names[field], text, number);
    if (!good && text[strcspn(text, "0123456789")]) /* "n/a" and "-" mean that there is no number */
        tag_names_add(&reading->wrong, tag->fields[EXPORT_NAME], "%s '%.40s'", field_names[field], tag->fields[field]);
    mem_free(tag->fields[field]);
    tag->fields[field] = good ? mem_strdup(number) : NULL;
    mem_free(text);
}

/* Reads whether a tag's value is negated, as "1", "0" or nothing. */
static void read_flag(struct number_reading *reading, struct export_tag *tag)
{
    char *text = tag->fields[EXPORT_NEGATE];
    bool negates;
    if (!text)
        return;
    const bool good = flag_parse(text, &negates);
    if (!good)
        tag_names_add(&reading->wrong, tag->fields[EXPORT_NAME], "Negate Value '%.40s'", text);
    tag->fields[EXPORT_NEGATE] = good ? mem_strdup(negates ? "1" : "0") : NULL;
    mem_free(text);
}

/* Computes the upper end of a range of which the list states the lower end and the length, as PI (AVEVA's historian) does. */
static void end_span(struct export_tag *tag)
{
    double low, span;
    char high[40];
    if (!tag->fields[EXPORT_SPAN] || !tag->fields[EXPORT_SCALED_LOW] || number_parse(tag->fields[EXPORT_SPAN], &span) != NUMBER_GOOD ||
        number_parse(tag->fields[EXPORT_SCALED_LOW], &low) != NUMBER_GOOD)
        return;
    snprintf(high, sizeof(high), "%.12g", low + span);
    export_tag_set(tag, EXPORT_SCALED_HIGH, high);
}

void tag_export_read_numbers(struct tag_export *list)
{
    struct number_reading reading = { .list = list };
    each_number(&reading, count_separators);
    each_number(&reading, read_number);
    for (size_t i = 0; i < list->count; i++) {
        read_flag(&reading, &list->tags[i]);
        end_span(&list->tags[i]);
    }
    tag_names_say(&reading.unclear, "number may have a decimal separator or a separator of thousands",
                  "numbers may have a decimal separator or a separator of thousands", &list->remarks);
    tag_names_say(&reading.wrong, "range, limit or Negate Value is not a number, and is left out",
                  "ranges, limits or Negate Values are not numbers, and are left out", &list->remarks);
    tag_names_finish(&reading.unclear);
    tag_names_finish(&reading.wrong);
}
