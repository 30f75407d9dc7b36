/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Offline renderer: everything that is needed to draw pictures of a plant without a daemon, from files made by plantcast-prep.
   Call from one thread only. */
#ifndef CLI_PICTURE_OFFLINE_RENDERER_H
#define CLI_PICTURE_OFFLINE_RENDERER_H
#include "history/history.h"
#include "loopcheck/loop_checks.h"
#include "access/access.h"
#include "render/split_view.h"
#include "snapshot.h"

/* The members are declared in the order in which they are opened. offline_renderer_close() frees them in reverse, because later
   members use earlier ones. */
struct offline_renderer {
    struct log *log;
    struct plant *plant;
    struct scene *scene;
    struct snapshot *snapshot; /* readings to draw */
    struct baselines *baselines;
    struct loop_checks *loop_checks; /* recorded loop checks, for pictures that mark unproven tags; NULL: no tag is marked */
    /* number of times that the readings in `snapshot` were replaced; a changed number makes `field` compute its values again */
    uint32_t turn;
    struct workers *workers;
    struct field *field;
    struct gl *gl;
    struct renderer *renderer;
    struct history_reader *reader; /* NULL: no history was opened */
    struct history_tag *tags;
    char *history;             /* path of the history folder */
    int64_t first_us, last_us; /* first and last recorded instant */
};

/* Opens the plant, its prepared files (made by plantcast-prep), the values to show, the baseline (readings to compare them with) and the
   recorded loop checks, and sets *view from options->args. Returns 0, or the exit code with the reason printed. Call
   offline_renderer_close() in both cases. */
int offline_renderer_open(struct offline_renderer *offline, struct snapshot_options *options, struct view *view);
/* Like offline_renderer_open(), but without loop checks and a view. Returns false with the reason printed. */
bool offline_renderer_open_plant(struct offline_renderer *offline, struct snapshot_options *options);
/* Sets *view from options->args. Returns false, with the reason printed, if they are invalid. */
bool offline_renderer_take_view(const struct offline_renderer *offline, const struct snapshot_options *options, struct view *view);
/* Like offline_renderer_open(), but the renderer already has this plant open: reads only new values, a new baseline (readings
   to compare the values with) and a new view. */
int offline_renderer_reopen(struct offline_renderer *offline, struct snapshot_options *options, struct view *view);
/* Creates the GL context and the renderer. On failure, logs the reason and returns false. */
bool offline_renderer_open_gl(struct offline_renderer *offline, const struct snapshot_options *options);
/* Opens the plant's recorded history. Returns false, with the reason printed, if the plant has none. */
bool offline_renderer_open_history(struct offline_renderer *offline, const struct snapshot_options *options);
/* Sets the readings and the view to an instant in the recorded history. Returns false if the history cannot be read (logged) or
   has no readings before that instant (printed). */
bool offline_renderer_seek(struct offline_renderer *offline, int64_t at_us, struct view *view);
/* Draws the view. Returns the frame, which the caller releases (frame_unref), or NULL on failure, after logging the reason. */
struct frame *offline_renderer_draw(struct offline_renderer *offline, const struct snapshot_options *options, struct view *view);
/* Writes the frame as a PNG file. On failure, logs the reason and returns false. */
bool offline_renderer_save(struct offline_renderer *offline, struct frame *frame, const char *path);
/* Frees all members, even if only some were opened. */
void offline_renderer_close(struct offline_renderer *offline);

#endif
