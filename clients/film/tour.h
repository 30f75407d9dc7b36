/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tours in films: which views are shown, for how long, and with which texts. Thread: one. */
#ifndef FILM_TOUR_H
#define FILM_TOUR_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "clients/cli/picture/snapshot.h"

/* Finds a tour in a response of /api/v1/walls. Returns its stops, which the caller releases (json_decref), or NULL with the reason printed.
   from: the responding server. */
json_t *tour_stops(const char *answer, const char *from, const char *id);
/* Returns the seconds that a stop is shown. */
double tour_dwell_s(const json_t *stop);
/* Returns the text of a stop, which belongs to the stop; "" if it has none. */
const char *tour_text(const json_t *stop);
/* Adds the view of a stop to the options' arguments. Returns false with the reason printed. */
bool tour_add_view(const json_t *stop, struct snapshot_options *options);
/* Writes the stops' texts as subtitles (WebVTT) to the film's name with the extension .vtt. from_s: stop_count + 1 start times in seconds,
   the last is the end. Returns false with the reason printed. */
bool tour_write_subtitles(const json_t *stops, const double *from_s, const char *film);
/* Draws a text over the lower edge of a picture, in as many lines as it needs. */
void tour_draw_text(const char *text, uint8_t *bgrx, int width_px, int height_px, int stride_bytes);

#endif
