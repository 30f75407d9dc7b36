/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tours in films: which views (stops) are shown, how long, and with which texts. Call from one thread only. */
#ifndef FILM_TOUR_H
#define FILM_TOUR_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "clients/cli/picture/snapshot.h"

/* Finds a tour by its id in a daemon's response to /api/v1/walls. Returns its stops as JSON, which the caller releases
   (json_decref), or NULL with the reason printed. from: the server's name in error messages. */
json_t *tour_stops(const char *answer, const char *from, const char *id);
/* Returns how many seconds a film shows this stop. */
double tour_dwell_s(const json_t *stop);
/* Returns the text of a stop, which belongs to the stop; "" if it has none. */
const char *tour_text(const json_t *stop);
/* Adds a stop's view to options->args. offline true: adds the view's parameters; false: adds its id, by which a daemon looks up
   the parameters. Returns false with the reason printed. */
bool tour_add_view(const json_t *stop, bool offline, struct snapshot_options *options);
/* Writes the texts of the stops as subtitles (WebVTT) to a file named like the film, with the extension .vtt. from_s: start
   time of each stop in seconds, followed by the end of the film. Returns false with the reason printed. */
bool tour_write_subtitles(const json_t *stops, const double *from_s, const char *film);
/* Draws a text over the lower edge of a picture, in as many lines as it needs. */
void tour_draw_text(const char *text, uint8_t *bgrx, int width_px, int height_px, int stride_bytes);

#endif
