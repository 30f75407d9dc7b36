/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The TLS certificate: checked before it is served, and read again when its files change. Call only in the event loop. */
#ifndef NET_TLS_H
#define NET_TLS_H
#include <openssl/ssl.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"

struct tls;
/* Reads both PEM files. Returns NULL if they cannot be served; the reason is logged. */
struct tls *tls_create(struct log *log, const char *cert_path, const char *key_path);
void tls_destroy(struct tls **tls); /* frees the certificate and sets *tls to NULL; accepts a pointer to NULL */
/* Makes the OpenSSL context use the certificate, now and after each change of its files. If a service manager runs the daemon,
   also writes the certificate in use to certificate.pem in the service's folder (RUNTIME_DIRECTORY). */
void tls_serve(struct tls *tls, SSL_CTX *context);
/* Reads the files again if they changed. If the new certificate cannot be served, logs that and keeps the old one active. Warns
   about a certificate that expires within 14 days, once a day and more often on its last day. */
void tls_look(struct tls *tls);
/* Returns when the active certificate expires, in seconds since 1970 (UTC). */
int64_t tls_ends_s(const struct tls *tls);
/* Returns whether the certificate is valid for that host name. */
bool tls_is_called(const struct tls *tls, const char *name);

#endif
