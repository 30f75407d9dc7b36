/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses the command-line options shared by `import` and `nodes`: numbers in ranges, words from fixed lists. */
#include "preprocess/import/options.h"

#include <stdlib.h>
#include <string.h>

#include "base/text/charset.h"

const struct conversion_params options_default = { .chord_m = 0.001, .timeout_s = 120, .memory_bytes = (size_t)2 << 30 };

void options_print(FILE *out)
{
    fputs("  --chord MM        maximum distance in mm between a curved surface and its triangles (default: 1)\n"
          "  --units UNIT      unit of length for models whose file states no unit: m, mm, cm, in or ft\n"
          "  --mesh-units UNIT unit of length for OBJ, STL, PLY and 3DS models only\n"
          "  --up AXIS         up axis for models whose file states none: y or z\n"
          "  --encoding NAME   character encoding of the names in the model, such as GB18030 or Windows-1251\n"
          "                    (default: the encoding that the model states, else the most likely one, which is\n"
          "                    printed)\n"
          "  --keep-covered    keep faces of RVM models that are hidden behind a neighbouring face\n"
          "  --timeout S       maximum time in seconds for reading one model (default: 120)\n"
          "  --memory MB       maximum memory in MB for reading one model (default: 2048)\n"
          "  --formats         print the CAD formats that this program can read\n",
          out);
}

static const char *one_of(const char *words, const char *value)
{
    size_t length = strlen(value);
    for (const char *at = words; *at; at += strcspn(at, " "), at += *at == ' ')
        if (strcspn(at, " ") == length && !strncmp(at, value, length))
            return value;
    return NULL;
}

static bool number(const char *value, double least, double most, double *out)
{
    char *end;
    *out = strtod(value, &end);
    return end != value && !*end && *out >= least && *out <= most;
}

bool options_take(struct conversion_params *params, const char *command, int option, const char *value)
{
    const char *wanted = NULL, *name = NULL;
    double taken;
    switch (option) {
    case 'c':
        name = "chord", wanted = number(value, 0.01, 1000, &taken) ? NULL : "expected 0.01 to 1000 (mm)";
        params->chord_m = taken / 1000;
        break;
    case 't':
        name = "timeout", wanted = number(value, 1, 86400, &taken) ? NULL : "expected 1 to 86400 (s)";
        params->timeout_s = wanted ? 1 : (int)taken;
        break;
    case 'm':
        name = "memory", wanted = number(value, 64, 1e6, &taken) ? NULL : "expected 64 to 1000000 (MB)";
        params->memory_bytes = wanted ? 0 : (size_t)taken << 20;
        break;
    case 'u': name = "units", wanted = (params->units = one_of("m mm cm in ft", value)) ? NULL : "expected m, mm, cm, in or ft"; break;
    case 'M':
        name = "mesh-units", wanted = (params->mesh_units = one_of("m mm cm in ft", value)) ? NULL : "expected m, mm, cm, in or ft";
        break;
    case 'e':
        name = "encoding";
        wanted = charset_resolve(value, params->encoding) ? NULL : "unknown encoding: iconv --list prints the known names";
        break;
    case 'U': name = "up", wanted = (params->up = one_of("y z", value)) ? NULL : "expected y or z"; break;
    case 'k': params->keep_covered = true; return true;
    default: return false;
    }
    if (wanted)
        fprintf(stderr, "plantcast %s: --%s %s: %s\n", command, name, value, wanted);
    return !wanted;
}
