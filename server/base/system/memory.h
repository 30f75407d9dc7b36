/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory usage of this process. Call from any thread. */
#ifndef BASE_SYSTEM_MEMORY_H
#define BASE_SYSTEM_MEMORY_H
#include <stddef.h>
#include <stdint.h>

/* Returns the size of the machine's memory in bytes, or the control group's limit if that is less. */
size_t memory_machine_bytes(void);
/* Returns the default memory limit in bytes: a quarter of memory_machine_bytes(), at most 2 GiB. */
size_t memory_default_bytes(void);

struct memory_use {             /* memory usage of the process, in bytes */
    size_t resident, anonymous; /* resident: bytes in RAM; anonymous: the part not mapped from files */
    size_t allocated;           /* bytes allocated by malloc() */
};
void memory_measure(struct memory_use *use); /* Measures how much memory this process uses now, and fills *use. */
/* Gives free pages of the heap back to the operating system. */
void memory_trim(void);

#endif
