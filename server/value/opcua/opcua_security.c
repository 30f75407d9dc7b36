/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks certificates of OPC UA servers with OpenSSL. The check in open62541 ignores the host name, and accepts a server whose
   first response contains no certificate. */
#include "value/opcua/opcua_security.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <errno.h>
#include <open62541/plugin/securitypolicy_default.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <string.h>

#include "base/files/login_file.h"
#include "base/mem.h"

enum { KEY_BITS = 2048, FILE_BYTES = 1 << 20 };

/* --- files ------------------------------------------------------------------------------------------------------------------ */

static BIO *open_file(const char *path, char why[200])
{
    BIO *file = BIO_new_file(path, "rb");
    if (!file)
        snprintf(why, 200, "%.120s cannot be read: %s", path, strerror(errno));
    return file;
}

/* Reads a certificate in PEM or DER. Returns NULL if the file is neither. */
static X509 *read_certificate(BIO *file)
{
    X509 *found = PEM_read_bio_X509(file, NULL, NULL, NULL);
    if (!found && BIO_reset(file) == 0)
        found = d2i_X509_bio(file, NULL);
    ERR_clear_error();
    return found;
}

static X509_CRL *read_crl(BIO *file)
{
    X509_CRL *found = PEM_read_bio_X509_CRL(file, NULL, NULL, NULL);
    if (!found && BIO_reset(file) == 0)
        found = d2i_X509_CRL_bio(file, NULL);
    ERR_clear_error();
    return found;
}

/* Callback of OpenSSL that must supply the passphrase of an encrypted key. Fails, because nobody is present to type one. */
static int no_passphrase(char *out, int bytes, int for_writing, void *arg)
{
    (void)out, (void)bytes, (void)for_writing, (void)arg;
    return -1;
}

static UA_ByteString taken(unsigned char *der, int bytes)
{
    UA_ByteString out = UA_BYTESTRING_NULL;
    if (bytes > 0 && UA_ByteString_allocBuffer(&out, (size_t)bytes) == UA_STATUSCODE_GOOD)
        memcpy(out.data, der, (size_t)bytes);
    OPENSSL_free(der);
    return out;
}

/* Reads a certificate and its private key from files, and converts both to DER. Returns false with the file and the reason in `why`. */
static bool read_pair(const char *certificate_path, const char *key_path, UA_ByteString *certificate, UA_ByteString *key, X509 **out,
                      char why[200])
{
    unsigned char *der = NULL;
    BIO *file = open_file(certificate_path, why);
    if (!file)
        return false;
    *out = read_certificate(file);
    BIO_free(file);
    if (!*out) {
        snprintf(why, 200, "%.120s has no certificate", certificate_path);
        return false;
    }
    int bytes = i2d_X509(*out, &der);
    *certificate = taken(der, bytes);
    file = open_file(key_path, why);
    if (!file)
        return false;
    EVP_PKEY *pair = PEM_read_bio_PrivateKey(file, NULL, no_passphrase, NULL);
    if (!pair && BIO_reset(file) == 0)
        pair = d2i_PrivateKey_bio(file, NULL);
    BIO_free(file);
    ERR_clear_error();
    der = NULL;
    bytes = pair ? i2d_PrivateKey(pair, &der) : 0;
    *key = taken(der, bytes);
    bool fits = pair && X509_check_private_key(*out, pair) == 1;
    if (!pair)
        snprintf(why, 200, "the key file %.120s has no private key, or one protected by a passphrase", key_path);
    else if (!fits)
        snprintf(why, 200, "%.80s is not the private key of certificate %.80s", key_path, certificate_path);
    EVP_PKEY_free(pair);
    ERR_clear_error();
    return fits;
}

/* Returns the applicationUri in our certificate. Servers require it to equal the one that we announce. */
static char *application_uri_of(X509 *certificate)
{
    GENERAL_NAMES *names = X509_get_ext_d2i(certificate, NID_subject_alt_name, NULL, NULL);
    char *uri = NULL;
    for (int i = 0; names && !uri && i < sk_GENERAL_NAME_num(names); i++) {
        const GENERAL_NAME *name = sk_GENERAL_NAME_value(names, i);
        if (name->type == GEN_URI)
            uri = mem_printf("%.*s", ASN1_STRING_length(name->d.uniformResourceIdentifier),
                             (const char *)ASN1_STRING_get0_data(name->d.uniformResourceIdentifier));
    }
    GENERAL_NAMES_free(names);
    return uri;
}

