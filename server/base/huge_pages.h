/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Large pages, where the system has them: memory that is read from end to end comes sooner. Any thread. */
#ifndef BASE_HUGE_PAGES_H
#define BASE_HUGE_PAGES_H
#include <stddef.h>

/* Asks for them for what of these bytes lies in whole ones; best before anything is written there. NULL with 0 bytes is fine. */
void huge_pages_advise(void *p, size_t bytes);

#endif
