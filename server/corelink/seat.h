/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tells a core from all others, also from one of the same name: a random number in its history folder, which no other process of the
   machine may use meanwhile, and which a copy of the folder does not keep. Thread: any. */
#ifndef CORELINK_SEAT_H
#define CORELINK_SEAT_H

struct seat {
    int fd; /* locked until it is closed */
    char id[9];
};

/* Takes the seat of a folder, which is made where it is missing. Returns NULL, or why it cannot be had (mem_free). */
char *seat_take(struct seat *seat, const char *folder);
void seat_leave(struct seat *seat); /* zero-initialised is fine */

#endif
