/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "readers.h"

#include <gio/gio.h>
#include <stdio.h>
#include <string.h>

#include "access/login_throttle.h"

/* Compares in constant time, so that the time does not tell which letter differs. */
static bool is_same(const char *said, const char *expected)
{
    gsize count = strlen(expected);
    int differs = strlen(said) != count;
    for (gsize i = 0; said[i] && i < count; i++)
        differs |= said[i] ^ expected[i];
    return !differs;
}

/* Writes the reader's address as bytes (IPv4 mapped into IPv6) and as text. */
static void find_address(SoupServerMessage *message, uint8_t bytes[16], char text[64])
{
    GSocketAddress *peer = soup_server_message_get_remote_address(message);
    memset(bytes, 0, 16);
    strcpy(text, "?");
    if (!G_IS_INET_SOCKET_ADDRESS(peer))
        return;
    GInetAddress *address = g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(peer));
    gsize count = g_inet_address_get_native_size(address);
    char *said = g_inet_address_to_string(address);
    if (count == 4)
        bytes[10] = bytes[11] = 0xff;
    memcpy(bytes + 16 - count, g_inet_address_to_bytes(address), count);
    g_strlcpy(text, said, 64);
    g_free(said);
}

bool reader_may(const struct options *options, SoupServerMessage *message, const char *user, const char *password)
{
    static struct login_throttle *throttle;
    static const uint8_t reader_hash[TOKEN_HASH_BYTES]; /* stands for the one password that there is */
    int64_t now_ns = g_get_monotonic_time() * 1000;
    uint8_t address[16];
    char text[64];
    find_address(message, address, text);
    if (!throttle)
        throttle = login_throttle_create();
    bool user_good = !user || is_same(user, options->user), good = is_same(password, options->password) && user_good;
    enum login login = login_throttle_judge(throttle, address, good ? reader_hash : NULL, now_ns);
    if (login == LOGIN_WRONG || login == LOGIN_WRONG_SLOWS)
        fprintf(stderr, "plantcast-video: wrong user or password from %s%s\n", text,
                login == LOGIN_WRONG_SLOWS ? "; only one in five seconds is judged from there now" : "");
    return login_is_good(login);
}
