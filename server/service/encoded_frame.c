/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures go. */
#include "service/encoded_frame.h"

#include "base/mem.h"

void encoded_frame_destroy(struct encoded_frame **picture)
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

size_t encoded_frame_bytes(const struct encoded_frame *picture)
{
    size_t bytes = picture->packet->count;
    for (int i = 0; i < picture->earlier_count; i++)
        bytes += picture->earlier[i]->count;
    return bytes;
}

bool encoded_frame_stands_alone(const struct encoded_frame *picture)
{
    return picture->earlier_count > 0 ? picture->earlier[0]->key : picture->packet->key;
}
