/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pipe runs, section by section. */
#include "lines.h"

void lines_build(struct site *site)
{
    (void)site;
}
