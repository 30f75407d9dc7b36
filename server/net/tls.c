/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads and checks the TLS certificate, and makes libwebsockets serve it to clients. */
#include "net/tls.h"

#include <errno.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "access/file_watch.h"

enum { HOUR_S = 3600, DAY_S = 24 * HOUR_S, WARN_BEFORE_S = 14 * DAY_S };

struct tls {
    struct log *log;
    char *cert_path, *key_path;
    struct file_watch cert_watch, key_watch;
    SSL_CTX *checked; /* newest certificate that passed the checks; NULL: none yet */
    bool served;      /* true: libwebsockets serves `checked` */
    time_t warned_s;  /* time when the last warning about the certificate's expiry was logged, in seconds of UTC; 0: none yet */
};

/* Returns why a file cannot be loaded. OpenSSL lists the cause first, and then the functions that failed for that reason. */
static const char *why(char out[200])
{
    unsigned long code = ERR_peek_error();
    const char *reason = ERR_reason_error_string(code);
    if (ERR_SYSTEM_ERROR(code))
        snprintf(out, 200, "%s", strerror(ERR_GET_REASON(code)));
    else if ((ERR_GET_LIB(code) == ERR_LIB_PEM && ERR_GET_REASON(code) == PEM_R_NO_START_LINE) || ERR_GET_LIB(code) == ERR_LIB_OSSL_DECODER)
        snprintf(out, 200, "the file contains no certificate, or no private key, that OpenSSL can read, in PEM format");
    else if ((ERR_GET_LIB(code) == ERR_LIB_X509 && ERR_GET_REASON(code) == X509_R_KEY_VALUES_MISMATCH) ||
             (ERR_GET_LIB(code) == ERR_LIB_SSL && ERR_GET_REASON(code) == SSL_R_NO_CERTIFICATE_ASSIGNED))
        snprintf(out, 200, "this private key does not belong to the certificate");
    else if (code)
        snprintf(out, 200, "%s (OpenSSL error %08lX)", reason ? reason : "unknown reason", code);
    else
        snprintf(out, 200, "%s", errno ? strerror(errno) : "no reason given");
    ERR_clear_error();
    return out;
}

static bool load(SSL_CTX *context, const struct tls *tls, const char **at)
{
    errno = 0;
    ERR_clear_error();
    *at = tls->cert_path;
    if (SSL_CTX_use_certificate_chain_file(context, tls->cert_path) != 1)
        return false;
    *at = tls->key_path;
    return SSL_CTX_use_PrivateKey_file(context, tls->key_path, SSL_FILETYPE_PEM) == 1 && SSL_CTX_check_private_key(context) == 1;
}

static void mark_read(struct file_watch *watch, const char *path)
{
    struct stat st;
    file_watch_read(watch, stat(path, &st) == 0 ? &st : NULL);
}

int64_t tls_ends_s(const struct tls *tls)
{
    struct tm utc;
    const X509 *cert = SSL_CTX_get0_certificate(tls->checked);
    return cert && ASN1_TIME_to_tm(X509_get0_notAfter(cert), &utc) == 1 ? (int64_t)timegm(&utc) : 0;
}

static void warn_of_end(struct tls *tls, time_t now_s)
{
    int64_t left_s = tls_ends_s(tls) - (int64_t)now_s;
    tls->warned_s = now_s;
    if (left_s <= 0)
        log_event(tls->log, LOG_ERROR, EVENT_CERTIFICATE_EXPIRES, "%s: this certificate has expired", tls->cert_path);
    else if (left_s < WARN_BEFORE_S)
        log_event(tls->log, LOG_WARN, EVENT_CERTIFICATE_EXPIRES, "%s: this certificate expires within 14 days, in %.1f %s", tls->cert_path,
                  (double)left_s / (left_s < DAY_S ? HOUR_S : DAY_S), left_s < DAY_S ? "hours" : "days");
}

/* Returns whether to warn about the certificate's expiry: once a day, once an hour on the last day, and when the certificate expires. */
static bool is_time_to_warn(const struct tls *tls, time_t now_s)
{
    int64_t ends_s = tls_ends_s(tls);
    bool last_day = now_s < ends_s && ends_s - now_s < DAY_S;
    return (tls->warned_s < ends_s) != (now_s < ends_s) || llabs((long long)(now_s - tls->warned_s)) >= (last_day ? HOUR_S : DAY_S);
}

static void warn(struct tls *tls)
{
    struct stat st;
    if (stat(tls->key_path, &st) == 0 && (st.st_mode & S_IROTH))
        log_warn(tls->log, "%s: all users of this machine can read this private key: run chmod 640 on the file", tls->key_path);
    warn_of_end(tls, time(NULL));
}

