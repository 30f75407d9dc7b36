/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who we are to an OPC UA server, and which servers are believed. Thread: one. */
#ifndef VALUE_OPCUA_SECURITY_H
#define VALUE_OPCUA_SECURITY_H
#include <open62541/client.h>
#include <openssl/x509.h>

#include "plant/plant.h"

struct opcua_security {
    const char *server_name;        /* that certificates of servers must have */
    UA_ByteString certificate, key; /* our own, DER; empty with security: none */
    UA_ByteString user_certificate, user_key;
    char *application_uri;          /* as in our certificate */
    X509_STORE *trusted;
};

/* Reads the files that a source names. host: that we connect to. Returns false if one cannot be used, and says in why which and what is
   wrong with it; opcua_security_finish() is needed all the same. config and host must outlive it. */
bool opcua_security_init(struct opcua_security *security, const struct plant_opcua *config, const char *host, char why[200]);
void opcua_security_finish(struct opcua_security *security);
/* Checks a server's certificate: that it is valid now, is for the right host, has a key that is long enough, and is trusted itself or by
   who signed it. Cuts the certificates of those off what *chain has. Returns a status code, with why it is Bad. */
UA_StatusCode opcua_security_check(const struct opcua_security *security, UA_ByteString *chain, char why[200]);
/* Gives a client what it needs to speak: our certificate in all policies, and who logs in by the file `login` (NULL: nobody).
   Returns false likewise. config's logging is set. */
bool opcua_security_apply(const struct opcua_security *security, const char *login, UA_ClientConfig *config, char why[200]);
/* Returns the URI of a policy. */
const char *opcua_policy_uri(enum opcua_policy policy);

#endif
