/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frees and measures encoded frames. */
#include "service/encoded_frame.h"

#include "base/mem.h"

void encoded_frame_destroy(struct encoded_frame **encoded)
{
    if (!*encoded)
        return;
    for (int i = 0; i < (*encoded)->earlier_count; i++)
        packet_unref(&(*encoded)->earlier[i]);
    mem_free((*encoded)->earlier);
    packet_unref(&(*encoded)->packet);
    mem_free(*encoded);
    *encoded = NULL;
}

size_t encoded_frame_bytes(const struct encoded_frame *encoded)
{
    size_t bytes = encoded->packet->count;
    for (int i = 0; i < encoded->earlier_count; i++)
        bytes += encoded->earlier[i]->count;
    return bytes;
}

bool encoded_frame_stands_alone(const struct encoded_frame *encoded)
{
    return encoded->earlier_count > 0 ? encoded->earlier[0]->key : encoded->packet->key;
}
