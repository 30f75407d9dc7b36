/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures go. */
#include "net/picture.h"

#include "base/mem.h"

void picture_destroy(struct picture **picture)
{
    if (!*picture)
        return;
    packet_unref(&(*picture)->packet);
    mem_free(*picture);
    *picture = NULL;
}