/* Loads the certificate and its key, and checks them. Returns false, after logging the reason, if they cannot be served. */
static bool check(struct tls *tls)
{
    char text[200];
    const char *at = "OpenSSL cannot create a TLS context";
    SSL_CTX *context = SSL_CTX_new(TLS_server_method());
    mark_read(&tls->cert_watch, tls->cert_path);
    mark_read(&tls->key_watch, tls->key_path);
    if (!context || !load(context, tls, &at)) {
        log_event(tls->log, LOG_ERROR, EVENT_CERTIFICATE_REFUSED, "TLS: %s: %s", at, why(text));
        SSL_CTX_free(context);
        return false;
    }
    SSL_CTX_free(tls->checked);
    tls->checked = context;
    warn(tls);
    return true;
}

struct tls *tls_create(struct log *log, const char *cert_path, const char *key_path)
{
    struct tls *tls = mem_new(sizeof(*tls));
    *tls = (struct tls){ .log = log, .cert_path = mem_strdup(cert_path), .key_path = mem_strdup(key_path) };
    if (!check(tls))
        tls_destroy(&tls);
    return tls;
}

void tls_destroy(struct tls **tls_ptr)
{
    struct tls *tls = *tls_ptr;
    if (!tls)
        return;
    SSL_CTX_free(tls->checked);
    mem_free(tls->cert_path);
    mem_free(tls->key_path);
    mem_free(tls);
    *tls_ptr = NULL;
}

/* Writes a certificate and its chain, which are public, to a file that all users can read. Returns 0 or -errno. */
static int write_chain(const SSL_CTX *context, const char *path)
{
    STACK_OF(X509) *chain = NULL;
    struct atomic_file file;
    char *bytes;
    BIO *pem = BIO_new(BIO_s_mem());
    bool good = pem && PEM_write_bio_X509(pem, SSL_CTX_get0_certificate(context)) == 1;
    SSL_CTX_get0_chain_certs((SSL_CTX *)context, &chain);
    for (int i = 0; good && i < sk_X509_num(chain); i++)
        good = PEM_write_bio_X509(pem, sk_X509_value(chain, i)) == 1;
    long count = good ? BIO_get_mem_data(pem, &bytes) : 0;
    int error = count > 0 ? atomic_file_begin(&file, path, 0644) : -ENOMEM;
    if (!error) {
        error = fchmod(file.fd, 0644) != 0 ? -errno : atomic_file_write(&file, bytes, (size_t)count);
        if (error)
            atomic_file_abandon(&file);
        else
            error = atomic_file_commit(&file, false);
    }
    BIO_free(pem);
    return error;
}

/* Writes the active certificate to the service's folder in /run, where Prometheus and other programs of this machine read it to
   verify this server. */
static void publish(const struct tls *tls)
{
    const char *runtime = getenv("RUNTIME_DIRECTORY");
    if (!runtime || !*runtime)
        return;
    char *path = mem_printf("%.*s/certificate.pem", (int)strcspn(runtime, ":"), runtime);
    int error = write_chain(tls->checked, path);
    if (error)
        log_warn(tls->log, "%s: %s", path, strerror(-error));
    mem_free(path);
}

/* Gives a new connection the newest certificate. OpenSSL keeps one certificate for each type of key in a server's SSL_CTX. A new
   certificate with another type of key would be added there, and would not replace the old one. Therefore this callback sets the
   certificate on each connection. */
static int choose_certificate(SSL *connection, void *arg)
{
    const struct tls *tls = arg;
    STACK_OF(X509) *chain = NULL;
    SSL_CTX_get0_chain_certs(tls->checked, &chain);
    SSL_certs_clear(connection);
    return SSL_use_cert_and_key(connection, SSL_CTX_get0_certificate(tls->checked), SSL_CTX_get0_privatekey(tls->checked), chain, 1);
}

void tls_serve(struct tls *tls, SSL_CTX *context)
{
    publish(tls);
    SSL_CTX_set_cert_cb(context, choose_certificate, tls);
    SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
    /* allows for TLS 1.2 only ciphers with forward secrecy and authenticated encryption, so no CBC ciphers; TLS 1.3 needs no
       list, because all its ciphers are secure */
    SSL_CTX_set_cipher_list(context, "ECDHE+AESGCM:ECDHE+CHACHA20");
    tls->served = true;
}

void tls_look(struct tls *tls)
{
    time_t now_s = time(NULL);
    if (is_time_to_warn(tls, now_s))
        warn_of_end(tls, now_s);
    bool cert = file_watch_changed(&tls->cert_watch, tls->cert_path), key = file_watch_changed(&tls->key_watch, tls->key_path);
    if ((!cert && !key) || !check(tls) || !tls->served)
        return;
    publish(tls);
    log_info(tls->log, "TLS: %s: serving the new certificate", tls->cert_path);
}

bool tls_is_called(const struct tls *tls, const char *name)
{
    X509 *cert = SSL_CTX_get0_certificate(tls->checked);
    return cert && X509_check_host(cert, name, 0, 0, NULL) == 1;
}
