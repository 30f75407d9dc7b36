/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Certificates and logins of an OPC UA client, and the check of server certificates. Call from one thread only. */
#ifndef VALUE_OPCUA_SECURITY_H
#define VALUE_OPCUA_SECURITY_H
#include <open62541/client.h>
#include <openssl/x509.h>

#include "plant/plant.h"

struct opcua_security {
    const char *server_name;        /* host name that the server's certificate must contain */
    UA_ByteString certificate, key; /* our certificate and private key in DER; empty with `security: none` */
    UA_ByteString user_certificate, user_key;
    char *application_uri; /* application URI in our certificate */
    X509_STORE *trusted;
};

/* Reads the certificate files that a source names. host: host name of the server. Returns false with the file and the reason in `why` if
   one cannot be used. Call opcua_security_finish() in both cases. `config` and `host` must outlive the struct. */
bool opcua_security_init(struct opcua_security *security, const struct plant_opcua *config, const char *host, char why[200]);
void opcua_security_finish(struct opcua_security *security);
/* Checks a server's certificate. It must be valid now and issued for the host, have a key that is long enough, and be trusted
 * itself or through its issuers. Removes the issuers' certificates from *chain. Returns a status code; if it is Bad, `why` has
 * the reason. */
UA_StatusCode opcua_security_check(const struct opcua_security *security, UA_ByteString *chain, char why[200]);
/* Sets security in the configuration of an open62541 client: our certificate in all policies, and the user from the file `login` (NULL:
   anonymous). Returns false with the reason in `why`. The logger in `config` must be set before the call. */
bool opcua_security_apply(const struct opcua_security *security, const char *login, UA_ClientConfig *config, char why[200]);
/* Returns the URI that identifies a security policy. */
const char *opcua_policy_uri(enum opcua_policy policy);

#endif
