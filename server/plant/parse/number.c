/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads numbers, which have a decimal point whatever the user's locale, and flags. */
#include "plant/parse/number.h"

#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static locale_t c_locale; /* the locale "C", which has a decimal point; created once per process, never freed */
static pthread_once_t c_locale_once = PTHREAD_ONCE_INIT;

static void make_c_locale(void)
{
    c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

static const char *skip_digits(const char *p, int *count)
{
    for (; *p >= '0' && *p <= '9'; p++)
        ++*count;
    return p;
}

/* Returns whether the text has the form [sign] digits [. digits] [e [sign] digits]: strtod() alone would accept hexadecimal and leading
   blanks. */
static bool is_decimal(const char *p)
{
    int digits = 0, exponent = 0;
    p = skip_digits(p + (*p == '+' || *p == '-'), &digits);
    if (*p == '.')
        p = skip_digits(p + 1, &digits);
    if (digits && (*p == 'e' || *p == 'E')) {
        p++;
        p = skip_digits(p + (*p == '+' || *p == '-'), &exponent);
        if (!exponent)
            return false;
    }
    return digits && !*p;
}

static bool is_not_finite(const char *p)
{
    static const char *const words[] = { "nan", "inf", "infinity", ".nan", ".inf", "#num!", "1.#inf", "1.#qnan" };
    p += *p == '+' || *p == '-';
    for (size_t i = 0; i < sizeof(words) / sizeof(*words); i++)
        if (!strcasecmp(p, words[i]))
            return true;
    return false;
}

enum number_result number_parse(const char *text, double *out)
{
    if (!is_decimal(text))
        return is_not_finite(text) ? NUMBER_NOT_FINITE : NUMBER_NOT_A_NUMBER;
    pthread_once(&c_locale_once, make_c_locale);
    double value = strtod_l(text, NULL, c_locale);
    if (!isfinite(value))
        return NUMBER_NOT_FINITE;
    *out = value;
    return NUMBER_GOOD;
}

bool flag_parse(const char *text, bool *out)
{
    static const char *const words[] = { "0", "1", "false", "true", "no", "yes" };
    for (int i = 0; i < 6; i++)
        if (!strcasecmp(text, words[i])) {
            *out = i % 2;
            return true;
        }
    return false;
}
