/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A DataValue of OPC UA as a reading: its status code and its source's time stay as they are, bit by bit. Pure. Thread: any. */
#ifndef VALUE_OPCUA_VALUE_H
#define VALUE_OPCUA_VALUE_H
#include <open62541/types.h>
#include <stdbool.h>

#include "value/stamped_writer.h"

/* Reads the value, or one element of an array (element -1: it is none). Returns false if it holds no number, or the array is too short;
   *out is then Bad, and why says what is wrong. */
bool opcua_value_read(const UA_DataValue *data, int element, struct stamped_value *out, char why[200]);

#endif
