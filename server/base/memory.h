/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What this process takes, and may take. Thread: any. */
#ifndef BASE_MEMORY_H
#define BASE_MEMORY_H
#include <stddef.h>
#include <stdint.h>

/* A quarter of the machine, or of what its control group may take, at most 2 GiB. */
size_t memory_default_bytes(void);

struct memory_use {             /* bytes */
    size_t resident, anonymous; /* in RAM; of these, what is no file's */
    size_t allocated;           /* handed out by malloc */
};
void memory_measure(struct memory_use *use);
/* What malloc keeps goes back to the machine, as far as whole pages are free. */
void memory_trim(void);

#endif