static bool trust_file(struct opcua_security *security, const char *path, char why[200])
{
    BIO *file = open_file(path, why);
    X509 *certificate = file ? read_certificate(file) : NULL;
    X509_CRL *crl = file && !certificate && BIO_reset(file) == 0 ? read_crl(file) : NULL;
    bool good = certificate || crl;
    if (file && !good)
        snprintf(why, 200, "%.120s contains neither a certificate nor a revocation list", path);
    if (certificate)
        X509_STORE_add_cert(security->trusted, certificate);
    if (crl) {
        X509_STORE_add_crl(security->trusted, crl);
        X509_STORE_set_flags(security->trusted, X509_V_FLAG_CRL_CHECK | X509_V_FLAG_CRL_CHECK_ALL);
    }
    X509_free(certificate);
    X509_CRL_free(crl);
    BIO_free(file);
    return good;
}

/* Verification callback of OpenSSL: accepts a certificate without a revocation list from its issuer, which OpenSSL would reject. */
static int on_verified(int good, X509_STORE_CTX *context)
{
    int error = X509_STORE_CTX_get_error(context);
    if (!good && error == X509_V_ERR_UNABLE_TO_GET_CRL) {
        X509_STORE_CTX_set_error(context, X509_V_OK);
        return 1;
    }
    return good;
}

static bool trust_folder(struct opcua_security *security, const char *path, char why[200])
{
    DIR *folder = opendir(path);
    size_t count = 0;
    bool good = folder;
    if (!folder)
        snprintf(why, 200, "%.120s cannot be read: %s", path, strerror(errno));
    for (const struct dirent *entry; good && (entry = readdir(folder));) {
        char *file = mem_printf("%s/%s", path, entry->d_name);
        if (*entry->d_name != '.') {
            good = trust_file(security, file, why);
            count++;
        }
        mem_free(file);
    }
    if (good && count == 0)
        snprintf(why, 200, "%.120s contains no certificate, so no OPC UA server is trusted", path);
    if (folder)
        closedir(folder);
    return good && count > 0;
}

bool opcua_security_init(struct opcua_security *security, const struct plant_opcua *config, const char *host, char why[200])
{
    X509 *ours = NULL, *user = NULL;
    *security = (struct opcua_security){ .server_name = config->server_name ? config->server_name : host };
    if (config->policy == OPCUA_NONE) {
        security->application_uri = mem_strdup("urn:plantcast");
        return true;
    }
    security->trusted = X509_STORE_new();
    X509_STORE_set_flags(security->trusted, X509_V_FLAG_PARTIAL_CHAIN);
    X509_STORE_set_verify_cb(security->trusted, on_verified);
    bool good = read_pair(config->certificate, config->key, &security->certificate, &security->key, &ours, why) &&
                trust_folder(security, config->trusted, why);
    if (good && config->user_certificate)
        good = read_pair(config->user_certificate, config->user_key, &security->user_certificate, &security->user_key, &user, why);
    security->application_uri = good ? application_uri_of(ours) : NULL;
    if (good && !security->application_uri) {
        snprintf(why, 200, "the certificate %.120s has no application URI among its alternative names", config->certificate);
        good = false;
    }
    X509_free(ours);
    X509_free(user);
    return good;
}

void opcua_security_finish(struct opcua_security *security)
{
    UA_ByteString *const bytes[] = { &security->certificate, &security->key, &security->user_certificate, &security->user_key };
    for (size_t i = 0; i < sizeof(bytes) / sizeof(*bytes); i++) {
        if (bytes[i]->data)
            OPENSSL_cleanse(bytes[i]->data, bytes[i]->length);
        UA_ByteString_clear(bytes[i]);
    }
    mem_free(security->application_uri);
    X509_STORE_free(security->trusted);
    *security = (struct opcua_security){ 0 };
}

/* --- servers ---------------------------------------------------------------------------------------------------------------- */

