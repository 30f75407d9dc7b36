/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names and MESSAGE_IDs of events. An identifier must never change, because programs match it. */

#include "base/log/log.h"

static const struct {
    const char *name, *id;
} events[EVENT_COUNT] = {
    [EVENT_READY] = { "ready", "7daf3322e49645a9be1ea095bfc868ba" },
    [EVENT_STOPPING] = { "stopping", "caee3d5b11564efda8693f43b82fec14" },
    [EVENT_RELOADED] = { "reloaded", "9f38847d17964894b87f61b33745992d" },
    [EVENT_RELOAD_REFUSED] = { "reload-refused", "2a53caf377e04e2fbe61b63960bf62b2" },
    [EVENT_CERTIFICATE_EXPIRES] = { "certificate-expires", "1eaac142fb0c470cbe822dc1829635d2" },
    [EVENT_CERTIFICATE_REFUSED] = { "certificate-refused", "d9cba2d3e8544de881638a55c7bf0f3d" },
    [EVENT_LOGIN_REFUSED] = { "login-refused", "c0c82d0d80a14d3e9ab4596a081f50ba" },
    [EVENT_HISTORY_UNWRITABLE] = { "history-unwritable", "0ac9a44ee73d4f119bb19f44a1971ee5" },
    [EVENT_HISTORY_WRITTEN] = { "history-written", "c064d741ee4c477bb4d3a87a3b3f7226" },
    [EVENT_HISTORY_LOST] = { "history-lost", "b6fe244b6ab142f59b086213062634a4" },
    [EVENT_AUDIT] = { "audit", "7a27c336fe9f2b6273eb4eb3326da376" },
    [EVENT_AUDIT_UNWRITABLE] = { "audit-unwritable", "3466dd222f962bef08faa5bb4b9969af" },
    [EVENT_AUDIT_WRITTEN] = { "audit-written", "c621267e1d782dc40803f391bdf13121" },
    [EVENT_AUDIT_BROKEN] = { "audit-broken", "6d23628aa3f59791d7339053f3d4784e" },
    [EVENT_AUDIT_NOT_SENT] = { "audit-not-sent", "d2b34ca0d711ea0bb2b3f29d9eb80181" },
    [EVENT_OPENID_FAILS] = { "openid-fails", "6ea31f6a8c4a17474743ed01ec757079" },
};

const char *log_event_name(enum log_event event)
{
    return events[event].name;
}

const char *log_event_id(enum log_event event)
{
    return events[event].id;
}
