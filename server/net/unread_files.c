/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the files with users' entries that could not be read. */
#include "net/unread_files.h"

#include <stddef.h>

#include "access/pairings.h"
#include "views/named_views.h"
#include "views/notes.h"
#include "views/short_links.h"
#include "views/wall_remote.h"

int unread_files(const struct plant_services *plant, const char *names[UNREAD_FILES])
{
    const char *const files[UNREAD_FILES] = { plant->named_views ? named_views_unread_file(plant->named_views) : NULL,
                                              plant->notes ? notes_unread_file(plant->notes) : NULL,
                                              plant->short_links ? short_links_unread_file(plant->short_links) : NULL,
                                              plant->wall_remote ? wall_remote_unread_file(plant->wall_remote) : NULL,
                                              plant->pairings ? pairings_unread_file(plant->pairings) : NULL };
    int count = 0;
    for (int i = 0; i < UNREAD_FILES; i++)
        if (files[i])
            names[count++] = files[i];
    return count;
}
