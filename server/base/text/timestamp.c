/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and prints timestamps, independently of the locale and, except for local times, of this computer's time zone. */
#include "base/text/timestamp.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define US_PER_S INT64_C(1000000)

/* Parses a number of at least `least` and at most `most` digits, and advances *text. Returns false if there are fewer than
   `least` digits. */
static bool digits(const char **text, int least, int most, int *out)
{
    int count = 0;
    *out = 0;
    for (; count < most && **text >= '0' && **text <= '9'; count++, (*text)++)
        *out = *out * 10 + (**text - '0');
    return count >= least;
}

static bool sign(const char **text, char wanted)
{
    return *(*text)++ == wanted;
}

/* Parses a fraction of a second such as `.5` and returns it in microseconds; further digits are ignored. */
static int64_t fraction(const char **text)
{
    int64_t us = 0, unit = US_PER_S / 10;
    if (**text != '.' && **text != ',')
        return 0;
    for ((*text)++; **text >= '0' && **text <= '9'; (*text)++, unit /= 10)
        us += (**text - '0') * unit;
    return us;
}

static bool zone(const char **text, int *offset_s)
{
    int hours, minutes = 0;
    char c = *(*text)++;
    *offset_s = 0;
    if (c == 'Z' || c == 'z')
        return true;
    if ((c != '+' && c != '-') || !digits(text, 2, 2, &hours))
        return false;
    if (**text == ':')
        (*text)++;
    if (**text && !digits(text, 2, 2, &minutes))
        return false;
    *offset_s = (hours * 60 + minutes) * (c == '-' ? -60 : 60);
    return hours <= 14 && minutes < 60;
}

static int days_of(int year, int month)
{
    static const int days[] = { 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31 };
    bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    return days[month - 1] + (month == 2 && leap);
}

/* Converts a local time in the process's time zone. If the local time occurs twice, as in autumn, chooses the earlier of the
   instants that are later than after_us. Returns false if the clocks skip that time. */
static bool from_local(const struct tm *shown, int64_t after_us, int64_t us, int64_t *t_us)
{
    int64_t found_us[2];
    int count = 0;
    for (int dst = 0; dst < 2; dst++) {
        struct tm tm = *shown;
        tm.tm_isdst = dst;
        int64_t at_us = (int64_t)mktime(&tm) * US_PER_S + us;
        if (tm.tm_hour == shown->tm_hour && tm.tm_min == shown->tm_min && tm.tm_mday == shown->tm_mday)
            found_us[count++] = at_us;
    }
    if (count == 0)
        return false;
    int64_t early_us = found_us[0], late_us = found_us[count - 1];
    if (late_us < early_us) {
        early_us = found_us[count - 1];
        late_us = found_us[0];
    }
    *t_us = early_us > after_us ? early_us : late_us;
    return true;
}

struct date {
    struct tm tm;
    int64_t us;
    bool has_zone;
    int offset_s;
};

static bool parse_date(const char *text, struct date *date)
{
    struct tm *tm = &date->tm;
    *date = (struct date){ 0 };
    if (!digits(&text, 4, 4, &tm->tm_year) || !sign(&text, '-') || !digits(&text, 2, 2, &tm->tm_mon) || !sign(&text, '-') ||
        !digits(&text, 2, 2, &tm->tm_mday) || (*text != 'T' && *text != 't' && *text != ' '))
        return false;
    text++;
    if (!digits(&text, 2, 2, &tm->tm_hour) || !sign(&text, ':') || !digits(&text, 2, 2, &tm->tm_min))
        return false;
    if (*text == ':' && (text++, !digits(&text, 2, 2, &tm->tm_sec)))
        return false;
    date->us = fraction(&text);
    date->has_zone = *text != 0;
    if (date->has_zone && (!zone(&text, &date->offset_s) || *text))
        return false;
    if (tm->tm_year < 1970 || tm->tm_year > 2200 || tm->tm_mon < 1 || tm->tm_mon > 12 || tm->tm_mday < 1 ||
        tm->tm_mday > days_of(tm->tm_year, tm->tm_mon) || tm->tm_hour > 23 || tm->tm_min > 59 || tm->tm_sec > 60)
        return false;
    tm->tm_year -= 1900;
    tm->tm_mon--;
    return true;
}

static int64_t with_zone_us(struct date *date)
{
    return ((int64_t)timegm(&date->tm) - date->offset_s) * US_PER_S + date->us;
}

static bool parse_back(const char *text, int64_t now_us, int64_t *t_us)
{
    int count, unit_s;
    text++;
    if (!digits(&text, 1, 9, &count))
        return false;
    switch (*text++) {
    case 's': unit_s = 1; break;
    case 'm': unit_s = 60; break;
    case 'h': unit_s = 3600; break;
    case 'd': unit_s = 86400; break;
    default: return false;
    }
    *t_us = now_us - (int64_t)count * unit_s * US_PER_S;
    return !*text && *t_us > 0;
}

static bool parse_seconds(const char *text, int64_t *t_us)
{
    int64_t seconds = 0;
    int count = 0;
    for (; *text >= '0' && *text <= '9' && count < 11; count++, text++)
        seconds = seconds * 10 + (*text - '0');
    *t_us = seconds * US_PER_S + fraction(&text);
    return count > 0 && !*text && seconds < INT64_C(7258118400); /* refuses times from the start of the year 2200 (7258118400) on */
}

bool timestamp_parse(const char *text, int64_t now_us, int64_t *t_us)
{
    if (!strcmp(text, "now")) {
        *t_us = now_us;
        return true;
    }
    if (*text == '-')
        return parse_back(text, now_us, t_us);
    struct date date;
    if (strlen(text) <= 4 || text[4] != '-')
        return parse_seconds(text, t_us);
    if (!parse_date(text, &date) || !date.has_zone)
        return false;
    *t_us = with_zone_us(&date);
    return true;
}

bool timestamp_parse_local(const char *text, int64_t after_us, int64_t *t_us)
{
    struct date date;
    if (!parse_date(text, &date))
        return false;
    if (!date.has_zone)
        return from_local(&date.tm, after_us, date.us, t_us);
    *t_us = with_zone_us(&date);
    return true;
}

void timestamp_use_zone(const char *iana_name)
{
    setenv("TZ", iana_name, 1);
    tzset();
}

void timestamp_print(int64_t t_us, char text[TIMESTAMP_BYTES])
{
    int64_t rest_us = t_us % US_PER_S, us = rest_us < 0 ? rest_us + US_PER_S : rest_us;
    time_t seconds = (time_t)((t_us - us) / US_PER_S);
    struct tm tm;
    size_t n = strftime(text, TIMESTAMP_BYTES, "%Y-%m-%dT%H:%M:%S", gmtime_r(&seconds, &tm));
    if (us % 1000)
        snprintf(text + n, TIMESTAMP_BYTES - n, ".%06dZ", (int)us);
    else
        snprintf(text + n, TIMESTAMP_BYTES - n, ".%03dZ", (int)(us / 1000));
}
