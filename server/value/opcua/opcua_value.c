/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts values of all numeric types of OPC UA to doubles. An array of several dimensions is indexed like a one-dimensional
   array, in the order of its elements in the message. */
#include "value/opcua/opcua_value.h"

#include <open62541/types_generated.h>
#include <stdio.h>

#include "value/quality.h"

static const uint32_t NO_SUCH_ELEMENT = 0x80370000; /* Bad_IndexRangeNoData */

/* Converts OPC UA time (units of 100 ns since 1601) to nanoseconds since 1970; 0: before 1970 or after 2262. */
static int64_t utc_ns_of(UA_DateTime time)
{
    int64_t ticks = time - UA_DATETIME_UNIX_EPOCH;
    return time > UA_DATETIME_UNIX_EPOCH && ticks < INT64_MAX / 100 ? ticks * 100 : 0;
}

static bool number_of(const UA_DataType *type, const void *at, double *out)
{
    switch (type->typeKind) {
    case UA_DATATYPEKIND_BOOLEAN: *out = *(const UA_Boolean *)at; return true;
    case UA_DATATYPEKIND_SBYTE: *out = *(const UA_SByte *)at; return true;
    case UA_DATATYPEKIND_BYTE: *out = *(const UA_Byte *)at; return true;
    case UA_DATATYPEKIND_INT16: *out = *(const UA_Int16 *)at; return true;
    case UA_DATATYPEKIND_UINT16: *out = *(const UA_UInt16 *)at; return true;
    case UA_DATATYPEKIND_INT32:
    case UA_DATATYPEKIND_ENUM: *out = *(const UA_Int32 *)at; return true;
    case UA_DATATYPEKIND_UINT32: *out = *(const UA_UInt32 *)at; return true;
    case UA_DATATYPEKIND_INT64: *out = (double)*(const UA_Int64 *)at; return true;
    case UA_DATATYPEKIND_UINT64: *out = (double)*(const UA_UInt64 *)at; return true;
    case UA_DATATYPEKIND_FLOAT: *out = *(const UA_Float *)at; return true;
    case UA_DATATYPEKIND_DOUBLE: *out = *(const UA_Double *)at; return true;
    default: return false;
    }
}

static bool read_number(const UA_Variant *variant, int element, struct stamped_value *out, char why[200])
{
    bool is_scalar = UA_Variant_isScalar(variant);
    if (!variant->type)
        snprintf(why, 200, "the OPC UA node has no value (null)");
    else if (is_scalar != (element < 0))
        snprintf(why, 200,
                 is_scalar
                     ? "the node's value is not an array; remove the element in brackets from the address"
                     : "the node's value is an array; write the number of an element in brackets in front of the address, such as [0]");
    else if (!is_scalar && (size_t)element >= variant->arrayLength)
        snprintf(why, 200, "the node's array has only %zu elements", variant->arrayLength);
    else if (!number_of(variant->type, (const char *)variant->data + (is_scalar ? 0 : (size_t)element) * variant->type->memSize,
                        &out->value))
        snprintf(why, 200, "the type of the node's value is not a number");
    else
        return true;
    bool is_short = variant->type && !is_scalar && element >= 0 && (size_t)element >= variant->arrayLength;
    out->quality = is_short ? NO_SUCH_ELEMENT : variant->type ? QUALITY_BAD_CONFIGURATION : QUALITY_BAD_SENSOR_FAILURE;
    return false;
}

bool opcua_value_read(const UA_DataValue *data, int element, struct stamped_value *out, char why[200])
{
    *out = (struct stamped_value){ .quality = data->hasStatus ? data->status : QUALITY_GOOD };
    if (data->hasSourceTimestamp || data->hasServerTimestamp)
        out->utc_ns = utc_ns_of(data->hasSourceTimestamp ? data->sourceTimestamp : data->serverTimestamp);
    if (quality_is_bad(out->quality))
        return true;
    static const UA_Variant nothing;
    return read_number(data->hasValue ? &data->value : &nothing, element, out, why);
}
