/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quality of a reading as an OPC UA status code (Part 4, 7.39; Part 8, annex A). Its two top bits are the severity: Good,
 * Uncertain or Bad. */
#ifndef VALUE_QUALITY_H
#define VALUE_QUALITY_H
#include <stdbool.h>
#include <stdint.h>

enum {
    QUALITY_GOOD = 0x00000000,
    QUALITY_UNCERTAIN = 0x40000000,
    QUALITY_UNCERTAIN_SENSOR_NOT_ACCURATE = 0x40930000,
    QUALITY_UNCERTAIN_LAST_USABLE = 0x40900000,
    QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE = 0x408F0000,
    QUALITY_UNCERTAIN_UNITS_EXCEEDED = 0x40940000,
};
#define QUALITY_BAD 0x80000000u
#define QUALITY_BAD_COMMUNICATION_ERROR 0x80050000u
#define QUALITY_BAD_NO_COMMUNICATION 0x80310000u
#define QUALITY_BAD_WAITING 0x80320000u /* BadWaitingForInitialData */
#define QUALITY_BAD_TOO_MANY_MATCHES 0x806D0000u
#define QUALITY_BAD_NO_MATCH 0x806F0000u
#define QUALITY_BAD_CONFIGURATION 0x80890000u
#define QUALITY_BAD_DEVICE_FAILURE 0x808B0000u
#define QUALITY_BAD_SENSOR_FAILURE 0x808C0000u
#define QUALITY_BAD_OUT_OF_SERVICE 0x808D0000u

/* Returns a status code without its info bits, which say for example that a limit was reached or a queue overflowed. */
static inline uint32_t quality_code(uint32_t q)
{
    return q & 0xFFFF0000u;
}
static inline bool quality_is_good(uint32_t q)
{
    return (q >> 30) == 0;
}
static inline bool quality_is_uncertain(uint32_t q)
{
    return (q >> 30) == 1;
}
static inline bool quality_is_bad(uint32_t q)
{
    return (q >> 30) >= 2;
}
/* Returns true if the severity (Good, Uncertain, Bad) of `q` is higher than that of `than`. */
static inline bool quality_is_worse(uint32_t q, uint32_t than)
{
    return (q >> 30) > (than >> 30);
}
/* Returns the name of a status code, such as "Bad_CommunicationError". For a code that is not in the table, returns the name of its
 * severity, such as "Bad". */
const char *quality_name(uint32_t q);
/* Returns the severity of a status code as used in JSON messages: "good", "uncertain" or "bad". */
const char *quality_class(uint32_t q);

#endif
