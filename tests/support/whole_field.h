/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the field at all vertices of an asset, which makes all of its levels of detail valid. */
#ifndef TESTS_WHOLE_FIELD_H
#define TESTS_WHOLE_FIELD_H
#include "field/field.h"

/* Returns the field at all vertices of the asset, as field_scalars_of() computes it. */
static inline const struct scalars *field_scalars(struct field *field, int asset, const struct field_params *params,
                                                  const struct snapshot *snapshot)
{
    return field_scalars_of(field, asset, params, snapshot, field_scene(field)->assets[asset].file->view.header->vertex_count);
}

#endif
