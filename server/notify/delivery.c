/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends alarm messages by SMTP and HTTP through libcurl. */
#include "notify/delivery.h"

#include <curl/curl.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/files/secret.h"
#include "base/mem.h"
#include "plant/sources/url.h"

enum { CONNECT_S = 10 };

struct transfer {
    CURL *handle; /* libcurl's handle for the message being sent; NULL: no message is being sent */
    struct curl_slist *list;
    char *body;
    size_t bytes, at;
    char why[CURL_ERROR_SIZE];
    struct log *log;
    int refused_now;   /* number of mailboxes that the mail server refused during this transfer */
    bool in_data;      /* true: the last command of the SMTP dialogue was DATA, so a reply concerns the message itself */
    bool is_refused;   /* true: the mail server refused the message itself */
    const char *name;  /* id of the recipient in the plant file, for the log */
    char mailbox[256]; /* mailbox named by the last RCPT command of the SMTP dialogue; empty: the last command was another one */
};

struct delivery {
    struct log *log;
    const struct plant_notify *notify;
    CURLM *multi;
    struct transfer *transfers; /* by recipient: its transfer */
};

struct delivery *delivery_create(struct log *log, const struct plant_notify *notify)
{
    struct delivery *delivery = mem_new(sizeof(*delivery));
    delivery->log = log;
    delivery->notify = notify;
    delivery->transfers = mem_array(notify->recipient_count + 1, sizeof(*delivery->transfers));
    if (curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK || !(delivery->multi = curl_multi_init())) {
        log_err(log, "notify: messages cannot be sent: libcurl cannot be initialised");
        delivery_destroy(&delivery);
    }
    return delivery;
}

static void end_transfer(struct delivery *delivery, struct transfer *transfer)
{
    if (transfer->handle) {
        curl_multi_remove_handle(delivery->multi, transfer->handle);
        curl_easy_cleanup(transfer->handle);
    }
    curl_slist_free_all(transfer->list);
    mem_free(transfer->body);
    *transfer = (struct transfer){ 0 };
}

void delivery_destroy(struct delivery **pointer)
{
    struct delivery *delivery = *pointer;
    if (!delivery)
        return;
    for (size_t i = 0; i < delivery->notify->recipient_count; i++)
        end_transfer(delivery, &delivery->transfers[i]);
    curl_multi_cleanup(delivery->multi);
    mem_free(delivery->transfers);
    mem_free(delivery);
    *pointer = NULL;
}

bool delivery_is_idle(const struct delivery *delivery, int recipient)
{
    return !delivery->transfers[recipient].handle;
}

/* --- requests --------------------------------------------------------------------------------------------------------------- */

static size_t give_body(char *buffer, size_t size, size_t count, void *arg)
{
    struct transfer *transfer = arg;
    size_t left = transfer->bytes - transfer->at, room = size * count, given = left < room ? left : room;
    memcpy(buffer, transfer->body + transfer->at, given);
    transfer->at += given;
    return given;
}

static size_t drop_answer(char *bytes, size_t size, size_t count, void *arg)
{
    (void)bytes;
    (void)arg;
    return size * count;
}

/* Returns true for replies to DATA and its text that will not change if the message is sent again (RFC 5321, 4.3.2), such as 550
   (policy), 552 (too large) and 554 (transaction failed). Replies 50x and 53x concern the commands and the login, not the message. */
static bool refuses_message(const char *bytes, int length)
{
    return length >= 3 && bytes[0] == '5' && bytes[1] != '0' && bytes[1] != '3';
}

/* Debug callback of libcurl. Logs when the mail server refuses a single mailbox: nothing else reports that, because the mail
   counts as delivered if other mailboxes accept it. Also finds out whether the mail server refuses the message itself. */
