/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of the OPC UA quality codes that readings have. */
#include "value/quality.h"

#include <stddef.h>

static const struct {
    uint32_t code;
    const char *name;
} names[] = {
    { QUALITY_GOOD, "Good" },
    { QUALITY_UNCERTAIN_LAST_USABLE, "Uncertain_LastUsableValue" },
    { QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, "Uncertain_NoCommunicationLastUsableValue" },
    { QUALITY_UNCERTAIN_SENSOR_NOT_ACCURATE, "Uncertain_SensorNotAccurate" },
    { QUALITY_UNCERTAIN_UNITS_EXCEEDED, "Uncertain_EngineeringUnitsExceeded" },
    { QUALITY_BAD_COMMUNICATION_ERROR, "Bad_CommunicationError" },
    { QUALITY_BAD_NO_COMMUNICATION, "Bad_NoCommunication" },
    { QUALITY_BAD_WAITING, "Bad_WaitingForInitialData" },
    { QUALITY_BAD_TOO_MANY_MATCHES, "Bad_TooManyMatches" },
    { QUALITY_BAD_NO_MATCH, "Bad_NoMatch" },
    { QUALITY_BAD_CONFIGURATION, "Bad_ConfigurationError" },
    { QUALITY_BAD_DEVICE_FAILURE, "Bad_DeviceFailure" },
    { QUALITY_BAD_SENSOR_FAILURE, "Bad_SensorFailure" },
    { QUALITY_BAD_OUT_OF_SERVICE, "Bad_OutOfService" },
};

const char *quality_name(uint32_t q)
{
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (names[i].code == quality_code(q))
            return names[i].name;
    return quality_is_good(q) ? "Good" : quality_is_uncertain(q) ? "Uncertain" : "Bad";
}

const char *quality_class(uint32_t q)
{
    return quality_is_good(q) ? "good" : quality_is_uncertain(q) ? "uncertain" : "bad";
}
