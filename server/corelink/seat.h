/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A core's unique identity, even among cores with the same name: a random number in its history folder. Only one process may use it at a
   time, and a copy of the folder does not keep it. Thread: any. */
#ifndef CORELINK_SEAT_H
#define CORELINK_SEAT_H

struct seat {
    int fd; /* locked until it is closed */
    char id[9];
};

/* Locks the identity of a folder, and creates it if it is missing. Returns NULL on success, or an error message (mem_free). */
char *seat_take(struct seat *seat, const char *folder);
void seat_leave(struct seat *seat); /* Releases the identity; a zero-initialised struct is fine. */

#endif
