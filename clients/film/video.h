/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a video file: H.264 by libavcodec, in the container that libavformat chooses by the file extension. Call from one thread only. */
#ifndef FILM_VIDEO_H
#define FILM_VIDEO_H
#include <stdbool.h>
#include <stdint.h>

struct video;
/* Opens the video file. Pictures with odd sides are cropped to even ones. lossless: nothing is cropped and the exact RGB values are
   preserved (H.264 High 4:4:4 Predictive, which browsers do not play). Returns NULL with the reason printed. */
struct video *video_create(const char *path, int width_px, int height_px, double fps, bool lossless);
/* Adds a text to the metadata (.mp4 and .mov files only). Call it before video_finish(). */
void video_set_text(struct video *video, const char *key, const char *text);
/* Encodes one picture. Returns false with the reason printed. */
bool video_add(struct video *video, const uint8_t *bgrx, int stride_bytes);
/* If `good`, writes what is still in the encoder and completes the file, else deletes it. Returns false if the file is incomplete. Frees
   the video; sets *video to NULL. */
bool video_finish(struct video **video, bool good);

#endif
