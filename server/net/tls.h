/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The certificate: checked before it is served, and taken anew when its files change. Thread: the loop. */
#ifndef NET_TLS_H
#define NET_TLS_H
#include <openssl/ssl.h>
#include <stdbool.h>

#include "base/log.h"

struct tls;
/* Both are PEM files. NULL: they cannot be served; the reason is logged. */
struct tls *tls_create(struct log *log, const char *cert_path, const char *key_path);
void tls_destroy(struct tls **tls); /* &NULL is fine; leaves NULL */
/* What connections are made with from now on. */
void tls_serve(struct tls *tls, SSL_CTX *context);
/* Looks whether the files are others by now. A certificate that cannot be served leaves the old one in force. */
void tls_look(struct tls *tls);
bool tls_is_called(const struct tls *tls, const char *name); /* the certificate is for this name */

#endif
