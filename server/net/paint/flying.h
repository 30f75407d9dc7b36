/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures that a GPU has been given whole and that are waited for, oldest first: another one is drawn meanwhile. Thread: the render
   thread. */
#ifndef NET_FLYING_H
#define NET_FLYING_H
#include "net/paint/batch.h"
#include "render/canvas.h"
#include "value/moments.h"
#include "value/store.h"

enum { FLYING_MOST = 3 };

struct flying {
    struct flying_picture {
        struct canvas *canvas;
        struct batch batch;         /* whom it is for */
        const struct moment *moment; /* what it shows, held; NULL: the snapshot */
        struct snapshot *snapshot;
        uint64_t content;           /* canvas_content */
        int64_t field_ns;
    } at[FLYING_MOST];
    int count;
};

void flying_init(struct flying *flying, size_t tag_count);
void flying_finish(struct flying *flying); /* none is under way */
/* There is room. Takes canvas, moment and batch over, and the snapshot where there is no moment; *batch and *snapshot are others then, of
   no content. */
void flying_push(struct flying *flying, const struct flying_picture *picture, struct batch *batch, struct snapshot **snapshot);
/* The one that is drawn for somebody else already. NULL: none. */
struct flying_picture *flying_find(struct flying *flying, uint64_t content);
/* The oldest has come down, its moment is given back; its batch and snapshot serve the next. */
const struct snapshot *flying_readings(const struct flying_picture *picture); /* what it shows */
void flying_pop(struct flying *flying);

#endif
