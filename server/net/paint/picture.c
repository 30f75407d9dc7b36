/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures go. */
#include "net/paint/picture.h"

#include "base/mem.h"

void picture_destroy(struct picture **picture)
{
    if (!*picture)
        return;
    for (int i = 0; i < (*picture)->earlier_count; i++)
        packet_unref(&(*picture)->earlier[i]);
    mem_free((*picture)->earlier);
    packet_unref(&(*picture)->packet);
    mem_free(*picture);
    *picture = NULL;
}

size_t picture_bytes(const struct picture *picture)
{
    size_t bytes = picture->packet->count;
    for (int i = 0; i < picture->earlier_count; i++)
        bytes += picture->earlier[i]->count;
    return bytes;
}

bool picture_stands_alone(const struct picture *picture)
{
    return picture->earlier_count > 0 ? picture->earlier[0]->key : picture->packet->key;
}
