/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Huge pages, if the system has them: speed up access to memory that is read from end to end. Call from any thread. */
#ifndef BASE_SYSTEM_HUGE_PAGES_H
#define BASE_SYSTEM_HUGE_PAGES_H
#include <stddef.h>

/* Asks the system to back a range with huge pages; best called before the range is first written. NULL with 0 bytes is fine. */
void huge_pages_advise(void *p, size_t bytes);

#endif
