/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asks the kernel for huge pages; the kernel may ignore the request. */
#include "base/system/huge_pages.h"

#include <stdint.h>
#include <sys/mman.h>

#define LARGE ((size_t)2 << 20)

void huge_pages_advise(void *p, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    size_t before = -(uintptr_t)p % LARGE;
    if (p && bytes >= before + LARGE)
        madvise((char *)p + before, (bytes - before) / LARGE * LARGE, MADV_HUGEPAGE);
#else
    (void)p;
    (void)bytes;
#endif
}
