/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Findings of a reader about a model, as JSON for programs and as lines for people. Thread: one per object.
 *
 * A reader prints plain lines, and lines of fields that tabs separate:
 *   lost ID NAME CLASS GUID REASON   an element with a shape that has no triangles
 *   error COUNT TEXT                 an error that a library logged
 *   unit UNIT LENGTH                 the file states no unit, UNIT was taken; LENGTH: longest side in units of the file */
#ifndef PREPROCESS_IMPORT_FINDINGS_H
#define PREPROCESS_IMPORT_FINDINGS_H
#include <jansson.h>

#include "base/text/text.h"

/* Returns the findings of one model: {file, lost_count, lost (at most 20,000): [{id, name, class, guid, why}], errors: [{count, text}],
 * left_out: [text], unit: {taken, length} or null, failed: text or null}. said: what its reader printed; failed: why it was not imported,
 * or NULL. Appends to `plain` the lines to print. */
json_t *findings_read(const char *file, const char *said, const char *failed, struct text *plain);

#endif
