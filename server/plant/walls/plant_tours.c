/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `tours`: sequences of views, each view with a duration and a text. */
#include <string.h>

#include "base/mem.h"
#include "plant/parse/suggest.h"
#include "plant/plant_impl.h"
#include "plant/walls/wall.h"

static void read_stop(struct yaml_reader *reader, yaml_node_t *node, struct tour_stop *stop)
{
    static const struct yaml_key keys[] = { { "view", KEY_NAME, true, offsetof(struct tour_stop, view), 0, 0, NULL, NULL },
                                            { "dwell_s", KEY_NUMBER, false, offsetof(struct tour_stop, dwell_s), 1, 3600, NULL, NULL },
                                            { "text", KEY_NAME, false, offsetof(struct tour_stop, text), 0, 0, NULL, NULL },
                                            { 0 } };
    struct yaml_map map;
    *stop = (struct tour_stop){ .dwell_s = 15 };
    if (!yaml_map_read(reader, node, "a stop", keys, stop, &map))
        return;
    stop->place = yaml_map_place(&map, "view");
    if (stop->text && strlen(stop->text) >= TOUR_TEXT_BYTES)
        yaml_error(reader, yaml_map_place(&map, "text"), "text: expected at most %d bytes, found %zu", TOUR_TEXT_BYTES - 1,
                   strlen(stop->text));
}

static void read_stops(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct tour *tour = record;
    int count;
    tour->stops = plant_list_make(reader, node, "stops", 1, TOUR_STOPS, sizeof(*tour->stops), &count);
    for (int i = 0; i < count; i++)
        read_stop(reader, yaml_list_item(reader, node, i), &tour->stops[tour->stop_count++]);
}

void plant_tours_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    static const struct yaml_key keys[] = { { "id", KEY_NAME, true, offsetof(struct tour, id), 0, 0, NULL, NULL },
                                            { "stops", KEY_CUSTOM, true, 0, 0, 0, NULL, read_stops },
                                            { 0 } };
    int count;
    plant->screens.tours = plant_list_make(reader, node, "tours", 0, TOURS, sizeof(*plant->screens.tours), &count);
    for (int i = 0; i < count; i++) {
        struct tour *tour = &plant->screens.tours[plant->screens.tour_count++];
        struct yaml_map map;
        tour->line = yaml_place(yaml_list_item(reader, node, i)).line;
        if (!yaml_map_read(reader, yaml_list_item(reader, node, i), "a tour", keys, tour, &map))
            continue;
        if (tour->id && !named_view_id_valid(tour->id))
            yaml_error(reader, yaml_map_place(&map, "id"), "id: expected letters, digits, '_', '-' and '.', found '%.60s'", tour->id);
        plant_list_check_id(reader, &map, "tour", plant->screens.tours, plant->screens.tour_count, sizeof(*tour),
                            offsetof(struct tour, line));
    }
}

const struct tour *tour_find(const struct plant *plant, const char *id)
{
    size_t i = 0;
    while (i < plant->screens.tour_count && (!plant->screens.tours[i].id || strcmp(plant->screens.tours[i].id, id) != 0))
        i++;
    return i < plant->screens.tour_count ? &plant->screens.tours[i] : NULL;
}

void plant_tours_check(const struct plant *plant, struct diag *diag)
{
    for (size_t t = 0; t < plant->screens.tour_count; t++)
        for (size_t s = 0; s < plant->screens.tours[t].stop_count; s++) {
            const struct tour_stop *stop = &plant->screens.tours[t].stops[s];
            if (!stop->view || named_view_find(plant, stop->view))
                continue;
            const char *near = suggest_nearest(stop->view, plant->screens.views, plant->screens.view_count, sizeof(*plant->screens.views));
            diag_error(diag, plant->files.path, stop->place.line, stop->place.column, "view: `views` has no '%.60s'%s%s%s", stop->view,
                       near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
        }
}

void plant_tours_free(struct plant *plant)
{
    for (size_t t = 0; t < plant->screens.tour_count; t++) {
        for (size_t s = 0; s < plant->screens.tours[t].stop_count; s++) {
            mem_free(plant->screens.tours[t].stops[s].view);
            mem_free(plant->screens.tours[t].stops[s].text);
        }
        mem_free(plant->screens.tours[t].stops);
        mem_free(plant->screens.tours[t].id);
    }
    mem_free(plant->screens.tours);
}
