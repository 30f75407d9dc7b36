/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory use of this process. Thread: any. */
#ifndef BASE_SYSTEM_MEMORY_H
#define BASE_SYSTEM_MEMORY_H
#include <stddef.h>
#include <stdint.h>

/* Returns the machine's memory, or that of the control group if it is less. */
size_t memory_machine_bytes(void);
/* Returns the default memory limit: a quarter of the machine's memory, or of that of the control group, at most 2 GiB. */
size_t memory_default_bytes(void);

struct memory_use {            /* bytes */
    size_t resident, anonymous; /* in RAM; of these, not mapped from files */
    size_t allocated;           /* allocated by malloc */
};
void memory_measure(struct memory_use *use); /* fills *use with the present numbers */
/* Returns free pages of the heap to the system. */
void memory_trim(void);

#endif
