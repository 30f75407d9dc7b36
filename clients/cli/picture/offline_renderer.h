/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Offline renderer: everything that draws pictures of a prepared plant without a daemon. Thread: one. */
#ifndef CLI_PICTURE_OFFLINE_RENDERER_H
#define CLI_PICTURE_OFFLINE_RENDERER_H
#include "history/history.h"
#include "access/access.h"
#include "render/split_view.h"
#include "snapshot.h"

struct offline_renderer { /* freed in the opposite order */
    struct log *log;
    struct plant *plant;
    struct scene *scene;
    struct snapshot *snapshot; /* what is drawn */
    struct baselines *baselines;
    uint32_t turn; /* counts sets of values */
    struct workers *workers;
    struct field *field;
    struct gl *gl;
    struct renderer *renderer;
    struct history_reader *reader; /* NULL: the past was not asked for */
    struct history_tag *tags;
    char *history;             /* its folder */
    int64_t first_us, last_us; /* what was recorded lies between them */
};

/* Opens the plant, its files, values and baseline, and sets *view from options->args. Returns 0, or the exit code with the reason printed.
   Close in both cases. */
int offline_renderer_open(struct offline_renderer *offline, struct snapshot_options *options, struct view *view);
/* As offline_renderer_open(), but without a view. Returns false with the reason printed. */
bool offline_renderer_open_plant(struct offline_renderer *offline, struct snapshot_options *options);
/* Sets *view from options->args. Returns false with the reason printed. */
bool offline_renderer_take_view(const struct offline_renderer *offline, const struct snapshot_options *options, struct view *view);
/* As offline_renderer_open(), for the same plant and renderer with other values, baseline and view. */
int offline_renderer_reopen(struct offline_renderer *offline, struct snapshot_options *options, struct view *view);
/* Creates the GL context and the renderer. Returns false if it cannot, logged. */
bool offline_renderer_open_gl(struct offline_renderer *offline, const struct snapshot_options *options);
/* Opens the plant's recorded history. Returns false if there is none, with the reason printed. */
bool offline_renderer_open_history(struct offline_renderer *offline,
                                   const struct snapshot_options *options);
/* Sets the readings and the view to an instant of recorded history. Returns false if it cannot be read (logged) or nothing was recorded by
   then (printed). */
bool offline_renderer_seek(struct offline_renderer *offline, int64_t at_us, struct view *view);
/* Draws the view. Returns the frame, which the caller releases (frame_unref), or NULL, logged. */
struct frame *offline_renderer_draw(struct offline_renderer *offline, const struct snapshot_options *options, struct view *view);
/* Writes the frame as PNG. Returns false if it cannot, logged. */
bool offline_renderer_save(struct offline_renderer *offline, struct frame *frame, const char *path);
/* Frees everything. One that was opened only in part is fine. */
void offline_renderer_close(struct offline_renderer *offline);

#endif
