/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tours for films: what is seen, for how long, and what is said about it. Thread: one. */
#ifndef FILM_TOUR_H
#define FILM_TOUR_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "clients/cli/picture/snapshot.h"

/* Finds a tour in an answer of /api/v1/walls. Returns its stops, which the caller releases (json_decref), or NULL with the reason printed.
   from: who answered. */
json_t *tour_stops(const char *answer, const char *from, const char *id);
/* Returns how long a stop is shown. */
double tour_dwell_s(const json_t *stop);
/* Returns what is said about a stop, which belongs to it; "": nothing. */
const char *tour_text(const json_t *stop);
/* Adds the view of a stop to the arguments. Returns false with the reason printed. */
bool tour_add_view(const json_t *stop, struct snapshot_options *options);
/* Writes the texts of stops as subtitles (WebVTT) to the film's name with .vtt for its ending; from_s: when each begins, stop_count + 1 of
   them. Returns false with the reason printed. */
bool tour_write_subtitles(const json_t *stops, const double *from_s, const char *film);
/* Draws a text over a picture, at its lower edge, in as many lines as it takes. */
void tour_draw_text(const char *text, uint8_t *bgrx, int width_px, int height_px, int stride_bytes);

#endif
