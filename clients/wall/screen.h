/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A window of SDL on X11, Wayland or KMS, full screen where nothing else is asked for. Without OpenGL it copies pixels. Thread: the one
   that
   opened it. */
#ifndef WALL_SCREEN_H
#define WALL_SCREEN_H
#include <cairo.h>
#include <stdbool.h>
#include <stdint.h>

#include "render/overlay/labels.h"

struct screen;
/* Opens the window; width_px 0: all of that monitor (from 0). Returns NULL with the reason printed. The caller closes it. */
struct screen *screen_open(int width_px, int height_px, int monitor);
void screen_close(struct screen **screen);
/* Returns the size of the window in pixels, and of the display it is on. */
void screen_size(const struct screen *screen, int window_px[2], int display_px[2]);
/* Returns what draws, such as "x11, opengl". Belongs to the screen. */
const char *screen_name(const struct screen *screen);
enum screen_event { SCREEN_NOTHING, SCREEN_QUIT, SCREEN_RESIZED, SCREEN_EXPOSED };
/* Returns the next thing that has happened, of those that are waiting. */
enum screen_event screen_poll(struct screen *screen);
/* Takes over a part of the picture. */
void screen_update(struct screen *screen, cairo_surface_t *picture, const struct box *dirty);
/* Shows it: shifted by so many pixels, on that ground, and as bright, up to 1. Returns false if the window can no longer be drawn, with
   the reason
   printed. */
bool screen_present(struct screen *screen, int shift_x, int shift_y, double brightness, uint32_t ground);

#endif