static bool is_for(X509 *certificate, const char *name)
{
    unsigned char address[16];
    bool is_address = inet_pton(AF_INET, name, address) == 1 || inet_pton(AF_INET6, name, address) == 1;
    return (is_address ? X509_check_ip_asc(certificate, name, 0) : X509_check_host(certificate, name, 0, 0, NULL)) == 1;
}

static UA_StatusCode status_of(int error)
{
    switch (error) {
    case X509_V_ERR_CERT_NOT_YET_VALID:
    case X509_V_ERR_CERT_HAS_EXPIRED: return UA_STATUSCODE_BADCERTIFICATETIMEINVALID;
    case X509_V_ERR_CERT_REVOKED: return UA_STATUSCODE_BADCERTIFICATEREVOKED;
    default: return UA_STATUSCODE_BADCERTIFICATEUNTRUSTED;
    }
}

static UA_StatusCode check_chain(const struct opcua_security *security, X509 *leaf, STACK_OF(X509) * others, char why[200])
{
    X509_STORE_CTX *context = X509_STORE_CTX_new();
    bool good = context && X509_STORE_CTX_init(context, security->trusted, leaf, others) == 1 && X509_verify_cert(context) == 1;
    int error = context ? X509_STORE_CTX_get_error(context) : X509_V_ERR_OUT_OF_MEM;
    if (!good)
        snprintf(why, 200, "the server's certificate: %s", X509_verify_cert_error_string(error));
    X509_STORE_CTX_free(context);
    ERR_clear_error();
    return good ? UA_STATUSCODE_GOOD : status_of(error);
}

static UA_StatusCode check_leaf(const struct opcua_security *security, X509 *leaf, char why[200])
{
    EVP_PKEY *key = X509_get0_pubkey(leaf);
    UA_StatusCode status = UA_STATUSCODE_GOOD;
    if (!key || EVP_PKEY_base_id(key) != EVP_PKEY_RSA || EVP_PKEY_bits(key) < KEY_BITS) {
        snprintf(why, 200, "the OPC UA server's certificate has no RSA key of %d bits or more", KEY_BITS);
        status = UA_STATUSCODE_BADCERTIFICATEPOLICYCHECKFAILED;
    } else if (!is_for(leaf, security->server_name)) {
        snprintf(why, 200, "the OPC UA server's certificate is not for %.100s: set `server_name` to the name in the certificate",
                 security->server_name);
        status = UA_STATUSCODE_BADCERTIFICATEHOSTNAMEINVALID;
    }
    ERR_clear_error();
    return status;
}

UA_StatusCode opcua_security_check(const struct opcua_security *security, UA_ByteString *chain, char why[200])
{
    const unsigned char *at = chain->data, *end = at + chain->length;
    X509 *leaf = chain->length > 0 ? d2i_X509(NULL, &at, (long)chain->length) : NULL;
    STACK_OF(X509) *others = sk_X509_new_null();
    if (!leaf || !security->trusted) {
        snprintf(why, 200,
                 leaf ? "no OPC UA server is trusted, because the folder `trust` is empty" : "the OPC UA server sent no certificate");
        sk_X509_free(others);
        X509_free(leaf);
        ERR_clear_error();
        return UA_STATUSCODE_BADCERTIFICATEINVALID;
    }
    size_t leaf_bytes = (size_t)(at - chain->data);
    for (X509 *next; at < end && sk_X509_num(others) < 8 && (next = d2i_X509(NULL, &at, (long)(end - at)));)
        sk_X509_push(others, next);
    UA_StatusCode status = check_chain(security, leaf, others, why);
    if (status == UA_STATUSCODE_GOOD)
        status = check_leaf(security, leaf, why);
    chain->length = leaf_bytes;
    sk_X509_pop_free(others, X509_free);
    X509_free(leaf);
    ERR_clear_error();
    return status;
}

/* --- a client's configuration ----------------------------------------------------------------------------------------------- */

const char *opcua_policy_uri(enum opcua_policy policy)
{
    static const char *const uris[] = { [OPCUA_AES256] = "http://opcfoundation.org/UA/SecurityPolicy#Aes256_Sha256_RsaPss",
                                        [OPCUA_BASIC256] = "http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256",
                                        [OPCUA_AES128] = "http://opcfoundation.org/UA/SecurityPolicy#Aes128_Sha256_RsaOaep",
                                        [OPCUA_NONE] = "http://opcfoundation.org/UA/SecurityPolicy#None" };
    return policy == OPCUA_BEST ? "" : uris[policy];
}

