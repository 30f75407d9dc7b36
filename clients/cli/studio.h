/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All that draws pictures of a prepared plant without a daemon. */
#ifndef CLI_STUDIO_H
#define CLI_STUDIO_H
#include "history/history.h"
#include "net/access.h"
#include "render/canvas.h"
#include "snapshot.h"

struct studio { /* freed in the opposite order */
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
    char *history;       /* its folder */
    int64_t first_us, last_us; /* what was recorded lies between them */
};

/* The plant, its files, values and baseline, and the view of options->args. 0, else the exit code; the reason is printed. */
int studio_open(struct studio *studio, struct snapshot_options *options, struct view *view);
/* The same plant, drawn by the same renderer, with other values, baseline and view: as studio_open. */
int studio_turn(struct studio *studio, struct snapshot_options *options, struct view *view);
bool studio_open_gl(struct studio *studio, const struct snapshot_options *options); /* false: logged */
bool studio_open_history(struct studio *studio, const struct snapshot_options *options); /* false: there is none; said */
/* Studio and view go to an instant of the past. False: it cannot be read (logged), or nothing was recorded by then (said). */
bool studio_travel(struct studio *studio, int64_t at_us, struct view *view);
/* NULL: logged. frame_unref. */
struct frame *studio_draw(struct studio *studio, const struct snapshot_options *options, struct view *view);
bool studio_save(struct studio *studio, struct frame *frame, const char *path); /* as PNG. False: logged */
void studio_close(struct studio *studio);

#endif
