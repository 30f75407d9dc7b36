/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fields of a tag in an exported tag list. */
#ifndef PREPROCESS_MATCH_EXPORT_FIELD_H
#define PREPROCESS_MATCH_EXPORT_FIELD_H

enum export_field { /* all fields of a tag are text; tag_export_read_numbers() gives numbers a decimal point */
                    EXPORT_NAME,
                    EXPORT_ADDRESS,
                    EXPORT_TYPE,
                    EXPORT_SCAN,
                    EXPORT_SCALING,
                    EXPORT_NEGATE, /* "1": the sign of the scaled value is reversed, or the bit is inverted; "0": not */
                    EXPORT_RAW_LOW,
                    EXPORT_RAW_HIGH,
                    EXPORT_SCALED_LOW,
                    EXPORT_SCALED_HIGH,
                    EXPORT_UNIT,
                    EXPORT_DESCRIPTION,
                    EXPORT_AREA, /* area, folder or path of the tag in the control system */
                    EXPORT_DEVICE,
                    EXPORT_LL,
                    EXPORT_L,
                    EXPORT_H,
                    EXPORT_HH,
                    EXPORT_SPAN, /* length of the range, if the list states the range's low end and length */
                    EXPORT_FIELDS
};

#endif
