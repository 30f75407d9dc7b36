/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses --map arguments and map files, which say which recorded series gives the value of which tag. */
#include "sim_map.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"

enum { MAX_BYTES = 1 << 20 };

static char *trim(char *text)
{
    while (isspace((unsigned char)*text))
        text++;
    size_t length = strlen(text);
    while (length && isspace((unsigned char)text[length - 1]))
        text[--length] = 0;
    return text;
}

/* Parses `SCALE`, `SCALE+OFFSET` or `SCALE-OFFSET`. */
static bool read_factors(const char *text, double *scale, double *offset)
{
    char *end;
    *offset = 0;
    *scale = strtod(text, &end);
    if (end == text || !isfinite(*scale))
        return false;
    while (isspace((unsigned char)*end))
        end++;
    if (!*end)
        return true;
    char sign = *end;
    const char *number = end + 1;
    *offset = strtod(number, &end);
    if ((sign != '+' && sign != '-') || end == number || *end || !isfinite(*offset))
        return false;
    *offset = sign == '-' ? -*offset : *offset;
    return true;
}

void sim_map_add(struct sim_map *map, const char *text, const char *file, int line, struct diag *diag)
{
    char *copy = mem_strdup(text), *equals = strchr(copy, '=');
    struct sim_map_entry entry = { .scale = 1, .file = file, .line = line };
    if (!equals) {
        diag_error(diag, file, line, 0, "%s: expected TAG=SERIES, TAG=SERIES*SCALE or TAG=SERIES*SCALE+OFFSET", text);
        goto done;
    }
    *equals = 0;
    char *tag = trim(copy), *series = equals + 1, *star = strrchr(series, '*');
    if (star)
        *star = 0;
    series = trim(series);
    if (!*tag || !*series || (star && !read_factors(trim(star + 1), &entry.scale, &entry.offset))) {
        diag_error(diag, file, line, 0, "%s: expected TAG=SERIES, TAG=SERIES*SCALE or TAG=SERIES*SCALE+OFFSET", text);
        goto done;
    }
    entry.tag = mem_strdup(tag);
    entry.series = mem_strdup(series);
    mem_grow(&map->entries, &map->capacity, map->count + 1, sizeof(*map->entries));
    map->entries[map->count++] = entry;
done:
    mem_free(copy);
}

void sim_map_add_file(struct sim_map *map, const char *path)
{
    mem_grow(&map->files, &map->file_capacity, map->file_count + 1, sizeof(*map->files));
    map->files[map->file_count++] = mem_strdup(path);
}

static char *beside(const char *map_path, const char *path)
{
    const char *slash = strrchr(map_path, '/');
    if (path[0] == '/' || !slash)
        return mem_strdup(path);
    return mem_printf("%.*s/%s", (int)(slash - map_path), map_path, path);
}

static bool begins_with_word(const char *line, const char *word)
{
    size_t length = strlen(word);
    return !strncmp(line, word, length) && isspace((unsigned char)line[length]);
}

static void read_line(struct sim_map *map, char *line, const char *path, int number, struct diag *diag)
{
    char *end;
    if (!*line || *line == '#')
        return;
    if (!strcmp(line, "loop")) {
        map->loop = true;
    } else if (begins_with_word(line, "speed")) {
        map->speed = strtod(line + 6, &end);
        if (*end || !isfinite(map->speed) || map->speed <= 0)
            diag_error(diag, path, number, 0, "%s: expected a number above 0", line);
    } else if (begins_with_word(line, "values")) {
        char *full = beside(path, trim(line + 7));
        sim_map_add_file(map, full);
        mem_free(full);
    } else {
        sim_map_add(map, line, path, number, diag);
    }
}

void sim_map_read(struct sim_map *map, const char *path, struct diag *diag)
{
    size_t bytes;
    char *text = text_read_file(path, MAX_BYTES, &bytes), *rest = text, *line;
    if (!text) {
        diag_error(diag, path, 0, 0, "cannot be read: %s", strerror(errno));
        return;
    }
    mem_grow(&map->map_files, &map->map_file_capacity, map->map_file_count + 1, sizeof(*map->map_files));
    char *kept_path = map->map_files[map->map_file_count++] = mem_strdup(path);
    for (int number = 1; (line = strsep(&rest, "\n")); number++)
        read_line(map, trim(line), kept_path, number, diag);
    mem_free(text);
}

void sim_map_finish(struct sim_map *map)
{
    for (size_t i = 0; i < map->count; i++) {
        mem_free(map->entries[i].tag);
        mem_free(map->entries[i].series);
    }
    for (size_t i = 0; i < map->file_count; i++)
        mem_free(map->files[i]);
    for (size_t i = 0; i < map->map_file_count; i++)
        mem_free(map->map_files[i]);
    mem_free(map->entries);
    mem_free(map->files);
    mem_free(map->map_files);
    *map = (struct sim_map){ 0 };
}
