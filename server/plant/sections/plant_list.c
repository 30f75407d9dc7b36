/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions for lists, paths, files with secrets and alarm limits, used by several sections of the plant file and the tag list. */
#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "plant/plant_impl.h"

const char *const plant_limit_names[LIMIT_COUNT] = { "LL", "L", "H", "HH" };

int plant_list_count(struct yaml_reader *reader, yaml_node_t *node, const char *name, int most)
{
    int count = yaml_list_count(reader, node, name);
    if (count > most)
        yaml_error(reader, yaml_place(node), "%s: expected at most %d, found %d", name, most, count);
    return count < most ? count : most;
}

void *plant_list_make(struct yaml_reader *reader, yaml_node_t *node, const char *name, int least, int most, size_t bytes_each, int *count)
{
    *count = plant_list_count(reader, node, name, most);
    if (*count >= 0 && *count < least)
        yaml_error(reader, yaml_place(node), "%s: expected at least one item, found an empty list", name);
    void *things = *count < 0 ? NULL : mem_try_array((size_t)*count, bytes_each);
    if (*count >= 0 && !things)
        yaml_error(reader, yaml_place(node), "%s: cannot read a list of %d items: out of memory", name, *count);
    if (!things)
        *count = 0;
    return things;
}

void plant_list_check_id(struct yaml_reader *reader, const struct yaml_map *map, const char *what, const void *things, size_t count,
                         size_t stride, size_t line_offset)
{
    const char *last = (const char *)things + (count - 1) * stride;
    const char *id, *other;
    memcpy(&id, last, sizeof(id));
    for (const char *thing = things; id && thing < last; thing += stride) {
        memcpy(&other, thing, sizeof(other));
        if (!other || strcmp(id, other) != 0)
            continue;
        int line;
        memcpy(&line, thing + line_offset, sizeof(line));
        yaml_error(reader, yaml_map_place(map, "id"), "id: %s '%s' is listed twice (first at line %d)", what, id, line);
        break;
    }
}

void plant_resolve_path(const struct plant *plant, char **path)
{
    if (!*path || **path == '/')
        return;
    char *whole = mem_printf("%s/%s", plant->files.folder, *path);
    mem_free(*path);
    *path = whole;
}

void plant_secret_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, const char *key, char **path)
{
    struct text_position place = yaml_map_place(map, key);
    plant_resolve_path(plant, path);
    if (*path && access(*path, R_OK) != 0)
        diag_warning(reader->diag, reader->path, place.line, place.column, "%s: '%s' cannot be read: %s", key, *path, strerror(errno));
}

bool plant_limits_wrong(const double limits[LIMIT_COUNT], int *lower, int *upper)
{
    *lower = -1;
    for (*upper = 0; *upper < LIMIT_COUNT; ++*upper) {
        if (isnan(limits[*upper]))
            continue;
        if (*lower >= 0 && !(limits[*lower] < limits[*upper]))
            return true;
        *lower = *upper;
    }
    return false;
}
