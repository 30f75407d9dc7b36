/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Certificates and logins of an OPC UA client, and the check of server certificates. Thread: one. */
#ifndef VALUE_OPCUA_SECURITY_H
#define VALUE_OPCUA_SECURITY_H
#include <open62541/client.h>
#include <openssl/x509.h>

#include "plant/plant.h"

struct opcua_security {
    const char *server_name;        /* host name that server certificates must contain */
    UA_ByteString certificate, key; /* our certificate and key, DER; empty with `security: none` */
    UA_ByteString user_certificate, user_key;
    char *application_uri; /* application URI from our certificate */
    X509_STORE *trusted;
};

/* Reads the certificate files that a source names. `host`: the host to connect to. Returns false with the file and the reason in `why`
   if one cannot be used; opcua_security_finish() is needed all the same. `config` and `host` must outlive the struct. */
bool opcua_security_init(struct opcua_security *security, const struct plant_opcua *config, const char *host, char why[200]);
void opcua_security_finish(struct opcua_security *security);
/* Checks a server's certificate: valid now, issued for the right host, key long enough, trusted by itself or through its issuers. Cuts the
   issuers' certificates off *chain. Returns a status code; if it is Bad, `why` has the reason. */
UA_StatusCode opcua_security_check(const struct opcua_security *security, UA_ByteString *chain, char why[200]);
/* Configures a client: our certificate in all policies, and the user from the file `login` (NULL: anonymous). Returns false with the
   reason in `why`. The logging in `config` must be set before. */
bool opcua_security_apply(const struct opcua_security *security, const char *login, UA_ClientConfig *config, char why[200]);
/* Returns the URI of a security policy. */
const char *opcua_policy_uri(enum opcua_policy policy);

#endif