static int hear_refusals(CURL *handle, curl_infotype type, char *bytes, size_t count, void *arg)
{
    static const char ask[] = "RCPT TO:";
    struct transfer *transfer = arg;
    size_t skipped = sizeof(ask) - 1;
    int length = (int)(count < 400 ? count : 400);
    (void)handle;
    if (type == CURLINFO_HEADER_OUT)
        transfer->in_data = count >= 4 && !strncmp(bytes, "DATA", 4);
    else if (type == CURLINFO_HEADER_IN && transfer->in_data && refuses_message(bytes, length))
        transfer->is_refused = true;
    while (length > 0 && (bytes[length - 1] == '\r' || bytes[length - 1] == '\n'))
        length--;
    if (type == CURLINFO_HEADER_OUT && (size_t)length > skipped && !strncmp(bytes, ask, skipped))
        snprintf(transfer->mailbox, sizeof(transfer->mailbox), "%.*s", length - (int)skipped, bytes + skipped);
    else if (type == CURLINFO_HEADER_OUT)
        transfer->mailbox[0] = 0;
    else if (type == CURLINFO_HEADER_IN && transfer->mailbox[0] && length > 0 && (bytes[0] == '4' || bytes[0] == '5')) {
        transfer->refused_now += length < 4 || bytes[3] != '-'; /* only the last line of a reply has no '-' after its code */
        log_warn(transfer->log, "notify: %s: the mail server refused %s: %.*s", transfer->name, transfer->mailbox, length, bytes);
    }
    return 0;
}

static void set_common(struct delivery *delivery, struct transfer *transfer, const char *ca_file)
{
    CURL *handle = transfer->handle;
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, transfer->why);
    curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, drop_answer);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    curl_easy_setopt(handle, CURLOPT_TIMEOUT_MS, (long)(delivery->notify->timeout_s * 1000));
    curl_easy_setopt(handle, CURLOPT_SSLVERSION, (long)CURL_SSLVERSION_TLSv1_2);
    /* lets the daemon end without waiting for libcurl's resolver thread, which may be waiting for a dead name server */
    curl_easy_setopt(handle, CURLOPT_QUICK_EXIT, 1L);
    if (ca_file)
        curl_easy_setopt(handle, CURLOPT_CAINFO, ca_file);
}

static char *set_mail(struct delivery *delivery, struct transfer *transfer, const struct notify_recipient *recipient)
{
    const struct notify_mail *mail = &delivery->notify->mail;
    CURL *handle = transfer->handle;
    char *why = NULL, *password = mail->password_file ? secret_read(mail->password_file, &why) : NULL;
    if (why)
        return why;
    if (password) {
        curl_easy_setopt(handle, CURLOPT_USERNAME, mail->user);
        curl_easy_setopt(handle, CURLOPT_PASSWORD, password);
    }
    secret_forget(password);
    set_common(delivery, transfer, mail->ca_file);
    curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "smtp,smtps");
    curl_easy_setopt(handle, CURLOPT_URL, mail->server);
    curl_easy_setopt(handle, CURLOPT_USE_SSL, (long)(url_is_here(mail->server) ? CURLUSESSL_TRY : CURLUSESSL_ALL));
    curl_easy_setopt(handle, CURLOPT_MAIL_FROM, mail->from);
    for (size_t i = 0; i < recipient->addresses.count; i++)
        transfer->list = curl_slist_append(transfer->list, recipient->addresses.at[i]);
    curl_easy_setopt(handle, CURLOPT_MAIL_RCPT, transfer->list);
    /* if the mail server refuses one mailbox, libcurl still sends the mail to the others */
    curl_easy_setopt(handle, CURLOPT_MAIL_RCPT_ALLLOWFAILS, 1L);
    curl_easy_setopt(handle, CURLOPT_DEBUGFUNCTION, hear_refusals);
    curl_easy_setopt(handle, CURLOPT_DEBUGDATA, transfer);
    curl_easy_setopt(handle, CURLOPT_VERBOSE, 1L);
    curl_easy_setopt(handle, CURLOPT_UPLOAD, 1L);
    curl_easy_setopt(handle, CURLOPT_READFUNCTION, give_body);
    curl_easy_setopt(handle, CURLOPT_READDATA, transfer);
    return NULL;
}

