/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures that a GPU has been given whole and that are waited for, oldest first: another one is drawn meanwhile. Thread: the render
   thread. */
#ifndef SERVICE_AWAITED_FRAMES_H
#define SERVICE_AWAITED_FRAMES_H
#include "service/request_group.h"
#include "render/split_view.h"
#include "value/snapshot_cache.h"
#include "value/store.h"

enum { AWAITED_FRAMES_MOST = 3 };

struct awaited_frames {
    struct awaited_frame {
        struct split_view *split;
        struct request_group batch;                   /* whom it is for */
        const struct historical_snapshot *historical; /* what it shows, held; NULL: the snapshot */
        struct snapshot *snapshot;
        uint64_t content; /* split_view_content */
        int64_t field_ns;
    } at[AWAITED_FRAMES_MOST];
    int count;
};

void awaited_frames_init(struct awaited_frames *flying, size_t tag_count);
void awaited_frames_finish(struct awaited_frames *flying); /* none is under way */
/* There is room. Takes split, moment and batch over, and the snapshot where there is no moment; *batch and *snapshot are others then, of
   no content. */
void awaited_frames_push(struct awaited_frames *flying, const struct awaited_frame *picture, struct request_group *batch,
                         struct snapshot **snapshot);
/* The one that is drawn for somebody else already. NULL: none. */
struct awaited_frame *awaited_frames_find(struct awaited_frames *flying, uint64_t content);
/* The oldest has come down, its moment is given back; its batch and snapshot serve the next. */
const struct snapshot *awaited_frames_readings(const struct awaited_frame *picture); /* what it shows */
void awaited_frames_pop(struct awaited_frames *flying);

#endif
