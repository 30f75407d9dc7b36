/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State words that historians write in place of a value, such as "Bad", "No Data" or "I/O Timeout". No side effects. Call from any
   thread. */
#ifndef VALUE_STATE_WORD_H
#define VALUE_STATE_WORD_H
#include <stdbool.h>
#include <stdint.h>

/* Returns true if the text says that there is no value, and sets *quality to the matching Bad quality. Such texts are blanks,
   dashes, NaN, null, spreadsheet errors (#N/A), digital states of PI, and quality names of OPC UA and Ignition. Case and
   punctuation do not matter. Other text leaves *quality unchanged. */
bool state_word_is_bad(const char *text, uint32_t *quality);

#endif
