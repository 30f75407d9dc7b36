/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All pipe runs between the equipment and along the rack, as assets L-101 and on. */
#ifndef GENERATE_LINES_H
#define GENERATE_LINES_H
#include "equipment.h"

void lines_build(struct site *site); /* after all equipment: it connects named nozzles */

#endif
