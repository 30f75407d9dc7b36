/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All that draws pictures of a prepared plant without a daemon. */
#ifndef CLI_OFFLINE_RENDERER_H
#define CLI_OFFLINE_RENDERER_H
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

/* The plant, its files, values and baseline, and the view of options->args. 0, else the exit code; the reason is printed. */
int offline_renderer_open(struct offline_renderer *offline, struct snapshot_options *options, struct view *view);
/* The same plant, drawn by the same renderer, with other values, baseline and view: as offline_renderer_open. */
int offline_renderer_reopen(struct offline_renderer *offline, struct snapshot_options *options, struct view *view);
bool offline_renderer_open_gl(struct offline_renderer *offline, const struct snapshot_options *options); /* false: logged */
bool offline_renderer_open_history(struct offline_renderer *offline,
                                   const struct snapshot_options *options); /* false: there is none; said */
/* Studio and view go to an instant of the past. False: it cannot be read (logged), or nothing was recorded by then (said). */
bool offline_renderer_seek(struct offline_renderer *offline, int64_t at_us, struct view *view);
/* NULL: logged. frame_unref. */
struct frame *offline_renderer_draw(struct offline_renderer *offline, const struct snapshot_options *options, struct view *view);
bool offline_renderer_save(struct offline_renderer *offline, struct frame *frame, const char *path); /* as PNG. False: logged */
void offline_renderer_close(struct offline_renderer *offline);

#endif
