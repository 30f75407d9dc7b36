/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts an OPC UA DataValue to a value with quality and time; keeps the status code and source timestamp unchanged. No side
   effects. Call from any thread. */
#ifndef VALUE_OPCUA_VALUE_H
#define VALUE_OPCUA_VALUE_H
#include <open62541/types.h>
#include <stdbool.h>

#include "value/stamped_writer.h"

/* Reads the value, or one element of an array (element -1: the value is not an array). Returns false with the reason in `why`, and *out
 * Bad, if the value is not a number or the array has no such element. */
bool opcua_value_read(const UA_DataValue *data, int element, struct stamped_value *out, char why[200]);

#endif
