/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures into a film file: H.264 by libavcodec, in what libavformat makes of the file's name. Not in builds without H.264. */
#ifndef CLI_VIDEO_H
#define CLI_VIDEO_H
#include <stdbool.h>
#include <stdint.h>

struct video;
/* Sides are cut to even numbers. NULL: the reason is printed. */
struct video *video_create(const char *path, int width_px, int height_px, double fps);
bool video_add(struct video *video, const uint8_t *bgrx, int stride_bytes); /* false: the reason is printed */
/* Writes what is left, if all went well; else the file is removed. False: it is not whole. Leaves NULL. */
bool video_finish(struct video **video, bool good);

#endif