static char *set_http(struct delivery *delivery, struct transfer *transfer, const struct notify_recipient *recipient)
{
    CURL *handle = transfer->handle;
    char *why = NULL, *token = recipient->token_file ? secret_read(recipient->token_file, &why) : NULL;
    if (why)
        return why;
    transfer->list = curl_slist_append(transfer->list, "Content-Type: application/json");
    transfer->list = curl_slist_append(transfer->list, "Expect:");
    if (token) {
        char *header = mem_printf("Authorization: Bearer %s", token);
        transfer->list = curl_slist_append(transfer->list, header);
        secret_forget(header);
    }
    secret_forget(token);
    set_common(delivery, transfer, recipient->ca_file);
    size_t length = strlen(recipient->url);
    bool slash = length > 0 && recipient->url[length - 1] == '/';
    char *url = recipient->kind == NOTIFY_ALERTMANAGER ? mem_printf("%s%sapi/v2/alerts", recipient->url, slash ? "" : "/")
                                                       : mem_strdup(recipient->url);
    curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(handle, CURLOPT_URL, url);
    mem_free(url);
    curl_easy_setopt(handle, CURLOPT_USERAGENT, "plantcastd");
    curl_easy_setopt(handle, CURLOPT_HTTPHEADER, transfer->list);
    curl_easy_setopt(handle, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)transfer->bytes);
    curl_easy_setopt(handle, CURLOPT_POSTFIELDS, transfer->body);
    curl_easy_setopt(handle, CURLOPT_FAILONERROR, 1L);
    return NULL;
}

char *delivery_start(struct delivery *delivery, int recipient, char *body, size_t bytes)
{
    const struct notify_recipient *to = &delivery->notify->recipients[recipient];
    struct transfer *transfer = &delivery->transfers[recipient];
    *transfer = (struct transfer){ .handle = curl_easy_init(), .body = body, .bytes = bytes, .log = delivery->log, .name = to->id };
    char *why = !transfer->handle          ? mem_strdup("out of memory")
                : to->kind == NOTIFY_EMAIL ? set_mail(delivery, transfer, to)
                                           : set_http(delivery, transfer, to);
    if (!why) {
        curl_easy_setopt(transfer->handle, CURLOPT_PRIVATE, (void *)transfer);
        if (curl_multi_add_handle(delivery->multi, transfer->handle) != CURLM_OK)
            why = mem_strdup("libcurl could not start to send the message");
    }
    if (why)
        end_transfer(delivery, transfer);
    return why;
}

/* --- waiting for results ---------------------------------------------------------------------------------------------------- */

/* Returns the HTTP status of the server's answer; -1: the transfer is not HTTP. */
static long http_status(const struct transfer *transfer)
{
    long status = 0;
    char *scheme = NULL;
    curl_easy_getinfo(transfer->handle, CURLINFO_RESPONSE_CODE, &status);
    curl_easy_getinfo(transfer->handle, CURLINFO_SCHEME, &scheme);
    return scheme && !strncasecmp(scheme, "http", 4) ? status : -1;
}

/* Returns NULL if the server accepted the message; else the reason, which the caller frees with mem_free(). A redirection counts as
   failure, because it may lead to a login page. */
static char *why_not(const struct transfer *transfer, CURLcode code)
{
    if (code != CURLE_OK)
        return mem_strdup(transfer->why[0] ? transfer->why : curl_easy_strerror(code));
    long status = http_status(transfer);
    return status != -1 && (status < 200 || status > 299) ? mem_printf("the server answered with HTTP status %ld", status) : NULL;
}

/* Returns true if the server refused the message itself: the mail server's reply to it, or an HTTP status that concerns its content.
   HTTP status 400 is not one: web servers also send it if the URL has http: instead of https:. */
static bool is_refused(const struct transfer *transfer)
{
    long status = http_status(transfer);
    return status == -1 ? transfer->is_refused : status == 413 || status == 422;
}

void delivery_wait(struct delivery *delivery, int timeout_ms, delivery_ended *each, void *arg)
{
    int running, left;
    curl_multi_perform(delivery->multi, &running);
    curl_multi_poll(delivery->multi, NULL, 0, timeout_ms, NULL);
    curl_multi_perform(delivery->multi, &running);
    for (CURLMsg *message; (message = curl_multi_info_read(delivery->multi, &left));) {
        if (message->msg != CURLMSG_DONE)
            continue;
        CURLcode code = message->data.result;
        struct transfer *transfer = NULL;
        curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, (char **)&transfer);
        char *why = why_not(transfer, code);
        bool refused = why && is_refused(transfer);
        int refused_mailboxes = why ? 0 : transfer->refused_now;
        end_transfer(delivery, transfer);
        each(arg, (int)(transfer - delivery->transfers), why, refused, refused_mailboxes);
        mem_free(why);
    }
}

void delivery_wake(struct delivery *delivery)
{
    curl_multi_wakeup(delivery->multi);
}