static UA_StatusCode verify(const UA_CertificateVerification *verification, const UA_ByteString *certificate)
{
    const struct opcua_security *security = verification->context;
    if (!security->trusted) /* no certificate to trust is loaded with `security: none` */
        return UA_STATUSCODE_GOOD;
    UA_ByteString chain = *certificate;
    char why[200];
    return opcua_security_check(security, &chain, why);
}

/* Accepts any application URI. open62541 calls this function only for our own certificate, which our URI was read from. */
static UA_StatusCode verify_uri(const UA_CertificateVerification *verification, const UA_ByteString *certificate, const UA_String *uri)
{
    (void)verification, (void)certificate, (void)uri;
    return UA_STATUSCODE_GOOD;
}

/* Adds all security policies that we support to a client's configuration. with_none: also adds the policy None, before the
   others. Returns false if out of memory. */
static bool add_policies(UA_SecurityPolicy **out, size_t *count, UA_ByteString certificate, UA_ByteString key, bool with_none,
                         const UA_Logger *logger)
{
    static UA_StatusCode (*const makers[])(UA_SecurityPolicy *, const UA_ByteString, const UA_ByteString,
                                           const UA_Logger *) = { UA_SecurityPolicy_Aes256Sha256RsaPss, UA_SecurityPolicy_Basic256Sha256,
                                                                  UA_SecurityPolicy_Aes128Sha256RsaOaep };
    bool good = true;
    *out = UA_calloc(4, sizeof(**out));
    if (*out && with_none) {
        good = UA_SecurityPolicy_None(*out, UA_BYTESTRING_NULL, logger) == UA_STATUSCODE_GOOD;
        *count += good;
    }
    for (size_t i = 0; good && *out && certificate.length > 0 && i < sizeof(makers) / sizeof(*makers); i++) {
        good = makers[i](*out + *count, certificate, key, logger) == UA_STATUSCODE_GOOD;
        *count += good;
    }
    return good && *out;
}

/* Sets the user of the session, from the login file or the user's certificate. Returns false with the reason in `why`. */
static bool log_in(const struct opcua_security *security, const char *path, UA_ClientConfig *config, char why[200])
{
    struct login_file login;
    if (security->user_certificate.length > 0) {
        UA_X509IdentityToken *token = UA_X509IdentityToken_new();
        UA_ByteString_copy(&security->user_certificate, &token->certificateData);
        UA_ExtensionObject_setValue(&config->userIdentityToken, token, &UA_TYPES[UA_TYPES_X509IDENTITYTOKEN]);
        return true;
    }
    if (!path)
        return true;
    if (!login_file_read(path, &login, why))
        return false;
    UA_UserNameIdentityToken *token = UA_UserNameIdentityToken_new();
    token->userName = UA_STRING_ALLOC(login.user);
    token->password = UA_STRING_ALLOC(login.password ? login.password : "");
    UA_ExtensionObject_setValue(&config->userIdentityToken, token, &UA_TYPES[UA_TYPES_USERNAMEIDENTITYTOKEN]);
    login_file_forget(&login);
    return true;
}

bool opcua_security_apply(const struct opcua_security *security, const char *login, UA_ClientConfig *config, char why[200])
{
    bool has_user = security->user_certificate.length > 0;
    config->certificateVerification =
        (UA_CertificateVerification){ .context = (void *)security, .verifyCertificate = verify, .verifyApplicationURI = verify_uri };
    config->clientDescription.applicationUri = UA_STRING_ALLOC(security->application_uri);
    config->clientDescription.applicationType = UA_APPLICATIONTYPE_CLIENT;
    bool good = add_policies(&config->securityPolicies, &config->securityPoliciesSize, security->certificate, security->key, true,
                             config->logging) &&
                add_policies(&config->authSecurityPolicies, &config->authSecurityPoliciesSize,
                             has_user ? security->user_certificate : security->certificate, has_user ? security->user_key : security->key,
                             false, config->logging);
    if (!good)
        snprintf(why, 200,
                 "no security policy accepts this client's certificate and key: check `certificate`, `key`, `user_certificate` "
                 "and `user_key`");
    return good && log_in(security, login, config, why);
}
